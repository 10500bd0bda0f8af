"""Several objectives at once: the designs that no other one beats in everything (NSGA-II, extra `opt`)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from vincula.arrays import Matrix
from vincula.design.asking import Asking, Progress
from vincula.design.judged import Judged
from vincula.errors import MissingExtraError, ModelError

if TYPE_CHECKING:
    from vincula.design.log import Log
    from vincula.design.problem import DesignProblem


@dataclass(frozen=True, slots=True, eq=False)
class Front:
    """The best compromises that a search found.

    Attributes:
        problem: The problem.
        members: The designs that no evaluated design beats, by the first objective.
        checked: Objectives of the members computed again, one by one, by the reference path.
        everything: Every design that was evaluated.
        counts: How many designs each constraint killed.
        evaluated: How many designs were asked for.
        seed: The seed.
    """

    problem: DesignProblem = field(repr=False)
    members: Judged = field(repr=False)
    checked: Matrix = field(repr=False)
    everything: Judged = field(repr=False)
    counts: dict[str, int]
    evaluated: int
    seed: int

    @property
    def largest_difference(self) -> float:
        """Largest relative difference between the search and the reference path."""
        scale = np.maximum(np.abs(self.checked), 1e-300)
        return float((np.abs(self.members.objectives - self.checked) / scale).max(initial=0.0))

    def to_dict(self) -> dict[str, Any]:
        """The report as plain values."""
        from vincula.design.reporting import front_facts

        return front_facts(self)

    def __str__(self) -> str:
        from vincula.design.reporting import front_text

        return front_text(self)


def front(
    problem: DesignProblem,
    *,
    seed: int = 0,
    population: int = 40,
    generations: int = 50,
    log: Log | None = None,
    progress: Progress | None = None,
) -> Front:
    """The best compromises between the objectives of a problem.

    NSGA-II of pymoo; every generation is one batch.  Kept are all designs ever evaluated that no other one
    beats in every objective; each is computed again by the reference path.

    Args:
        problem: A problem with at least two objectives.
        seed: Seed of the search.
        population: Designs of a generation.
        generations: How many generations.
        log: Keeps every batch, and gives them back when the search is begun again.
        progress: Told after every batch.

    Raises:
        ModelError: Fewer than two objectives, or settings that are no search.
        DesignError: No feasible design, with what killed how many.
        MissingExtraError: pymoo is not installed.
    """
    from vincula.design.pareto import pareto_front

    if len(problem.objectives) < 2:
        raise ModelError("a front needs two objectives or more: use optimize for one")
    if population < 4 or generations < 1 or seed < 0:
        raise ModelError(f"population {population}, generations {generations}, seed {seed}: no search")
    run = f"front seed={seed} population={population} generations={generations}"
    asking = Asking(problem, run, log, progress, population * generations)
    _evolve(asking, seed, population, generations)
    asking.refuse_nothing_feasible()
    found = asking.everything
    able = found.part(np.flatnonzero(found.feasible))
    _, unique = np.unique(able.designs, axis=0, return_index=True)
    able = able.part(np.sort(unique))
    members = able.part(pareto_front(-able.signed))
    members = members.part(np.argsort(members.objectives[:, 0], kind="stable"))
    again = problem.by_reference().judge(members.designs).objectives
    return Front(
        problem, members, again, found, found.counted(problem.names_of_constraints), asking.evaluated, seed
    )


def _evolve(asking: Asking, seed: int, population: int, generations: int) -> None:
    try:
        from pymoo.algorithms.moo.nsga2 import NSGA2
        from pymoo.core.problem import Problem
        from pymoo.optimize import minimize
    except ImportError as error:
        raise MissingExtraError("pymoo", "opt", "a search with several objectives") from error
    space = asking.problem.space
    count = len(asking.problem.objectives)

    class Batches(Problem):  # type: ignore[misc]
        """A generation is one question."""

        def __init__(self) -> None:
            super().__init__(n_var=len(space.names), n_obj=count, n_ieq_constr=1, xl=space.low, xu=space.high)

        def _evaluate(self, x: Any, out: dict[str, Any], *_: Any, **__: Any) -> None:
            judged = asking(np.asarray(x))
            signed = judged.signed
            out["F"] = np.where(np.isfinite(signed), signed, 1e30)
            out["G"] = judged.broken.sum(axis=1)[:, None]

    minimize(Batches(), NSGA2(pop_size=population), ("n_gen", generations), seed=seed, verbose=False)
