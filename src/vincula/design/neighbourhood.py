"""Around an optimum: how flat it is along every variable, and what manufacturing errors do to it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from vincula.arrays import Vector

if TYPE_CHECKING:
    from vincula.design.asking import Asking

MOVES: Final = (-0.01, -0.001, 0.001, 0.01)
"""By how much every variable is moved, in parts of its range."""


@dataclass(frozen=True, slots=True, eq=False)
class Neighbourhood:
    """What happens near a design.

    Attributes:
        moved: variables x `MOVES`: the objective with one variable moved; NaN outside the bounds or where the
            design is not feasible.
        sampled: Objectives of designs with random manufacturing errors; NaN where one is not feasible;
            empty where no variable has a tolerance.
    """

    moved: Vector
    sampled: Vector

    @property
    def kept(self) -> float:
        """Share of the designs with manufacturing errors that are feasible; NaN without tolerances."""
        return float(np.isfinite(self.sampled).mean()) if len(self.sampled) else float("nan")


def neighbourhood(asking: Asking, design: Vector, seed: int, samples: int) -> Neighbourhood:
    """Evaluate the neighbourhood of a design.

    Manufacturing errors are independent and uniform between minus and plus the tolerance of each variable;
    they may leave the bounds, which bind the drawing and not the workshop.

    Args:
        asking: Judges designs.
        design: The design.
        seed: Seed of the errors.
        samples: How many designs with errors.
    """
    space = asking.problem.space
    span = space.high - space.low
    count, moves = len(design), len(MOVES)
    table = np.repeat(design[None, :], count * moves, axis=0)
    for k in range(count):
        table[k * moves : (k + 1) * moves, k] += np.array(MOVES) * span[k]
    inside = ((table >= space.low) & (table <= space.high)).all(axis=1)
    moved = np.full(len(table), np.nan)
    if inside.any():
        found = asking(table[inside])
        moved[inside] = np.where(found.feasible, found.objectives[:, 0], np.nan)
    tolerances = np.array([variable.tolerance for variable in space.variables])
    sampled = np.empty(0)
    if tolerances.any() and samples > 0:
        errors = np.random.default_rng(seed).uniform(-1.0, 1.0, (samples, count)) * tolerances
        found = asking(design + errors)
        sampled = np.where(found.feasible, found.objectives[:, 0], np.nan)
    return Neighbourhood(moved.reshape(count, moves), sampled)
