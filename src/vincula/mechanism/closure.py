"""Closing loops: from a start, from motor positions, or from a pose of the reference member."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Final

import numpy as np

from vincula.arrays import Vector
from vincula.mechanism.closed import ClosedConfiguration, Closing
from vincula.mechanism.closure_failure import cannot_close, length_conflicts, named_values
from vincula.mechanism.closure_problem import ClosureProblem
from vincula.mechanism.closure_solver import Limits, Solution, solve
from vincula.mechanism.closure_unknowns import MEMBER
from vincula.mechanism.closure_values import Mask
from vincula.mechanism.configuration import Configuration
from vincula.mechanism.holding import (
    Holding,
    MotorValues,
    PoseOrPoint,
    asked,
    held_columns,
    holding,
    problem_for,
    start_values,
)
from vincula.mechanism.residuals import CLOSED, LoopResidual
from vincula.numerics.lapack import svd
from vincula.numerics.rank import decide_rank

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism

LONGEST_JUMP: Final = 0.25
"""Held values are carried to where they are asked for in steps of this size [rad, or lengths L]."""
TYPED: Final = 100.0
"""Gaps up to this many times the rounding of typed numbers are put down to it."""
RADII: Final = (0.3, 0.6, 1.0, 1.5, 2.2, 3.1)
"""Sizes of the random displacements of further starts [rad]; lengths move by a third of it times L."""


def close(
    mechanism: Mechanism,
    near: MotorValues | None = None,
    *,
    motors: MotorValues | None = None,
    pose: PoseOrPoint | None = None,
    limits: bool = False,
    attempts: int = 25,
    seed: int = 0,
) -> ClosedConfiguration:
    """A configuration that closes all loops, contacts and couplings; see `Mechanism.close`."""
    held = holding(mechanism, motors, pose)
    found = closed_with(_problem(mechanism, held, limits), held, near, limits, attempts, seed)
    how = Closing(mechanism, held, found.problem, found.solution, found.free, found.goal, found.start)
    return ClosedConfiguration(found.values, how, found.iterations, found.attempts)


@dataclass(frozen=True, slots=True, eq=False)
class Found:
    """A closed configuration with how it was found.

    Attributes:
        values: The configuration.
        problem: The equations.
        solution: Their solution.
        free: For every rate, whether it was free to move.
        goal: The state that the search started from.
        start: The configuration that it started from.
        iterations: Jacobians evaluated.
        attempts: Starts tried.
    """

    values: Configuration
    problem: ClosureProblem
    solution: Solution
    free: Mask
    goal: Vector
    start: Configuration
    iterations: int
    attempts: int


def closed_with(
    problem: ClosureProblem,
    held: Holding,
    near: MotorValues | None = None,
    limits: bool = False,
    attempts: int = 25,
    seed: int = 0,
) -> Found:
    """As `close`, with equations made before: they depend on what is held, not on its values.

    Raises:
        ClosureError: No closed configuration was found.
    """
    mechanism = problem.mechanism
    q = start_values(mechanism, near, held)
    fixed = held_columns(problem, held)
    bounds = Limits(*problem.variables.limits(mechanism)) if limits else None
    origin = problem.start(mechanism.configuration(near))
    goal = asked(problem, problem.start(q), held)
    conflicts = partial(length_conflicts, mechanism, q, _held_joints(mechanism, held), held.pose, held.point)
    known = conflicts() if attempts > 1 else ()
    starts = _starts(problem, origin, goal, ~fixed, bounds, 1 if known else attempts, seed)
    best, iterations, tried = _first_closed(problem, starts, ~fixed, bounds)
    if not is_closed(problem, best):
        raise cannot_close(
            mechanism,
            problem.configuration(best.state, q),
            _missed(problem, best),
            conflicts=known or conflicts(),
            attempts=tried,
            hints=_hints(problem, best, held, fixed, bounds, q),
        )
    free = ~fixed & ~best.held_by_limit
    best, more = approached(problem, best, goal, free, bounds)
    free = ~fixed & ~best.held_by_limit
    values = problem.configuration(best.state, q)
    return Found(values, problem, best, free, goal, q, iterations + more, tried)


def _first_closed(
    problem: ClosureProblem, starts: Iterator[Vector], free: Mask, bounds: Limits | None
) -> tuple[Solution, int, int]:
    """The first start that closes, else the best; with Jacobians evaluated and starts tried."""
    best = solve(problem, next(starts), free, bounds)
    iterations, tried = best.iterations, 1
    while not is_closed(problem, best):
        start = next(starts, None)
        if start is None:
            break
        tried += 1
        trial = solve(problem, start, free, bounds)
        iterations += trial.iterations
        if trial.residual < best.residual:
            best = trial
    return best, iterations, tried


def _missed(problem: ClosureProblem, solution: Solution) -> tuple[LoopResidual, ...]:
    """By how much the pose and the motors over several axes miss what was asked for."""
    result = []
    raw = solution.equations.gaps / problem.row_scale
    for name in (MEMBER, *(drive.name for drive in problem.drives)):
        rows = [k for k, source in enumerate(problem.sources) if source == name]
        if rows:
            linear = float(np.linalg.norm([raw[k] for k in rows if problem.linear_rows[k]]))
            angular = float(np.linalg.norm([raw[k] for k in rows if not problem.linear_rows[k]]))
            label = "the pose asked for" if name == MEMBER else f"motor {name}"
            gap = math.hypot(linear, problem.length * angular)
            result.append(LoopResidual(label, "loop", linear, angular, gap))
    return tuple(result)


def is_closed(problem: ClosureProblem, solution: Solution) -> bool:
    """Whether a solution closes everything as well as the library asks for."""
    return solution.residual <= 1e-2 * CLOSED


def approached(
    problem: ClosureProblem, solution: Solution, goal: Vector, free: Mask, bounds: Limits | None
) -> tuple[Solution, int]:
    """The closed state nearest to a start, down the free motions from one that is closed.

    Returns:
        The solution and the number of Jacobians evaluated.
    """
    iterations, fraction = 0, 1.0
    where = problem.variables
    distance = float(np.linalg.norm(where.step_between(solution.state, goal)[free]))
    for _ in range(30):
        jacobian = solution.equations.jacobian[:, free]
        _, values, right = svd(jacobian)
        kernel = right[:, decide_rank(jacobian, name="closure equations", values=values).rank :]
        if kernel.shape[1] == 0:
            break
        step = np.zeros(problem.columns)
        step[free] = kernel @ (kernel.T @ where.step_between(solution.state, goal)[free])
        size = float(np.linalg.norm(step))
        if size < 1e-8:
            break
        step *= fraction * min(1.0, 0.5 / size)
        trial = solve(problem, where.moved(solution.state, step), free, bounds, iterations=12)
        iterations += trial.iterations
        reached = float(np.linalg.norm(where.step_between(trial.state, goal)[free]))
        if is_closed(problem, trial) and reached < distance:
            solution, distance = trial, reached
        else:
            fraction *= 0.5
            if fraction < 0.1:
                break
    return solution, iterations


def _problem(mechanism: Mechanism, held: Holding, limits: bool) -> ClosureProblem:
    """The equations; with limits, limited joints outside the tree have values of their own."""
    limited = [axis for j in mechanism.joints if limits and j.limits and not j.closure
               for axis in mechanism.type_of(j).axis_names(j.name)]  # fmt: skip
    return problem_for(mechanism, held, limited)


def _starts(
    problem: ClosureProblem,
    origin: Vector,
    goal: Vector,
    free: Mask,
    bounds: Limits | None,
    attempts: int,
    seed: int,
) -> Iterator[Vector]:
    """The start; held values carried there in small steps; then random displacements, growing."""
    where = problem.variables
    carried = _carried(problem, origin, goal, free, bounds)
    if carried is not None:
        yield carried
    yield goal
    rng = np.random.default_rng(seed)
    metres = where.column_scale != 1.0
    for k in range(attempts - 1):
        radius = RADII[min(k * len(RADII) // max(attempts - 1, 1), len(RADII) - 1)]
        step = rng.uniform(-radius, radius, problem.columns)
        step[metres] /= 3.0
        step[~free] = 0.0
        yield where.moved(goal, step)


def _carried(
    problem: ClosureProblem, origin: Vector, goal: Vector, free: Mask, bounds: Limits | None
) -> Vector | None:
    """The start with held values carried in small steps, when they are far and `origin` is closed."""
    where = problem.variables
    way = where.step_between(origin, goal)
    way[free] = 0.0
    count = int(np.ceil(np.abs(way).max(initial=0.0) / LONGEST_JUMP))
    if count <= 1 or float(np.linalg.norm(problem.gaps(origin))) > CLOSED:
        return None
    state = origin
    for _ in range(count):
        solution = solve(problem, where.moved(state, way / count), free, bounds, iterations=20)
        if not is_closed(problem, solution):
            return None
        state = solution.state
    return asked_exactly(problem, state, goal, free)


def asked_exactly(problem: ClosureProblem, state: Vector, goal: Vector, free: Mask) -> Vector:
    """The state with held values copied from the goal, free of rounding."""
    where = problem.variables
    result = state.copy()
    for name, place in where.values_of.items():
        if not free[where.columns_of[name]].any():
            result[place] = goal[place]
    return result


def _held_joints(mechanism: Mechanism, held: Holding) -> set[str]:
    """Joints all of whose axes are held or locked."""
    still = {*mechanism.lock, *held.axes}
    whole = {
        joint.name
        for joint in mechanism.all_joints
        if mechanism.type_of(joint).axes and still.issuperset(mechanism.type_of(joint).axis_names(joint.name))
    }
    return whole | set(held.joints)


def _hints(
    problem: ClosureProblem,
    best: Solution,
    held: Holding,
    held_mask: Mask,
    bounds: Limits | None,
    q: Configuration,
) -> tuple[str, ...]:
    """What would close: exact numbers, no limits, or nothing held."""
    known = problem.mechanism.precision
    doubt = known.digits_length / problem.length + known.digits_angle
    if 0.0 < best.residual <= TYPED * doubt:
        text = (
            f"The gap is no larger than what the rounding of typed numbers leaves open ({doubt:.2g} of the "
            "characteristic length): a loop with more rows than it needs closes only with exact numbers, so "
            "give them with more digits"
        )
        return (text,)
    hints = []
    everything = np.ones(problem.columns, dtype=bool)
    if bounds is not None:
        free = solve(problem, best.state, ~held_mask)
        if is_closed(problem, free):
            values = problem.variables.scalar_values(free.state)
            over = np.flatnonzero((values < bounds.lower) | (values > bounds.upper))
            names = [problem.variables.names[k] for k in over]
            shown = ", ".join(f"{n} = {values[k]:.6g}" for n, k in zip(names, over, strict=True))
            return (f"It closes beyond the limits, at {shown}",)
    if held_mask.any():
        free = solve(problem, best.state, everything, bounds)
        if is_closed(problem, free):
            nearest = problem.configuration(free.state, q)
            names = [name for name in (*held.joints, *_locked_joints(problem.mechanism)) if name in nearest]
            shown = f", near {named_values(names, nearest)}" if names else ""
            hints.append(f"It closes when nothing is held{shown}")
    return tuple(hints)


def _locked_joints(mechanism: Mechanism) -> list[str]:
    """Joints with a locked axis."""
    locked = set(mechanism.lock)
    return [
        joint.name
        for joint in mechanism.all_joints
        if locked.intersection(mechanism.type_of(joint).axis_names(joint.name))
    ]
