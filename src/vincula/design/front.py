"""Several objectives at once: the designs that no other one beats in everything (extra `opt`).

NSGA-II for two objectives.  From three on nearly all designs of a generation are unbeaten, and being apart
from the others decides; NSGA-III then keeps a design near each of many directions, spread over all
compromises.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import comb
from typing import TYPE_CHECKING, Any, Final, Literal

import numpy as np
from numpy.typing import NDArray

from vincula.arrays import Matrix
from vincula.design.asking import Asking, Progress
from vincula.design.judged import Judged
from vincula.design.rechecked import rechecked
from vincula.errors import MissingExtraError, ModelError, UnknownNameError

if TYPE_CHECKING:
    from vincula.design.log import Log
    from vincula.design.problem import DesignProblem

Method = Literal["nsga2", "nsga3"]
NAMES: Final[dict[Method, str]] = {"nsga2": "NSGA-II", "nsga3": "NSGA-III"}
"""Names of the methods in reports."""
BOUNDLESS: Final = 720.0
"""What an infinite objective counts for a search; arcsinh of the largest double is 711."""
SAME_DIGITS: Final = 9
"""Objectives that agree to so many digits are equal."""


@dataclass(frozen=True, slots=True, eq=False)
class Front:
    """The best compromises that a search found.

    Attributes:
        problem: The problem.
        members: The designs that no evaluated design beats, by the first objective; one of each kind where
            several have the same objectives.
        checked: Objectives of the members computed again, one by one, by the reference path.
        everything: Every design that was evaluated.
        counts: How many designs each constraint killed.
        evaluated: How many designs were asked for.
        seed: The seed.
        method: What searched: `nsga2` or `nsga3`.
    """

    problem: DesignProblem = field(repr=False)
    members: Judged = field(repr=False)
    checked: Matrix = field(repr=False)
    everything: Judged = field(repr=False)
    counts: dict[str, int]
    evaluated: int
    seed: int
    method: Method

    @property
    def largest_difference(self) -> float:
        """Largest relative difference between the search and the reference path."""
        found, again = self.members.objectives, self.checked
        scale = np.maximum(np.abs(again), 1e-300)
        with np.errstate(invalid="ignore"):
            difference = np.where(found == again, 0.0, np.abs(found - again) / scale)
        return float(difference.max(initial=0.0))

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
    method: Method | None = None,
    log: Log | None = None,
    progress: Progress | None = None,
) -> Front:
    """The best compromises between the objectives of a problem.

    NSGA-II or NSGA-III of pymoo; every generation is one batch.  Kept are all designs ever evaluated that no
    other one beats in every objective; each is computed again by the reference path (see `rechecked`).

    Args:
        problem: A problem with at least two objectives.
        seed: Seed of the search.
        population: Designs of a generation.
        generations: How many generations.
        method: `nsga2` or `nsga3`; None for `nsga3` from three objectives on.
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
    method = method or ("nsga3" if len(problem.objectives) > 2 else "nsga2")
    if method not in NAMES:
        raise UnknownNameError("method", method, NAMES)
    run = f"front seed={seed} population={population} generations={generations} {method}"
    asking = Asking(problem, run, log, progress, population * generations)
    _evolve(asking, method, seed, population, generations)
    asking.refuse_nothing_feasible()
    found = asking.everything
    able = found.part(np.flatnonzero(found.feasible))
    _, unique = np.unique(able.designs, axis=0, return_index=True)
    able = able.part(np.sort(unique))
    members = able.part(pareto_front(-able.signed))
    members = members.part(np.argsort(members.objectives[:, 0], kind="stable"))
    members = members.part(different(members.objectives))
    again = rechecked(problem, members)
    counts = found.counted(problem.names_of_constraints)
    return Front(problem, members, again, found, counts, asking.evaluated, seed, method)


def searched(judged: Judged) -> Matrix:
    """Objectives as the search sees them, smaller being better.

    arcsinh keeps the order and has a bound: one huge or boundless value hides no other.

    Args:
        judged: A generation.
    """
    return np.clip(np.arcsinh(judged.signed), -BOUNDLESS, BOUNDLESS)


def different(objectives: Matrix) -> NDArray[np.int_]:
    """Rows that differ in some objective by more than rounding: one compromise is told once.

    A variable that no objective depends on would else give one for each of its values.

    Args:
        objectives: designs x objectives.
    """
    seen: dict[tuple[str, ...], int] = {}
    for row, values in enumerate(objectives):
        seen.setdefault(tuple(f"{value:.{SAME_DIGITS}g}" for value in values), row)
    return np.array(list(seen.values()), dtype=int)


def _evolve(asking: Asking, method: Method, seed: int, population: int, generations: int) -> None:
    try:
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
            out["F"] = searched(judged)
            out["G"] = judged.broken.sum(axis=1)[:, None]

    algorithm = _algorithm(method, count, population)
    minimize(Batches(), algorithm, ("n_gen", generations), seed=seed, verbose=False)


def _algorithm(method: Method, objectives: int, population: int) -> Any:
    if method == "nsga2":
        from pymoo.algorithms.moo.nsga2 import NSGA2

        return NSGA2(pop_size=population)
    from pymoo.algorithms.moo.nsga3 import NSGA3
    from pymoo.util.ref_dirs import get_reference_directions

    parts = partitions(objectives, population)
    directions = get_reference_directions("das-dennis", objectives, n_partitions=parts)
    return NSGA3(directions, pop_size=population)


def partitions(objectives: int, population: int) -> int:
    """Into how many parts every objective is divided, so that there is a design for every direction.

    Das and Dennis (1998): comb(parts + objectives - 1, parts) directions, at most as many as designs.

    Args:
        objectives: How many objectives.
        population: Designs of a generation.
    """
    parts = 1
    while comb(parts + objectives, parts + 1) <= population:
        parts += 1
    return parts
