"""All designs of a grid over one or two variables: the landscape of a problem."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from vincula.arrays import Vector
from vincula.design.asking import Asking, Progress
from vincula.design.judged import Judged
from vincula.errors import ModelError, UnknownNameError

if TYPE_CHECKING:
    from vincula.design.log import Log
    from vincula.design.problem import DesignProblem

BATCH: Final = 32768
"""Configurations of one batch, of all its designs together: a fraction of a second in lanes."""
LEAST: Final = 64
"""Least designs of one batch, which is what an interruption can cost."""
MOST: Final = 4_000_000
"""Most designs of a landscape."""


@dataclass(frozen=True, slots=True, eq=False)
class Landscape:
    """Objectives over a grid of designs.

    Attributes:
        problem: The problem.
        names: The one or two variables.
        axes: Their values.
        values: Objectives on the grid, (points of the first, of the second, objectives); NaN where a
            design is not feasible.
        judged: Every design, in the order of the grid.
        counts: How many designs each constraint killed.
    """

    problem: DesignProblem = field(repr=False)
    names: tuple[str, ...]
    axes: tuple[Vector, ...]
    values: Vector = field(repr=False)
    judged: Judged = field(repr=False)
    counts: dict[str, int]

    def best(self, objective: int = 0) -> tuple[dict[str, float], float]:
        """The best design of the grid by variable, and its objective.

        Raises:
            DesignError: No design of the grid is feasible.
        """
        from vincula.errors import DesignError

        merit = self.judged.merit(objective)
        k = int(np.argmin(merit))
        if not self.judged.feasible[k]:
            raise DesignError(f"no feasible design among {len(merit)} of the grid", counts=self.counts)
        return self.problem.space.named(self.judged.designs[k]), float(self.judged.objectives[k, objective])

    def to_dict(self) -> dict[str, Any]:
        """The report as plain values."""
        from vincula.design.reporting import landscape_facts

        return landscape_facts(self)


def scan(
    problem: DesignProblem,
    names: Sequence[str],
    *,
    counts: Sequence[int] | int = 41,
    at: Mapping[str, float] | None = None,
    log: Log | None = None,
    progress: Progress | None = None,
) -> Landscape:
    """Evaluate a grid over one or two variables.

    Args:
        problem: The problem.
        names: The variables.
        counts: Points along each of them, bounds included.
        at: Values of the other variables; where they start by default.
        log: Keeps every batch, and gives them back when the scan is begun again.
        progress: Told after every batch.

    Raises:
        ModelError: Not one or two different variables, or no grid.
        UnknownNameError: A variable that does not exist.
    """
    space = problem.space
    for name in (*names, *(at or {})):
        if name not in space.names:
            raise UnknownNameError("variable", name, space.names)
    sizes = [counts] * len(names) if isinstance(counts, int) else list(counts)
    if not 1 <= len(names) <= 2 or len(set(names)) != len(names) or len(sizes) != len(names):
        raise ModelError(f"a landscape is drawn over one or two different variables, got {len(names)}")
    if min(sizes) < 2 or int(np.prod(sizes)) > MOST:
        raise ModelError(
            f"a landscape of {sizes} designs: give at least 2 along each variable, {MOST} in all"
        )
    places = [space.names.index(name) for name in names]
    axes = tuple(np.linspace(space.low[p], space.high[p], n) for p, n in zip(places, sizes, strict=True))
    base = space.start
    for name, value in (at or {}).items():
        base[space.names.index(name)] = value
    mesh = np.meshgrid(*axes, indexing="ij")
    table = np.tile(base, (mesh[0].size, 1))
    for place, values in zip(places, mesh, strict=True):
        table[:, place] = values.ravel()
    asking = Asking(problem, f"scan {list(names)} {sizes} {base.tolist()}", log, progress, len(table))
    asking.stage = "scanning"
    batch = max(LEAST, BATCH // problem.places)
    for first in range(0, len(table), batch):
        asking(table[first : first + batch])
    judged = asking.everything
    values = np.where(judged.feasible[:, None], judged.objectives, np.nan)
    shaped = values.reshape((*sizes, len(problem.objectives)))
    return Landscape(
        problem, tuple(names), axes, shaped, judged, judged.counted(problem.names_of_constraints)
    )
