"""The four ranks beyond the summary, certified in lanes on whole matrices: all twelve counts rest on them.

Cost grows with the cube of the mechanism, so this is done only where the twelve counts are asked for.
"""

from __future__ import annotations

from vincula.kernels.lanes import tables as t
from vincula.kernels.lanes.certificates import is_certain
from vincula.kernels.lanes.dense import dense_rows
from vincula.kernels.lanes.jit import Code, Lane, Slots, kernel
from vincula.kernels.lanes.reflections import inverse_square, square_below, triangularise
from vincula.kernels.lanes.vector import load, select, splat, store


@kernel
def certain_counts(w: Slots, code: Code, constants: Slots, base: int, z: Lane) -> Lane:
    """1 where the ranks of J_a, G^T, [J_a G^T] and of the test matrix are those of the plan, else 0."""
    m, n = code[t.ROWS], code[t.COLUMNS]
    whole = base + code[t.WHOLE]
    dense_rows(w, code, constants, base, code[t.EVERY_COLUMN], whole, z)
    good = splat(1.0, z)
    for k in range(4):
        entry = code[t.RANKS] + code[t.RANK_SPACE] * k
        rows, rank, count = code[entry], code[entry + 1], code[entry + 2]
        for j in range(count):
            target = whole + (n + code[t.TWIST]) * m + j * rows
            _column(w, code[entry + 4 + j], m, rows, n, code[t.MOTORS], whole, target, z)
        good = good * _one(w, code, constants, base, rows, rank, count, code[entry + 3], z)
    return good


@kernel
def _column(
    w: Slots, column: int, m: int, rows: int, n: int, motors: int, whole: int, target: int, z: Lane
) -> None:
    """A column of one of the matrices: of m rows as it is, of 2 m rows [[J_a J_p 0], [J_a 0 -G^T]]."""
    source = whole + column * m
    above = rows == m or column < n
    below = column < motors or column >= n
    for r in range(m):
        x = load(w, source + r, z)
        if above:
            store(w, target + r, x)
        else:
            store(w, target + r, z)
        if rows > m:
            if below:
                store(w, target + m + r, x)
            else:
                store(w, target + m + r, z)


@kernel
def _one(
    w: Slots, code: Code, constants: Slots, base: int, rows: int, rank: int, count: int, order: int, z: Lane
) -> Lane:
    """1 where one matrix has its rank for certain."""
    matrix = base + code[t.WHOLE] + (code[t.COLUMNS] + code[t.TWIST]) * code[t.ROWS]
    factors = base + code[t.WHOLE_FACTORS]
    vector = factors + 3 * rank
    triangularise(w, matrix, rows, code, order, rank, count, factors, z)
    inverse = inverse_square(w, matrix, rows, code, order, rank, factors, vector, z)
    trail = z
    for j in range(rank, count):
        trail = trail + square_below(w, matrix + code[order + j] * rows, rank, rows, z)
    return select(is_certain(w, code, constants, base, inverse, trail, z), splat(1.0, z), z)
