"""Twists as numbers at one point: (linear velocity of the point, angular velocity), ground axes.

In the plane the angular velocity is one number and the cross products collapse to a quarter turn.
"""

from __future__ import annotations

import numpy as np

from vincula.arrays import Matrix, Vector


def cross(one: Vector, two: Vector) -> Vector:
    """Cross product of two vectors in space (numpy's own is slow on single ones)."""
    (ax, ay, az), (x, y, z) = one, two
    return np.array([ay * z - az * y, az * x - ax * z, ax * y - ay * x])


def cross_rows(one: Matrix, two: Matrix) -> Matrix:
    """Cross products row by row (numpy's own is slow on few rows).

    Args:
        one: n x 3.
        two: n x 3.
    """
    (ax, ay, az), (x, y, z) = one.T, two.T
    return np.stack([ay * z - az * y, az * x - ax * z, ax * y - ay * x], axis=1)


def moment_arm(offset: Vector) -> Matrix:
    """The matrix B with B @ omega = omega x offset: s x 1 in the plane, 3 x 3 in space.

    Args:
        offset: From the rotation's centre to the point whose velocity is wanted [m].
    """
    if offset.shape[0] == 2:
        return np.array([[-offset[1]], [offset[0]]])
    x, y, z = offset
    return np.array([[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]])


def transport(offset: Vector) -> Matrix:
    """d x d matrix taking a twist at one point to the twist at the point `offset` away [m]."""
    s = offset.shape[0]
    d = 3 if s == 2 else 6
    matrix = np.eye(d)
    matrix[:s, s:] = moment_arm(offset)
    return matrix


def block_rotation(rotation: Matrix) -> Matrix:
    """d x d matrix turning both halves of a twist (in the plane only the linear half)."""
    s = rotation.shape[0]
    if s == 2:
        matrix = np.eye(3)
        matrix[:2, :2] = rotation
        return matrix
    matrix = np.zeros((6, 6))
    matrix[:3, :3] = rotation
    matrix[3:, 3:] = rotation
    return matrix
