"""Batches of several dimensions closed in lanes on one branch.

The first configurations of all rows are closed like a batch of one dimension less, then every row from its
first one.  Beyond a gap (a hole in what is reachable, a concave edge) the straight way along a row ends, and
a search would lead to any branch: what lies there is closed from a neighbour in another row instead, as far
as the branch of the start reaches.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vincula.arrays import Matrix

if TYPE_CHECKING:
    from vincula.kernels.lanes.closing import ClosedLanes, LaneClosing
    from vincula.mechanism.configuration import Configuration

Numbers = NDArray[np.int64]
Mask = NDArray[np.bool_]


def closed_grid(
    closing: LaneClosing, inputs: Matrix, shape: tuple[int, ...], start: Configuration, threads: int
) -> ClosedLanes:
    """Close a batch from one start, each configuration from a neighbour.

    Args:
        closing: The closing.
        inputs: Motor values or poses, one a configuration in row-major order.
        shape: Dimensions of the batch.
        start: A closed configuration, from which the first of all is closed.
        threads: Threads to use.
    """
    found, lost = _in_rows(closing, inputs, shape, start, threads)
    if found.closed.all() and not lost.any():
        return found
    return _spread(closing, inputs, shape, found, found.closed & ~lost, threads)


def _in_rows(
    closing: LaneClosing, inputs: Matrix, shape: tuple[int, ...], start: Configuration, threads: int
) -> tuple[ClosedLanes, Mask]:
    """Rows closed from their first configurations, and which lanes may have lost the branch of the start."""
    stretch = shape[-1] if shape else 1
    rows = len(inputs) // max(stretch, 1)
    if rows <= 1:
        found = closing.run(inputs, start, stretch, threads)
        lost = np.logical_or.accumulate(found.jumped) if found.jumped.any() else found.jumped
        return found, lost
    heads = slice(None, None, stretch)
    first, lost = _in_rows(closing, inputs[heads], shape[:-1], start, threads)
    given = np.array(inputs[heads])
    open_ = np.flatnonzero(~first.closed & ~first.jumped)  # they stand where the one before them stood
    given[open_] = closing.given_rows(first.values[open_])
    found = closing.run_rows(inputs, first.values, given, stretch, threads)
    found.steps[heads] += first.steps
    jumped = np.logical_or.accumulate(found.jumped.reshape(rows, stretch), axis=1)
    return found, (jumped | lost[:, None]).ravel()


def _spread(
    closing: LaneClosing, inputs: Matrix, shape: tuple[int, ...], found: ClosedLanes, sure: Mask, threads: int
) -> ClosedLanes:
    """Close what is not surely on the branch from neighbours that are, and go on from there."""
    values, steps, residual = found.values, found.steps, found.residual
    closed, jumped = found.closed.copy(), found.jumped.copy()
    todo = _pairs(np.flatnonzero(sure), shape)
    while True:
        todo = todo[~sure[todo[:, 1]]]
        if not len(todo):
            return replace(found, closed=closed, jumped=jumped)
        _, once = np.unique(todo[:, 1], return_index=True)
        now, todo = todo[once], np.delete(todo, once, axis=0)
        near, lanes = now.T
        tried = closing.run_rows(inputs[lanes], values[near], inputs[near], 1, threads)
        reached = lanes[tried.closed]
        sure[reached], closed[reached], jumped[reached] = True, True, False
        values[reached], steps[reached] = tried.values[tried.closed], tried.steps[tried.closed]
        residual[reached] = tried.residual[tried.closed]
        todo = np.concatenate([todo, _pairs(reached, shape)])


def _pairs(numbers: Numbers, shape: tuple[int, ...]) -> Numbers:
    """Places in a grid, each with every neighbour that it has, m x 2, by their row-major numbers."""
    places = np.stack(np.unravel_index(numbers, shape), axis=1)
    pairs, stride = [], 1
    for axis in reversed(range(len(shape))):
        for way, inside in ((-1, places[:, axis] > 0), (1, places[:, axis] < shape[axis] - 1)):
            pairs.append(np.stack([numbers[inside], numbers[inside] + way * stride], axis=1))
        stride *= shape[axis]
    return np.concatenate(pairs)
