"""From rotated motions to efficiencies, bounds and directions, in lanes."""

from __future__ import annotations

from vincula.kernels.lanes import outputs as o
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
    more,
    neg,
    rsqrt,
    select,
    splat,
    sqrt,
    store,
)

CLOSED_SQUARE = 0.98e-16
"""Squared gap, in units of the length, up to which a loop is closed for certain (the rule is 1e-8)."""
OPEN_GAP = 2e-8
"""Gap, in units of the length, from which a loop is open for certain (the rule is 1e-8)."""
ALIKE = 1.0 - 1e-9
"""Components this near the largest one count as equal; the first of them is made positive."""


@kernel
def finish(
    w: Slots, code: Code, constants: Slots, base: int, certain: Lane, settled: Lane, want: int,
    widest: float, z: Lane,
) -> None:  # fmt: skip
    """Results at `OUTPUT`, in the sections of `outputs`: status, residual, angle, and what is wanted.

    Args:
        w: The workspace.
        code: Tables.
        constants: Constants.
        base: See `frames.place_all`.
        certain: 1 where all ranks are certain.
        settled: 1 where all rotations converged.
        want: What is wanted, as in `outputs`.
        widest: Gaps up to this are measured well enough to say that a loop is open.
        z: Zero.
    """
    out, notes = base + code[t.OUTPUT], base + code[t.NOTES]
    square, one = load(w, notes + t.RESIDUAL, z), splat(1.0, z)
    residual, nothing = sqrt(square), z / z
    good = both(less(square, splat(CLOSED_SQUARE, z)), more(certain * settled, z))
    opened = both(more(residual, splat(OPEN_GAP, z)), less(residual, splat(widest, z)))
    status = select(good, z, select(opened, splat(float(o.OPENED), z), splat(float(o.UNKNOWN), z)))
    store(w, out + o.STATUS, status)
    store(w, out + o.RESIDUAL, residual)
    angle = load(w, notes + t.LIMB_INVERSE, z)
    store(w, out + o.ANGLE, angle)
    store(w, out + o.LIMITS, one / z)
    store(w, out + o.LIMITS + 1, z)
    store(w, out + o.LIMITS + 2, nothing)
    first, count = code[t.FREE], code[t.FREEDOM] - code[t.FREE] - code[t.IDLE]
    squares, out = base + code[t.SQUARES], out + o.FIRST
    for p in range(count):
        of_motors = load(w, squares + 2 * (first + p), z)
        of_twist = load(w, squares + 2 * (first + p) + 1, z)
        ratio = of_twist / of_motors
        store(w, out + p, ratio)
        if want & o.BOUNDS:
            store(w, out + count + p, _bound(ratio, of_motors, of_twist, angle, z))
        if want & o.RECIPROCALS:
            store(w, out + 3 * count - 1 - p, one / ratio)
    out += 3 * count
    if want & (o.MOTIONS | o.EFFORTS):
        _all_directions(w, code, constants, base, out, first, count, want, z)
    if want & o.REST:
        _free_and_idle(w, code, base, out + 2 * count * (code[t.MOTORS] + code[t.TWIST]), z)


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
    efforts = out + count * size
    for p in range(count):
        column = base + code[t.MOTIONS] + (first + p) * size
        of_q = rsqrt(load(w, squares + 2 * (first + p), z))
        of_u = rsqrt(load(w, squares + 2 * (first + p) + 1, z))
        task, motor = out + p * d, out + count * d + p * motors
        if want & o.MOTIONS or want & o.SHARED:
            _direction(w, constants, column, motors, d, metric, of_q, of_u, task, motor, z)
        if want & o.EFFORTS:
            q = count - 1 - p
            other_task, other_motor = efforts + q * d, efforts + count * d + q * motors
            if want & o.SHARED:
                for i in range(d):
                    store(w, other_task + i, load(w, task + i, z))
                for i in range(motors):
                    store(w, other_motor + i, z - load(w, motor + i, z))
            else:
                _direction(w, constants, column, motors, d, metric + size, neg(of_q), of_u,
                           other_task, other_motor, z)  # fmt: skip


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
