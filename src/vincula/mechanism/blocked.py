"""What joints and contacts prohibit: the rows of Tables I and II, as directions in their frames.

A row is written in the axes of frame A (first body), at the origin of frame B (second body), on the
motion of B against A.  Where a joint or contact moves, it is then exactly the rate at which a gap
between the two frames opens.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vincula.arrays import Matrix, Vector
from vincula.mechanism.joint_types import JointType, angle_about_z
from vincula.spatial.poses import Pose, rotation_vector
from vincula.spatial.selectors import component_names, contact_components
from vincula.spatial.space import Space


@dataclass(frozen=True, slots=True, eq=False)
class BlockedRow:
    """One prohibited direction of relative velocity.

    Attributes:
        name: Name of the force component: fx ... mz, ft and fn for contacts in the plane.
        push: Direction in which velocity is blocked, axes of frame A; zero if none is.
        turn: Direction about which turning is blocked, axes of frame A; one component in the plane.
        across: None, or an axis carried by frame B: blocked is then the turn about the common normal
            of z of A and this axis, and `turn` is what that is when the frames coincide.
    """

    name: str
    push: Vector
    turn: Vector
    across: Vector | None = None

    @property
    def linear(self) -> bool:
        """Whether the row is in m/s."""
        return self.name[0] == "f"


def joint_rows(kind: JointType, lead: float, second_axis: Vector) -> tuple[BlockedRow, ...]:
    """Table II, for every joint type: the complement of its axes.

    Args:
        kind: The joint type.
        lead: Advance of a screw joint a turn [m].
        second_axis: Second axis of a universal joint in the joint frame.
    """
    s, turns = (2, 1) if kind.planar else (3, 3)
    moving = {step[1] for step in kind.steps if step[0] == "T"}
    rows: list[BlockedRow] = []
    for k, letter in enumerate("xyz"[:s]):
        if letter not in moving:
            turn = np.zeros(turns)
            if "H" in kind.steps and letter == "z":
                turn[2] = -lead / (2 * math.pi)
            rows.append(BlockedRow(f"f{letter}", np.eye(s)[k], turn))
    return (*rows, *_blocked_turns(kind, second_axis))


def _blocked_turns(kind: JointType, second_axis: Vector) -> list[BlockedRow]:
    turning = [step for step in kind.steps if step[0] != "T"]
    if "S" in turning or (kind.planar and turning):
        return []
    if kind.planar:
        return [BlockedRow("mz", np.zeros(2), np.ones(1))]
    if len(turning) == 2:
        across = np.cross([0.0, 0.0, 1.0], second_axis)
        return [BlockedRow("mx", np.zeros(3), across / np.linalg.norm(across), second_axis)]
    axes = "xyz" if not turning else "xy"
    return [BlockedRow(f"m{axis}", np.zeros(3), np.eye(3)[k]) for k, axis in enumerate(axes)]


def contact_rows(type_name: str, space: Space) -> tuple[BlockedRow, ...]:
    """Table I: the selector of a contact type.

    Of a frictionless line the plane is the first body's and the line, x of frame B, the second's: as
    they slide on each other the blocked tilt goes with the line.

    Raises:
        UnknownNameError: No such type.
        TopologyError: The type does not exist in the plane.
    """
    components = contact_components(type_name, space)
    s = space.translations
    rows = []
    for name, component in zip(component_names(components, space), components, strict=True):
        unit = np.eye(space.dimension)[component]
        across = np.array([1.0, 0.0, 0.0]) if type_name == "line" and component == 4 else None
        rows.append(BlockedRow(name, unit[:s], unit[s:], across))
    return tuple(rows)


def row_matrix(rows: Sequence[BlockedRow], first: Pose, second: Pose) -> Matrix:
    """rows x d matrix on relative twists at the origin of frame B, in ground axes."""
    s = len(first.position)
    matrix = np.zeros((len(rows), 3 if s == 2 else 6))
    for k, row in enumerate(rows):
        matrix[k, :s] = first.rotation @ row.push
        if row.across is not None:
            matrix[k, s:] = common_normal(first.rotation[:, 2], second.rotation @ row.across)
        else:
            matrix[k, s:] = row.turn if s == 2 else first.rotation @ row.turn
    return matrix


def common_normal(one: Vector, two: Vector) -> Vector:
    """Unit vector perpendicular to two directions in space."""
    across = np.cross(one, two)
    return np.asarray(across / np.linalg.norm(across))


@dataclass(frozen=True, slots=True, eq=False)
class Blocked:
    """The directions of relative velocity that a joint prohibits, at one configuration.

    Attributes:
        matrix: rows x d, on twists of the second body against the first, at the origin of frame B in
            ground axes.
        gaps: For every row, how far the position is from satisfying it [m or rad]; at a closed
            configuration the row is its derivative.
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
    """The rows of a joint in ground axes, with the gaps of its two frames.

    Args:
        kind: The joint type.
        first: Pose of frame A in ground axes.
        second: Pose of frame B in ground axes.
        lead: Advance of a screw a turn [m].
        second_axis: Second axis of a universal joint in the joint frame.
    """
    rows = joint_rows(kind, lead, second_axis)
    offset = first.rotation.T @ (second.position - first.position)
    far = [row for row in rows if row.linear]
    gaps = [float(row.push @ offset) for row in far]
    if "H" in kind.steps:
        advance = lead / (2 * math.pi) * angle_about_z(first, second)
        gaps[-1] = math.remainder(gaps[-1] - advance, lead)
    turned = _turn_gaps(rows[len(far) :], first, second, second_axis)
    return Blocked(
        row_matrix(rows, first, second),
        np.array([*gaps, *turned]),
        tuple(row.linear for row in rows),
        tuple(row.name for row in rows),
    )


def _turn_gaps(
    rows: Sequence[BlockedRow], first: Pose, second: Pose, second_axis: Vector
) -> Sequence[float] | Vector:
    if not rows:
        return []
    relative = first.rotation.T @ second.rotation
    if rows[0].across is not None:
        return [angle_beyond(relative @ second_axis, second_axis)]
    return tilt(relative[:, 2]) if len(rows) == 2 else rotation_vector(relative)


def angle_beyond(axis: Vector, drawn: Vector) -> float:
    """Angle between z and `axis` beyond the one between z and `drawn` [rad]."""
    return math.atan2(math.hypot(axis[0], axis[1]), axis[2]) - math.atan2(
        math.hypot(drawn[0], drawn[1]), drawn[2]
    )


def tilt(axis: Vector) -> Vector:
    """Rotation vector (x, y) that takes z to `axis`; half a turn about x when they are opposite."""
    sine = math.hypot(axis[0], axis[1])
    angle = math.atan2(sine, axis[2])
    if sine == 0.0:
        return np.array([angle, 0.0])
    return np.array([-axis[1], axis[0]]) * (angle / sine)
