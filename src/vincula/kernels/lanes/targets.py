"""Where kernels write: tables of addresses, see `delivery`."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final

import numpy as np
from numpy.typing import NDArray

NOTHING: Final = np.zeros(0, dtype=np.int64)


@dataclass(frozen=True, slots=True, eq=False)
class Tables:
    """The tables of one call.

    Attributes:
        parts: What goes where.
        copies: What goes on from there past the caches; used by one thread.
        kept: Memory in between, which lives as long as the tables.
    """

    parts: NDArray[np.int64]
    copies: NDArray[np.int64] = field(default_factory=lambda: NOTHING)
    kept: NDArray[np.float64] | None = None


def address(array: NDArray[np.float64]) -> int:
    """Where the first number of an array is."""
    found: int = array.__array_interface__["data"][0]
    return found
