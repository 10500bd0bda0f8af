"""A block of W configurations in the workspace: values in, numbers out, one aligned workspace a thread."""

from __future__ import annotations

import numpy as np

from vincula.kernels.lanes import tables as t
from vincula.kernels.lanes.frames import constant, enter_constants
from vincula.kernels.lanes.jit import Code, Lane, Slots, kernel
from vincula.kernels.lanes.vector import load, store

LINE = 8
"""Doubles in a line of the cache; the workspace begins at one."""


@kernel
def aligned(slots: int, width: int) -> Slots:
    """An aligned workspace."""
    room = np.empty(slots * width + LINE)
    start = (LINE - (room.ctypes.data // 8) % LINE) % LINE
    return room[start : start + slots * width]


@kernel
def enter(
    w: Slots, code: Code, constants: Slots, base: int, values: Slots, block: int, width: int, z: Lane
) -> None:
    """Copy the values of one block into the workspace, scaled; missing lanes repeat the last one.

    Args:
        w: The workspace.
        code: Tables.
        constants: Constants; with two dimensions those of the block are copied as well.
        base: See `frames.place_all`.
        values: N x values.
        block: The block: configurations block W ... block W + W - 1.
        width: W.
        z: Zero.
    """
    last = values.shape[0] - 1
    first = (base + code[t.VALUE_SLOT]) * width
    for lane in range(width):
        source = min(block * width + lane, last)
        for k in range(code[t.VALUES]):
            w[first + k * width + lane] = values[source, k]
    enter_constants(w, constants, block, width)
    scale_values(w, code, constants, base, z)


@kernel
def leave(w: Slots, slot: int, count: int, out: Slots, first: int, width: int) -> None:
    """Copy `count` slots to rows of `out`, one a lane, from row `first` on; what exceeds is left out."""
    for lane in range(min(width, out.shape[0] - first)):
        for k in range(count):
            out[first + lane, k] = w[(slot + k) * width + lane]


@kernel
def scale_values(w: Slots, code: Code, constants: Slots, base: int, z: Lane) -> None:
    """Divide values in metres by the characteristic length."""
    scales = code[t.VALUE_SCALE]
    for k in range(code[t.VALUES]):
        scale = code[scales + k]
        if scale >= 0:
            slot = base + code[t.VALUE_SLOT] + k
            store(w, slot, load(w, slot, z) * constant(constants, w, scale, z))
