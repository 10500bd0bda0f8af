"""Passive joints eliminated front by front, in lanes: what is left are rows on motors and member."""

from __future__ import annotations

from vincula.kernels.lanes import tables as t
from vincula.kernels.lanes.chains import keep_inverse, note_chains
from vincula.kernels.lanes.jit import Code, Lane, Slots, kernel
from vincula.kernels.lanes.reflections import inverse_square, left_null, square_below, triangularise
from vincula.kernels.lanes.rows import joint_entries, member_entries
from vincula.kernels.lanes.vector import fma, larger, load, store


@kernel
def eliminate(w: Slots, code: Code, constants: Slots, base: int, z: Lane) -> None:
    """Reduced rows of all limbs, and notes on norms and inverses.

    Args:
        w: The workspace, frames placed and slopes of couplings known.
        code: Tables.
        constants: Constants.
        base: See `frames.place_all`.
        z: Zero.
    """
    notes = base + code[t.NOTES]
    for k in range(t.NOTE_COUNT):
        store(w, notes + k, z)
    for front in range(code[t.FRONTS]):
        entry = code[t.FRONT] + t.FRONT_ENTRY * front
        _gather(w, code, constants, base, entry, z)
        _hand_on(w, code, base, entry, z)
    note_chains(w, code, base, z)


@kernel
def _gather(w: Slots, code: Code, constants: Slots, base: int, entry: int, z: Lane) -> None:
    """The matrix of a front: rows of its blocks, then what earlier fronts handed on."""
    m, joints, member = code[entry], code[entry + 1] + code[entry + 3], code[entry + 6]
    matrix = base + code[t.BUFFER]
    row = 0
    for k in range(code[entry + 9]):
        block = code[code[entry + 8] + k]
        joint_entries(w, code, constants, base, block, code[entry + 10], joints, matrix + row, m, z)
        if member == 1:
            member_entries(w, code, base, block, matrix + joints * m + row, m, z)
        row += code[code[t.BLOCK] + t.BLOCK_ENTRY * block + 1]
    _note_norm(w, code, matrix, entry, row, base + code[t.NOTES], z)
    columns = joints + member * code[t.TWIST]
    at = code[entry + 11]
    for _ in range(code[entry + 12]):
        place, rows, width = base + code[at], code[at + 1], code[at + 2]
        for j in range(columns):
            source = code[at + 3 + j]
            for r in range(rows):
                value = z
                if source >= 0:
                    value = load(w, place + r * width + source, z)
                store(w, matrix + j * m + row + r, value)
        row += rows
        at += 3 + columns


@kernel
def _note_norm(w: Slots, code: Code, matrix: int, entry: int, rows: int, notes: int, z: Lane) -> None:
    """Add the squares of the rows of blocks to the squared norm of A."""
    columns = code[entry + 1] + code[entry + 3] + code[entry + 6] * code[t.TWIST]
    own = _norm(w, matrix, code[entry], rows, 0, columns, z)
    store(w, notes + t.NORM, load(w, notes + t.NORM, z) + own)


@kernel
def _norm(w: Slots, matrix: int, m: int, rows: int, first: int, last: int, z: Lane) -> Lane:
    """Squared norm of the upper rows of columns first ... last - 1."""
    total = z
    for j in range(first, last):
        for r in range(rows):
            x = load(w, matrix + j * m + r, z)
            total = fma(x, x, total)
    return total


@kernel
def _hand_on(w: Slots, code: Code, base: int, entry: int, z: Lane) -> None:
    """Eliminate the pivots of a front and store the rows that are left, row after row."""
    m, pivots, rank, others = code[entry], code[entry + 1], code[entry + 2], code[entry + 3]
    behind = others + code[entry + 6] * code[t.TWIST]
    order, steps = code[entry + 13], code[entry + 14]
    matrix, factors, vector = base + code[t.BUFFER], base + code[t.FACTORS], base + code[t.VECTOR]
    notes, out = base + code[t.NOTES], base + code[entry + 7]
    by_left = code[entry + 5] == t.BY_LEFT
    reach = rank if by_left else pivots + behind
    joints = pivots + others
    of_motors = _norm(w, matrix, m, m, pivots, joints, z)
    of_twist = _norm(w, matrix, m, m, joints, pivots + behind, z)
    triangularise(w, matrix, m, code, order, steps, reach, factors, z)
    if code[entry + 16] >= 0:
        keep_inverse(w, code, base, entry, z)
    elif pivots > 0:
        square = inverse_square(w, matrix, m, code, order, rank, factors, vector, z)
        store(w, notes + t.PASSIVE_INVERSE, larger(load(w, notes + t.PASSIVE_INVERSE, z), square))
        coupled = larger(load(w, notes + t.MOTOR_COUPLING, z), square * of_motors)
        store(w, notes + t.MOTOR_COUPLING, coupled)
        coupled = fma(square, of_twist, load(w, notes + t.OBJECT_COUPLING, z))
        store(w, notes + t.OBJECT_COUPLING, coupled)
    if by_left:
        _by_left(w, code, entry, matrix, factors, vector, notes, out, z)
    else:
        _by_reflection(w, code, entry, matrix, factors, notes, out, behind, z)


@kernel
def _by_left(
    w: Slots, code: Code, entry: int, matrix: int, factors: int, vector: int, notes: int, out: int, z: Lane
) -> None:
    """Rows handed on as products with left null vectors; dependent pivots must give nothing."""
    m, pivots, rank, handed = code[entry], code[entry + 1], code[entry + 2], code[entry + 4]
    behind = code[entry + 3] + code[entry + 6] * code[t.TWIST]
    order = code[entry + 13]
    trail = z
    for r in range(handed):
        left_null(w, matrix, m, code, order, rank, factors, rank + r, vector, z)
        for j in range(rank, pivots):
            x = _product(w, vector, matrix + code[order + j] * m, m, z)
            trail = fma(x, x, trail)
        for j in range(behind):
            store(w, out + r * behind + j, _product(w, vector, matrix + (pivots + j) * m, m, z))
    store(w, notes + t.TRAIL, larger(load(w, notes + t.TRAIL, z), trail))


@kernel
def _product(w: Slots, x: int, y: int, count: int, z: Lane) -> Lane:
    s = load(w, x, z) * load(w, y, z)
    for i in range(1, count):
        s = fma(load(w, x + i, z), load(w, y + i, z), s)
    return s


@kernel
def _by_reflection(
    w: Slots, code: Code, entry: int, matrix: int, factors: int, notes: int, out: int, behind: int, z: Lane
) -> None:
    """Rows handed on as the reflections left them; all that is below them must be zero."""
    m, pivots, rank, handed = code[entry], code[entry + 1], code[entry + 2], code[entry + 4]
    order, steps = code[entry + 13], code[entry + 14]
    trail = z
    for j in range(rank, pivots + behind):
        column = code[order + j]
        place = matrix + column * m
        if j < steps:
            # A reflected column: the diagonal is beside the factors, below it the reflection itself.
            diagonal = load(w, factors + 3 * j + 2, z)
            for r in range(handed):
                value = z
                if rank + r < j:
                    value = load(w, place + rank + r, z)
                elif rank + r == j:
                    value = diagonal
                store(w, out + r * behind + column - pivots, value)
        elif column < pivots:
            trail = trail + square_below(w, place, rank, m, z)
        else:
            trail = trail + square_below(w, place, rank + handed, m, z)
            for r in range(handed):
                store(w, out + r * behind + column - pivots, load(w, place + rank + r, z))
    store(w, notes + t.TRAIL, larger(load(w, notes + t.TRAIL, z), trail))
