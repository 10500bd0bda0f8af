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
    pose = Pose.identity(s)
    index = 0
    for step in kind.steps:
        if step == "S":
            pose = pose @ Pose(rotation_from_quaternion_wxyz(values[index : index + 4]), np.zeros(3))
            index += 4
            continue
        pose = pose @ _step(step, float(values[index]), s, lead, second_axis)
        index += 1
    return pose


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
    s = 2 if kind.planar else 3
    columns: list[Vector] = []
    for step in kind.steps:
        if step[0] == "T":
            axis = first.rotation[:, "xyz".index(step[1])]
            columns.append(np.concatenate([axis, np.zeros(1 if s == 2 else 3)]))
        elif s == 2:
            arm = point - second.position
            columns.append(np.array([-arm[1], arm[0], 1.0]))
        elif step == "S":
            columns.extend(_turn(second.rotation[:, k], point - second.position) for k in range(3))
        elif step == "R2":
            columns.append(_turn(second.rotation @ second_axis, point - second.position))
        else:
            axis = first.rotation[:, 2]
            column = _turn(axis, point - second.position)
            if step == "H":
                column[:3] += lead / (2 * math.pi) * axis
            columns.append(column)
    d = 3 if s == 2 else 6
    return np.column_stack(columns) if columns else np.zeros((d, 0))


def _turn(axis: Vector, arm: Vector) -> Vector:
    ax, ay, az = axis
    x, y, z = arm
    return np.array([ay * z - az * y, az * x - ax * z, ax * y - ay * x, ax, ay, az])


@dataclass(frozen=True, slots=True, eq=False)
class Blocked:
    """The directions of relative velocity that a joint or contact prohibits.

    Attributes:
        matrix: rows x d, on relative twists at the joint's point in ground axes.
        gaps: For every row, how far the position is from satisfying it [m or rad]; the row is its
            derivative, relative motion being that of the second body against the first.
        linear: For every row, whether it is in m/s.
        names: Names of the force components.
    """

    matrix: Matrix
    gaps: Vector
    linear: tuple[bool, ...]
    names: tuple[str, ...]


def blocked_directions(
    kind: JointType, first: Pose, second: Pose, lead: float, second_axis: Vector
) -> Blocked:
    """Table II for every joint type: the complement of its axes, with the gaps of the positions."""
    s = 2 if kind.planar else 3
    frame = first.rotation
    offset = second.position - first.position
    moving = {step[1] for step in kind.steps if step[0] == "T"}
    letters = "xyz"[:s]
    rows: list[Vector] = []
    gaps: list[float] = []
    names: list[str] = []
    turns = 1 if s == 2 else 3
    for k, letter in enumerate(letters):
        if letter in moving:
            continue
        row = np.concatenate([frame[:, k], np.zeros(turns)])
        gap = float(frame[:, k] @ offset)
        if "H" in kind.steps and letter == "z":
            pitch = lead / (2 * math.pi)
            row[3:] -= pitch * frame[:, 2]
            gap = _wrapped(gap - pitch * _angle_about_z(first, second), lead)
        rows.append(row)
        gaps.append(gap)
        names.append(f"f{letter}")
    directions, errors, labels = _blocked_turns(kind, first, second, second_axis)
    for direction, error, label in zip(directions, errors, labels, strict=True):
        rows.append(np.concatenate([np.zeros(s), direction]))
        gaps.append(error)
        names.append(label)
    linear = tuple(name[0] == "f" for name in names)
    d = s + turns
    matrix = np.array(rows) if rows else np.zeros((0, d))
    return Blocked(matrix, np.array(gaps), linear, tuple(names))


def _wrapped(gap: float, lead: float) -> float:
    return gap if lead == 0 else gap - lead * round(gap / lead)


def _angle_about_z(first: Pose, second: Pose) -> float:
    relative = first.rotation.T @ second.rotation
    return math.atan2(relative[1, 0] - relative[0, 1], relative[0, 0] + relative[1, 1])


def _blocked_turns(
    kind: JointType, first: Pose, second: Pose, second_axis: Vector
) -> tuple[list[Vector], list[float], list[str]]:
    from vincula.spatial.poses import rotation_vector

    turning = [step for step in kind.steps if step[0] != "T"]
    if "S" in turning or (kind.planar and turning):
        return [], [], []
    relative = first.rotation.T @ second.rotation
    if kind.planar:
        return [np.ones(1)], [float(rotation_vector(relative)[0])], ["mz"]
    if not turning:
        error = rotation_vector(relative)
        return [first.rotation[:, k] for k in range(3)], [float(e) for e in error], ["mx", "my", "mz"]
    if len(turning) == 2:
        one, two = first.rotation[:, 2], second.rotation @ second_axis
        across = np.cross(one, two)
        size = float(np.linalg.norm(across))
        error_1 = (float(second_axis[2]) - float(one @ two)) / size
        return [across / size], [error_1], ["mx"]
    tilt = _tilt(relative[:, 2])
    return [first.rotation[:, 0], first.rotation[:, 1]], [float(tilt[0]), float(tilt[1])], ["mx", "my"]


def _tilt(axis: Vector) -> Vector:
    """Rotation vector (x, y) that takes z to `axis`; half a turn about x when they are opposite."""
    sine = math.hypot(axis[0], axis[1])
    angle = math.atan2(sine, axis[2])
    if sine == 0.0:
        return np.array([angle, 0.0])
    return np.array([-axis[1], axis[0]]) * (angle / sine)


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
            values.append(_angle_about_z(first, second))
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
