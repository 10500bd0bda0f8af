"""What each joint type permits: its values, its axes, its motion, the twists of its axes.

A joint connects two frames, A on its first body and B on its second.  At the joint's values q the
frames satisfy  X_A @ motion(q) = X_B.  In space z of the joint frame is the axis (of a universal
joint the first axis); in the plane a prismatic joint moves along x.  Everything that is needed at a
closed configuration (columns, blocked directions, gaps) follows from the poses of A and B alone, so
it serves joints in the tree and joints that close loops alike.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from vincula.arrays import Matrix, Vector
from vincula.errors import TopologyError, UnknownNameError, listing
from vincula.spatial.poses import Pose, rotation_about, rotation_from_quaternion_wxyz
from vincula.spatial.space import PLANAR, Space
from vincula.spatial.twists import cross

_Z: Final = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, slots=True)
class JointType:
    """One joint type in one space.

    Attributes:
        name: Name in files: revolute, prismatic, screw, cylindrical, universal, spherical, planar,
            fixed or free.
        steps: Elementary motions in order: Tx Ty Tz translations along joint-frame axes, Rz rotation
            about z, R2 rotation about the second axis, H helical motion along z, S a ball.
        axes: Suffixes of the axis names ("" for a joint with one axis).
        values: Number of configuration values.
        planar: Whether this is the type's form in the plane.
    """

    name: str
    steps: tuple[str, ...]
    axes: tuple[str, ...]
    values: int
    planar: bool

    @property
    def linear(self) -> tuple[bool, ...]:
        """For every axis, whether its rate is in m/s."""
        flags: list[bool] = []
        for step in self.steps:
            flags.extend([False] * 3 if step == "S" else [step[0] == "T"])
        return tuple(flags)

    @property
    def value_linear(self) -> tuple[bool, ...]:
        """For every configuration value, whether it is in metres."""
        flags: list[bool] = []
        for step in self.steps:
            flags.extend([False] * 4 if step == "S" else [step[0] == "T"])
        return tuple(flags)

    @property
    def scalar_values(self) -> bool:
        """Whether every axis has one scalar value of its own (no quaternion)."""
        return "S" not in self.steps

    @property
    def zero(self) -> Vector:
        """The values at which both frames coincide."""
        values: list[float] = []
        for step in self.steps:
            values.extend([1.0, 0.0, 0.0, 0.0] if step == "S" else [0.0])
        return np.array(values)

    def axis_names(self, joint: str) -> tuple[str, ...]:
        """Full names of the axes of a joint called `joint`."""
        return tuple(f"{joint}.{suffix}" if suffix else joint for suffix in self.axes)


_SPATIAL_TYPES: Final = {
    kind.name: kind
    for kind in (
        JointType("revolute", ("Rz",), ("",), 1, False),
        JointType("prismatic", ("Tz",), ("",), 1, False),
        JointType("screw", ("H",), ("",), 1, False),
        JointType("cylindrical", ("Rz", "Tz"), ("rotation", "translation"), 2, False),
        JointType("universal", ("Rz", "R2"), ("1", "2"), 2, False),
        JointType("spherical", ("S",), ("x", "y", "z"), 4, False),
        JointType("planar", ("Tx", "Ty", "Rz"), ("x", "y", "rotation"), 3, False),
        JointType("fixed", (), (), 0, False),
        JointType("free", ("Tx", "Ty", "Tz", "S"), ("vx", "vy", "vz", "wx", "wy", "wz"), 7, False),
    )
}
_PLANAR_TYPES: Final = {
    kind.name: kind
    for kind in (
        JointType("revolute", ("Rz",), ("",), 1, True),
        JointType("prismatic", ("Tx",), ("",), 1, True),
        JointType("fixed", (), (), 0, True),
        JointType("free", ("Tx", "Ty", "Rz"), ("vx", "vy", "wz"), 3, True),
    )
}
JOINT_TYPES: Final[tuple[str, ...]] = tuple(_SPATIAL_TYPES)
"""Names of all joint types."""


def joint_type(name: str, space: Space) -> JointType:
    """The joint type called `name` in a space.

    Raises:
        UnknownNameError: No such type.
        TopologyError: The type exists in space only.
    """
    types = _PLANAR_TYPES if space is PLANAR else _SPATIAL_TYPES
    if name in types:
        return types[name]
    if name in _SPATIAL_TYPES:
        raise TopologyError(f"joint type {name!r} exists in space only; in the plane use {listing(types)}")
    raise UnknownNameError("joint type", name, types)


def motion(kind: JointType, values: Vector, lead: float, second_axis: Vector) -> Pose:
    """Pose of frame B in frame A at the given values.

    Args:
        kind: The joint type.
        values: Its configuration values [m, rad, quaternion wxyz].
        lead: Advance of a screw a turn [m].
        second_axis: Unit vector of a universal joint's second axis in the joint frame.
    """
    s = 2 if kind.planar else 3
    pose: Pose | None = None
    index = 0
    for step in kind.steps:
        if step == "S":
            moved = Pose(rotation_from_quaternion_wxyz(values[index : index + 4]), np.zeros(3))
            index += 4
        else:
            moved = _step(step, float(values[index]), s, lead, second_axis)
            index += 1
        pose = moved if pose is None else pose @ moved
    return Pose.identity(s) if pose is None else pose


def _step(step: str, value: float, s: int, lead: float, second_axis: Vector) -> Pose:
    if step[0] == "T":
        position = np.zeros(s)
        position["xyz".index(step[1])] = value
        return Pose(np.eye(s), position)
    if s == 2:
        return Pose.from_angle(value)
    if step == "R2":
        return Pose(rotation_about(second_axis, value), np.zeros(3))
    rise = lead / (2 * math.pi) * value if step == "H" else 0.0
    return Pose(rotation_about(_Z, value), np.array([0.0, 0.0, rise]))


@dataclass(frozen=True, slots=True, eq=False)
class Screw:
    """The motion that one axis of a joint permits: a turn about a line, a slide along it, or both.

    Attributes:
        on_second: Whether the axis is carried by frame B (otherwise by frame A); it goes through the
            origin of B.
        axis: Unit vector in that frame; zero for a turn in the plane.
        turn: 1 where the axis turns, else 0.
        slide: Advance along the axis for a unit of the rate.
    """

    on_second: bool
    axis: Vector
    turn: float
    slide: float


def screws(kind: JointType, lead: float, second_axis: Vector) -> tuple[Screw, ...]:
    """The screw of every axis of a joint.

    Args:
        kind: The joint type.
        lead: Advance of a screw joint a turn [m].
        second_axis: Second axis of a universal joint in the joint frame.
    """
    unit = np.eye(2 if kind.planar else 3)
    found: list[Screw] = []
    for step in kind.steps:
        if step[0] == "T":
            found.append(Screw(False, unit["xyz".index(step[1])], 0.0, 1.0))
        elif kind.planar:
            found.append(Screw(True, np.zeros(2), 1.0, 0.0))
        elif step == "S":
            found.extend(Screw(True, unit[k], 1.0, 0.0) for k in range(3))
        elif step == "R2":
            found.append(Screw(True, second_axis, 1.0, 0.0))
        else:
            found.append(Screw(False, _Z, 1.0, lead / (2 * math.pi) if step == "H" else 0.0))
    return tuple(found)


def axis_twists(
    kind: JointType, first: Pose, second: Pose, lead: float, second_axis: Vector, point: Vector
) -> Matrix:
    """d x axes twists, at `point` in ground axes, of the second body relative to the first.

    Args:
        kind: The joint type.
        first: Pose of frame A in ground axes.
        second: Pose of frame B in ground axes.
        lead: Advance of a screw a turn [m].
        second_axis: Second axis of a universal joint in the joint frame.
        point: Where the linear velocities are taken [m].
    """
    arm = point - second.position
    twists = np.zeros((3 if kind.planar else 6, len(kind.axes)))
    for k, screw in enumerate(screws(kind, lead, second_axis)):
        axis = (second if screw.on_second else first).rotation @ screw.axis
        if kind.planar:
            twists[:2, k] = screw.slide * axis + screw.turn * np.array([-arm[1], arm[0]])
            twists[2, k] = screw.turn
        else:
            twists[:3, k] = screw.slide * axis + screw.turn * cross(axis, arm)
            twists[3:, k] = screw.turn * axis
    return twists


def angle_about_z(first: Pose, second: Pose) -> float:
    """Angle about z from frame A to frame B, their z axes being nearly the same [rad]."""
    relative = first.rotation.T @ second.rotation
    return math.atan2(relative[1, 0] - relative[0, 1], relative[0, 0] + relative[1, 1])


def values_between(kind: JointType, first: Pose, second: Pose, second_axis: Vector) -> Vector:
    """The joint values that bring frame A onto frame B, as nearly as the joint permits.

    Angles are in (-pi, pi]; for a screw the turn is the one of the angle, not of the advance.
    """
    relative = first.inverse() @ second
    values: list[float] = []
    for step in kind.steps:
        if step[0] == "T":
            values.append(float(relative.position["xyz".index(step[1])]))
        elif step == "S":
            values.extend(float(v) for v in Pose(relative.rotation, np.zeros(3)).as_quaternion_wxyz())
        elif kind.planar:
            values.append(math.atan2(relative.rotation[1, 0], relative.rotation[0, 0]))
        elif step == "R2":
            turned = rotation_about(_Z, values[-1]).T @ relative.rotation
            values.append(_angle_about(turned, second_axis))
        elif "R2" in kind.steps:
            values.append(_first_universal_angle(relative.rotation, second_axis))
        else:
            values.append(angle_about_z(first, second))
    return np.array(values)


def _angle_about(rotation: Matrix, axis: Vector) -> float:
    sine = 0.5 * float(
        axis
        @ np.array(
            [
                rotation[2, 1] - rotation[1, 2],
                rotation[0, 2] - rotation[2, 0],
                rotation[1, 0] - rotation[0, 1],
            ]
        )
    )
    return math.atan2(sine, 0.5 * (float(np.trace(rotation)) - 1.0))


def _first_universal_angle(rotation: Matrix, second_axis: Vector) -> float:
    """Angle about z that carries the drawn second axis to where `rotation` has it."""
    there = rotation @ second_axis
    return math.atan2(
        second_axis[0] * there[1] - second_axis[1] * there[0],
        second_axis[0] * there[0] + second_axis[1] * there[1],
    )
