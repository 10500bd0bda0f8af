"""Exact derivatives of an objective by the variables, where it is smooth."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from vincula.arrays import Vector
from vincula.design.measures import Index, Measure, SphereDistance

if TYPE_CHECKING:
    from vincula.design.problem import DesignProblem
    from vincula.kernels.gradients import Gradient

TIE_STEP: Final = 1e-5
"""Step of the central differences of ties, in parts of the range of a variable; linear ties are exact."""


def slope(problem: DesignProblem, design: Vector) -> tuple[float, Vector] | None:
    """An objective so that smaller is better, and its derivatives by the variables.

    None where it has none: several equal extreme efficiencies, the worst of several configurations, a measure
    without analytic derivatives, or an objective over configurations that have to be closed again.

    Args:
        problem: A problem with one objective.
        design: One design.
    """
    measure = problem.objectives[0]
    if problem.given != "configuration" or (problem.places > 1 and measure.over != "mean"):
        return None
    found = _measured(problem, measure, design)
    if found is None:
        return None
    value, by_parameter, names = found
    sign = float(problem.signs[0])
    return sign * value, sign * (by_parameter @ _ties(problem, design, names))


def _measured(
    problem: DesignProblem, measure: Measure, design: Vector
) -> tuple[float, Vector, tuple[str, ...]] | None:
    """Value and derivatives by the parameters, mean of the configurations."""
    parameters = {k: float(v[0]) for k, v in problem.space.parameters(design[None, :]).items()}
    names = tuple(parameters)
    places = problem.configurations

    def of(quantity: str) -> Gradient | None:
        compiled = problem.compiled_for(measure.weights)
        found = compiled.gradient(places, quantity, wrt=names, parameters=parameters)
        return found if np.all(found.smooth) and np.isfinite(found.gradient).all() else None

    if isinstance(measure, Index):
        from vincula.kernels.gradients_one_by_one import SMOOTH

        part = measure.quantity.partition(":")[0].partition(".")[2]
        if part not in ("smallest", "largest") and part not in SMOOTH:
            return None
        one = of(measure.quantity)
        if one is None:
            return None
        return float(np.mean(one.values)), _mean(one.gradient), names
    if isinstance(measure, SphereDistance):
        high = of("kinematic.largest")
        low = of("kinematic.smallest") if high is not None else None
        if high is None or low is None:
            return None
        value = float(np.mean((high.values - 1.0) ** 2 + (low.values - 1.0) ** 2))
        rows = 2.0 * (
            (high.values - 1.0)[..., None] * high.gradient + (low.values - 1.0)[..., None] * low.gradient
        )
        return value, _mean(rows), names
    return None


def _mean(gradient: Vector) -> Vector:
    return np.asarray(gradient.reshape(-1, gradient.shape[-1]).mean(axis=0))


def _ties(problem: DesignProblem, design: Vector, names: tuple[str, ...]) -> Vector:
    """Derivatives of the parameters by the variables, parameters x variables."""
    space = problem.space
    steps = TIE_STEP * (space.high - space.low)
    moves = np.diag(steps)
    up, down = space.parameters(design + moves), space.parameters(design - moves)
    return np.array([(up[name] - down[name]) / (2.0 * steps) for name in names])
