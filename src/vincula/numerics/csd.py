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

SMALLER = 0.7071067811865476
"""Below 45 degrees' sine a length is the smaller one of its pair."""


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

    Small sines come from a one-sided Jacobi decomposition of the second block, small cosines from one
    of the first, so each is accurate by itself; the large partner of a small one is the length of its
    well-conditioned image, and so is its direction.  Both sets of directions are orthonormal and
    paired, also inside clusters.

    Args:
        task: First block, p x k with p >= k, weighted; rows may differ in size by many orders.
        motor: Second block, r x k with r >= k, weighted the same way.
    """
    p, k = task.shape
    if k == 0:
        return Angles(np.empty(0), np.empty(0), np.empty((p, 0)), np.empty((motor.shape[0], 0)))
    stack = qr_rows_pivoted(np.vstack([task, motor]), k)
    upper, lower = stack[:p], stack[p:]
    if np.vdot(upper, upper) > 0.5 * k:
        motor_side, sines, task_side, cosines = _from_small(lower, upper)
    else:
        task_side, cosines, motor_side, sines = _from_small(upper, lower)
    order = np.argsort(sines / cosines, kind="stable")
    return Angles(cosines[order], sines[order], task_side[:, order], motor_side[:, order])


def _from_small(small: Matrix, large: Matrix) -> tuple[Matrix, Vector, Matrix, Vector]:
    """Directions and lengths in two blocks of an orthonormal stack, most lengths in `small` being small.

    Where the length in `small` is the smaller one, it and its direction come from that block; the
    rest from the other block, inside the complement.
    """
    left, lengths, right = jacobi_svd(small)
    trusted = lengths <= SMALLER
    other, partner = _normalised(large @ right[:, trusted])
    if trusted.all():
        return left, lengths, other, partner
    rest = right[:, ~trusted]
    # Orthogonal already, but for rounding that would swamp the directions of tiny lengths.
    image = large @ rest
    other_rest, partner_rest, turn = jacobi_svd(image - other @ (other.T @ image))
    left_rest, lengths_rest = _normalised(small @ (rest @ turn))
    return (
        np.hstack([left[:, trusted], left_rest]),
        np.concatenate([lengths[trusted], lengths_rest]),
        np.hstack([other, other_rest]),
        np.concatenate([partner, partner_rest]),
    )


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


def orthonormal(columns: Matrix) -> Matrix:
    """Orthonormal basis of independent columns, stable row by row."""
    return qr_rows_pivoted(columns, columns.shape[1])


def _normalised(columns: Matrix) -> tuple[Matrix, Vector]:
    lengths = np.sqrt(np.einsum("ij,ij->j", columns, columns))
    return columns / lengths, lengths
