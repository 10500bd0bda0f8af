"""Kernels in echelon form with every entry accurate by itself, for weights of very different size.

An orthonormal basis is accurate as a whole: its rows are parallel, or orthogonal, to 1e-16 only.
Weights over 1e+-16 magnify that into all digits.  In echelon form on pivots that follow the weights,
refined with exact residuals, rows that are parallel in the data stay so, and small entries have digits
of their own.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from vincula.arrays import Matrix, Vector
from vincula.numerics.lapack import pivots

Indices = NDArray[np.intp]

NEAR = 0.1
"""A row may become a pivot when it is this near to the most independent one left."""
_ITERATIONS = 3
_SPLITTER = 134217729.0  # 2^27 + 1: Dekker's splitting of a double into two halves


def graded_pivots(basis: Matrix, sizes: Vector, count: int, taken: Sequence[int] = ()) -> list[int]:
    """Rows of a basis that are independent and, among those, have the largest sizes.

    Rows in `taken` count as chosen already; only the new ones are returned.

    Args:
        basis: n x k, unweighted, with well-scaled columns.
        sizes: n weights of the rows.
        count: Number of new rows wanted.
        taken: Independent rows to go on from.
    """
    left = np.array(basis)
    chosen: list[int] = []
    for row in taken:
        left = _without(left, row)
    for _ in range(count):
        lengths = np.linalg.norm(left, axis=1)
        lengths[[*taken, *chosen]] = 0.0
        allowed = lengths >= NEAR * lengths.max()
        best = int(np.argmax(np.where(allowed, sizes * lengths, -1.0)))
        chosen.append(best)
        left = _without(left, best)
    return chosen


def refined_kernel(matrix: Matrix, rank: int, free: list[int], held: list[int]) -> Matrix:
    """Kernel vectors with the identity on the `free` columns and zero on the `held` ones.

    Gaussian elimination, then iterative refinement with exact residuals: small entries come out with
    relative accuracy.

    Args:
        matrix: m x n, of the given rank.
        rank: From the ledger; n = rank + len(free) + len(held).
        free: Columns that get the identity.
        held: Columns that stay zero.

    Returns:
        n x len(free) matrix.
    """
    n = matrix.shape[1]
    if not free:
        return np.zeros((n, 0))
    kernel = np.zeros((n, len(free)))
    kernel[free, range(len(free))] = 1.0
    solved = [i for i in range(n) if i not in set(free) and i not in set(held)]
    rows = np.sort(pivots(matrix[:, solved].T)[:rank]) if matrix.shape[0] > rank else slice(None)
    square = matrix[rows][:, solved]
    for _ in range(_ITERATIONS):
        kernel[solved] -= np.linalg.solve(square, exact_product(matrix[rows], kernel))
    return kernel


def exact_product(a: Matrix, x: Matrix) -> Matrix:
    """a @ x, every entry as if computed exactly and rounded once (Dekker's product, exact sums)."""
    product = a[:, :, None] * x[None, :, :]
    a_high, a_low = _halves(a[:, :, None])
    x_high, x_low = _halves(x[None, :, :])
    error = ((a_high * x_high - product) + a_high * x_low + a_low * x_high) + a_low * x_low
    terms = np.concatenate([product, error], axis=1).transpose(0, 2, 1).tolist()
    return np.array([[math.fsum(entry) for entry in row] for row in terms]).reshape(a.shape[0], x.shape[1])


def _without(left: Matrix, row: int) -> Matrix:
    direction = left[row] / np.linalg.norm(left[row])
    return left - np.outer(left @ direction, direction)


def _halves(values: Matrix) -> tuple[Matrix, Matrix]:
    shifted = _SPLITTER * values
    high = shifted - (shifted - values)
    return high, values - high
