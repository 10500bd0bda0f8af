"""Distances to singularities of many configurations: what `samples.distances` says, in lanes.

Imported late, and only where numba is installed.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from vincula.arrays import Matrix
from vincula.kernels.lane_block import LaneBlock
from vincula.kernels.lanes import tables as t
from vincula.kernels.lanes.program import LaneProgram, singular_values_of


def distance_writer(program: LaneProgram, ranks: Sequence[int]) -> Callable[[LaneBlock, Matrix], None]:
    """What writes distances, N x 4.

    Args:
        program: The program.
        ranks: Ranks of the `WATCHED` matrices in general.
    """
    motors, joints = int(program.code[t.MOTORS]), int(program.code[t.COLUMNS])
    rows, last = int(program.code[t.ROWS]), joints + int(program.code[t.TWIST])
    spans = ((motors, joints), (0, joints), (motors, last), (0, last))
    known = [0 < rank <= min(rows, two - one) for rank, (one, two) in zip(ranks, spans, strict=True)]
    table = [(one, two, rank) for (one, two), rank, ok in zip(spans, ranks, known, strict=True) if ok]
    # The last one is what the others are relative to: the largest singular value of the whole matrix.
    table.append((0, last, 1 if min(rows, last) else 0))

    def write(block: LaneBlock, out: Matrix) -> None:
        values = singular_values_of(block.program, block.values, block.constants, np.array(table, np.int64))
        scale = np.where(values[:, -1] == 0.0, 1.0, values[:, -1])
        out[...] = np.inf
        out[:, known] = values[:, :-1] / scale[:, None]

    return write
