"""Cosines and sines of a pair graded on both sides, in long decimal arithmetic.

With weights over many orders of magnitude on both blocks, double precision keeps the large ratios
and loses the small ones in sums that cancel, although the blocks determine them to all digits.  The pairs are
small (k is at most the number of motors and of twist components), so a few milliseconds of exact
work settle it.
"""

from __future__ import annotations

from decimal import Context, Decimal, localcontext

import numpy as np

from vincula.arrays import Matrix
from vincula.numerics.csd import Angles

_DIGITS = 240
"""Weights of 1e+-16 on both sides spread squared ratios over 1e+-64, and Gram matrices square that."""
_SWEEPS = 60

Rows = list[list[Decimal]]


def angles_of_graded_pair(
    task: Matrix, motor: Matrix, free: Matrix | None = None, idle: Matrix | None = None
) -> Angles:
    """As `angles_of_pair`, accurate for any grading of rows on both sides.

    Eigenvalues of L^-1 T^T T L^-T with S^T S = L L^T, by Jacobi rotations.

    Args:
        task: First block, p x k.
        motor: Second block, r x k.
        free: p x j columns that task directions are taken orthogonal to.
        idle: r x i columns that motor directions are taken orthogonal to.
    """
    k = task.shape[1]
    if k == 0:
        return Angles(np.empty(0), np.empty(0), np.empty_like(task), np.empty_like(motor))
    with localcontext(Context(prec=_DIGITS, Emin=-999999, Emax=999999)):
        t, s = _without(_rows(task), free), _without(_rows(motor), idle)
        lower = _cholesky(_gram(s, k))
        half = [_forward(lower, column) for column in _gram(t, k)]
        squares = [_forward(lower, list(column)) for column in zip(*half, strict=True)]
        values, vectors = _jacobi(squares)
        order = sorted(range(k), key=lambda i: -values[i])
        columns = [_backward(lower, [vectors[r][i] for r in range(k)]) for i in order]
        ratios = [values[i].sqrt() for i in order]
        cosines = [float(r / (1 + r * r).sqrt()) for r in ratios]
        sines = [float(1 / (1 + r * r).sqrt()) for r in ratios]
        task_side = [[float(_dot(row, z) / r) for z, r in zip(columns, ratios, strict=True)] for row in t]
        motor_side = [[float(_dot(row, z)) for z in columns] for row in s]
    # Shapes are given because there may be no pair, or no row, at all: a mechanism without motors.
    return Angles(
        np.array(cosines),
        np.array(sines),
        np.array(task_side).reshape(len(t), k),
        np.array(motor_side).reshape(len(s), k),
    )


def _rows(matrix: Matrix) -> Rows:
    return [[Decimal(x) for x in row] for row in matrix.tolist()]


def _without(rows: Rows, removed: Matrix | None) -> Rows:
    """The part of the columns orthogonal to the columns of `removed`."""
    if removed is None or removed.shape[1] == 0:
        return rows
    e, j, k = _rows(removed), removed.shape[1], len(rows[0])
    lower = _cholesky(_gram(e, j))
    columns = [[row[c] for row in rows] for c in range(k)]
    taken = [[_dot([row[i] for row in e], column) for i in range(j)] for column in columns]
    parts = [_backward(lower, _forward(lower, right)) for right in taken]
    return [[row[c] - _dot(e[r], parts[c]) for c in range(k)] for r, row in enumerate(rows)]


def _dot(a: list[Decimal], b: list[Decimal]) -> Decimal:
    return sum((x * y for x, y in zip(a, b, strict=True)), Decimal(0))


def _gram(rows: Rows, k: int) -> Rows:
    columns = [[row[i] for row in rows] for i in range(k)]
    return [[_dot(a, b) for b in columns] for a in columns]


def _cholesky(square: Rows) -> Rows:
    lower: Rows = [[Decimal(0)] * len(square) for _ in square]
    for i, row in enumerate(square):
        for j in range(i + 1):
            rest = row[j] - _dot(lower[i][:j], lower[j][:j])
            lower[i][j] = rest.sqrt() if i == j else rest / lower[j][j]
    return lower


def _forward(lower: Rows, right: list[Decimal]) -> list[Decimal]:
    """L^-1 right."""
    solved: list[Decimal] = []
    for row, value in zip(lower, right, strict=True):
        solved.append((value - _dot(row[: len(solved)], solved)) / row[len(solved)])
    return solved


def _backward(lower: Rows, right: list[Decimal]) -> list[Decimal]:
    """L^-T right."""
    k = len(right)
    solved = list(right)
    for i in reversed(range(k)):
        rest = solved[i] - sum((lower[j][i] * solved[j] for j in range(i + 1, k)), Decimal(0))
        solved[i] = rest / lower[i][i]
    return solved


def _jacobi(square: Rows) -> tuple[list[Decimal], Rows]:
    """Eigenvalues and eigenvectors (columns) of a positive definite matrix, by cyclic rotations."""
    k = len(square)
    a = [list(row) for row in square]
    v = [[Decimal(int(i == j)) for j in range(k)] for i in range(k)]
    small = Decimal(10) ** (-_DIGITS // 4)
    for _ in range(_SWEEPS):
        pairs = [
            (i, j) for i in range(k) for j in range(i + 1, k)
            if a[i][j] * a[i][j] > small * small * abs(a[i][i] * a[j][j])
        ]  # fmt: skip
        if not pairs:
            break
        for i, j in pairs:
            _rotate(a, v, i, j)
    return [a[i][i] for i in range(k)], v


def _rotate(a: Rows, v: Rows, i: int, j: int) -> None:
    """One rotation in the plane (i, j) that makes a[i][j] zero."""
    if a[i][j] == 0:
        return
    half = (a[j][j] - a[i][i]) / (2 * a[i][j])
    tangent = (1 if half >= 0 else -1) / (abs(half) + (half * half + 1).sqrt())
    c = 1 / (tangent * tangent + 1).sqrt()
    s = tangent * c
    for row in (*a, *v):
        row[i], row[j] = c * row[i] - s * row[j], s * row[i] + c * row[j]
    a[i], a[j] = (
        [c * x - s * y for x, y in zip(a[i], a[j], strict=True)],
        [s * x + c * y for x, y in zip(a[i], a[j], strict=True)],
    )
