"""One thread for the BLAS that LAPACK runs on, while many small matrices are decomposed one after another.

OpenBLAS wakes a thread a core for a few hundred numbers; where the cores are busy these wait for each other,
and a decomposition of 0.2 ms takes 15.  There is no portable switch: the OpenBLAS of numpy and scipy is
asked by the names of its functions, any other library is left as it is.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import lru_cache
from typing import Any, Final

NAMES: Final = ("scipy_openblas_{}_num_threads", "openblas_{}_num_threads")
"""What OpenBLAS calls its switch: in the wheels of numpy and scipy, and elsewhere."""
WIDTHS: Final = ("", "64_")
"""What stands behind the name where the library counts with 64 bits."""


@contextmanager
def one_blas_thread() -> Iterator[None]:
    """Within it BLAS uses one thread, for the whole process; the number before is put back."""
    switches = _switches()
    before = [get() for get, _ in switches]
    for _, put in switches:
        put(1)
    try:
        yield
    finally:
        for (_, put), number in zip(switches, before, strict=True):
            put(number)


@lru_cache(maxsize=1)
def _switches() -> tuple[tuple[Callable[[], int], Callable[[int], Any]], ...]:
    """Functions that tell and set the number of threads, one pair a library found."""
    import numpy.linalg._umath_linalg as of_numpy
    from scipy.linalg import _flapack as of_scipy

    found = []
    for module in (of_scipy, of_numpy):
        try:
            library = ctypes.CDLL(module.__file__)
        except OSError:
            continue
        for name in (name + width for name in NAMES for width in WIDTHS):
            # A symbol is looked for in the module and in every library that it needs.
            get = getattr(library, name.format("get"), None)
            put = getattr(library, name.format("set"), None)
            if get is not None and put is not None:
                found.append((get, put))
                break
    return tuple(found)
