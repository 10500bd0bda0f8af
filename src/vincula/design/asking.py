"""Between a search and a problem: counts, keeps and replays every design that is asked for."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from vincula.arrays import Matrix
from vincula.design.judged import OWN, Judged, joined
from vincula.errors import DesignError, listing

if TYPE_CHECKING:
    from vincula.design.log import Log
    from vincula.design.problem import DesignProblem
NO_COST: Final = OWN[-1]
"""What kills a design whose objective is infinite or undefined."""
ADVICE: Final = "Loosen the one that kills most, or widen the bounds of the variables"


@dataclass(frozen=True, slots=True)
class Step:
    """How far a search is.

    Attributes:
        stage: What it is doing, in words.
        evaluated: Designs looked at so far.
        total: How many it may look at in the end.
        best: Best feasible objective, in its own sense; None while there is none.
    """

    stage: str
    evaluated: int
    total: int
    best: float | None


Progress = Callable[[Step], None]


class Asking:
    """Judges designs for one search, in order.

    Args:
        problem: The problem.
        run: What tells this search from others in one log: its kind and settings.
        log: Where batches are kept and found again; None to keep them in memory only.
        progress: Told after every batch.
        total: How many designs the search may look at.
    """

    def __init__(
        self,
        problem: DesignProblem,
        run: str,
        log: Log | None = None,
        progress: Progress | None = None,
        total: int = 0,
    ) -> None:
        self.problem, self.log, self.progress, self.total = problem, log, progress, total
        self.run = f"{run.split(maxsplit=1)[0]} {hashlib.sha256(run.encode()).hexdigest()[:16]}"
        self.stage = "searching"
        self.replayed = 0
        self._parts: list[Judged] = []
        self._best: float | None = None
        self._count = 0

    def __call__(self, designs: Matrix) -> Judged:
        """What designs are worth."""
        table = np.ascontiguousarray(np.atleast_2d(designs), dtype=float)
        kept = self.log.get(self.run, len(self._parts), table) if self.log is not None else None
        if kept is None:
            judged = self.problem.judge(table)
            if self.log is not None:
                self.log.put(self.run, len(self._parts), judged)
        else:
            judged = kept
            self.replayed += len(table)
        self._parts.append(judged)
        self._count += len(table)
        self._tell(judged)
        return judged

    @property
    def everything(self) -> Judged:
        """All designs asked for so far."""
        return joined(self._parts)

    @property
    def evaluated(self) -> int:
        """How many designs were asked for."""
        return self._count

    def refuse_nothing_feasible(self) -> None:
        """Refuse to go on where no design keeps every constraint.

        Raises:
            DesignError: None does; how many each constraint killed.
        """
        found = self.everything
        if found.feasible.any():
            return
        counts = found.counted(self.problem.names_of_constraints)
        ranked = sorted(counts.items(), key=lambda item: -item[1])
        told = listing(f"{name!r} killed {count}" for name, count in ranked)
        several = " (a design may break several)" if len(counts) > 1 else ""
        endless = ranked[0][0] == NO_COST
        advice = self._why_no_cost() if endless else ADVICE
        raise DesignError(f"no feasible design among {len(found)}: {told}{several}. {advice}", counts=counts)

    def _why_no_cost(self) -> str:
        """What may be wrong where the objective is infinite or undefined everywhere."""
        problem = self.problem
        names = listing(repr(objective.name) for objective in problem.objectives)
        said = f"{names}: infinite or undefined for all of them"
        loose = problem.usual["indeterminacy"]
        if loose:
            ways = "1 way" if loose == 1 else f"{loose} ways"
            return (
                f"{said}, for the member moves in {ways} with all motors locked: give the mechanism more "
                "motors (vincula place ranks them), or a weight of 0 to what may move"
            )
        return f"{said}. Look at one design with vincula analyze, or choose another objective"

    def _tell(self, judged: Judged) -> None:
        if self.progress is None:
            return
        values = judged.signed[:, 0]
        if len(values) and np.isfinite(values).any():
            least = float(values.min())
            self._best = least if self._best is None else min(self._best, least)
        best = None if self._best is None else self._best * float(self.problem.signs[0])
        self.progress(Step(self.stage, self._count, max(self.total, self._count), best))
