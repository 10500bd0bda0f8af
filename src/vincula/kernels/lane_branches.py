"""Signed measures of branches in lanes: what `mechanism.branches` says, for stacks of whole matrices.

LAPACK decomposes the blocks of a stack one after the other, so a lane's numbers do not depend on the others.
Lanes in which a rank could be decided otherwise by the reference path are handed to it.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from vincula.arrays import Matrix, Vector
from vincula.kernels.lanes.threads import pool
from vincula.kernels.quantities import SIDE_OF
from vincula.kernels.reference_path import Arrays
from vincula.mechanism.branches import CLEAR, Sided, sided_groups
from vincula.mechanism.residuals import CLOSED
from vincula.numerics.rank import rounding_unit

if TYPE_CHECKING:
    from vincula.kernels.lane_path import LanePath

AT_ONCE: Final = 1 << 18
"""Numbers of whole matrices that are held at a time."""
ROOM: Final = 2.0
"""How far from a decision, as a factor, a lane must be to be decided here."""

Stack = NDArray[np.float64]


def asks_for_branches(names: Iterable[str]) -> bool:
    """Whether any of these quantities are measures of branches."""
    return any(name in SIDE_OF for name in names)


def write_branches(
    path: LanePath, values: Matrix, lanes: NDArray[np.intp], arrays: Arrays, threads: int
) -> NDArray[np.intp]:
    """Write the measures of lanes that are certain.

    Args:
        path: The mechanism in lanes.
        values: N x coordinates.
        lanes: The lanes.
        arrays: One array a quantity.
        threads: Threads to use.

    Returns:
        Those of the lanes that must go to the reference path after all.
    """
    mechanism = path.mechanism
    sides = {name: sided_groups(mechanism)[side] for name, side in SIDE_OF.items() if name in arrays}
    size = len(mechanism.layout.rows) * (len(mechanism.layout.columns) + mechanism.space.dimension)
    step = max(1, AT_ONCE // max(1, size))
    # A gap of a loop that counts as closed can hide singular values up to this (see `watching.decided`).
    hidden = ROOM * math.sqrt(2.0 * CLOSED * max(1.0, mechanism.length))

    def slab(first: int) -> NDArray[np.intp]:
        some = lanes[first : first + step]
        matrices = path.program.matrices(values[some])
        scale = np.linalg.svd(matrices, compute_uv=False)[:, 0]
        sure = np.ones(len(some), dtype=bool)
        for name, groups in sides.items():
            for k, one in enumerate(groups):
                found, certain = _measures(one, matrices, hidden)
                arrays[name][some, k] = found / scale
                sure &= certain
        return some[~sure]

    starts = range(0, len(lanes), step)
    several = threads > 1 and len(starts) > 1
    left = list(pool(threads).map(slab, starts) if several else map(slab, starts))
    return np.concatenate(left) if left else lanes[:0]


def _measures(one: Sided, matrices: Stack, hidden: float) -> tuple[Vector, NDArray[np.bool_]]:
    """Measures of one group, not yet relative to anything, and in which lanes they are certain."""
    blocks = np.ascontiguousarray(matrices[:, one.group.rows][:, :, one.group.columns])
    if one.left is None or one.right is None:
        return np.full(len(blocks), np.nan), np.zeros(len(blocks), dtype=bool)
    rank = one.left.shape[1]
    values = np.linalg.svd(blocks, compute_uv=False)
    rounding = (values[:, 0] if rank else 0.0) * rounding_unit(*blocks.shape[1:])
    kept = values[:, rank - 1] if rank else np.full(len(blocks), np.inf)
    beyond = values[:, rank] if rank < values.shape[1] else np.zeros(len(blocks))
    sure = (kept > hidden) & (kept > 2.0 * ROOM * rounding) & (beyond * ROOM <= rounding)
    reduced = one.left.T @ blocks @ one.right
    found = np.copysign(kept, np.linalg.slogdet(reduced)[0])
    if rank and not one.square:
        share = np.linalg.svd(reduced, compute_uv=False)[:, -1] / kept
        found[share < CLEAR] = np.nan
        sure &= (share * ROOM < CLEAR) | (share > ROOM * CLEAR)
    return found, sure
