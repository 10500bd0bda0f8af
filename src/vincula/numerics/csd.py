"""Cosines and sines of a pair of blocks: generalised singular values to high relative accuracy.

Given the two blocks (T; S) of a basis, with both blocks of full column rank, the decomposition
T R^-1 = U C X^T, S R^-1 = Q S X^T (R from the QR factorisation of the stack) gives c_i / s_i, the
generalised singular values.  Source: numerics page, step 5.

Why not the generalised eigenproblem of T^T T and S^T S: squaring loses half the digits, and beyond
ratios of 1e8 all of them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vincula.arrays import Matrix, Vector
from vincula.numerics.lapack import eliminated, identity, jacobi_svd, qr_rows_pivoted


@dataclass(frozen=True, slots=True, eq=False)
class Angles:
    """The cosine-sine decomposition of a pair, largest ratio first.

    Attributes:
        cosines: c_i, descending.
        sines: s_i, ascending.
        task: Orthonormal directions of the first block, rows x k.
        motor: Orthonormal directions of the second block, paired with `task`.
    """

    cosines: Vector
    sines: Vector
    task: Matrix
    motor: Matrix

    @property
    def ratios(self) -> Vector:
        """c_i / s_i, descending."""
        return self.cosines / self.sines


def angles_of_pair(task: Matrix, motor: Matrix) -> Angles:
    """The cosine-sine decomposition of two blocks, each of full column rank k.

    Cosines and sines come from separate one-sided Jacobi decompositions, so each small one is
    accurate by itself.  Directions: where s <= c, motor directions are singular vectors of the
    second block and task directions their well-conditioned images; where c < s the other way round,
    inside the complement.  So both sets are orthonormal and paired, also inside clusters.

    Args:
        task: First block, p x k with p >= k, weighted; rows may differ in size by many orders.
        motor: Second block, r x k with r >= k, weighted the same way.
    """
    p, k = task.shape
    if k == 0:
        return Angles(np.empty(0), np.empty(0), np.empty((p, 0)), np.empty((motor.shape[0], 0)))
    stack = qr_rows_pivoted(np.vstack([task, motor]), k)
    upper, lower = stack[:p], stack[p:]
    task_left, cosines, task_right = jacobi_svd(upper)
    motor_left, sines, motor_right = jacobi_svd(lower)
    sines = sines[::-1]
    leading = int(np.count_nonzero(sines <= cosines))
    if leading == 0:
        return Angles(cosines, sines, task_left, _normalised(lower @ task_right))
    # Right vectors for the smallest sines come last; take them in the order of the ratios.
    first, rest = motor_right[:, ::-1][:, :leading], motor_right[:, : k - leading]
    task_side, motor_side = _normalised(upper @ first), motor_left[:, ::-1][:, :leading]
    if leading < k:
        task_rest, _, turn = jacobi_svd(upper @ rest)
        task_side = np.hstack([task_side, task_rest])
        motor_side = np.hstack([motor_side, _normalised(lower @ rest @ turn)])
    return Angles(cosines, sines, task_side, motor_side)


def deflated(block: Matrix, fixed: Matrix) -> tuple[Matrix, Matrix, Matrix]:
    """Coordinates of `block` orthogonal to the columns of `fixed`, and both bases.

    Rows are sorted by size and columns of `fixed` pivoted, which keeps graded rows accurate: what a
    heavy row takes up is removed exactly, not left as rounding error beside light rows.

    Args:
        block: p x k.
        fixed: p x j, of full column rank j.

    Returns:
        (p - j) x k coordinates; p x j orthonormal basis of `fixed`; p x (p - j) orthonormal basis of
        its complement, which the coordinates refer to.
    """
    p, j = fixed.shape
    if j == 0:
        return block, fixed, identity(p)
    turned, factor = eliminated(fixed, block)
    return turned[j:], factor[:, :j], factor[:, j:]


def _normalised(columns: Matrix) -> Matrix:
    return np.asarray(columns / np.sqrt(np.einsum("ij,ij->j", columns, columns)))
