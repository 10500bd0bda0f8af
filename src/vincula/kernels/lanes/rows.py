"""Constraint rows in lanes: entries of A = [J_a J_p -G^T] in scaled units, block by block.

Rows come by blocks (all rows of a part), written into a matrix by columns with a leading dimension of
the caller's choice: entry (row r of the block, column k of the caller's list) goes to slot
target + k stride + r.
"""

from __future__ import annotations

from vincula.kernels.lanes import tables as t
from vincula.kernels.lanes.frames import constant
from vincula.kernels.lanes.jit import Code, Lane, Slots, kernel
from vincula.kernels.lanes.vector import fma, fnma, load, neg, splat, store


@kernel
def slopes(w: Slots, code: Code, constants: Slots, base: int, z: Lane) -> None:
    """Slopes of all polynomial couplings at the values in the workspace."""
    at = code[t.POLYNOMIAL]
    count = code[at]
    at += 1
    for _ in range(count):
        target, terms = base + code[at], code[at + 1]
        at += 2
        inner = z
        for _term in range(terms):
            inner = inner + term(w, constants, base + code[at], code[at + 1], z)
            at += 2
        store(w, target, polynomial(w, constants, code[at], code[at + 1], inner, z))
        at += 2


@kernel
def term(w: Slots, constants: Slots, value: int, index: int, z: Lane) -> Lane:
    """Coefficient times (value - reference); constants: the coefficient, and it times the reference."""
    return fma(constant(constants, w, index, z), load(w, value, z), neg(constant(constants, w, index + 1, z)))


@kernel
def polynomial(w: Slots, constants: Slots, length: int, index: int, x: Lane, z: Lane) -> Lane:
    """Value of a polynomial with constant coefficients, lowest first."""
    value = z
    for k in range(length - 1, -1, -1):
        value = fma(value, x, constant(constants, w, index + k, z))
    return value


@kernel
def joint_entries(
    w: Slots, code: Code, constants: Slots, base: int, block: int, columns: int, count: int,
    target: int, stride: int, z: Lane,
) -> None:  # fmt: skip
    """Entries of one block in chosen columns of [J_a J_p].

    Args:
        w: The workspace, frames placed.
        code: Tables.
        constants: Constants.
        base: See `frames.place_all`.
        block: The row block.
        columns: Where in `code` the list of columns is.
        count: Its length.
        target: Slot of the first entry.
        stride: Slots from one column to the next.
        z: Zero.
    """
    entry = code[t.BLOCK] + t.BLOCK_ENTRY * block
    first, rows, kind = code[entry], code[entry + 1], code[entry + 4]
    signs = code[t.SIGN] + code[t.COLUMNS] * block
    for k in range(count):
        column = code[columns + k]
        sign = code[signs + column]
        place = target + k * stride
        if sign == 0:
            for r in range(rows):
                store(w, place + r, z)
        elif kind != t.GEOMETRY:
            store(w, place, _coefficient(w, code, constants, base, block, kind, sign - 1, z))
        else:
            _axis_entries(
                w, code, constants, base, column, sign, base + code[entry + 2], first, rows, place, z
            )


@kernel
def _coefficient(
    w: Slots, code: Code, constants: Slots, base: int, block: int, kind: int, index: int, z: Lane
) -> Lane:
    """Coefficient of a coupling or drive."""
    value = constant(constants, w, index, z)
    if kind == t.CURVED:
        before = 0
        for other in range(block):
            if code[code[t.BLOCK] + t.BLOCK_ENTRY * other + 4] == t.CURVED:
                before += 1
        at = code[t.POLYNOMIAL] + 1
        for _ in range(before):
            at += 4 + 2 * code[at + 1]
        value = fma(load(w, base + code[at], z), constant(constants, w, index + 1, z), value)
    return value


@kernel
def _axis_entries(
    w: Slots, code: Code, constants: Slots, base: int, column: int, sign: int, point: int, first: int,
    rows: int, place: int, z: Lane,
) -> None:  # fmt: skip
    """Entries of one joint axis in the rows of one block: velocity at the point, and angular velocity."""
    entry = code[t.COLUMN] + t.COLUMN_ENTRY * column
    frame, centre, axis = base + code[entry], base + code[entry + 1], code[entry + 2]
    turn, advance = code[entry + 3], code[entry + 4]
    stride = 3
    if axis < 0:
        axis, stride = 0, 1
    a, b, c = (
        load(w, frame + axis, z),
        load(w, frame + axis + stride, z),
        load(w, frame + axis + 2 * stride, z),
    )
    if sign < 0:
        a, b, c = neg(a), neg(b), neg(c)
    if turn == 0:
        for r in range(rows):
            store(w, place + r, _pushed(w, code, base, first + r, a, b, c, z))
        return
    x = load(w, point + 9, z) - load(w, centre + 9, z)
    y = load(w, point + 10, z) - load(w, centre + 10, z)
    v = load(w, point + 11, z) - load(w, centre + 11, z)
    p, q, s = fnma(c, y, b * v), fnma(a, v, c * x), fnma(b, x, a * y)
    if advance >= 0:
        rise = constant(constants, w, advance, z)
        p, q, s = fma(rise, a, p), fma(rise, b, q), fma(rise, c, s)
    for r in range(rows):
        store(w, place + r, _entry(w, code, base, first + r, p, q, s, a, b, c, z))


@kernel
def _pushed(w: Slots, code: Code, base: int, row: int, p: Lane, q: Lane, s: Lane, z: Lane) -> Lane:
    """A row on a pure translation."""
    entry = code[t.ROW] + t.ROW_ENTRY * row
    kind, frame, axis = code[entry], base + code[entry + 1], code[entry + 2]
    if kind == t.TURN_GROUND or kind == t.TURN_FRAME:
        return z
    return _push(w, kind, frame, axis, p, q, s, z)


@kernel
def _push(w: Slots, kind: int, frame: int, axis: int, p: Lane, q: Lane, s: Lane, z: Lane) -> Lane:
    if kind == t.PUSH_GROUND:
        if axis == 0:
            return p
        if axis == 1:
            return q
        return s
    stride = 3
    if kind == t.GENERAL:
        axis, stride = 0, 1
    return _dot(w, frame + axis, stride, p, q, s, z)


@kernel
def _dot(w: Slots, slot: int, stride: int, p: Lane, q: Lane, s: Lane, z: Lane) -> Lane:
    """Scalar product of three slots `stride` apart with a vector."""
    return fma(load(w, slot, z), p, fma(load(w, slot + stride, z), q, load(w, slot + 2 * stride, z) * s))


@kernel
def _entry(
    w: Slots, code: Code, base: int, row: int, p: Lane, q: Lane, s: Lane, a: Lane, b: Lane, c: Lane, z: Lane
) -> Lane:
    """A row on the velocity (p, q, s) of the point and the angular velocity (a, b, c)."""
    entry = code[t.ROW] + t.ROW_ENTRY * row
    kind, frame, axis = code[entry], base + code[entry + 1], code[entry + 2]
    if kind == t.TURN_GROUND:
        return _push(w, t.PUSH_GROUND, frame, axis, a, b, c, z)
    if kind == t.TURN_FRAME:
        return _dot(w, frame + axis, 3, a, b, c, z)
    value = _push(w, kind, frame, axis, p, q, s, z)
    if kind == t.GENERAL:
        value = value + _dot(w, frame + 3, 1, a, b, c, z)
    return value


@kernel
def member_entries(w: Slots, code: Code, base: int, block: int, target: int, stride: int, z: Lane) -> None:
    """Entries of one block in the columns of the member's twist: -G^T; arguments as `joint_entries`."""
    entry = code[t.BLOCK] + t.BLOCK_ENTRY * block
    first, rows, carried = code[entry], code[entry + 1], code[entry + 3]
    if carried == 0 or code[entry + 4] != t.GEOMETRY:
        for k in range(code[t.TWIST]):
            for r in range(rows):
                store(w, target + k * stride + r, z)
        return
    point, origin = base + code[entry + 2], base + code[t.REFERENCE]
    # -carried times the row, so the arm and the row change sign together.
    x = load(w, point + 9, z) - load(w, origin + 9, z)
    y = load(w, point + 10, z) - load(w, origin + 10, z)
    v = load(w, point + 11, z) - load(w, origin + 11, z)
    # In space and ground axes a row is written where it belongs; otherwise through scratch.
    direct = code[t.TWIST] == 6 and code[t.BODY_AXES] == 0
    scratch = base + code[t.SCRATCH]
    for r in range(rows):
        if direct:
            _row_wrench(w, code, base, first + r, x, y, v, carried, target + r, stride, z)
            continue
        _row_wrench(w, code, base, first + r, x, y, v, carried, scratch, 1, z)
        written = scratch
        if code[t.BODY_AXES] == 1:
            _into_axes(w, origin, scratch, scratch + 6, z)
            written = scratch + 6
        for k in range(code[t.TWIST]):
            component = k
            if code[t.TWIST] == 3 and k == 2:
                component = 5
            store(w, target + k * stride + r, load(w, written + component, z))


@kernel
def _row_wrench(
    w: Slots, code: Code, base: int, row: int, x: Lane, y: Lane, v: Lane, carried: int, target: int,
    stride: int, z: Lane,
) -> None:  # fmt: skip
    """A row on the member's twist, times -carried: push, and arm x push + turn."""
    entry = code[t.ROW] + t.ROW_ENTRY * row
    kind, frame, axis = code[entry], base + code[entry + 1], code[entry + 2]
    a, b, c = _row_part(w, kind, frame, axis, False, z)
    p, q, s = _row_part(w, kind, frame, axis, True, z)
    if carried > 0:
        a, b, c, p, q, s = neg(a), neg(b), neg(c), neg(p), neg(q), neg(s)
    if kind == t.PUSH_GROUND or kind == t.PUSH_FRAME or kind == t.GENERAL:
        p, q, s = p + fnma(v, b, y * c), q + fnma(x, c, v * a), s + fnma(y, a, x * b)
    store(w, target, a)
    store(w, target + stride, b)
    store(w, target + 2 * stride, c)
    store(w, target + 3 * stride, p)
    store(w, target + 4 * stride, q)
    store(w, target + 5 * stride, s)


@kernel
def _row_part(w: Slots, kind: int, frame: int, axis: int, turn: bool, z: Lane) -> tuple[Lane, Lane, Lane]:
    """Push or turn of a row in ground axes."""
    if kind == t.GENERAL:
        if turn:
            frame += 3
        return load(w, frame, z), load(w, frame + 1, z), load(w, frame + 2, z)
    if turn == (kind == t.PUSH_GROUND or kind == t.PUSH_FRAME):
        return z, z, z
    if kind == t.PUSH_FRAME or kind == t.TURN_FRAME:
        return load(w, frame + axis, z), load(w, frame + 3 + axis, z), load(w, frame + 6 + axis, z)
    one = splat(1.0, z)
    if axis == 0:
        return one, z, z
    if axis == 1:
        return z, one, z
    return z, z, one


@kernel
def _into_axes(w: Slots, frame: int, source: int, target: int, z: Lane) -> None:
    """Both halves of a row written in the axes of a frame."""
    for half in range(2):
        at = source + 3 * half
        p, q, s = load(w, at, z), load(w, at + 1, z), load(w, at + 2, z)
        for k in range(3):
            store(w, target + 3 * half + k, _dot(w, frame + k, 3, p, q, s, z))
