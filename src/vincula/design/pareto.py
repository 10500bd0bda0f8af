"""Pareto front: the choices that no other choice beats in everything."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vincula.arrays import Matrix

CHUNK = 256
"""Choices compared with all others at a time."""


def pareto_front(values: Matrix) -> NDArray[np.bool_]:
    """Which rows are on the front: none is at least as good in every column and better in one.

    Args:
        values: One row a choice, one column a criterion, more being better.  A row with NaN is on no front.

    Returns:
        One boolean a row; equal rows are on the front together.
    """
    front: NDArray[np.bool_] = np.asarray(np.isnan(values).sum(axis=1) == 0)
    known = values[front]
    beaten = np.zeros(len(known), dtype=bool)
    for start in range(0, len(known), CHUNK):
        part = known[start : start + CHUNK, np.newaxis, :]
        as_good = np.all(known >= part, axis=2)
        better = np.any(known > part, axis=2)
        beaten[start : start + CHUNK] = np.any(as_good & better, axis=1)
    front[front] = ~beaten
    return front
