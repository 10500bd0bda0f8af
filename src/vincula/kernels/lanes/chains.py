"""Smallest singular values of passive joints where a limb has several fronts, in lanes.

The triangle R of all fronts of a limb is sparse, its inverse is not.  But the squared norm of the inverse
is the trace of S = (R^T R)^-1, of which only the blocks on the columns of each front are needed: from the
root outwards, with E = R_pp^-1 R_pf (p the pivots of a front, f its columns that later fronts eliminate),

    S_pf = -E S_ff,    S_pp = R_pp^-1 R_pp^-T + E S_ff E^T.

In the same way X = R^-1 B for the columns B of motors and twist: X_p = R_pp^-1 B_p - E X_f.
"""

from __future__ import annotations

from vincula.kernels.lanes import tables as t
from vincula.kernels.lanes.jit import Code, Lane, Slots, kernel
from vincula.kernels.lanes.vector import fma, fnma, larger, load, neg, store


@kernel
def keep_inverse(w: Slots, code: Code, base: int, entry: int, z: Lane) -> None:
    """Keep R_pp^-1 and E of a front just reflected, by columns."""
    m, rank, order = code[entry], code[entry + 2], code[entry + 13]
    rest, count = code[entry + 18], code[entry + 17]
    matrix, factors, target = base + code[t.BUFFER], base + code[t.FACTORS], base + code[entry + 16]
    for j in range(rank):
        column = target + j * rank
        for i in range(rank):
            store(w, column + i, z)
        store(w, column + j, load(w, factors + 3 * j + 1, z))
        for i in range(j - 1, -1, -1):
            s = z
            for k in range(i + 1, j + 1):
                s = fma(load(w, matrix + code[order + k] * m + i, z), load(w, column + k, z), s)
            store(w, column + i, neg(s * load(w, factors + 3 * i + 1, z)))
    for j in range(count):
        _solved(w, code, base, entry, code[rest + 2 * j], target + (rank + j) * rank, z)
    for j in range(code[entry + 20]):
        _solved(w, code, base, entry, code[code[entry + 21] + j], target + (rank + count + j) * rank, z)


@kernel
def _solved(w: Slots, code: Code, base: int, entry: int, position: int, column: int, z: Lane) -> None:
    """R_pp^-1 times the upper rows of one column of a front; zero for a column that it does not have."""
    m, rank, order = code[entry], code[entry + 2], code[entry + 13]
    matrix, factors = base + code[t.BUFFER], base + code[t.FACTORS]
    for i in range(rank - 1, -1, -1):
        if position < 0:
            store(w, column + i, z)
            continue
        s = load(w, matrix + position * m + i, z)
        for k in range(i + 1, rank):
            s = fnma(load(w, matrix + code[order + k] * m + i, z), load(w, column + k, z), s)
        store(w, column + i, s * load(w, factors + 3 * i + 1, z))


@kernel
def note_chains(w: Slots, code: Code, base: int, z: Lane) -> None:
    """Note the largest squared norm of an inverse over all limbs of several fronts."""
    notes = base + code[t.NOTES]
    for front in range(code[t.FRONTS] - 1, -1, -1):
        entry = code[t.FRONT] + t.FRONT_ENTRY * front
        if code[entry + 16] >= 0:
            if code[entry + 19] < 0:
                store(w, notes + t.LIMB_INVERSE, z)
                store(w, notes + t.LIMB_COUPLING, z)
            _blocks(w, code, base, entry, z)
            _couplings(w, code, base, entry, notes, z)
            total = load(w, notes + t.LIMB_INVERSE, z)
            store(w, notes + t.PASSIVE_INVERSE, larger(load(w, notes + t.PASSIVE_INVERSE, z), total))


@kernel
def _blocks(w: Slots, code: Code, base: int, entry: int, z: Lane) -> None:
    """S on the columns of one front; its trace is added to that of the limb."""
    rank, count = code[entry + 2], code[entry + 17]
    size = rank + count
    inverse, target = base + code[entry + 16], base + code[entry + 16] + rank * (size + code[entry + 20])
    if count > 0:
        _of_parent(w, code, base, entry, target, size, z)
    for i in range(rank):
        for j in range(count):
            s = z
            for k in range(count):
                other = load(w, target + (rank + k) * size + rank + j, z)
                s = fnma(load(w, inverse + (rank + k) * rank + i, z), other, s)
            store(w, target + i * size + rank + j, s)
            store(w, target + (rank + j) * size + i, s)
    trace = load(w, base + code[t.NOTES] + t.LIMB_INVERSE, z)
    for i in range(rank):
        for j in range(rank):
            s = z
            for k in range(rank):
                s = fma(load(w, inverse + k * rank + i, z), load(w, inverse + k * rank + j, z), s)
            for k in range(count):
                crossed = load(w, target + i * size + rank + k, z)
                s = fnma(crossed, load(w, inverse + (rank + k) * rank + j, z), s)
            store(w, target + i * size + j, s)
            if i == j:
                trace = trace + s
    store(w, base + code[t.NOTES] + t.LIMB_INVERSE, trace)


@kernel
def _of_parent(w: Slots, code: Code, base: int, entry: int, target: int, size: int, z: Lane) -> None:
    """S_ff: taken from the front that eliminates the rows handed on; columns dropped there count nothing."""
    rank, count, rest = code[entry + 2], code[entry + 17], code[entry + 18]
    parent = code[t.FRONT] + t.FRONT_ENTRY * code[entry + 19]
    side = code[parent + 2] + code[parent + 17]
    source = base + code[parent + 16] + code[parent + 2] * (side + code[parent + 20])
    for j in range(count):
        for k in range(count):
            one, two = code[rest + 2 * j + 1], code[rest + 2 * k + 1]
            value = z
            if one >= 0 and two >= 0:
                value = load(w, source + one * side + two, z)
            store(w, target + (rank + j) * size + rank + k, value)


@kernel
def _couplings(w: Slots, code: Code, base: int, entry: int, notes: int, z: Lane) -> None:
    """X on the columns of one front; its squares are added to those of the limb."""
    rank, count, width = code[entry + 2], code[entry + 17], code[entry + 20]
    size, rest = rank + count, code[entry + 18]
    inverse = base + code[entry + 16]
    target = inverse + rank * (size + width) + size * size
    parent = code[t.FRONT] + t.FRONT_ENTRY * code[entry + 19]
    side = code[parent + 2] + code[parent + 17]
    source = base + code[parent + 16] + code[parent + 2] * (side + width) + side * side
    of_motors, of_twist = load(w, notes + t.LIMB_COUPLING, z), load(w, notes + t.OBJECT_COUPLING, z)
    for j in range(width):
        for k in range(count):
            value = z
            if code[rest + 2 * k + 1] >= 0:
                value = load(w, source + j * side + code[rest + 2 * k + 1], z)
            store(w, target + j * size + rank + k, value)
        for i in range(rank):
            s = load(w, inverse + (size + j) * rank + i, z)
            for k in range(count):
                other = load(w, target + j * size + rank + k, z)
                s = fnma(load(w, inverse + (rank + k) * rank + i, z), other, s)
            store(w, target + j * size + i, s)
            if j < width - code[t.TWIST]:
                of_motors = fma(s, s, of_motors)
            else:
                of_twist = fma(s, s, of_twist)
    store(w, notes + t.LIMB_COUPLING, of_motors)
    store(w, notes + t.OBJECT_COUPLING, of_twist)
    store(w, notes + t.MOTOR_COUPLING, larger(load(w, notes + t.MOTOR_COUPLING, z), of_motors))
