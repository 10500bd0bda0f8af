"""Distances to singularities: chosen singular values of the matrices of every configuration, in lanes."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numba

from vincula.kernels.lanes import tables as t
from vincula.kernels.lanes.dense import dense_matrix
from vincula.kernels.lanes.entries import fingerprint
from vincula.kernels.lanes.frames import borrowed
from vincula.kernels.lanes.jit import Code, Slots
from vincula.kernels.lanes.singular import bidiagonalise, side_by_side, singular_value
from vincula.kernels.lanes.vector import first_of, load, store, zeros
from vincula.kernels.lanes.workspace import aligned, enter, leave

_OPTIONS = {"error_model": "numpy", "nogil": True, "cache": True}

SOURCES = "dense distance_entry frames jit reflections rows singular tables trigonometry vector workspace"
MATRIX = 3
"""Entries of one matrix: first column, column after the last, which value (1 the largest, 0 none)."""


@lru_cache(maxsize=4)
def distance_entry(width: int) -> Any:
    """Singular values: (values, code, constants, base, columns, matrices, out).

    `columns` is where in `code` the list of all columns is, `matrices` `MATRIX` entries a matrix, and out
    N x matrices.
    """
    stamp = fingerprint(SOURCES)

    @numba.njit(**_OPTIONS)
    def run(
        values: Slots, tables: Code, numbers: Slots, base: int, columns: int, matrices: Code, out: Slots
    ) -> str:
        z = zeros(width)
        m, n = tables[t.ROWS], tables[t.COLUMNS] + tables[t.TWIST]
        count, longest = len(matrices) // MATRIX, max(m, n)
        whole = base + tables[t.SLOTS]
        part = whole + m * n
        squares = part + m * n
        spare = squares + 2 * longest
        found = spare + longest + 3
        room = aligned(found + count, width)
        w, code, constants = first_of(room), first_of(tables), borrowed(numbers)
        for block in range((values.shape[0] + width - 1) // width):
            enter(w, code, constants, base, values, block, width, z)
            dense_matrix(w, code, constants, base, columns, whole, z)
            for k in range(count):
                first, last, rank = matrices[MATRIX * k], matrices[MATRIX * k + 1], matrices[MATRIX * k + 2]
                p, q = min(m, last - first), max(m, last - first)
                if rank > 0:
                    side_by_side(w, whole + first * m, m, last - first, part, z)
                    bidiagonalise(w, part, p, q, squares, spare, z)
                    store(w, found + k, singular_value(w, squares, p, rank, z))
                else:
                    store(w, found + k, load(w, whole, z))
            leave(w, found, count, out, block * width, width)
        room[0] = 0.0  # alive until here
        return stamp

    return run
