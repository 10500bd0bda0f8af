"""What closing and following hold: motor positions, locked axes, the pose of the reference member."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from vincula.arrays import Vector, checked
from vincula.errors import ModelError, UnknownNameError
from vincula.mechanism.closure_problem import ClosureProblem
from vincula.mechanism.closure_unknowns import MEMBER
from vincula.mechanism.closure_values import Mask
from vincula.mechanism.configuration import Configuration
from vincula.mechanism.joint_types import values_between
from vincula.spatial.poses import Pose

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism
    from vincula.mechanism.parts import Joint

MotorValues = Mapping[str, float | Sequence[float] | Vector]
"""Values by joint, axis or motor name [rad, m]."""
POINT: Final = "(position of the reference point)"
"""Name of what is held when the reference point alone is."""
PoseOrPoint = Pose | Sequence[float] | Vector
"""Where the reference member is to be: point and body axes in ground axes, or the point alone [m]."""


@dataclass(frozen=True, slots=True, eq=False)
class Holding:
    """Values that are asked for.

    Attributes:
        joints: Whole values by joint name.
        axes: One value by axis name, for joints with several axes.
        drives: One value by name of a motor over several axes.
        pose: Pose of the reference member: reference point and body axes in ground axes.
        point: Position of the reference point, when its orientation is left free [m].
    """

    joints: Mapping[str, Vector]
    axes: Mapping[str, float]
    drives: Mapping[str, float]
    pose: Pose | None = None
    point: Vector | None = None

    @property
    def member(self) -> bool:
        """Whether something of the member is held."""
        return self.pose is not None or self.point is not None

    @property
    def names(self) -> tuple[str, ...]:
        """Everything that is held, as the user named it or by axis."""
        member = (MEMBER,) if self.pose is not None else (POINT,) if self.point is not None else ()
        return (*self.joints, *self.axes, *self.drives, *member)


def holding(mechanism: Mechanism, motors: MotorValues | None, pose: PoseOrPoint | None = None) -> Holding:
    """The values that a user asks for, checked.

    Args:
        mechanism: The mechanism.
        motors: Values by joint, axis or motor name.
        pose: Pose of the reference member, or position of the reference point alone.

    Raises:
        UnknownNameError: A name that is no joint, axis or motor with a value.
        ModelError: An axis of a ball, which has no value of its own.
        ShapeError: The wrong number of values.
    """
    joints: dict[str, Vector] = {}
    axes: dict[str, float] = {}
    drives: dict[str, float] = {}
    known = {drive.name for drive in mechanism.drives}
    scalar = _scalar_axes(mechanism)
    for name, value in (motors or {}).items():
        target = mechanism.motors.get(name, name) if name not in mechanism.joint else name
        if target in known:
            drives[target] = float(checked(np.atleast_1d(value), f"value of motor {name!r}", (1,))[0])
        elif target in mechanism.home:
            joints[target] = mechanism.home.replaced({target: value})[target]
        elif target in scalar:
            axes[target] = float(checked(np.atleast_1d(value), f"value of axis {name!r}", (1,))[0])
        elif target in mechanism.axis_names:
            raise ModelError(
                f"axis {name!r} of a ball has no value of its own: give the joint's quaternion (w, x, y, z)"
            )
        else:
            choices = [*mechanism.home, *scalar, *known, *mechanism.motors]
            raise UnknownNameError("joint, axis or motor with a value", name, dict.fromkeys(choices))
    if pose is None or isinstance(pose, Pose):
        return Holding(joints, axes, drives, _checked_pose(mechanism, pose))
    point = checked(pose, "position of the reference point", (mechanism.space.translations,))
    return Holding(joints, axes, drives, point=point)


def problem_for(
    mechanism: Mechanism, held: Holding, also: Sequence[str] = (), *, member: bool = False
) -> ClosureProblem:
    """The closure equations in which everything held is an unknown of its own.

    Args:
        mechanism: The mechanism.
        held: What is held.
        also: Further axes or drives that must be unknowns: motors that are watched.
        member: Whether the member's pose must be an unknown although it is not held.
    """
    of_axis = _joint_of_axis(mechanism)
    names = [*held.axes, *mechanism.lock, *also]
    kept = {*held.joints, *(of_axis[name].name for name in names if name in of_axis)}
    drives = {*held.drives, *(name for name in also if name not in of_axis)}
    return ClosureProblem(mechanism, kept, drives, member=member or held.member)


def held_columns(problem: ClosureProblem, held: Holding) -> Mask:
    """For every rate of a problem, whether it is held (locked axes are)."""
    mask = np.zeros(problem.columns, dtype=bool)
    where = problem.variables
    for name in (*held.joints, *held.drives):
        mask[where.columns_of[name]] = True
    for axis in held.axes:
        mask[where.column[axis]] = True
    for axis in problem.mechanism.lock:
        if axis in where.column:
            mask[where.column[axis]] = True
    if held.member:
        place = where.columns_of[MEMBER]
        s = problem.mechanism.space.translations
        mask[place if held.pose is not None else slice(place.start, place.start + s)] = True
    return mask


def asked(problem: ClosureProblem, state: Vector, held: Holding) -> Vector:
    """The state with everything held at the values asked for."""
    where = problem.variables
    result = state.copy()
    for name, values in held.joints.items():
        result[where.values_of[name]] = values
    for name, value in (*held.axes.items(), *held.drives.items()):
        result[where.value[name]] = value
    if held.pose is not None:
        result[where.values_of[MEMBER]] = _pose_values(problem, held.pose)
    elif held.point is not None:
        start = where.values_of[MEMBER].start
        result[start : start + len(held.point)] = held.point
    return result


def start_values(mechanism: Mechanism, near: MotorValues | None, held: Holding) -> Configuration:
    """The configuration to start from: `near`, with what is held by whole joints."""
    q = mechanism.configuration(near)
    values: dict[str, Vector] = dict(held.joints)
    of_axis = _joint_of_axis(mechanism)
    for axis, value in held.axes.items():
        joint = of_axis[axis]
        changed = np.array(values.get(joint.name, q[joint.name]))
        changed[mechanism.type_of(joint).axis_names(joint.name).index(axis)] = value
        values[joint.name] = changed
    return q.replaced(values) if values else q


def _checked_pose(mechanism: Mechanism, pose: Pose | None) -> Pose | None:
    if pose is None:
        return None
    s = mechanism.space.translations
    position = checked(pose.position, "position of the pose", (s,))
    rotation = checked(pose.rotation, "rotation of the pose", (s, s))
    if not np.allclose(rotation @ rotation.T, np.eye(s), rtol=0.0, atol=1e-9):
        raise ModelError("the rotation of the pose is not orthonormal: give a rotation matrix")
    return Pose(rotation, position)


def _pose_values(problem: ClosureProblem, pose: Pose) -> Vector:
    joint = problem.variables.joint[MEMBER]
    ground = Pose.identity(problem.mechanism.space.translations)
    return values_between(problem.mechanism.type_of(joint), ground, pose, joint.second_axis)


def _joint_of_axis(mechanism: Mechanism) -> dict[str, Joint]:
    return {
        axis: joint
        for joint in mechanism.all_joints
        for axis in mechanism.type_of(joint).axis_names(joint.name)
    }


def _scalar_axes(mechanism: Mechanism) -> list[str]:
    """Axes of joints with several axes, each with a scalar value."""
    return [
        axis
        for joint in mechanism.all_joints
        if not joint.closure and mechanism.type_of(joint).scalar_values
        for axis in mechanism.type_of(joint).axis_names(joint.name)
    ]
