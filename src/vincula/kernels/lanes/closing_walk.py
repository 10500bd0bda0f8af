"""From one closed configuration to the next in lanes, on the same branch.

Each lane holds a closed configuration and what is given there, and is carried to what is asked for: at once
where that is near, else in shorter ways, which get shorter still where closing is given up and longer again
where it is not.  Values are foretold along the last way where the new one goes on in its direction.
"""

from __future__ import annotations

from typing import Final

from vincula.kernels.lanes import closing_tables as c
from vincula.kernels.lanes import tables as t
from vincula.kernels.lanes.closing_gaps import columns_product
from vincula.kernels.lanes.closing_newton import close_lanes
from vincula.kernels.lanes.jit import Code, Lane, Slots, kernel
from vincula.kernels.lanes.vector import (
    absolute,
    at_least,
    at_most,
    both,
    fma,
    fnma,
    larger,
    less,
    load,
    more,
    rsqrt,
    select,
    some_lane,
    splat,
    store,
)

LONGEST_WAY: Final = 0.35
"""What is given moves by no more at once [rad, or lengths L]."""
LARGEST_CHANGE: Final = 0.5
"""No value changes by more over one way [rad, lengths L]: else it may leap a hole that no way leads through,
such as the one about the foot of a leg whose two bars differ little."""
SHORTEST_WAY: Final = 1e-4
"""A lane that does not close over a way as short as this does not arrive."""
MOST_WAYS: Final = 400
"""Ways tried before a lane is left open."""
STRAIGHT: Final = 0.04
"""A way goes on in the direction of the last where what is left of it, squared, is below this share."""


@kernel
def walk(
    w: Slots, code: Code, plan: Code, constants: Slots, base: int, target: int, wanted: Lane, z: Lane
) -> tuple[Lane, Lane, Lane]:
    """Carry every lane to what is asked for; a lane that does not arrive stays where it was.

    Args:
        w: The workspace, with what `STATE` names.
        code: Values and frames.
        plan: Tables of closing.
        constants: Constants.
        base: See `frames.place_all`.
        target: Slot of what is asked for.
        wanted: 1 in lanes that are to move.
        z: Zero.

    Returns:
        1 in lanes that arrived, 2 in lanes that close there after a jump; the number of steps; the sum of
        the squares of the gaps.
    """
    half, one = splat(0.5, z), splat(1.0, z)
    live, arrived, steps, hope, gap = wanted, z, z, one, z
    reach = splat(LONGEST_WAY, z)
    _remember(w, plan, base, more(wanted, half), z)
    for _ in range(MOST_WAYS):
        if not some_lane(more(live, half)):
            break
        left = _distance(w, plan, base, target, z)
        whole = at_most(left, reach)
        share = select(whole, one, reach / left)
        _set_out(w, code, plan, base, target, share, whole, live, hope, z)
        closed, count, gap = close_lanes(w, code, plan, constants, base, live, True, z)
        steps = steps + count
        good = both(more(closed, half), at_most(_change(w, code, plan, base, z), splat(LARGEST_CHANGE, z)))
        _keep(w, code, plan, base, good, z)
        there = both(good, whole)
        arrived = select(there, one, arrived)
        # Longer ways after success, shorter after none, there without foretelling.
        way = select(whole, left, reach)
        longer = reach + reach
        longer = select(more(longer, splat(LONGEST_WAY, z)), splat(LONGEST_WAY, z), longer)
        shorter = select(more(hope, half), way, way * splat(0.25, z))
        hope = select(good, one, select(more(live, half), z, hope))
        reach = select(good, longer, shorter)
        live = select(there, z, select(at_least(reach, splat(SHORTEST_WAY, z)), live, z))
    lost = select(more(arrived, half), z, wanted)
    if some_lane(more(lost, half)):
        found, count, jumped = _jump(w, code, plan, constants, base, target, lost, z)
        gap = select(more(lost, half), jumped, gap)
        arrived, steps = arrived + found + found, steps + count
    return arrived, steps, gap


@kernel
def _jump(
    w: Slots, code: Code, plan: Code, constants: Slots, base: int, target: int, lost: Lane, z: Lane
) -> tuple[Lane, Lane, Lane]:
    """Close lanes that did not arrive from where they set out, wherever that leads."""
    half = splat(0.5, z)
    going = more(lost, half)
    _go_back(w, plan, base, going, z)
    _set_out(w, code, plan, base, target, splat(1.0, z), at_least(lost, z), lost, z, z)
    found, count, gap = close_lanes(w, code, plan, constants, base, lost, False, z)
    _keep(w, code, plan, base, more(found, half), z)
    _stop(w, plan, base, going, z)
    return found, count, gap


@kernel
def _remember(w: Slots, plan: Code, base: int, setting: Lane, z: Lane) -> None:
    """Keep where lanes set out."""
    count, inputs, saved = plan[c.STATE_VALUES], plan[c.INPUTS], base + plan[c.STATE]
    here, anchor = _given_here(plan, base), base + plan[c.ANCHOR]
    for k in range(count):
        store(w, anchor + k, select(setting, load(w, saved + k, z), load(w, anchor + k, z)))
    for k in range(inputs):
        store(w, anchor + count + k, select(setting, load(w, here + k, z), load(w, anchor + count + k, z)))


@kernel
def _go_back(w: Slots, plan: Code, base: int, going: Lane, z: Lane) -> None:
    """Stand again where lanes set out."""
    count, inputs, saved = plan[c.STATE_VALUES], plan[c.INPUTS], base + plan[c.STATE]
    here, anchor = _given_here(plan, base), base + plan[c.ANCHOR]
    for k in range(count):
        store(w, saved + k, select(going, load(w, anchor + k, z), load(w, saved + k, z)))
    for k in range(inputs):
        store(w, here + k, select(going, load(w, anchor + count + k, z), load(w, here + k, z)))


@kernel
def _stop(w: Slots, plan: Code, base: int, going: Lane, z: Lane) -> None:
    """Forget the last way: nothing is foretold from it."""
    count, inputs, saved = plan[c.STATE_VALUES], plan[c.INPUTS], base + plan[c.STATE]
    here = _given_here(plan, base)
    for k in range(count):
        store(w, saved + count + k, select(going, z, load(w, saved + count + k, z)))
    for k in range(inputs):
        store(w, here + inputs + k, select(going, z, load(w, here + inputs + k, z)))


@kernel
def _distance(w: Slots, plan: Code, base: int, target: int, z: Lane) -> Lane:
    """Largest change of what is given, from where the lane stands to what is asked for."""
    here, most = _given_here(plan, base), z
    for k in range(plan[c.INPUTS]):
        change = absolute(load(w, target + k, z) - load(w, here + k, z))
        # Not a number where either is none: nothing is near it then.
        most = select(at_most(change, most), most, change)
    return most


@kernel
def _change(w: Slots, code: Code, plan: Code, base: int, z: Lane) -> Lane:
    """Largest change of a value since the lane last stood."""
    saved, values, most = base + plan[c.STATE], base + code[t.VALUE_SLOT], z
    for k in range(plan[c.STATE_VALUES]):
        most = larger(absolute(load(w, values + k, z) - load(w, saved + k, z)), most)
    return most


@kernel
def _given_here(plan: Code, base: int) -> int:
    """Slot of what was given where the lane stands."""
    slot: int = base + plan[c.STATE] + 2 * plan[c.STATE_VALUES]
    return slot


@kernel
def _set_out(
    w: Slots, code: Code, plan: Code, base: int, target: int,
    share: Lane, whole: Lane, live: Lane, hope: Lane, z: Lane,
) -> None:  # fmt: skip
    """What is given, and values to start from, a share of the way ahead; only in live lanes."""
    count, values, inputs = plan[c.STATE_VALUES], base + code[t.VALUE_SLOT], plan[c.INPUTS]
    moving, given = more(live, splat(0.5, z)), base + plan[c.INPUT]
    saved = base + plan[c.STATE]
    here = _given_here(plan, base)
    along, length, size = z, z, z
    for k in range(inputs):
        there = load(w, target + k, z)
        way = (there - load(w, here + k, z)) * share
        last = load(w, here + inputs + k, z)
        along, length, size = fma(way, last, along), fma(last, last, length), fma(way, way, size)
        ahead = select(whole, there, load(w, here + k, z) + way)
        store(w, given + k, select(moving, ahead, load(w, given + k, z)))
    factor = along / length
    # What is left of the way after the last one's direction is taken off: size - along^2 / length.
    straight = at_most(fnma(factor, along, size), splat(STRAIGHT, z) * size)
    usable = both(both(straight, more(hope, splat(0.5, z))), at_most(absolute(factor), splat(2.0, z)))
    factor = select(usable, factor, z)
    for k in range(count):
        start = fma(factor, load(w, saved + count + k, z), load(w, saved + k, z))
        store(w, values + k, select(moving, start, load(w, values + k, z)))
    at = plan[c.QUATERNIONS]
    for k in range(plan[at]):
        _normalise(w, base + plan[at + 1 + k], moving, z)
    at = plan[c.HELD]
    for k in range(plan[at]):
        store(w, base + plan[at + 1 + 2 * k], load(w, given + plan[at + 2 + 2 * k], z))


@kernel
def _normalise(w: Slots, slot: int, moving: Lane, z: Lane) -> None:
    """A quaternion of length one."""
    a, b, d, e = load(w, slot, z), load(w, slot + 1, z), load(w, slot + 2, z), load(w, slot + 3, z)
    scale = select(moving, rsqrt(fma(a, a, fma(b, b, fma(d, d, e * e)))), splat(1.0, z))
    store(w, slot, a * scale)
    store(w, slot + 1, b * scale)
    store(w, slot + 2, d * scale)
    store(w, slot + 3, e * scale)


@kernel
def _keep(w: Slots, code: Code, plan: Code, base: int, good: Lane, z: Lane) -> None:
    """Stand where closing succeeded, and remember the way there; elsewhere go back."""
    count, values, inputs = plan[c.STATE_VALUES], base + code[t.VALUE_SLOT], plan[c.INPUTS]
    _measure(w, plan, base, good, z)
    saved, here, given = base + plan[c.STATE], _given_here(plan, base), base + plan[c.INPUT]
    for k in range(count):
        new, old = load(w, values + k, z), load(w, saved + k, z)
        store(w, saved + count + k, select(good, new - old, load(w, saved + count + k, z)))
        store(w, saved + k, select(good, new, old))
    for k in range(inputs):
        new, old = load(w, given + k, z), load(w, here + k, z)
        store(w, here + inputs + k, select(good, new - old, load(w, here + inputs + k, z)))
        store(w, here + k, select(good, new, old))


@kernel
def _measure(w: Slots, plan: Code, base: int, good: Lane, z: Lane) -> None:
    """Values of joints that are not solved for, from where their frames are."""
    at = plan[c.MEASURED] + 1
    for _ in range(plan[plan[c.MEASURED]]):
        value, one, two = base + plan[at + 1], base + plan[at + 2], base + plan[at + 3]
        if plan[at] == c.PLACE:
            x = load(w, two + 9, z) - load(w, one + 9, z)
            y = load(w, two + 10, z) - load(w, one + 10, z)
            v = load(w, two + 11, z) - load(w, one + 11, z)
            for k in range(3):
                offset = fma(
                    load(w, one + k, z), x, fma(load(w, one + 3 + k, z), y, load(w, one + 6 + k, z) * v)
                )
                store(w, value + k, select(good, offset, load(w, value + k, z)))
            value += 3
        _read_turn(w, one, two, value, good, z)
        at += 4


@kernel
def _read_turn(w: Slots, one: int, two: int, value: int, good: Lane, z: Lane) -> None:
    """Quaternion of the turn from A to B, with the sign nearest to the one before.

    Of the four ways to write it the one with the largest component loses no digits.
    """
    r00, r11, r22 = (
        columns_product(w, one, two, z),
        columns_product(w, one + 1, two + 1, z),
        columns_product(w, one + 2, two + 2, z),
    )
    r01, r10 = columns_product(w, one, two + 1, z), columns_product(w, one + 1, two, z)
    r02, r20 = columns_product(w, one, two + 2, z), columns_product(w, one + 2, two, z)
    r12, r21 = columns_product(w, one + 1, two + 2, z), columns_product(w, one + 2, two + 1, z)
    unit = splat(1.0, z)
    trace = r00 + r11 + r22
    a, b, d, e = unit + trace, r21 - r12, r02 - r20, r10 - r01
    best = trace
    better = more(r00, best)
    a, b, d, e = (select(better, r21 - r12, a), select(better, unit + r00 - r11 - r22, b),
                  select(better, r10 + r01, d), select(better, r02 + r20, e))  # fmt: skip
    best = larger(r00, best)
    better = more(r11, best)
    a, b, d, e = (select(better, r02 - r20, a), select(better, r10 + r01, b),
                  select(better, unit + r11 - r00 - r22, d), select(better, r21 + r12, e))  # fmt: skip
    best = larger(r11, best)
    better = more(r22, best)
    a, b, d, e = (select(better, r10 - r01, a), select(better, r02 + r20, b),
                  select(better, r21 + r12, d), select(better, unit + r22 - r00 - r11, e))  # fmt: skip
    scale = rsqrt(fma(a, a, fma(b, b, fma(d, d, e * e))))
    p, q, r, s = load(w, value, z), load(w, value + 1, z), load(w, value + 2, z), load(w, value + 3, z)
    same = fma(a, p, fma(b, q, fma(d, r, e * s)))
    scale = select(less(same, z), z - scale, scale)
    store(w, value, select(good, a * scale, p))
    store(w, value + 1, select(good, b * scale, q))
    store(w, value + 2, select(good, d * scale, r))
    store(w, value + 3, select(good, e * scale, s))
