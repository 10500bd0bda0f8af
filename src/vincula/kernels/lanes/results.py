"""From rotated motions to efficiencies, bounds and directions, in lanes; then out of the workspace."""

from __future__ import annotations

from vincula.kernels.lanes import tables as t
from vincula.kernels.lanes.frames import constant
from vincula.kernels.lanes.jit import Code, Lane, Slots, kernel
from vincula.kernels.lanes.vector import (
    absolute,
    at_least,
    both,
    fma,
    larger,
    less,
    load,
    neg,
    rsqrt,
    select,
    splat,
    sqrt,
    store,
)

CLOSED_SQUARE = 0.98e-16
"""Squared gap, in units of the length, up to which a loop is closed for certain (the rule is 1e-8)."""
ALIKE = 1.0 - 1e-9
"""Components this near the largest one count as equal; the first of them is made positive."""


@kernel
def finish(
    w: Slots, code: Code, constants: Slots, base: int, certain: Lane, settled: Lane, want: int, z: Lane
) -> None:
    """Results at `OUTPUT`: certain, residual, angle, efficiencies, bounds, and directions that are wanted.

    Args:
        w: The workspace.
        code: Tables.
        constants: Constants.
        base: See `frames.place_all`.
        certain: 1 where all ranks are certain.
        settled: 1 where all rotations converged.
        want: Added up: 1 motion directions, 2 effort directions, 4 free twists and idle rates.
        z: Zero.
    """
    out, notes = base + code[t.OUTPUT], base + code[t.NOTES]
    residual = load(w, notes + t.RESIDUAL, z)
    closed = select(less(residual, splat(CLOSED_SQUARE, z)), certain, z)
    store(w, out, closed * settled)
    store(w, out + 1, sqrt(residual))
    angle = load(w, notes + t.LIMB_INVERSE, z)
    store(w, out + 2, angle)
    first, count = code[t.FREE], code[t.FREEDOM] - code[t.FREE] - code[t.IDLE]
    squares = base + code[t.SQUARES]
    for p in range(count):
        of_motors = load(w, squares + 2 * (first + p), z)
        of_twist = load(w, squares + 2 * (first + p) + 1, z)
        ratio = of_twist / of_motors
        store(w, out + 3 + p, ratio)
        store(w, out + 3 + count + p, _bound(ratio, of_motors, of_twist, angle, z))
    if want & 3:
        _all_directions(w, code, constants, base, out + 3 + 2 * count, first, count, want, z)
    if want & 4:
        pairs = (want & 1) + (want >> 1 & 1)
        size = code[t.MOTORS] + code[t.TWIST]
        _free_and_idle(w, code, base, out + 3 + 2 * count + pairs * count * size, z)


@kernel
def _free_and_idle(w: Slots, code: Code, base: int, out: int, z: Lane) -> None:
    """Twists of the motions that no motor drives, then rates of those that leave the member at rest."""
    motors, d = code[t.MOTORS], code[t.TWIST]
    size, k = motors + d, code[t.FREEDOM]
    for p in range(code[t.FREE]):
        for i in range(d):
            store(w, out + i, load(w, base + code[t.MOTIONS] + p * size + motors + i, z))
        out += d
    for p in range(k - code[t.IDLE], k):
        for i in range(motors):
            store(w, out + i, load(w, base + code[t.MOTIONS] + p * size + i, z))
        out += motors


@kernel
def _bound(ratio: Lane, of_motors: Lane, of_twist: Lane, angle: Lane, z: Lane) -> Lane:
    """Bound on the error of (cos / sin)^2 when the angle is known to within `angle`."""
    half = sqrt(of_motors * of_twist)
    relative = (angle + angle) / half
    return select(less(relative, splat(0.5, z)), ratio * relative * splat(2.0, z), splat(1.0, z) / z)


@kernel
def _all_directions(
    w: Slots, code: Code, constants: Slots, base: int, out: int, first: int, count: int, want: int, z: Lane
) -> None:
    """Motions (twists, rates) largest first, then efforts (wrenches, torques) largest first."""
    motors, d = code[t.MOTORS], code[t.TWIST]
    size = motors + d
    squares, metric = base + code[t.SQUARES], code[t.METRIC] + size
    for p in range(count):
        column = base + code[t.MOTIONS] + (first + p) * size
        of_q = rsqrt(load(w, squares + 2 * (first + p), z))
        of_u = rsqrt(load(w, squares + 2 * (first + p) + 1, z))
        place = out
        if want & 1:
            _direction(w, constants, column, motors, d, metric, of_q, of_u, place + p * d,
                       place + count * d + p * motors, z)  # fmt: skip
            place += count * size
        if want & 2:
            q = count - 1 - p
            _direction(w, constants, column, motors, d, metric + size, neg(of_q), of_u, place + q * d,
                       place + count * d + q * motors, z)  # fmt: skip


@kernel
def _direction(
    w: Slots, constants: Slots, column: int, motors: int, d: int, metric: int, of_q: Lane, of_u: Lane,
    task: int, motor: int, z: Lane,
) -> None:  # fmt: skip
    """Physical directions of one pair, the largest component on the task side positive."""
    largest = z
    for i in range(d):
        x = load(w, column + motors + i, z) * of_u * constant(constants, w, metric + motors + i, z)
        store(w, task + i, x)
        largest = larger(absolute(x), largest)
    sign = _sign(w, task, d, largest * splat(ALIKE, z), z)
    for i in range(d):
        store(w, task + i, fma(load(w, task + i, z), sign, z))  # the sum makes -0.0 positive
    for i in range(motors):
        x = load(w, column + i, z) * of_q * constant(constants, w, metric + i, z)
        store(w, motor + i, fma(x, sign, z))


@kernel
def _sign(w: Slots, slot: int, count: int, enough: Lane, z: Lane) -> Lane:
    """Sign of the first component that is large enough."""
    one = splat(1.0, z)
    sign, open_ = one, one
    for i in range(count):
        x = load(w, slot + i, z)
        here = both(at_least(absolute(x), enough), less(z, open_))
        sign = select(here, select(less(x, z), neg(one), one), sign)
        open_ = select(here, z, open_)
    return sign


@kernel
def write(w: Slots, slot: int, count: int, out: Slots, first: int, width: int) -> None:
    """Copy `count` slots to rows of `out`, one a lane, from row `first` on; what exceeds is left out."""
    for lane in range(min(width, out.shape[0] - first)):
        for k in range(count):
            out[first + lane, k] = w[(slot + k) * width + lane]
