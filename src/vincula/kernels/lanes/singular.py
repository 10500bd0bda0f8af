"""Single singular values of a matrix, in lanes: bidiagonal by reflections, then by bisection.

The r-th largest singular value alone needs no rotations: how many of them exceed a number is the number of
positive pivots of a tridiagonal matrix with a zero diagonal (Golub and Kahan 1965; Demmel and Kahan 1990).
Its error is rounding relative to the largest one, as with LAPACK.
"""

from __future__ import annotations

from vincula.kernels.lanes.jit import Lane, Slots, kernel
from vincula.kernels.lanes.reflections import apply, reflect
from vincula.kernels.lanes.vector import (
    absolute,
    at_least,
    fma,
    fnma,
    less,
    load,
    more,
    select,
    splat,
    sqrt,
    store,
)

HALVINGS = 57
"""Halvings of the interval: what is left of it is below the last digit of the largest value."""
TINY = 1e-290
"""A pivot smaller than this is taken as this: it stands for one of either sign."""


@kernel
def side_by_side(w: Slots, source: int, m: int, columns: int, target: int, z: Lane) -> None:
    """Copy a matrix stored by columns, turned so that its columns are not longer than there are of them.

    Args:
        w: The workspace.
        source: First slot; column c begins at source + c m.
        m: Rows.
        columns: Columns.
        target: Where it goes.
        z: Zero.
    """
    for c in range(columns):
        for r in range(m):
            x = load(w, source + c * m + r, z)
            if columns <= m:
                store(w, target + c * m + r, x)
            else:
                store(w, target + r * columns + c, x)


@kernel
def bidiagonalise(w: Slots, matrix: int, p: int, q: int, squares: int, room: int, z: Lane) -> None:
    """Squares of the 2 p - 1 entries of the bidiagonal form, diagonal and beside it in turn.

    Args:
        w: The workspace.
        matrix: First slot of p columns of q >= p rows, overwritten.
        p: Columns.
        q: Rows.
        squares: Where the squares go.
        room: p + 3 slots.
        z: Zero.
    """
    factors = room + p
    for k in range(p):
        a = matrix + k * q
        reflect(w, a, k, q, factors, z)
        x = load(w, factors + 2, z)
        store(w, squares + 2 * k, x * x)
        for j in range(k + 1, p):
            apply(w, a, k, q, factors, matrix + j * q, z)
        if k + 1 < p:
            for j in range(k + 1, p):
                store(w, room + j, load(w, matrix + j * q + k, z))
            reflect(w, room, k + 1, p, factors, z)
            x = load(w, factors + 2, z)
            store(w, squares + 2 * k + 1, x * x)
            for i in range(k + 1, q):
                _apply_to_row(w, matrix + i, k + 1, p, q, room, factors, z)


@kernel
def _apply_to_row(w: Slots, row: int, first: int, p: int, q: int, room: int, factors: int, z: Lane) -> None:
    """Apply the reflection kept in `room` to the columns first ... p - 1 of one row."""
    s = z
    for j in range(first, p):
        s = fma(load(w, room + j, z), load(w, row + j * q, z), s)
    s = s * load(w, factors, z)
    for j in range(first, p):
        place = row + j * q
        store(w, place, fnma(s, load(w, room + j, z), load(w, place, z)))


@kernel
def singular_value(w: Slots, squares: int, p: int, rank: int, z: Lane) -> Lane:
    """The singular value of this rank, 1 the largest, of a bidiagonal matrix of p columns.

    Args:
        w: The workspace.
        squares: Where the squares of its entries are.
        p: Columns.
        rank: Which value, from 1 to p.
        z: Zero.
    """
    total = z
    for i in range(2 * p - 1):
        total = total + load(w, squares + i, z)
    low, high = z, sqrt(total)
    wanted, half, one = splat(float(rank) - 0.5, z), splat(0.5, z), splat(1.0, z)
    tiny = splat(TINY, z)
    for _ in range(HALVINGS):
        middle = (low + high) * half
        pivot = z - middle
        above = z
        for i in range(2 * p - 1):
            safe = select(less(absolute(pivot), tiny), z - tiny, pivot)
            pivot = z - middle - load(w, squares + i, z) / safe
            above = above + select(more(pivot, z), one, z)
        enough = at_least(above, wanted)
        low, high = select(enough, middle, low), select(enough, high, middle)
    return (low + high) * half
