"""How kernels are compiled, and the names of their argument types.

No fast arithmetic: it breaks infinities and NaN, and reassociation would make results depend on the
number of lanes.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import numba
import numpy as np
from numpy.typing import NDArray

from vincula.kernels.lanes.tables import Code

__all__ = ["Code", "Lane", "Slots", "kernel"]

Slots = NDArray[np.float64]
"""A workspace: slot i of W lanes is at [i W, (i + 1) W)."""
Lane = Any
"""A vector of lanes; the last argument of every kernel is a zero that gives their number."""

OPTIONS = {"error_model": "numpy", "nogil": True, "no_cpython_wrapper": True, "no_cfunc_wrapper": True}
"""Division by zero gives infinities; kernels call each other only, so they need no wrappers for Python."""

F = TypeVar("F", bound=Callable[..., Any])


def kernel(function: F) -> F:
    """A function of kernels, compiled into every kernel that calls it."""
    compiled: F = numba.njit(**OPTIONS)(function)
    return compiled
