"""The few functions that Python calls, compiled once a machine and kept on disk.

numba's own cache looks at the file of the cached function only, so an edit in a file it calls would go
unnoticed.  Therefore only entries are cached, and each closes over a fingerprint of all kernel sources:
another fingerprint is another entry.
"""

from __future__ import annotations

import hashlib
from functools import lru_cache
from pathlib import Path
from typing import Any

import llvmlite
import numba

from vincula.kernels.lanes import tables as t
from vincula.kernels.lanes.dense import dense_matrix
from vincula.kernels.lanes.jit import Code, Slots
from vincula.kernels.lanes.vector import zero_of
from vincula.kernels.lanes.workspace import aligned, enter

_OPTIONS = {"error_model": "numpy", "nogil": True, "cache": True}


@lru_cache(maxsize=1)
def fingerprint() -> str:
    """A digest of all kernel sources and of the compiler's version."""
    digest = hashlib.sha256(f"{numba.__version__} {llvmlite.__version__}".encode())
    for path in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


@lru_cache(maxsize=1)
def lanes_of_this_machine() -> int:
    """How many lanes to run side by side: two registers of the widest kind."""
    from llvmlite import binding

    return 16 if binding.get_host_cpu_features().get("avx512f") else 8


@lru_cache(maxsize=4)
def dense_entry(width: int) -> Any:
    """Whole matrices: (values, code, constants, base, columns, slots, out), out N x m x (n + d)."""
    zero, stamp = zero_of(width), fingerprint()

    @numba.njit(**_OPTIONS)
    def run(
        values: Slots, code: Code, constants: Slots, base: int, columns: int, slots: int, out: Any
    ) -> str:
        z = zero()
        w = aligned(slots, width)
        m, n = code[t.ROWS], code[t.COLUMNS] + code[t.TWIST]
        target = base + code[t.SLOTS]
        for block in range((values.shape[0] + width - 1) // width):
            enter(w, code, constants, base, values, block, width, z)
            dense_matrix(w, code, constants, base, columns, target, z)
            for lane in range(min(width, values.shape[0] - block * width)):
                for c in range(n):
                    for r in range(m):
                        out[block * width + lane, r, c] = w[(target + c * m + r) * width + lane]
        return stamp

    return run
