"""Whole constraint matrices A = [J_a J_p -G^T] (scaled) of many configurations."""

from __future__ import annotations

from vincula.kernels.lanes import tables as t
from vincula.kernels.lanes.frames import place_all
from vincula.kernels.lanes.jit import Code, Lane, Slots, kernel
from vincula.kernels.lanes.rows import joint_entries, member_entries, slopes


@kernel
def dense_matrix(
    w: Slots, code: Code, constants: Slots, base: int, columns: int, target: int, z: Lane
) -> None:
    """A by columns at `target`, m slots a column; frames are placed on the way.

    Args:
        w: The workspace, values entered.
        code: Tables.
        constants: Constants.
        base: See `frames.place_all`.
        columns: Where in `code` the list of all columns is.
        target: First slot.
        z: Zero.
    """
    place_all(w, code, constants, base, z)
    slopes(w, code, constants, base, z)
    dense_rows(w, code, constants, base, columns, target, z)


@kernel
def dense_rows(w: Slots, code: Code, constants: Slots, base: int, columns: int, target: int, z: Lane) -> None:
    """The same where frames and slopes are known."""
    m, n = code[t.ROWS], code[t.COLUMNS]
    for block in range(code[t.BLOCKS]):
        first = code[code[t.BLOCK] + t.BLOCK_ENTRY * block]
        joint_entries(w, code, constants, base, block, columns, n, target + first, m, z)
        member_entries(w, code, base, block, target + n * m + first, m, z)
