"""Gauss-Newton in lanes: closed from where the values are, or given up in that lane.

A lane is given up when steps do not shrink as near a solution they must (by half, Newton and Kantorovich):
what it would find need not be on the branch it started on.  Whoever asked then takes shorter ways.
"""

from __future__ import annotations

from typing import Final

from vincula.kernels.lanes import closing_tables as c
from vincula.kernels.lanes.closing_gaps import gaps_at
from vincula.kernels.lanes.closing_steps import solve_step
from vincula.kernels.lanes.jit import Code, Lane, Slots, kernel
from vincula.kernels.lanes.vector import (
    at_most,
    both,
    either,
    fma,
    fnma,
    less,
    load,
    more,
    rsqrt,
    select,
    some_lane,
    splat,
    store,
)

MOST_STEPS: Final = 12
"""Steps after which a lane is given up."""
MOST_SEARCHED: Final = 60
"""The same where any branch will do."""
LONGEST_STEP: Final = 0.7
"""No unknown may move by more in one step [rad, or lengths L]."""
SHRINKS: Final = 0.5
"""Every step is at most this share of the one before."""
NEAR: Final = 1e-6
"""Steps as short as this are not compared: rounding has a say in them."""
ROUNDING: Final = 2e-15
"""A gap of this size, times the root of their number, is rounding."""
POLISHED: Final = 1e-9
"""After a step as short as this nothing is left to improve, ..."""
CLOSED: Final = 1e-12
"""... if gaps are below this; otherwise the lane is given up."""
LEAST_DAMPING: Final = 1e-12
"""Added to the normal matrix always: far below the square of any regular singular value."""
DAMPING: Final = 1e-2
"""Damping for a squared gap of one, as in `mechanism.closure_solver`."""


@kernel
def close_lanes(
    w: Slots, code: Code, plan: Code, constants: Slots, base: int, wanted: Lane, strict: bool, z: Lane
) -> tuple[Lane, Lane, Lane]:
    """Close from the values in the workspace.

    Args:
        w: The workspace: values to start from, and what is given.
        code: Values and frames.
        plan: Tables of closing.
        constants: Constants.
        base: See `frames.place_all`.
        wanted: 1 in lanes that are to move, 0 in the others.
        strict: Whether lanes are given up whose steps do not shrink; otherwise steps are cut short, the
            damping grows where gaps do not shrink, and what is found may be on another branch.
        z: Zero.

    Returns:
        1 in lanes that were closed, the number of steps, the sum of the squares of the gaps.
    """
    half, one, longest = splat(0.5, z), splat(1.0, z), splat(LONGEST_STEP, z)
    rounding = splat(ROUNDING * ROUNDING * plan[c.EQUATIONS], z)
    live, closed, steps, before, damping = wanted, z, z, splat(1e300, z), splat(DAMPING, z)
    gap = before
    for step in range(MOST_STEPS if strict else MOST_SEARCHED):
        last = gap
        gap = gaps_at(w, code, plan, constants, base, z)
        done = either(
            at_most(gap, rounding),
            both(at_most(before, splat(POLISHED, z)), at_most(gap, splat(CLOSED * CLOSED, z))),
        )
        closed = select(done, closed + live, closed)
        live = select(done, z, live)
        if not some_lane(more(live, half)):
            break
        if step > 0 and not strict:
            shrunk = select(less(gap, splat(0.25, z) * last), splat(0.2, z), one)
            damping = damping * select(less(gap, last), shrunk, splat(4.0, z))
        size = solve_step(w, plan, constants, base, fma(damping, gap, splat(LEAST_DAMPING, z)), z)
        short = at_most(size, longest)
        if strict:
            shrinks = either(at_most(size, splat(SHRINKS, z) * before), at_most(size, splat(NEAR, z)))
            live = select(both(short, shrinks), live, z)
        else:
            _shorten(w, plan, base, select(short, one, longest / size), z)
        steps = steps + live
        before = size
        apply_step(w, plan, base, live, z)
    sided = more(load(w, base + plan[c.SIDE], z), z)
    return select(sided, closed, z), steps, gap


@kernel
def _shorten(w: Slots, plan: Code, base: int, share: Lane, z: Lane) -> None:
    """Take a share of the step."""
    step = base + plan[c.STEP]
    for k in range(plan[c.UNKNOWNS]):
        store(w, step + k, load(w, step + k, z) * share)


@kernel
def apply_step(w: Slots, plan: Code, base: int, live: Lane, z: Lane) -> None:
    """Move the values by the step, in lanes that are live."""
    moving = more(live, splat(0.5, z))
    step, at = base + plan[c.STEP], plan[c.UPDATE] + 1
    for _ in range(plan[plan[c.UPDATE]]):
        value = base + plan[at + 1]
        if plan[at] == c.NUMBER:
            old = load(w, value, z)
            store(w, value, select(moving, old + load(w, step + plan[at + 2], z), old))
        else:
            _turn_ball(w, value, step + plan[at + 2], step + plan[at + 3], step + plan[at + 4], moving, z)
        at += 5


@kernel
def _turn_ball(w: Slots, value: int, one: int, two: int, three: int, moving: Lane, z: Lane) -> None:
    """A quaternion after a small turn about the axes of the second body."""
    half = splat(0.5, z)
    x, y, v = load(w, one, z) * half, load(w, two, z) * half, load(w, three, z) * half
    a, b, d, e = load(w, value, z), load(w, value + 1, z), load(w, value + 2, z), load(w, value + 3, z)
    p = fnma(b, x, fnma(d, y, fnma(e, v, a)))
    q = fma(a, x, fma(d, v, fnma(e, y, b)))
    r = fma(a, y, fma(e, x, fnma(b, v, d)))
    s = fma(a, v, fma(b, y, fnma(d, x, e)))
    scale = rsqrt(fma(p, p, fma(q, q, fma(r, r, s * s))))
    store(w, value, select(moving, p * scale, a))
    store(w, value + 1, select(moving, q * scale, b))
    store(w, value + 2, select(moving, r * scale, d))
    store(w, value + 3, select(moving, s * scale, e))
