"""The last digits of a design: by gradients where the objective is smooth, else by a simplex."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from vincula.arrays import Vector
from vincula.design.gradients import slope
from vincula.design.judged import INFEASIBLE

if TYPE_CHECKING:
    from vincula.design.asking import Asking

STEPS: Final = (0.01, -0.03)
"""First sizes of a simplex, in parts of the range: on a ridge one may be stuck where another is not."""
MOST_A_VARIABLE: Final = 120
"""Most designs that a simplex may look at, a variable."""
NEAR: Final = 0.05
"""How far around a design other basins are looked for, in parts of the range."""
LOOKS: Final = 24
"""Random designs looked at there, a variable."""
BASINS: Final = 3
"""How many of them a simplex begins at besides."""
NO_SLOPE: Final = 1e-9
"""Gain below which another look by the simplex is of no use."""


def polished(asking: Asking, design: Vector) -> tuple[Vector, str]:
    """A design that is at least as good as the one given, and how it was found.

    Args:
        asking: Judges designs.
        design: A feasible design.
    """
    first = float(asking(design[None, :]).merit()[0])
    smooth = _by_gradients(asking, design)
    if smooth is not None and smooth[1] <= first:
        return smooth[0], "gradient"
    best, value, before = design, first, np.inf
    while before - value > NO_SLOPE * max(1.0, abs(value)):
        before = value
        for step in STEPS:
            best, value = _by_simplex(asking, best, value, step)
        for begin in _beside(asking, best):
            other, worth = _by_simplex(asking, begin, np.inf, STEPS[0])
            if worth < value:
                best, value = other, worth
    return best, "simplex"


def _beside(asking: Asking, design: Vector) -> list[Vector]:
    """The best of random designs around one, apart from it: where other basins may begin."""
    space = asking.problem.space
    span = space.high - space.low
    random = np.random.default_rng(0).uniform(-NEAR, NEAR, (LOOKS * len(span), len(span)))
    random = random[np.abs(random).max(axis=1) > 0.2 * NEAR]
    found = asking(np.clip(design + random * span, space.low, space.high))
    order = np.argsort(found.merit(), kind="stable")[:BASINS]
    return [found.designs[k] for k in order if found.feasible[k]]


def _by_gradients(asking: Asking, design: Vector) -> tuple[Vector, float] | None:
    """L-BFGS-B in the box; None where the objective has no gradient on the way, or an edge is in it."""
    from scipy.optimize import minimize

    space = asking.problem.space
    span = space.high - space.low
    lost = False

    def both(unit: Vector) -> tuple[float, Vector]:
        nonlocal lost
        at = np.clip(space.low + unit * span, space.low, space.high)
        merit = float(asking(at[None, :]).merit()[0])
        # Across the edge of what is allowed the merit jumps, and a step along the edge has no gradient here.
        found = slope(asking.problem, at) if merit < INFEASIBLE else None
        if found is None:
            lost = True
            raise StopIteration
        value, gradient = found
        return merit, gradient * span / np.sqrt(1.0 + value**2)  # the derivative of arcsinh

    try:
        result = minimize(
            both, (design - space.low) / span, jac=True, method="L-BFGS-B",
            bounds=[(0.0, 1.0)] * len(span), options={"ftol": 1e-15, "gtol": 1e-10, "maxfun": 100},
        )  # fmt: skip
    except StopIteration:
        return None
    if lost:
        return None
    return np.clip(space.low + result.x * span, space.low, space.high), float(result.fun)


def _by_simplex(asking: Asking, design: Vector, merit: float, step: float) -> tuple[Vector, float]:
    """Nelder and Mead in the box, restarted by the caller while it gains."""
    from scipy.optimize import minimize

    space = asking.problem.space
    span = space.high - space.low
    unit = (design - space.low) / span
    simplex = np.tile(unit, (len(unit) + 1, 1))
    for k in range(len(unit)):
        simplex[k + 1, k] += step if 0.0 <= unit[k] + step <= 1.0 else -step

    def value(at: Vector) -> float:
        return float(asking(np.clip(space.low + at * span, space.low, space.high)[None, :]).merit()[0])

    result = minimize(
        value, unit, method="Nelder-Mead", bounds=[(0.0, 1.0)] * len(unit),
        options={"initial_simplex": simplex, "xatol": 1e-8, "fatol": 1e-12,
                 "maxfev": MOST_A_VARIABLE * len(unit)},
    )  # fmt: skip
    if float(result.fun) <= merit:
        return np.clip(space.low + result.x * span, space.low, space.high), float(result.fun)
    return design, merit
