"""Gaps of open loops with their exact derivatives: what the closing of a loop drives to zero.

At a closed configuration these rows are the selectors of Tables I and II.  Away from it the rows of
orientations differ, because a rotation vector does not change at the rate of the angular velocity;
Gauss-Newton needs the true derivative to converge from far away.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from vincula.arrays import Matrix, Vector
from vincula.mechanism.joint_types import JointType
from vincula.spatial.poses import Pose, rotation_vector
from vincula.spatial.selectors import contact_components
from vincula.spatial.space import Space
from vincula.spatial.twists import cross

Turning = Literal["vector", "tilt", "between axes"]
_X = np.array([1.0, 0.0, 0.0])
_Z = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, slots=True, eq=False)
class Selection:
    """Which components of the pose of a frame B in a frame A must vanish.

    Attributes:
        linear: Components of the position of B in A.
        angular: Components of the orientation error.
        turning: How orientation is measured: the rotation `vector` from A to B, the `tilt` of z of B
            against z of A (a rotation vector without spin), or the angle `between axes`, z of A and
            `second_axis` of B.
        translations: 2 in the plane, 3 in space.
        second_axis: Unit vector in B, for `between axes`.
    """

    linear: tuple[int, ...]
    angular: tuple[int, ...]
    turning: Turning
    translations: int
    second_axis: Vector

    @property
    def count(self) -> int:
        """Number of rows."""
        return len(self.linear) + len(self.angular)


def whole_pose(translations: int) -> Selection:
    """Everything must vanish: a joint whose own values are unknowns, a pose that is asked for."""
    turns = (0,) if translations == 2 else (0, 1, 2)
    return Selection(tuple(range(translations)), turns, "vector", translations, _Z)


def joint_selection(kind: JointType, second_axis: Vector) -> Selection:
    """What a joint type blocks (Table II).  A screw has no such rows: its values are unknowns."""
    s = 2 if kind.planar else 3
    moving = {step[1] for step in kind.steps if step[0] == "T"}
    linear = tuple(k for k in range(s) if "xyz"[k] not in moving)
    turning = [step for step in kind.steps if step[0] != "T"]
    if not turning:
        return Selection(linear, whole_pose(s).angular, "vector", s, _Z)
    if "S" in turning or kind.planar:
        return Selection(linear, (), "vector", s, _Z)
    if len(turning) == 2:
        return Selection(linear, (0,), "between axes", s, second_axis)
    return Selection(linear, (0, 1), "tilt", s, _Z)


def contact_selection(kind: str, space: Space) -> Selection:
    """What a contact type blocks (Table I).

    A line without friction blocks one tilt alone: the angle between its direction and the normal.
    """
    components = contact_components(kind, space)
    s = space.translations
    linear = tuple(k for k in components if k < s)
    if kind == "line":
        return Selection(linear, (0,), "between axes", s, _X)
    return Selection(linear, tuple(k - s for k in components if k >= s), "vector", s, _Z)


def gap_rows(selection: Selection, first: Pose, second: Pose) -> tuple[Vector, Matrix]:
    """Gaps between frames A and B, and their derivatives.

    Args:
        selection: What must vanish.
        first: Frame A in ground axes.
        second: Frame B in ground axes.

    Returns:
        Gaps [m, rad], and the matrix (rows x d) that takes the twist of B relative to A, at the origin
        of B in ground axes, to their rates.  The matrix is exact at any gap short of half a turn.
    """
    s = selection.translations
    back = first.rotation.T
    far = len(selection.linear)
    gaps = np.empty(selection.count)
    rows = np.zeros((selection.count, s + (1 if s == 2 else 3)))
    if far:
        linear = list(selection.linear)
        gaps[:far] = (back @ (second.position - first.position))[linear]
        rows[:far, :s] = back[linear]
    if selection.angular:
        error, rates = _turned(selection, back @ second.rotation)
        angular = list(selection.angular)
        gaps[far:] = error[angular]
        rows[far:, s:] = rates[angular] if s == 2 else rates[angular] @ back
    return gaps, rows


def _turned(selection: Selection, relative: Matrix) -> tuple[Vector, Matrix]:
    """Orientation error of a relative rotation, and its rate for an angular velocity in A's axes."""
    if selection.translations == 2:
        return rotation_vector(relative), np.ones((1, 1))
    if selection.turning == "tilt":
        return _tilt(relative[:, 2])
    if selection.turning == "between axes":
        return _angle_between(relative @ selection.second_axis, selection.second_axis)
    error = rotation_vector(relative)
    return error, _rotation_vector_rate(error)


def _rotation_vector_rate(error: Vector) -> Matrix:
    """Inverse left Jacobian of SO(3): rate of a rotation vector for an angular velocity in outer axes."""
    angle = float(np.linalg.norm(error))
    x, y, z = error
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    if angle < 1e-4:
        factor = 1.0 / 12.0
    else:
        half = 0.5 * angle
        factor = (1.0 - half / math.tan(half)) / (angle * angle)
    rate: Matrix = np.eye(3) - 0.5 * cross + factor * (cross @ cross)
    return rate


def _tilt(axis: Vector) -> tuple[Vector, Matrix]:
    """Rotation vector (x, y) without spin that takes z to the unit vector `axis`, and its rate."""
    sine = math.hypot(axis[0], axis[1])
    angle = math.atan2(sine, axis[2])
    if sine == 0.0:
        return np.array([angle, 0.0]), np.eye(3)[:2]
    turn = np.array([-axis[1], axis[0], 0.0]) / sine
    beside = np.array([-turn[1], turn[0]])
    rate = np.outer(turn[:2], turn)
    rate += np.outer((angle / sine) * beside, cross(axis, turn))
    error: Vector = angle * turn[:2]
    return error, rate


def _angle_between(axis: Vector, drawn: Vector) -> tuple[Vector, Matrix]:
    """Angle from z to `axis` beyond the drawn one, and its rate."""
    across = np.array([-axis[1], axis[0], 0.0])
    size = math.hypot(axis[0], axis[1])
    error = math.atan2(size, axis[2]) - math.atan2(math.hypot(drawn[0], drawn[1]), drawn[2])
    if size == 0.0:
        return np.array([error]), np.array([[1.0, 0.0, 0.0]])
    return np.array([error]), across[None, :] / size
