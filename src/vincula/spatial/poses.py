"""The one pose type, in the plane and in space: a rotation matrix and a position.

Conversions from quaternions, angles and rotation vectors are scipy's; the order of a quaternion is
always in the name (`wxyz`).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vincula.arrays import Matrix, Vector, frozen, numbers
from vincula.elementary import choice, is_less


@dataclass(frozen=True, slots=True, eq=False)
class Pose:
    """Position and orientation of one frame in another: x_outer = rotation @ x_inner + position.

    Attributes:
        rotation: s x s rotation matrix.
        position: s-vector [m].
    """

    rotation: Matrix
    position: Vector

    @staticmethod
    def identity(translations: int = 3) -> Pose:
        """The pose that changes nothing, in the plane (2) or in space (3)."""
        return Pose(frozen(np.eye(translations)), frozen(np.zeros(translations)))

    @staticmethod
    def at(position: Sequence[float] | Vector, rotation: Matrix | None = None) -> Pose:
        """A pose at a position, with identity rotation unless one is given."""
        point = numbers(position)
        turn = np.eye(len(point)) if rotation is None else numbers(rotation)
        return Pose(frozen(turn), frozen(point))

    @staticmethod
    def from_quaternion_wxyz(
        quaternion: Sequence[float] | Vector, position: Sequence[float] | Vector = (0, 0, 0)
    ) -> Pose:
        """A spatial pose from a quaternion (w, x, y, z) of any non-zero length."""
        return Pose.at(position, rotation_from_quaternion_wxyz(quaternion))

    @staticmethod
    def from_angle(angle: float, position: Sequence[float] | Vector = (0, 0)) -> Pose:
        """A planar pose turned by `angle` [rad]."""
        c, s = np.cos(angle), np.sin(angle)
        return Pose.at(position, np.array([[c, -s], [s, c]]))

    def __matmul__(self, inner: Pose) -> Pose:
        return Pose(self.rotation @ inner.rotation, self.rotation @ inner.position + self.position)

    def inverse(self) -> Pose:
        """The pose of the outer frame in the inner one."""
        back = self.rotation.T
        return Pose(back, -(back @ self.position))

    def apply(self, point: Vector) -> Vector:
        """A point given in the inner frame, in the outer one."""
        return self.rotation @ point + self.position

    def as_quaternion_wxyz(self) -> Vector:
        """The rotation of a spatial pose as a unit quaternion (w, x, y, z), w >= 0."""
        from scipy.spatial.transform import Rotation

        x, y, z, w = Rotation.from_matrix(self.rotation).as_quat()
        quaternion = np.array([w, x, y, z])
        return -quaternion if w < 0 else quaternion


def rotation_from_quaternion_wxyz(quaternion: Sequence[float] | Vector) -> Matrix:
    """Rotation matrix of a quaternion (w, x, y, z) of any non-zero length."""
    w, x, y, z = (float(value) for value in quaternion)
    n = w * w + x * x + y * y + z * z
    s = 2.0 / n
    return np.array(
        [
            [1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y)],
            [s * (x * y + w * z), 1 - s * (x * x + z * z), s * (y * z - w * x)],
            [s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y)],
        ]
    )


def rotation_vector(rotation: Matrix) -> Vector:
    """Rotation vector (axis times angle) of a rotation: 1 component in the plane, 3 in space [rad]."""
    if rotation.shape[0] == 2:
        return np.array([np.arctan2(rotation[1, 0], rotation[0, 0])])
    cosine = 0.5 * (float(rotation[0, 0] + rotation[1, 1] + rotation[2, 2]) - 1.0)
    if cosine > -0.9:  # the skew part is accurate short of half a turn, and this is called often
        twice = rotation - rotation.T
        x, y, z = 0.5 * float(twice[2, 1]), 0.5 * float(twice[0, 2]), 0.5 * float(twice[1, 0])
        sine = math.sqrt(x * x + y * y + z * z)
        factor = math.atan2(sine, cosine) / sine if sine > 0.0 else 1.0
        return np.array([factor * x, factor * y, factor * z])
    from scipy.spatial.transform import Rotation

    return np.asarray(Rotation.from_matrix(rotation).as_rotvec(), dtype=float)


def rotation_about(axis: Vector, angle: float) -> Matrix:
    """Rotation by `angle` [rad] about the unit vector `axis` in space."""
    x, y, z = (float(value) for value in axis)
    c, s = float(np.cos(angle)), float(np.sin(angle))
    t = 1.0 - c
    return np.array(
        [
            [c + t * x * x, t * x * y - s * z, t * x * z + s * y],
            [t * x * y + s * z, c + t * y * y, t * y * z - s * x],
            [t * x * z - s * y, t * y * z + s * x, c + t * z * z],
        ]
    )


def frame_with_z(axis: Vector, near_x: Vector | None = None) -> Matrix:
    """A right-handed rotation whose third column is the unit vector `axis`.

    The first column is as near as possible to `near_x` when given, else to the ground axis least
    aligned with `axis`.  Signs and zeros of `axis` are kept exactly, so a frame along a ground axis
    has exact zeros and ones.
    """
    z = numbers(axis)
    if near_x is None:
        near_x = _least_aligned(z)
    x = near_x - (near_x @ z) * z
    x = x / np.linalg.norm(x)
    return np.column_stack([x, np.cross(z, x), z])


def _least_aligned(z: Vector) -> Vector:
    """The ground axis with the smallest component in z, the first of equal ones."""
    if z.dtype != object:
        return np.asarray(np.eye(3)[int(np.argmin(np.abs(z)))])
    a, b, c = (abs(x) for x in z)
    second = choice(is_less(b, a), 1.0, 0.0)
    least = choice(second, b, a)
    third = choice(is_less(c, least), 1.0, 0.0)
    return np.array([choice(third, 0.0, 1.0 - second), choice(third, 0.0, second), third])
