"""The best design of one objective: differential evolution over batches, then a local polish."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from vincula.arrays import Vector
from vincula.design.asking import Asking, Progress
from vincula.design.judged import Judged
from vincula.design.neighbourhood import Neighbourhood, neighbourhood
from vincula.design.polish import polished
from vincula.errors import ModelError, listing

if TYPE_CHECKING:
    from vincula.design.log import Log
    from vincula.design.problem import DesignProblem

AT_BOUND: Final = 1e-6
"""How near a bound, in parts of its range, an optimum counts as lying on it."""
APART: Final = 0.05
"""How far runners-up lie from each other at least, in parts of the range of a variable."""


@dataclass(frozen=True, slots=True, eq=False)
class Optimum:
    """What a search for one objective found.

    Attributes:
        problem: The problem.
        design: The best design.
        value: Its objective, in its own sense.
        start: The design to compare with.
        start_value: Its objective; NaN where it is not feasible.
        everything: Every design that was evaluated.
        counts: How many designs each constraint killed.
        bounds: Variables on a bound of theirs, with `low` or `high`.
        around: How flat the optimum is, and what manufacturing errors do to it.
        runners_up: Other designs, the best of every neighbourhood.
        polish: How the optimum was refined: `gradient`, `simplex` or `none`.
        evaluated: How many designs were asked for.
        seed: The seed.
        converged: Whether the population agreed before the last generation.
    """

    problem: DesignProblem = field(repr=False)
    design: Vector
    value: float
    start: Vector
    start_value: float
    everything: Judged = field(repr=False)
    counts: dict[str, int]
    bounds: dict[str, str]
    around: Neighbourhood = field(repr=False)
    runners_up: Judged = field(repr=False)
    polish: str
    evaluated: int
    seed: int
    converged: bool

    @property
    def parameters(self) -> dict[str, float]:
        """The best design by variable, in the units of the parameters."""
        return self.problem.space.named(self.design)

    def mechanism(self) -> Any:
        """The best mechanism."""
        return self.problem.mechanism(self.design)

    def to_dict(self) -> dict[str, Any]:
        """The report as plain values; what has no value is null."""
        from vincula.design.reporting import optimum_facts

        return optimum_facts(self)

    def __str__(self) -> str:
        from vincula.design.reporting import optimum_text

        return optimum_text(self)


def optimize(
    problem: DesignProblem,
    *,
    seed: int = 0,
    population: int | None = None,
    generations: int = 200,
    tolerance: float = 1e-6,
    polish: bool = True,
    samples: int = 200,
    log: Log | None = None,
    progress: Progress | None = None,
) -> Optimum:
    """The best design of a problem with one objective.

    Differential evolution (scipy, best/1/bin, every generation one batch), then the best design is polished:
    by gradients where the objective is smooth, else by a simplex.  With the same seed, and with a log after
    any interruption, the result is the same.

    Args:
        problem: The problem.
        seed: Seed of the search.
        population: Designs of a generation; None for 10 a variable and at least 24.
        generations: Most generations.
        tolerance: Spread of the population at which it counts as agreed.
        polish: Whether the best design is refined.
        samples: Designs of the tolerance analysis, where a variable has a tolerance.
        log: Keeps every batch, and gives them back when the search is begun again.
        progress: Told after every batch.

    Raises:
        ModelError: Several objectives, or settings that are no search.
        DesignError: No feasible design, with what killed how many; or a log of another problem.
    """
    if len(problem.objectives) != 1:
        names = listing(objective.name for objective in problem.objectives)
        raise ModelError(f"{len(problem.objectives)} objectives ({names}): use front, or choose one")
    count = population or max(24, 10 * len(problem.space.names))
    if count < 5 or generations < 1 or seed < 0:
        raise ModelError(
            f"population {count}, generations {generations}, seed {seed}: give at least 5, 1 and 0"
        )
    run = f"evolution seed={seed} population={count} generations={generations} tolerance={tolerance} {polish}"
    asking = Asking(problem, run, log, progress, count * (generations + 1))
    start = asking(problem.space.start[None, :])
    best, converged = _evolved(asking, seed, count, generations, tolerance)
    asking.refuse_nothing_feasible()
    how = "none"
    if polish:
        asking.stage = "polishing"
        best, how = polished(asking, best)
    found = asking.everything
    first = int(np.argmin(found.merit()))
    design = np.array(found.designs[first])
    asking.stage = "looking around"
    around = neighbourhood(asking, design, seed, samples)
    return Optimum(
        problem=problem,
        design=design,
        value=float(found.objectives[first, 0]),
        start=problem.space.start,
        start_value=float(start.objectives[0, 0]) if start.feasible[0] else float("nan"),
        everything=found,
        counts=found.counted(problem.names_of_constraints),
        bounds=_on_bounds(problem, design),
        around=around,
        runners_up=runners_up(problem, found),
        polish=how,
        evaluated=len(found),
        seed=seed,
        converged=converged,
    )


def _evolved(
    asking: Asking, seed: int, count: int, generations: int, tolerance: float
) -> tuple[Vector, bool]:
    """The best design of differential evolution, and whether the population agreed."""
    from scipy.optimize import differential_evolution

    space = asking.problem.space
    # A population of its own, since scipy's is a multiple of the number of variables.
    random = np.random.default_rng(seed)
    rows = (np.argsort(random.random((len(space.names), count)), axis=1) + random.random((1, count))) / count
    first = space.low + rows.T * (space.high - space.low)

    def merit(columns: Vector) -> Vector:
        return asking(np.atleast_2d(columns.T)).merit()

    found = differential_evolution(
        merit,
        list(zip(space.low, space.high, strict=True)),
        init=np.clip(first, space.low, space.high),
        maxiter=generations,
        tol=0.0,
        atol=tolerance,
        seed=seed,
        polish=False,
        vectorized=True,
        updating="deferred",
    )
    return np.asarray(found.x), bool(found.success)


def _on_bounds(problem: DesignProblem, design: Vector) -> dict[str, str]:
    found = {}
    for name, value, low, high in zip(
        problem.space.names, design, problem.space.low, problem.space.high, strict=True
    ):
        if value - low <= AT_BOUND * (high - low):
            found[name] = "low"
        elif high - value <= AT_BOUND * (high - low):
            found[name] = "high"
    return found


def runners_up(problem: DesignProblem, found: Judged, most: int = 6) -> Judged:
    """The best designs that lie apart from each other, the best of all first."""
    places = found.designs / (problem.space.high - problem.space.low)
    merit = np.where(found.feasible, found.merit(), np.inf)
    kept: list[int] = []
    while len(kept) < most and np.isfinite(merit).any():
        kept.append(int(np.argmin(merit)))
        merit[np.abs(places - places[kept[-1]]).max(axis=1) <= APART] = np.inf
    return found.part(np.array(kept, dtype=int))
