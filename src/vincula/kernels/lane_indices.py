"""Indices of ellipsoids in lanes: from semi-axes on chosen components, as `analysis.indices` defines them.

Imported late, and only where numba is installed.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vincula.analysis.indices import components_of_part
from vincula.arrays import Matrix
from vincula.kernels.index_formulas import INDEX_OF_AXES
from vincula.kernels.lane_block import LaneBlock
from vincula.kernels.lane_quantities import Block, Listing, Written
from vincula.kernels.lane_spectra import LaneRelation, certainly, on_rows
from vincula.kernels.lanes import outputs as o
from vincula.kernels.quantities import Quantity
from vincula.kernels.semi_axes import singular_values
from vincula.kernels.small_matrices import decomposed, lengths, products
from vincula.kernels.small_subspaces import cleared, orthonormal
from vincula.numerics.rank import decide_rank


def index_written(quantity: Quantity, listing: Listing) -> Written | str:
    """How lanes write an index; or why only the reference path does.

    Args:
        quantity: The index.
        listing: What its ellipsoid lists.
    """
    sample = listing.sample
    chosen = components_of_part(sample, quantity.on)
    shadow = sample.set.project(chosen)
    lines, axes = shadow.lines.shape[1], shadow.axes.shape[1]
    if listing.direct and not listing.infinite and axes == min(listing.finite, len(chosen)):
        return _of_kernel(quantity, listing, chosen)
    relation = listing.relation()
    if isinstance(relation, str):
        return relation
    if decide_rank(sample.task_weight.factor[:, chosen] @ shadow.lines).rank != lines:
        return "the weights ignore directions in which the set is unbounded"
    return _of_relation(quantity, listing, relation, chosen, lines, axes)


def _of_kernel(quantity: Quantity, listing: Listing, chosen: list[int]) -> Written:
    """An index of a bounded ellipsoid whose finite efficiencies a kernel gives."""
    roots, index = np.diag(listing.sample.task_weight.factor), INDEX_OF_AXES[quantity.part]
    kinematic, size = listing.kind == "kinematic", len(chosen)

    def values(block: LaneBlock) -> Matrix:
        found = block.raw.efficiencies
        return found if kinematic else 1.0 / found[:, ::-1]

    def of_all(block: LaneBlock, out: Block) -> None:
        out[:] = index(_padded(np.sqrt(values(block)), size))

    def of_part(block: LaneBlock, out: Block) -> None:
        raw = block.raw
        sides = raw.twists if kinematic else raw.wrenches
        if sides is None:
            raise RuntimeError("lanes were not asked for directions")
        axes = sides[:, :, chosen] * roots[chosen] * np.sqrt(values(block))[:, :, None]
        certain = block.sure if block.sure.all() else block.sure & np.isfinite(axes).all(axis=(1, 2))
        found = np.full((len(axes), min(axes.shape[1:])), np.nan)
        found[certain] = singular_values(axes[certain])
        largest = lengths(axes).max(axis=1, initial=0.0)
        certainly(found / largest[:, None], found.shape[1], size, block)
        out[:] = index(_padded(found, size))

    return Written(0, writer=of_all) if size == len(roots) else Written(listing.want, writer=of_part)


def _of_relation(
    quantity: Quantity, listing: Listing, relation: LaneRelation, chosen: list[int], lines: int, axes: int
) -> Written:
    """An index of any ellipsoid.

    Args:
        quantity: The index.
        listing: What the ellipsoid lists.
        relation: Its relation.
        chosen: Task components.
        lines: Lines that its shadow on them has.
        axes: Semi-axes that its shadow has.
    """
    factor, index = relation.task.factor[:, chosen], INDEX_OF_AXES[quantity.part]
    size = decide_rank(factor, name="weights of the chosen components").rank
    if not (lines or axes):
        return Written(same=float(index(np.zeros((1, size)))[0]))

    def write(block: LaneBlock, out: Block) -> None:
        found, sure = relation.spectra(block), block.sure
        free = found.infinite[:, : listing.infinite]
        free = free[:, :, chosen] / lengths(free)[:, :, None]
        certainly(decomposed(free, sure)[0], lines, len(chosen), block)
        free = orthonormal(free, sure, lines)
        whole = found.task * found.ratios[:, :, None]
        largest = lengths(whole).max(axis=1, initial=0.0)
        apart = cleared(whole[:, :, chosen], free, sure)
        sizes, turn = decomposed(apart, sure)
        certainly(sizes / largest[:, None], axes, len(chosen), block)
        apart = on_rows(products(turn[:, :axes], apart, sure), factor, block)
        free = on_rows(free, factor, block)
        sizes = decomposed(free, sure)[0]
        certainly(sizes / sizes[:, :1], lines, size, block)
        free = orthonormal(free, sure)
        bounded = decomposed(cleared(apart, free, sure), sure)[0]
        unbounded = np.full((len(sure), lines), np.inf)
        out[:] = index(_padded(np.concatenate([unbounded, bounded], axis=1)[:, :size], size))

    return Written(0 if relation.squeezing is not None else o.MOTIONS | o.REST, writer=write)


def _padded(axes: NDArray[np.float64], size: int) -> NDArray[np.float64]:
    """Semi-axes, zero in the directions that a set does not reach."""
    if axes.shape[1] == size:
        return axes
    return np.concatenate([axes, np.zeros((len(axes), size - axes.shape[1]))], axis=1)
