"""Householder reflections in lanes, on matrices stored by columns, columns taken in a given order."""

from __future__ import annotations

from vincula.kernels.lanes.jit import Code, Lane, Slots, kernel
from vincula.kernels.lanes.vector import fma, fnma, less, load, more, neg, rsqrt, select, splat, store

TINY = 1e-280
"""Squared lengths below this count as zero: a reflection of nothing, and an inverse beyond all bounds."""
HUGE = 1e140


@kernel
def reflect(w: Slots, a: int, k: int, m: int, factors: int, z: Lane) -> None:
    """Make the reflection that clears rows k + 1 ... m - 1 of a column.

    The column keeps the reflection from row k on; three slots at `factors` get its factor, one over the
    diagonal entry that it leaves, and that entry.
    """
    head = load(w, a + k, z)
    square = z
    for i in range(k + 1, m):
        x = load(w, a + i, z)
        square = fma(x, x, square)
    square = fma(head, head, square)
    there = more(square, splat(TINY, z))
    inverse = select(there, rsqrt(square), splat(HUGE, z))
    length = square * inverse
    below = less(head, z)
    shift = select(below, neg(length), length)
    first = head + shift
    store(w, a + k, first)
    store(w, factors, select(there, splat(1.0, z) / (first * shift), z))
    store(w, factors + 1, select(below, inverse, neg(inverse)))
    store(w, factors + 2, neg(shift))


@kernel
def apply(w: Slots, a: int, k: int, m: int, factors: int, b: int, z: Lane) -> None:
    """Apply the reflection kept in column a to the rows k ... m - 1 at b."""
    s = load(w, a + k, z) * load(w, b + k, z)
    for i in range(k + 1, m):
        s = fma(load(w, a + i, z), load(w, b + i, z), s)
    s = s * load(w, factors, z)
    for i in range(k, m):
        store(w, b + i, fnma(s, load(w, a + i, z), load(w, b + i, z)))


@kernel
def triangularise(
    w: Slots, matrix: int, m: int, code: Code, order: int, steps: int, columns: int, factors: int, z: Lane
) -> None:
    """Reflect the first `steps` of `columns` columns, in order, to a triangle.

    Args:
        w: The workspace.
        matrix: First slot; column c begins at matrix + c m.
        m: Rows.
        code: Tables.
        order: Where in `code` the order of the columns is.
        steps: Number of reflections.
        columns: Number of columns that they are applied to, those reflected included.
        factors: Three slots a reflection.
        z: Zero.
    """
    for h in range(steps):
        a = matrix + code[order + h] * m
        reflect(w, a, h, m, factors + 3 * h, z)
        for j in range(h + 1, columns):
            apply(w, a, h, m, factors + 3 * h, matrix + code[order + j] * m, z)


@kernel
def inverse_square(
    w: Slots, matrix: int, m: int, code: Code, order: int, steps: int, factors: int, vector: int, z: Lane
) -> Lane:
    """Squared Frobenius norm of the inverse of the triangle; its root bounds 1 / smallest singular value."""
    total = z
    for j in range(steps):
        x = load(w, factors + 3 * j + 1, z)
        store(w, vector + j, x)
        total = fma(x, x, total)
        for i in range(j - 1, -1, -1):
            s = z
            for k in range(i + 1, j + 1):
                s = fma(load(w, matrix + code[order + k] * m + i, z), load(w, vector + k, z), s)
            x = neg(s * load(w, factors + 3 * i + 1, z))
            store(w, vector + i, x)
            total = fma(x, x, total)
    return total


@kernel
def solved_square(
    w: Slots, matrix: int, m: int, code: Code, order: int, steps: int, factors: int, column: int,
    vector: int, z: Lane,
) -> Lane:  # fmt: skip
    """Squared length of the solution for one reflected column: of the inverse of the triangle times it."""
    total = z
    for i in range(steps - 1, -1, -1):
        s = load(w, column + i, z)
        for k in range(i + 1, steps):
            s = fnma(load(w, matrix + code[order + k] * m + i, z), load(w, vector + k, z), s)
        x = s * load(w, factors + 3 * i + 1, z)
        store(w, vector + i, x)
        total = fma(x, x, total)
    return total


@kernel
def left_null(
    w: Slots, matrix: int, m: int, code: Code, order: int, steps: int, factors: int, row: int, vector: int,
    z: Lane,
) -> None:  # fmt: skip
    """Unit vector orthogonal to the reflected columns: the image of unit vector `row` >= steps."""
    for i in range(m):
        store(w, vector + i, z)
    store(w, vector + row, splat(1.0, z))
    for h in range(steps - 1, -1, -1):
        apply(w, matrix + code[order + h] * m, h, m, factors + 3 * h, vector, z)


@kernel
def square_below(w: Slots, column: int, first: int, m: int, z: Lane) -> Lane:
    """Squared length of rows first ... m - 1 of a column."""
    total = z
    for i in range(first, m):
        x = load(w, column + i, z)
        total = fma(x, x, total)
    return total
