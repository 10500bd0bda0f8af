"""Where a signed measure on a grid passes through zero between its points, and where it jumps instead.

Between two neighbours of opposite sign zero is found by linear interpolation.  A measure that belongs to
another branch at the next point does not pass zero: it changes there much more than it does beside it, or
turns back.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from vincula.arrays import Matrix

STEEPEST: Final = 4.0
"""How much more than beside it a measure may change between two points and still pass through zero: smooth
ones change almost alike from step to step, on coarse grids close to another singularity up to four times."""

_Edge = tuple[int, int, int]
"""Row and column of its first point, and whether it goes up (0) or to the right (1)."""


@dataclass(frozen=True, slots=True, eq=False)
class ZeroCurves:
    """Zeros of a measure over a grid.

    Attributes:
        curves: Polylines, each n x 2 places (column, row) counted in grid points.
        jumps: k x 2 x 2 sides of cells between points whose measures have opposite signs and jump.
    """

    curves: tuple[Matrix, ...]
    jumps: Matrix


def zero_curves(measure: Matrix) -> ZeroCurves:
    """Zeros of a measure, by rows and columns; NaN where it is not known.

    Args:
        measure: One number a grid point.
    """
    measure = np.where(np.isfinite(measure), measure, np.nan)
    signs = np.where(np.isnan(measure), np.nan, np.where(measure >= 0.0, 1.0, -1.0))
    shares: dict[_Edge, float] = {}
    jumps: list[list[tuple[float, float]]] = []
    for axis in (0, 1):
        turned = measure if axis == 1 else measure.T
        change = np.diff(turned, axis=1)
        sides = np.diff(signs if axis == 1 else signs.T, axis=1)
        passes = _passes(change, sides == 0.0)
        for i, j in np.argwhere(np.abs(sides) > 0.0):
            row, column = (int(i), int(j)) if axis == 1 else (int(j), int(i))
            if passes[i, j]:
                shares[row, column, axis] = float(-turned[i, j] / change[i, j])
            elif axis == 1:
                jumps.append([(column + 0.5, row - 0.5), (column + 0.5, row + 0.5)])
            else:
                jumps.append([(column - 0.5, row + 0.5), (column + 0.5, row + 0.5)])
    curves = tuple(_chains(shares, measure))
    return ZeroCurves(curves, np.array(jumps).reshape(-1, 2, 2))


def _passes(change: Matrix, alike: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Whether every change along a row goes on beside it, the same way; or is usual if nothing is beside it.

    Args:
        change: Changes between neighbours.
        alike: Which of them are between points of the same side.
    """
    padded = np.pad(np.where(alike, change, np.nan), ((0, 0), (1, 1)), constant_values=np.nan)
    beside = np.fmax(padded[:, :-2] * np.sign(change), padded[:, 2:] * np.sign(change))
    usual = float(np.median(np.abs(change[alike]))) if alike.any() else np.inf
    return np.asarray(np.abs(change) <= STEEPEST * np.where(np.isnan(beside), usual, beside))


def _chains(shares: dict[_Edge, float], measure: Matrix) -> Iterator[Matrix]:
    """The crossings of all cells joined to polylines; a closed one ends where it begins."""
    beside: dict[_Edge, list[_Edge]] = {edge: [] for edge in shares}
    rows, columns = measure.shape
    cells = {(i - back, j) if axis == 1 else (i, j - back) for i, j, axis in shares for back in (0, 1)}
    for i, j in sorted(cells):
        if 0 <= i < rows - 1 and 0 <= j < columns - 1:
            for one, two in _pairs(i, j, shares, measure):
                beside[one].append(two)
                beside[two].append(one)
    left = dict.fromkeys(sorted(beside, key=lambda edge: (len(beside[edge]) == 2, edge)))
    while left:
        edge = next(iter(left))
        chain = [edge]
        del left[edge]
        while follow := [other for other in beside[chain[-1]] if other in left]:
            chain.append(follow[0])
            del left[follow[0]]
        if len(chain) > 2 and chain[0] in beside[chain[-1]]:
            chain.append(chain[0])
        places = np.array([_place(edge, shares[edge]) for edge in chain])
        if np.ptp(places, axis=0).any():  # not a single grid point that is singular itself
            yield places


def _pairs(i: int, j: int, shares: dict[_Edge, float], measure: Matrix) -> list[tuple[_Edge, _Edge]]:
    """Which crossings of a cell belong together: across its corners where all four sides are crossed."""
    low, right, high, left = (i, j, 1), (i, j + 1, 0), (i + 1, j, 1), (i, j, 0)
    found = [edge for edge in (low, right, high, left) if edge in shares]
    if len(found) == 4:
        middle = float(np.mean(measure[i : i + 2, j : j + 2]))
        alike = (middle >= 0.0) == (measure[i, j] >= 0.0)
        return [(low, right), (high, left)] if alike else [(low, left), (high, right)]
    return [(found[0], found[1])] if len(found) == 2 else []


def _place(edge: _Edge, share: float) -> tuple[float, float]:
    i, j, axis = edge
    return (j + share, float(i)) if axis == 1 else (float(j), i + share)
