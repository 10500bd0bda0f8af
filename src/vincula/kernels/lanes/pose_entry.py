"""Where the reference member is: its frame in ground axes, in lanes."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numba

from vincula.kernels.lanes import tables as t
from vincula.kernels.lanes.entries import fingerprint
from vincula.kernels.lanes.frames import borrowed, place_all
from vincula.kernels.lanes.jit import Code, Slots
from vincula.kernels.lanes.vector import first_of, zeros
from vincula.kernels.lanes.workspace import aligned, enter, leave

_OPTIONS = {"error_model": "numpy", "nogil": True, "cache": True}


@lru_cache(maxsize=4)
def pose_entry(width: int) -> Any:
    """Frames: (values, code, constants, base, out), out N x 12: rotation by rows, origin in lengths L."""
    stamp = fingerprint("frames jit pose_entry tables trigonometry vector workspace")

    @numba.njit(**_OPTIONS)
    def run(values: Slots, tables: Code, numbers: Slots, base: int, out: Slots) -> str:
        z = zeros(width)
        room = aligned(base + tables[t.SLOTS], width)
        w, code, constants = first_of(room), first_of(tables), borrowed(numbers)
        for block in range((values.shape[0] + width - 1) // width):
            enter(w, code, constants, base, values, block, width, z)
            place_all(w, code, constants, base, z)
            leave(w, base + code[t.REFERENCE], 12, out, block * width, width)
        room[0] = 0.0  # alive until here
        return stamp

    return run
