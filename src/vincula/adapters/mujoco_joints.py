"""The kinematic tree of a compiled MuJoCo model: bodies, joints and sites of the mechanism graph.

Body frames are MuJoCo's body frames and configuration values are MuJoCo's `qpos` values; a joint's
`ref` is therefore folded into the frame on its first body.  Several joints of one body are a chain
with massless bodies `body:joint` between them.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, Final

import mujoco
import numpy as np

from vincula.adapters.mujoco_names import ModelNames, unused
from vincula.mechanism.parts import GROUND, Body, Frame, Joint, Limits
from vincula.spatial.poses import Pose, frame_with_z, rotation_about

_FREE: Final = int(mujoco.mjtJoint.mjJNT_FREE)
_BALL: Final = int(mujoco.mjtJoint.mjJNT_BALL)
_SLIDE: Final = int(mujoco.mjtJoint.mjJNT_SLIDE)
TYPES: Final = {
    _FREE: "free",
    _BALL: "spherical",
    _SLIDE: "prismatic",
    int(mujoco.mjtJoint.mjJNT_HINGE): "revolute",
}
"""Our joint type of every MuJoCo joint type."""

_WIDTH: Final = {"free": 7, "spherical": 4, "prismatic": 1, "revolute": 1}
_Z: Final = np.array([0.0, 0.0, 1.0])


def joint_type_of(model: Any, joint: int) -> str:
    """Our name for the type of joint `joint`."""
    return TYPES[int(model.jnt_type[joint])]


def joint_values(model: Any, joint: int, qpos: Any) -> tuple[float, ...]:
    """The values of one joint in a `qpos` vector; quaternions as they stand."""
    start = int(model.jnt_qposadr[joint])
    return tuple(float(x) for x in qpos[start : start + _WIDTH[joint_type_of(model, joint)]])


class Tree:
    """Bodies and joints in MuJoCo's order, with the home configuration `qpos0`.

    Attributes:
        bodies: Bodies; the ground is not among them.
        joints: Joints of the file, and a fixed joint for every body without one.
        mocap: Names of the mocap bodies, which are fixed to the ground where they are.
    """

    def __init__(self, model: Any, names: ModelNames, mocap: Mapping[int, Pose] | None = None) -> None:
        self._model, self._names = model, names
        self._mocap = mocap or {}
        self._efforts = _efforts(model)
        self._pose: dict[str, Pose] = {GROUND: Pose.identity()}
        self._taken = set(names.bodies)
        self._joint_names = {*names.joints, *names.equalities}  # loop joints are called as equalities
        self.bodies: list[Body] = []
        self.joints: list[Joint] = []
        self.mocap: list[str] = []
        for body in range(1, model.nbody):
            self._add_body(body)

    def _add_body(self, body: int) -> None:
        model, name = self._model, self._names.bodies[body]
        parent = self._names.bodies[int(model.body_parentid[body])]
        offset = Pose.from_quaternion_wxyz(model.body_quat[body], model.body_pos[body])
        if int(model.body_mocapid[body]) >= 0:
            offset = self._mocap.get(body, offset)
            self.mocap.append(name)
        count, start = int(model.body_jntnum[body]), int(model.body_jntadr[body])
        if count == 0:
            joint = unused(f"{name}.fixed", self._joint_names)
            self._joint_names.add(joint)
            self._add(Joint(joint, "fixed", parent, name, offset, Pose.identity()), offset)
            return
        first = parent
        for index in range(start, start + count):
            last = index == start + count - 1
            second = name if last else unused(f"{name}:{self._names.joints[index]}", self._taken)
            self._taken.add(second)
            self._add(self._joint(index, first, second, offset), offset)
            first, offset = second, Pose.identity()

    def _add(self, joint: Joint, offset: Pose) -> None:
        """Append a joint and its second body, which stands at `offset` from the first at `qpos0`."""
        pose = self._pose[joint.first] @ offset
        if joint.type == "free":
            pose = Pose.from_quaternion_wxyz(joint.home[3:], joint.home[:3])
        elif joint.type == "spherical" and joint.home != (1.0, 0.0, 0.0, 0.0):
            turn = Pose.from_quaternion_wxyz(joint.home)
            pose = self._pose[joint.first] @ joint.frame_on_first @ turn @ joint.frame_on_second.inverse()
        self._pose[joint.second] = pose
        self.bodies.append(Body(joint.second, pose))
        self.joints.append(joint)

    def _joint(self, index: int, first: str, second: str, offset: Pose) -> Joint:
        model = self._model
        kind, name = joint_type_of(model, index), self._names.joints[index]
        home = joint_values(model, index, model.qpos0)
        if kind == "free":
            return Joint(name, kind, GROUND, second, Pose.identity(), Pose.identity(), home=home)
        if kind == "spherical":
            on_second = Pose.at(model.jnt_pos[index])
            return Joint(name, kind, first, second, offset @ on_second, on_second, home=home)
        on_second = Pose.at(model.jnt_pos[index], frame_with_z(np.array(model.jnt_axis[index], dtype=float)))
        on_first = offset @ on_second @ _back(kind, home[0])
        return Joint(name, kind, first, second, on_first, on_second, home=home, limits=self._limits(index))

    def _limits(self, index: int) -> tuple[Limits, ...]:
        limited = bool(self._model.jnt_limited[index])
        effort = self._efforts.get(index)
        if not limited and effort is None:
            return ()
        lower, upper = (float(x) for x in self._model.jnt_range[index])
        return (Limits(lower if limited else None, upper if limited else None, None, effort),)


def _back(kind: str, reference: float) -> Pose:
    """The motion by `-reference` along or about z: at `qpos = ref` a body stands as it is drawn."""
    if reference == 0.0:
        return Pose.identity()
    if kind == "prismatic":
        return Pose.at((0.0, 0.0, -reference))
    return Pose.at((0.0, 0.0, 0.0), rotation_about(_Z, -reference))


def _efforts(model: Any) -> dict[int, float]:
    """Largest torque or force [N m, N] by hinge and slide joint, where the model limits it."""
    by_motor: dict[int, float] = {}
    for actuator in range(model.nu):
        if int(model.actuator_trntype[actuator]) not in (
            int(mujoco.mjtTrn.mjTRN_JOINT),
            int(mujoco.mjtTrn.mjTRN_JOINTINPARENT),
        ):
            continue
        limit = math.inf
        if model.actuator_forcelimited[actuator]:
            gear = abs(float(model.actuator_gear[actuator][0]))
            limit = gear * _largest(model.actuator_forcerange[actuator])
        joint = int(model.actuator_trnid[actuator][0])
        by_motor[joint] = by_motor.get(joint, 0.0) + limit
    for joint in range(model.njnt):
        if model.jnt_actfrclimited[joint]:
            by_motor[joint] = min(by_motor.get(joint, math.inf), _largest(model.jnt_actfrcrange[joint]))
    return {joint: effort for joint, effort in by_motor.items() if math.isfinite(effort)}


def _largest(interval: Any) -> float:
    return max(abs(float(interval[0])), abs(float(interval[1])))


def site_frames(model: Any, names: ModelNames) -> list[Frame]:
    """The sites as named frames."""
    return [
        Frame(
            names.sites[site],
            names.bodies[int(model.site_bodyid[site])],
            Pose.from_quaternion_wxyz(model.site_quat[site], model.site_pos[site]),
        )
        for site in range(model.nsite)
    ]
