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

from vincula.kernels.lanes import outputs as o
from vincula.kernels.lanes import tables as t
from vincula.kernels.lanes.angles import measure, rotate_all
from vincula.kernels.lanes.certificates import certain_ranks, certify_twists
from vincula.kernels.lanes.delivery import COPY, PART, deliver, fence, pass_on
from vincula.kernels.lanes.dense import dense_matrix
from vincula.kernels.lanes.elimination import eliminate
from vincula.kernels.lanes.frames import borrowed, place_all
from vincula.kernels.lanes.gaps import note_gaps
from vincula.kernels.lanes.jit import Code, Lane, Slots, kernel
from vincula.kernels.lanes.ranks import certain_counts
from vincula.kernels.lanes.relation import relate
from vincula.kernels.lanes.results import finish
from vincula.kernels.lanes.rows import slopes
from vincula.kernels.lanes.vector import first_of, zeros
from vincula.kernels.lanes.workspace import aligned, enter

_OPTIONS = {"error_model": "numpy", "nogil": True, "cache": True}


SPECTRA = (
    "angles certificates chains delivery dense elimination entries frames gaps jit outputs ranks reflections "
    "relation results rows tables trigonometry vector workspace"
)
"""Sources that the entries of this file are made of."""


@lru_cache(maxsize=4)
def fingerprint(sources: str = "") -> str:
    """A digest of kernel sources and of the compiler's version.

    Args:
        sources: Names of the files, separated by spaces; all of this folder by default.
    """
    digest = hashlib.sha256(f"{numba.__version__} {llvmlite.__version__}".encode())
    folder = Path(__file__).parent
    names = [f"{name}.py" for name in sources.split()] or sorted(path.name for path in folder.glob("*.py"))
    for name in names:
        digest.update((folder / name).read_bytes())
    return digest.hexdigest()[:16]


@lru_cache(maxsize=1)
def lanes_of_this_machine() -> int:
    """How many lanes to run side by side: two registers of the widest kind."""
    from llvmlite import binding

    return 16 if binding.get_host_cpu_features().get("avx512f") else 8


@lru_cache(maxsize=4)
def dense_entry(width: int) -> Any:
    """Whole matrices: (values, code, constants, base, columns, slots, out), out N x m x (n + d)."""
    stamp = fingerprint(SPECTRA)

    @numba.njit(**_OPTIONS)
    def run(
        values: Slots, tables: Code, numbers: Slots, base: int, columns: int, slots: int, out: Any
    ) -> str:
        z = zeros(width)
        room = aligned(slots, width)
        w, code, constants = first_of(room), first_of(tables), borrowed(numbers)
        m, n = code[t.ROWS], code[t.COLUMNS] + code[t.TWIST]
        target = base + code[t.SLOTS]
        for block in range((values.shape[0] + width - 1) // width):
            enter(w, code, constants, base, values, block, width, z)
            dense_matrix(w, code, constants, base, columns, target, z)
            for lane in range(min(width, values.shape[0] - block * width)):
                for c in range(n):
                    for r in range(m):
                        out[block * width + lane, r, c] = w[(target + c * m + r) * width + lane]
        room[0] = 0.0  # alive until here
        return stamp

    return run


@kernel
def spectra(w: Slots, code: Code, constants: Slots, base: int, want: int, widest: float, z: Lane) -> None:
    """Everything for one block of configurations whose values are in the workspace."""
    place_all(w, code, constants, base, z)
    slopes(w, code, constants, base, z)
    eliminate(w, code, constants, base, z)
    note_gaps(w, code, constants, base, z)
    certify_twists(w, code, base, z)
    certain = certain_ranks(w, code, constants, base, z)
    if want & o.COUNTS:
        certain = certain * certain_counts(w, code, constants, base, z)
    relate(w, code, constants, base, z)
    settled = rotate_all(w, code, base, z)
    size = code[t.MOTORS] + code[t.TWIST]
    measure(w, base + code[t.MOTIONS], base + code[t.SQUARES], code[t.FREEDOM], code[t.MOTORS], size, z)
    finish(w, code, constants, base, certain, settled, want, widest, z)


@lru_cache(maxsize=4)
def spectra_entry(width: int) -> Any:
    """Spectra of blocks first ... last - 1 of `width` configurations each.

    The function takes: values (N x values), tables, constants, first slot after constants that differ from
    lane to lane, what is wanted, the widest gap that is measured well, first and last block; then where
    results go: the two tables of `delivery`, and a status of every configuration.
    """
    stamp = fingerprint(SPECTRA)

    @numba.njit(**_OPTIONS)
    def run(
        values: Slots, tables: Code, numbers: Slots, base: int, want: int, widest: float,
        first: int, last: int, parts: Code, copies: Code, status: Any,
    ) -> str:  # fmt: skip
        z = zeros(width)
        room = aligned(base + (tables[t.TOTAL_WITH_COUNTS] if want & o.COUNTS else tables[t.TOTAL]), width)
        w, code, constants, table = first_of(room), first_of(tables), borrowed(numbers), first_of(parts)
        output, count = base + code[t.OUTPUT], len(parts) // PART
        further, streams = first_of(copies), len(copies) // COPY
        for block in range(first, last):
            enter(w, code, constants, base, values, block, width, z)
            spectra(w, code, constants, base, want, widest, z)
            row = block * width
            lanes = min(width, len(values) - row)
            if streams > 0:
                deliver(w, output, table, count, 0, lanes, width, z)
                pass_on(further, streams, row, lanes)
            else:
                deliver(w, output, table, count, row, lanes, width, z)
            for lane in range(lanes):
                status[row + lane] = int(w[(output + o.STATUS) * width + lane])
        if streams > 0:
            fence()
        room[0] = 0.0  # alive until here
        return stamp

    return run
