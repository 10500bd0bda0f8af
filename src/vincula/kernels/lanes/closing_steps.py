"""One Gauss-Newton step of closing in lanes: rows, normal matrix, its sparse factor, the step.

The normal matrix squares the condition number; a step is only a correction, so what that costs is a
little speed of convergence, never accuracy.  A damping far below anything regular keeps free motions and
superfluous rows from dividing by zero.
"""

from __future__ import annotations

from vincula.kernels.lanes import closing_tables as c
from vincula.kernels.lanes.closing_scalar_gaps import add_scalar_rows
from vincula.kernels.lanes.frames import constant
from vincula.kernels.lanes.jit import Code, Lane, Slots, kernel
from vincula.kernels.lanes.vector import absolute, fma, fnma, larger, load, neg, splat, store


@kernel
def solve_step(w: Slots, plan: Code, constants: Slots, base: int, damping: Lane, z: Lane) -> Lane:
    """Write the step of every unknown, in the order of elimination; the largest of them in absolute value.

    Args:
        w: The workspace, gaps written.
        plan: Tables of closing.
        constants: Constants.
        base: See `frames.place_all`.
        damping: Added to the diagonal of the normal matrix.
        z: Zero.
    """
    normal, step = base + plan[c.NORMAL], base + plan[c.STEP]
    for k in range(plan[c.ENTRIES]):
        store(w, normal + k, z)
    for k in range(plan[c.UNKNOWNS]):
        store(w, step + k, z)
    for block in range(plan[c.BLOCKS]):
        entry = plan[c.BLOCK] + c.BLOCK_ENTRY * block
        _part_rows(w, plan, constants, base, entry, z)
        _add_part(w, plan, base, entry, z)
    add_scalar_rows(w, plan, base, z)
    _eliminate(w, plan, base, damping, z)
    return _substitute(w, plan, base, z)


@kernel
def _part_rows(w: Slots, plan: Code, constants: Slots, base: int, entry: int, z: Lane) -> None:
    """Rows of one part on all its unknowns, column after column."""
    point, rows = base + plan[entry + 1] + 9, plan[entry + 7]
    columns, target = plan[entry + 9], base + plan[entry + 11]
    px, py, pz = load(w, point, z), load(w, point + 1, z), load(w, point + 2, z)
    for k in range(plan[entry + 10]):
        column = plan[c.COLUMN] + c.COLUMN_ENTRY * plan[columns + 2 * k]
        frame, axis, centre = base + plan[column], plan[column + 1], base + plan[column + 2]
        stride = 3
        if axis < 0:
            axis, stride = 0, 1
        a, b, d = (load(w, frame + axis, z), load(w, frame + axis + stride, z),
                   load(w, frame + axis + 2 * stride, z))  # fmt: skip
        if plan[columns + 2 * k + 1] < 0:
            a, b, d = neg(a), neg(b), neg(d)
        if plan[column + 3] == 0:
            _entries(w, plan, base, entry, target, a, b, d, z, z, z, z)
        else:
            x, y, v = px - load(w, centre + 9, z), py - load(w, centre + 10, z), pz - load(w, centre + 11, z)
            p, q, s = fnma(d, y, b * v), fnma(a, v, d * x), fnma(b, x, a * y)
            if plan[column + 4] >= 0:
                rise = constant(constants, w, plan[column + 4], z)
                p, q, s = fma(rise, a, p), fma(rise, b, q), fma(rise, d, s)
            _entries(w, plan, base, entry, target, p, q, s, a, b, d, z)
        target += rows


@kernel
def _entries(
    w: Slots, plan: Code, base: int, entry: int, target: int,
    p: Lane, q: Lane, s: Lane, a: Lane, b: Lane, d: Lane, z: Lane,
) -> None:  # fmt: skip
    """One column: rates of all gaps for the velocity (p, q, s) of B's origin and the turning (a, b, d)."""
    one, offset, turns = base + plan[entry], plan[entry + 2], plan[entry + 3]
    if offset & c.ALL:
        target = _picked(w, offset, target, p, q, s, z)
    else:
        for k in range(3):
            if offset & (1 << k):
                rest = fma(load(w, one + 3 + k, z), q, load(w, one + 6 + k, z) * s)
                store(w, target, fma(load(w, one + k, z), p, rest))
                target += 1
    if turns == c.WHOLE:
        _picked(w, plan[entry + 4], target, a, b, d, z)
    elif turns != c.FREE:
        at, last = base + plan[entry + 8], base + plan[entry + 8] + 3 * _turn_count(plan, entry)
        while at < last:
            rest = fma(load(w, at + 1, z), b, load(w, at + 2, z) * d)
            store(w, target, fma(load(w, at, z), a, rest))
            target += 1
            at += 3


@kernel
def _picked(w: Slots, mask: int, target: int, x: Lane, y: Lane, v: Lane, z: Lane) -> int:
    """Write the components of a vector that a mask names; the slot after them."""
    if mask & 1:
        store(w, target, x)
        target += 1
    if mask & 2:
        store(w, target, y)
        target += 1
    if mask & 4:
        store(w, target, v)
        target += 1
    return target


@kernel
def _turn_count(plan: Code, entry: int) -> int:
    """Number of gaps of orientation."""
    offset = plan[entry + 2]
    count: int = plan[entry + 7] - ((offset & 1) + ((offset >> 1) & 1) + ((offset >> 2) & 1))
    return count


@kernel
def _add_part(w: Slots, plan: Code, base: int, entry: int, z: Lane) -> None:
    """Add J^T J and -J^T gap of one part."""
    rows, count, columns = plan[entry + 7], plan[entry + 10], plan[entry + 9]
    jacobian, gap = base + plan[entry + 11], base + plan[entry + 6]
    pairs = columns + 2 * count
    normal, step = base + plan[c.NORMAL], base + plan[c.STEP]
    for k in range(count):
        one = jacobian + rows * k
        target = step + plan[columns + 2 * k]
        total = load(w, target, z)
        for r in range(rows):
            total = fnma(load(w, one + r, z), load(w, gap + r, z), total)
        store(w, target, total)
        for other in range(k, count):
            two = jacobian + rows * other
            target = normal + plan[pairs]
            total = load(w, target, z)
            for r in range(rows):
                total = fma(load(w, one + r, z), load(w, two + r, z), total)
            store(w, target, total)
            pairs += 1


@kernel
def _eliminate(w: Slots, plan: Code, base: int, damping: Lane, z: Lane) -> None:
    """L D L^T of the damped normal matrix, right-hand side carried along; 1 / D on the diagonal."""
    normal, step = base + plan[c.NORMAL], base + plan[c.STEP]
    one, at = splat(1.0, z), plan[c.FACTOR]
    for k in range(plan[c.UNKNOWNS]):
        diagonal, count = normal + plan[at], plan[at + 1]
        inverse = one / larger(load(w, diagonal, z) + damping, damping)
        store(w, diagonal, inverse)
        value = load(w, step + k, z)
        pairs = at + 2 + count
        for i in range(count):
            entry = diagonal + 1 + i
            factor = load(w, entry, z) * inverse
            for j in range(i, count):
                target = normal + plan[pairs]
                store(w, target, fnma(factor, load(w, diagonal + 1 + j, z), load(w, target, z)))
                pairs += 1
            target = step + plan[at + 2 + i]
            store(w, target, fnma(factor, value, load(w, target, z)))
        for i in range(count):
            store(w, diagonal + 1 + i, load(w, diagonal + 1 + i, z) * inverse)
        at = pairs


@kernel
def _substitute(w: Slots, plan: Code, base: int, z: Lane) -> Lane:
    """Back substitution; the largest step in absolute value."""
    normal, step, at = base + plan[c.NORMAL], base + plan[c.STEP], plan[c.FACTOR]
    starts = plan[c.FACTOR] - plan[c.UNKNOWNS]
    most = z
    for k in range(plan[c.UNKNOWNS] - 1, -1, -1):
        at = plan[starts + k]
        diagonal, count = normal + plan[at], plan[at + 1]
        value = load(w, step + k, z) * load(w, diagonal, z)
        for i in range(count):
            value = fnma(load(w, diagonal + 1 + i, z), load(w, step + plan[at + 2 + i], z), value)
        store(w, step + k, value)
        most = larger(absolute(value), most)
    return most
