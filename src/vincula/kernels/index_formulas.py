"""Indices as functions of semi-axes, for many sets at once; single ones are in `analysis.indices`."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np
from numpy.typing import NDArray

from vincula.arrays import Vector


def _volume(axes: NDArray[np.float64]) -> Vector:
    return np.asarray(np.where(axes[:, -1] == 0.0, 0.0, np.prod(axes, axis=1)))


def _condition(axes: NDArray[np.float64]) -> Vector:
    flat, unbounded = axes[:, -1] == 0.0, np.isinf(axes[:, 0])
    neither = unbounded & (flat | np.isinf(axes[:, -1]))
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(np.where(neither, np.nan, np.where(flat, np.inf, axes[:, 0] / axes[:, -1])))


def _isotropy(axes: NDArray[np.float64]) -> Vector:
    squares = axes**2
    with np.errstate(divide="ignore", invalid="ignore"):
        found = np.exp(np.mean(np.log(squares), axis=1)) / np.mean(squares, axis=1)
    return np.asarray(np.where(np.isinf(axes[:, 0]), np.nan, np.where(squares[:, -1] == 0.0, 0.0, found)))


INDEX_OF_AXES: Final[dict[str, Callable[[NDArray[np.float64]], Vector]]] = {
    "yoshikawa_volume": _volume,
    "condition": _condition,
    "condition_number": _condition,
    "inverse_condition_number": lambda axes: 1.0 / _condition(axes),
    "isotropy": _isotropy,
    "smallest_singular_value": lambda axes: np.asarray(axes[:, -1]),
}
"""Indices of N x semi-axes, longest first: inf for lines, 0 for directions that are not reached."""
