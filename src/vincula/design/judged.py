"""What a batch of designs was found to be: objectives, broken constraints, reasons."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from vincula.arrays import Matrix, Vector

INFEASIBLE: Final = 1000.0
"""Merit of the best infeasible design; feasible ones are below 711, the largest arcsinh of a double."""
OWN: Final = ("a tie or relation has no value", "cannot be built", "does not close", "no finite cost")
"""What kills a design before, or beside, the constraints of the problem."""


@dataclass(frozen=True, slots=True, eq=False)
class Judged:
    """Designs and what they are worth.

    Attributes:
        designs: designs x variables.
        objectives: designs x objectives, in their own sense; NaN where there is no number.
        broken: designs x constraints: `OWN`, then those of the problem; amounts, 0 where kept.
        signs: +1 for objectives of which smaller is better, else -1.
        doubtful: Designs with a configuration at which a rank is not decided.
    """

    designs: Matrix
    objectives: Matrix
    broken: Matrix
    signs: Vector
    doubtful: NDArray[np.bool_]

    def __len__(self) -> int:
        return len(self.designs)

    @property
    def feasible(self) -> NDArray[np.bool_]:
        """Designs that keep every constraint."""
        return np.asarray(~(self.broken > 0.0).any(axis=1))

    @property
    def signed(self) -> Matrix:
        """Objectives so that smaller is better; inf for designs that are not feasible."""
        values = np.where(np.isnan(self.objectives), np.inf, self.objectives * self.signs)
        return np.where(self.feasible[:, None], values, np.inf)

    def merit(self, objective: int = 0) -> Vector:
        """One number a design to search by: any feasible design is below every other.

        Feasible: arcsinh of the objective, which keeps its order and its digits and has a bound.  Else
        `INFEASIBLE` and the sum of what is broken.
        """
        with np.errstate(invalid="ignore"):
            value = np.arcsinh(np.where(self.feasible, self.signed[:, objective], 0.0))
        return np.asarray(np.where(self.feasible, value, INFEASIBLE + self.broken.sum(axis=1)))

    def counted(self, names: Sequence[str]) -> dict[str, int]:
        """How many designs break each constraint, those that occur; a design may break several.

        Args:
            names: Names of the columns of `broken`.
        """
        counts = (self.broken > 0.0).sum(axis=0)
        return {name: int(count) for name, count in zip(names, counts, strict=True) if count}

    def part(self, rows: NDArray[np.int_] | NDArray[np.bool_] | slice) -> Judged:
        """Some of the designs."""
        return Judged(
            self.designs[rows], self.objectives[rows], self.broken[rows], self.signs, self.doubtful[rows]
        )


def joined(parts: Sequence[Judged]) -> Judged:
    """Several batches as one; there must be at least one."""
    return Judged(
        np.concatenate([part.designs for part in parts]),
        np.concatenate([part.objectives for part in parts]),
        np.concatenate([part.broken for part in parts]),
        parts[0].signs,
        np.concatenate([part.doubtful for part in parts]),
    )
