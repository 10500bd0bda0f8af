"""Damped Gauss-Newton on the closure equations, polished to rounding.

Far from closure Levenberg's damping, proportional to the squared residual, keeps steps short; near it
the damping vanishes and steps are minimum-norm Gauss-Newton steps through a pseudo-inverse whose rank
the one rank rule decides.  So free directions, redundant rows of planar loops written in space and
singular configurations need no special case (Fan and Yuan 2005: quadratic convergence under a local
error bound, without a regular Jacobian).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.linalg.lapack import dposv

from vincula.arrays import Matrix, Vector
from vincula.mechanism.closure_problem import ClosureProblem, Equations
from vincula.mechanism.closure_values import Mask
from vincula.numerics.lapack import svd
from vincula.numerics.rank import decide_rank

LONGEST_STEP: Final = 0.7
"""No unknown moves by more in one step [rad, or lengths L]: the solution found stays near the start."""
STRONG: Final = 1e-7
"""Weaker damping is applied through singular values: normal equations would lose the free directions."""
FLOOR: Final = 1e-15
"""A scaled residual below this is rounding: nothing is left to improve."""
SLACK: Final = 1e-12
"""A value this near to a limit stands on it [m, rad]."""
PATIENCE: Final = 8
"""Steps in a row that gain less than a thousandth, after which a start is given up."""


@dataclass(frozen=True, slots=True, eq=False)
class Limits:
    """Bounds of the unknowns in the order of the rates [m, rad]; infinite where there are none."""

    lower: Vector
    upper: Vector


@dataclass(frozen=True, slots=True, eq=False)
class Solution:
    """Where the iteration ended.

    Attributes:
        state: Values of the unknowns.
        equations: Gaps and Jacobian there.
        residual: Norm of the scaled gaps.
        iterations: Number of Jacobians that were evaluated.
        held_by_limit: For every rate, whether its value ended on a limit.
    """

    state: Vector
    equations: Equations
    residual: float
    iterations: int
    held_by_limit: Mask


def solve(
    problem: ClosureProblem,
    state: Vector,
    free: Mask,
    limits: Limits | None = None,
    iterations: int = 100,
) -> Solution:
    """The state near `state` that satisfies the closure equations, or the nearest to doing so.

    Args:
        problem: The equations.
        state: Where to start.
        free: For every rate, whether it may move.
        limits: Bounds that the unknowns respect; None for none.
        iterations: Most steps.
    """
    if limits is not None:
        state = _clipped(problem, state, free, limits)
    here = problem.equations(state)
    size = float(np.linalg.norm(here.gaps))
    damping, idle, count = 1e-2, 0, 1
    while size > FLOOR and count < iterations and idle < PATIENCE:
        usable = free
        if limits is not None:
            usable = free & ~_pushing(problem, state, here, limits)
        step = np.zeros(problem.columns)
        step[usable] = _step(here.jacobian[:, usable], here.gaps, damping * size * size)
        longest = float(np.abs(step).max(initial=0.0))
        if longest > LONGEST_STEP:
            step *= LONGEST_STEP / longest
        if longest == 0.0:
            break
        there = problem.variables.moved(state, step)
        if limits is not None:
            there = _clipped(problem, there, usable, limits)
        trial = problem.equations(there)
        count += 1
        reached = float(np.linalg.norm(trial.gaps))
        if reached < size:
            expected = float(np.linalg.norm(here.gaps + here.jacobian @ step))
            gain = (size**2 - reached**2) / max(size**2 - expected**2, 1e-300)
            damping = max(damping * (0.2 if gain > 0.7 else 1.0 if gain > 0.25 else 4.0), 1e-8)
            idle = idle + 1 if reached > 0.999 * size else 0
            state, here, size = there, trial, reached
        elif size < 1e-12:
            break
        else:
            damping *= 10.0
            idle += 1 if damping * size * size > 1e4 else 0
    stopped = np.zeros(problem.columns, dtype=bool) if limits is None else free & _on(problem, state, limits)
    return Solution(state, here, size, count, stopped)


def _step(jacobian: Matrix, gaps: Vector, damping: float) -> Vector:
    """Levenberg's step for one damping; with vanishing damping the minimum-norm Gauss-Newton step."""
    if jacobian.shape[1] == 0:
        return np.zeros(0)
    if damping > STRONG:
        normal = jacobian.T @ jacobian
        normal[np.diag_indices_from(normal)] += damping
        _, found, info = dposv(normal, -(jacobian.T @ gaps))
        if info == 0:
            return np.asarray(found)
    return minimum_norm(jacobian, -gaps, damping)


def minimum_norm(jacobian: Matrix, target: Vector, damping: float = 0.0) -> Vector:
    """The shortest x with jacobian @ x nearest to target; rank by the one rank rule."""
    left, values, right = svd(jacobian)
    rank = decide_rank(jacobian, name="closure equations", values=values).rank
    kept = values[:rank]
    weights = kept / (kept * kept + damping)
    return np.asarray(right[:, :rank] @ (weights * (left[:, :rank].T @ target)))


def _clipped(problem: ClosureProblem, state: Vector, free: Mask, limits: Limits) -> Vector:
    """The state with free values brought back inside their limits."""
    values = problem.variables.scalar_values(state)
    bounded = np.where(free, np.clip(values, limits.lower, limits.upper), values)
    if np.array_equal(bounded, values):
        return state
    return problem.variables.moved(state, (bounded - values) / problem.variables.column_scale)


def _on(problem: ClosureProblem, state: Vector, limits: Limits) -> Mask:
    """Rates whose values stand on a limit."""
    values = problem.variables.scalar_values(state)
    return np.asarray((values <= limits.lower + SLACK) | (values >= limits.upper - SLACK))


def _pushing(problem: ClosureProblem, state: Vector, here: Equations, limits: Limits) -> Mask:
    """Rates whose values stand on a limit that the descent would cross."""
    values = problem.variables.scalar_values(state)
    descent = -(here.jacobian.T @ here.gaps)
    below = (values <= limits.lower + SLACK) & (descent < 0.0)
    above = (values >= limits.upper - SLACK) & (descent > 0.0)
    return np.asarray(below | above)
