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
    missing: NDArray[np.bool_] = np.isnan(values)
    front = np.array([not row.any() for row in missing], dtype=np.bool_)
    known = values[front]
    beaten = np.zeros(len(known), dtype=bool)
    for start in range(0, len(known), CHUNK):
        part = known[start : start + CHUNK, np.newaxis, :]
        as_good = (known >= part).all(axis=2)
        beaten[start : start + CHUNK] = (as_good & (known > part).any(axis=2)).any(axis=1)
    front[front] = ~beaten
    return front
