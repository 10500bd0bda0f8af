"""Motions of motors and member, limb by limb, in lanes: an orthonormal basis in the metrics.

Reduced rows C_a q_a + C_u u = 0 come limb by limb.  Twists are u = U y in terms of the motions y left so
far; a limb with its motors q turns this into rows [C_a, C_u U] on (q, y), whose null space by reflections
is the next y.  At the end y stands for all motions, and going back through the limbs gives the motors.

Rows of U and motions y end at fixed slots and begin where their length says: a limb's motors are written
before them, what its reflections clear is left behind, and nothing is ever moved.
"""

from __future__ import annotations

from vincula.kernels.lanes import tables as t
from vincula.kernels.lanes.frames import constant
from vincula.kernels.lanes.jit import Code, Lane, Slots, kernel
from vincula.kernels.lanes.reflections import apply, square_below, triangularise
from vincula.kernels.lanes.vector import fma, larger, load, splat, store


@kernel
def relate(w: Slots, code: Code, constants: Slots, base: int, z: Lane) -> None:
    """The basis of all motions: k columns of n_a + d entries at `MOTIONS`.

    Args:
        w: The workspace, reduced rows known.
        code: Tables.
        constants: Constants.
        base: See `frames.place_all`.
        z: Zero.
    """
    basis, d, widest = base + code[t.BASIS], code[t.TWIST], code[t.WIDEST]
    for i in range(d):
        for j in range(d):
            store(w, basis + (i + 1) * widest - d + j, z)
        store(w, basis + (i + 1) * widest - d + i, splat(1.0, z))
    for limb in range(code[t.LIMBS]):
        entry = code[t.LIMB] + t.LIMB_ENTRY * limb
        if code[entry + 1] > 0:
            _rows_on_motions(w, code, constants, base, entry, limb == 0, z)
        _next_basis(w, code, base, entry, z)
    _motions(w, code, base, z)


@kernel
def _rows_on_motions(
    w: Slots, code: Code, constants: Slots, base: int, entry: int, first: bool, z: Lane
) -> None:
    """Reflections of the rows of one limb on (its motors, motions before), rows as columns."""
    rows, motors, own = code[entry + 1], code[entry + 2], code[entry + 3]
    before, d, widest = code[entry + 9], code[t.TWIST], code[t.WIDEST]
    length = motors + before
    source, target = base + code[entry], base + code[entry + 8]
    basis, metric = base + code[t.BASIS], code[t.METRIC]
    for r in range(rows):
        row, column = source + r * (motors + d), target + r * length
        for j in range(motors):
            factor = constant(constants, w, metric + code[own + j], z)
            store(w, column + j, load(w, row + j, z) * factor)
        for j in range(before):
            store(w, column + motors + j, z)
        for i in range(d):
            x = load(w, row + motors + i, z) * constant(constants, w, metric + code[t.MOTORS] + i, z)
            if first:
                store(w, column + motors + i, x)
                continue
            for j in range(before):
                place = column + motors + j
                known = load(w, basis + (i + 1) * widest - before + j, z)
                store(w, place, fma(x, known, load(w, place, z)))
    factors = target + rows * length
    triangularise(w, target, length, code, code[entry + 7], code[entry + 6], rows, factors, z)
    trail = load(w, base + code[t.NOTES] + t.TRAIL, z)
    for r in range(code[entry + 6], rows):
        left = square_below(w, target + code[code[entry + 7] + r] * length, code[entry + 6], length, z)
        trail = larger(trail, left)
    store(w, base + code[t.NOTES] + t.TRAIL, trail)


@kernel
def _next_basis(w: Slots, code: Code, base: int, entry: int, z: Lane) -> None:
    """U in terms of the motions that the limb leaves."""
    rows, motors, rank, order = code[entry + 1], code[entry + 2], code[entry + 6], code[entry + 7]
    before, d, widest = code[entry + 9], code[t.TWIST], code[t.WIDEST]
    length = motors + before
    target = base + code[entry + 8]
    factors, basis = target + rows * length, base + code[t.BASIS]
    for i in range(d):
        row = basis + (i + 1) * widest - length
        for j in range(motors):
            store(w, row + j, z)
        for h in range(rank):
            apply(w, target + code[order + h] * length, h, length, factors + 3 * h, row, z)


@kernel
def _motions(w: Slots, code: Code, base: int, z: Lane) -> None:
    """Every motion y = e_p, back through the limbs: motors first, then the twist."""
    k, d, widest = code[t.FREEDOM], code[t.TWIST], code[t.WIDEST]
    size, vectors, motions = code[t.MOTORS] + d, base + code[t.VECTOR], base + code[t.MOTIONS]
    for p in range(k):
        for j in range(k):
            store(w, vectors + (p + 1) * widest - k + j, z)
        store(w, vectors + (p + 1) * widest - k + p, splat(1.0, z))
    for limb in range(code[t.LIMBS] - 1, -1, -1):
        entry = code[t.LIMB] + t.LIMB_ENTRY * limb
        for p in range(k):
            _back(w, code, base, entry, motions + p * size, vectors + (p + 1) * widest, z)
    for p in range(k):
        for i in range(d):
            known = load(w, base + code[t.BASIS] + (i + 1) * widest - k + p, z)
            store(w, motions + p * size + code[t.MOTORS] + i, known)


@kernel
def _back(w: Slots, code: Code, base: int, entry: int, column: int, end: int, z: Lane) -> None:
    """From the motions after a limb to its motors and the motions before it; both end at a slot."""
    rows, motors, own = code[entry + 1], code[entry + 2], code[entry + 3]
    rank, order, before = code[entry + 6], code[entry + 7], code[entry + 9]
    length = motors + before
    target, first = base + code[entry + 8], end - length
    factors = target + rows * length
    for j in range(rank):
        store(w, first + j, z)
    for h in range(rank - 1, -1, -1):
        apply(w, target + code[order + h] * length, h, length, factors + 3 * h, first, z)
    for j in range(motors):
        store(w, column + code[own + j], load(w, first + j, z))
