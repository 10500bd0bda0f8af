"""Couplings and motors over several axes in lanes: gaps and rows, from the table of `closing_scalars`."""

from __future__ import annotations

from vincula.kernels.lanes import closing_tables as c
from vincula.kernels.lanes.frames import constant
from vincula.kernels.lanes.jit import Code, Lane, Slots, kernel
from vincula.kernels.lanes.vector import fma, fnma, load, store


@kernel
def _terms(
    w: Slots, plan: Code, constants: Slots, base: int, at: int, count: int, start: Lane, z: Lane
) -> Lane:
    """start + sum of values times constants."""
    total = start
    for k in range(count):
        value = load(w, base + plan[at + 2 * k], z)
        total = fma(value, constant(constants, w, plan[at + 2 * k + 1], z), total)
    return total


@kernel
def scalar_gaps(w: Slots, plan: Code, constants: Slots, base: int, z: Lane) -> Lane:
    """Gaps and rows of all scalar equations; the sum of the squares of the gaps."""
    at, total = plan[c.SCALAR] + 1, z
    for _ in range(plan[plan[c.SCALAR]]):
        gap, count = base + plan[at], plan[at + 1]
        at += 2
        value = _terms(
            w, plan, constants, base, at, count, constant(constants, w, plan[at + 2 * count], z), z
        )
        at += 2 * count + 1
        if plan[at] >= 0:
            given = load(w, base + plan[c.INPUT] + plan[at], z)
            value = fnma(given, constant(constants, w, plan[at + 1], z), value)
        count = plan[at + 2]
        at += 3
        inner = _terms(
            w, plan, constants, base, at, count, constant(constants, w, plan[at + 2 * count], z), z
        )
        at += 2 * count + 1
        degree, first = plan[at], plan[at + 1]
        curve, slope = z, z
        for k in range(degree - 1, -1, -1):
            slope = fma(slope, inner, curve)
            curve = fma(curve, inner, constant(constants, w, first + k, z))
        value = value - curve
        store(w, gap, value)
        total = fma(value, value, total)
        count = plan[at + 2]
        at += 3
        jacobian = base + plan[at + 3 * count + count * (count + 1) // 2]
        for k in range(count):
            rate = constant(constants, w, plan[at + 3 * k + 1], z)
            rate = fnma(slope, constant(constants, w, plan[at + 3 * k + 2], z), rate)
            store(w, jacobian + k, rate)
        at += 3 * count + count * (count + 1) // 2 + 1
    return total


@kernel
def add_scalar_rows(w: Slots, plan: Code, base: int, z: Lane) -> None:
    """Add J^T J and -J^T gap of the scalar equations to the normal matrix and its right-hand side."""
    at = plan[c.SCALAR] + 1
    normal, step = base + plan[c.NORMAL], base + plan[c.STEP]
    for _ in range(plan[plan[c.SCALAR]]):
        gap = load(w, base + plan[at], z)
        at += 2 + 2 * plan[at + 1] + 1
        at += 3 + 2 * plan[at + 2] + 1
        count = plan[at + 2]
        at += 3
        pairs = at + 3 * count
        jacobian = base + plan[pairs + count * (count + 1) // 2]
        for k in range(count):
            rate = load(w, jacobian + k, z)
            target = step + plan[at + 3 * k]
            store(w, target, fnma(rate, gap, load(w, target, z)))
            for other in range(k, count):
                target = normal + plan[pairs]
                store(w, target, fma(rate, load(w, jacobian + other, z), load(w, target, z)))
                pairs += 1
        at = pairs + 1
