"""Gaps of open loops in lanes: where frames are, and by how much they miss each other.

Orientations are measured by sines, which vanish where the rotation vectors of `mechanism.closure_rows` do
and need no inverse functions; cosines tell them from half a turn.
"""

from __future__ import annotations

from vincula.kernels.lanes import closing_tables as c
from vincula.kernels.lanes import tables as t
from vincula.kernels.lanes.closing_scalar_gaps import scalar_gaps
from vincula.kernels.lanes.frames import constant, quaternion_rotation, run_tape, turned
from vincula.kernels.lanes.jit import Code, Lane, Slots, kernel
from vincula.kernels.lanes.trigonometry import cosine_sine
from vincula.kernels.lanes.vector import fma, fnma, less, load, neg, select, splat, store


@kernel
def gaps_at(w: Slots, code: Code, plan: Code, constants: Slots, base: int, z: Lane) -> Lane:
    """Place all frames at the values in the workspace, write all gaps; the sum of their squares.

    Args:
        w: The workspace: values, and what is given.
        code: Values and frames.
        plan: Tables of closing.
        constants: Constants.
        base: See `frames.place_all`.
        z: Zero.
    """
    if plan[c.POSE] >= 0:
        _place_member(w, plan, base, z)
    run_tape(w, code, constants, base, 0, code[t.TAPE_LENGTH], z)
    at = plan[c.DIRECTION]
    for k in range(plan[at]):
        entry = at + 1 + 3 * k
        turned(w, constants, base + plan[entry + 1], plan[entry + 2], base + plan[entry], z)
    store(w, base + plan[c.SIDE], splat(1.0, z))
    total = z
    for block in range(plan[c.BLOCKS]):
        total = total + _part_gaps(w, plan, constants, base, plan[c.BLOCK] + c.BLOCK_ENTRY * block, z)
    return total + scalar_gaps(w, plan, constants, base, z)


@kernel
def _place_member(w: Slots, plan: Code, base: int, z: Lane) -> None:
    """The frame at the reference point from the pose given."""
    given, target = base + plan[c.INPUT], base + plan[c.POSE]
    if plan[c.INPUTS] == 3:
        cosine, sine = cosine_sine(load(w, given + 2, z), z)
        for i in range(9):
            store(w, target + i, z)
        store(w, target, cosine)
        store(w, target + 1, neg(sine))
        store(w, target + 3, sine)
        store(w, target + 4, cosine)
        store(w, target + 8, splat(1.0, z))
        store(w, target + 11, z)
    else:
        quaternion_rotation(w, given + 3, 1, target, z)
        store(w, target + 11, load(w, given + 2, z))
    store(w, target + 9, load(w, given, z))
    store(w, target + 10, load(w, given + 1, z))


@kernel
def _part_gaps(w: Slots, plan: Code, constants: Slots, base: int, entry: int, z: Lane) -> Lane:
    """Gaps of one part; the sum of their squares."""
    one, two = base + plan[entry], base + plan[entry + 1]
    offset, turns, gap = plan[entry + 2], plan[entry + 3], base + plan[entry + 6]
    x = load(w, two + 9, z) - load(w, one + 9, z)
    y = load(w, two + 10, z) - load(w, one + 10, z)
    v = load(w, two + 11, z) - load(w, one + 11, z)
    total = z
    for k in range(3):
        if offset & (1 << k):
            if offset & c.ALL:
                value = x
                if k == 1:
                    value = y
                elif k == 2:
                    value = v
            else:
                value = _along(w, one + k, 3, x, y, v, z)
            store(w, gap, value)
            total = fma(value, value, total)
            gap += 1
    if turns != c.FREE:
        total = total + _turn_gaps(w, plan, constants, base, entry, gap, z)
    return total


@kernel
def _along(w: Slots, slot: int, stride: int, x: Lane, y: Lane, v: Lane, z: Lane) -> Lane:
    """Scalar product of three slots `stride` apart with a vector."""
    return fma(load(w, slot, z), x, fma(load(w, slot + stride, z), y, load(w, slot + 2 * stride, z) * v))


@kernel
def _turn_gaps(w: Slots, plan: Code, constants: Slots, base: int, entry: int, gap: int, z: Lane) -> Lane:
    """Gaps of orientation, the directions they open about, the cosine that rules out half a turn."""
    turns = plan[entry + 3]
    if turns == c.WHOLE:
        return _whole_turn(w, plan, base, entry, gap, z)
    if turns == c.VECTOR:
        return _turn_components(w, plan, base, entry, gap, z)
    return _axis_gaps(w, plan, constants, base, entry, gap, z)


@kernel
def _seen(w: Slots, plan: Code, base: int, cosine: Lane, z: Lane) -> None:
    """Keep the smallest cosine."""
    side = base + plan[c.SIDE]
    before = load(w, side, z)
    store(w, side, select(less(before, cosine), before, cosine))


@kernel
def _whole_turn(w: Slots, plan: Code, base: int, entry: int, gap: int, z: Lane) -> Lane:
    """Axis times sine of the turn from A to B, in ground axes."""
    one, two, mask = base + plan[entry], base + plan[entry + 1], plan[entry + 4]
    p, q, r, trace = z, z, z, z
    for k in range(3):
        a, b, d = load(w, one + k, z), load(w, one + 3 + k, z), load(w, one + 6 + k, z)
        x, y, v = load(w, two + k, z), load(w, two + 3 + k, z), load(w, two + 6 + k, z)
        p = fma(b, v, fnma(d, y, p))
        q = fma(d, x, fnma(a, v, q))
        r = fma(a, y, fnma(b, x, r))
        trace = fma(a, x, fma(b, y, fma(d, v, trace)))
    half, total = splat(0.5, z), z
    for k in range(3):
        if mask & (1 << k):
            value = p
            if k == 1:
                value = q
            elif k == 2:
                value = r
            value = value * half
            store(w, gap, value)
            total = fma(value, value, total)
            gap += 1
    _seen(w, plan, base, trace - splat(1.0, z), z)
    return total


@kernel
def _turn_components(w: Slots, plan: Code, base: int, entry: int, gap: int, z: Lane) -> Lane:
    """Components of axis times sine in the axes of A; they open about (trace 1 - M) e_k / 2."""
    one, two, mask, rows = base + plan[entry], base + plan[entry + 1], plan[entry + 4], base + plan[entry + 8]
    half, total = splat(0.5, z), z
    trace = z
    for k in range(3):
        trace = trace + columns_product(w, one + k, two + k, z)
    for k in range(3):
        if mask & (1 << k):
            i, j = (k + 1) % 3, (k + 2) % 3
            # Component k of the rotation vector times sin / angle: (M[j, i] - M[i, j]) / 2.
            value = half * (columns_product(w, one + j, two + i, z) - columns_product(w, one + i, two + j, z))
            store(w, gap, value)
            total = fma(value, value, total)
            p, q, r = (columns_product(w, one + k, two, z), columns_product(w, one + k, two + 1, z),
                       columns_product(w, one + k, two + 2, z))  # fmt: skip
            for axis in range(3):
                row = one + 3 * axis
                direction = fma(p, load(w, row, z), fma(q, load(w, row + 1, z), r * load(w, row + 2, z)))
                store(w, rows + axis, half * fma(trace, load(w, row + k, z), neg(direction)))
            _seen(w, plan, base, trace - columns_product(w, one + k, two + k, z), z)
            gap += 1
            rows += 3
    return total


@kernel
def columns_product(w: Slots, one: int, two: int, z: Lane) -> Lane:
    """Scalar product of two columns of rotations."""
    rest = fma(load(w, one + 3, z), load(w, two + 3, z), load(w, one + 6, z) * load(w, two + 6, z))
    return fma(load(w, one, z), load(w, two, z), rest)


@kernel
def _axis_gaps(w: Slots, plan: Code, constants: Slots, base: int, entry: int, gap: int, z: Lane) -> Lane:
    """z of A against z of B, or against another axis of B."""
    one, two, rows = base + plan[entry], base + plan[entry + 1], base + plan[entry + 8]
    if plan[entry + 3] == c.BETWEEN:
        index = plan[entry + 5]
        turned(w, constants, two, index, rows, z)
        x, y, v = load(w, rows, z), load(w, rows + 1, z), load(w, rows + 2, z)
        value = _along(w, one + 2, 3, x, y, v, z) - constant(constants, w, index + 3, z)
        _write_cross(w, rows, x, y, v, one + 2, z)
        store(w, gap, value)
        return value * value
    x, y, v = load(w, two + 2, z), load(w, two + 5, z), load(w, two + 8, z)
    first = neg(_along(w, one + 1, 3, x, y, v, z))
    second = _along(w, one, 3, x, y, v, z)
    store(w, gap, first)
    store(w, gap + 1, second)
    _write_cross(w, rows + 3, x, y, v, one, z)
    _write_cross(w, rows, neg(x), neg(y), neg(v), one + 1, z)
    _seen(w, plan, base, _along(w, one + 2, 3, x, y, v, z), z)
    return fma(first, first, second * second)


@kernel
def _write_cross(w: Slots, target: int, x: Lane, y: Lane, v: Lane, column: int, z: Lane) -> None:
    """(x, y, v) cross a column of a rotation."""
    a, b, d = load(w, column, z), load(w, column + 3, z), load(w, column + 6, z)
    store(w, target, fnma(v, b, y * d))
    store(w, target + 1, fnma(x, d, v * a))
    store(w, target + 2, fnma(y, a, x * b))
