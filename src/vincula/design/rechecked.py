"""Designs computed again by the reference path: everywhere, or where it matters most.

Over many configurations the reference path would take longer than the search.  Then every design is computed
again at the configurations that decide its objectives and at others spread over all; what the configurations
are is taken from the search, and the reference path verifies that they are closed.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from vincula.arrays import Matrix, Vector
from vincula.design.judged import Judged
from vincula.design.measures import Measure, WorkspaceShare

if TYPE_CHECKING:
    from vincula.design.problem import DesignProblem

WHOLE: Final = 500
"""Up to so many configurations in all, of all designs together, everything is closed and computed again."""
SPREAD: Final = 16
"""Configurations of every design besides the deciding ones, where there are more."""


def rechecked(problem: DesignProblem, judged: Judged) -> Matrix:
    """Objectives of designs by the reference path.

    A worst value is the worst of the configurations that are looked at, the deciding one among them; a mean
    is that of the search, corrected by the mean difference at them.

    Args:
        problem: The problem.
        judged: Feasible designs of it.
    """
    if len(judged) * problem.places <= WHOLE:
        return problem.by_reference().judge(judged.designs).objectives
    found = np.array(judged.objectives)
    for k, objective in enumerate(problem.objectives):
        found[:, k] = _again(problem, objective, judged.designs, found[:, k])
    return found


def _again(problem: DesignProblem, objective: Measure, designs: Matrix, found: Vector) -> Vector:
    """One objective of every design."""
    lanes = problem.looked_at(objective, designs)
    values = np.where(lanes.reached, objective.at(lanes), np.nan)
    places = _places(objective.signed(values))
    again = problem.looked_at(objective, designs, places, lanes)
    own = np.where(again.reached, objective.at(again), np.nan)
    if isinstance(objective, WorkspaceShare):
        return np.asarray(found * again.reached.mean(axis=1))
    if objective.over == "mean":
        before = np.take_along_axis(values, places, axis=1)
        return np.asarray(found + np.mean(own - before, axis=1))
    return np.asarray(own.max(axis=1) if objective.better == "smaller" else own.min(axis=1))


def _places(signed: Matrix) -> NDArray[np.intp]:
    """For every design the places to look at, all of them reached: the worst, and others in even steps."""
    rows: list[Any] = []
    for row in signed:
        there = np.flatnonzero(~np.isnan(row))
        spread = there[np.linspace(0, len(there) - 1, SPREAD).astype(int)]
        rows.append([there[np.argmax(row[there])], *spread])
    return np.array(rows)
