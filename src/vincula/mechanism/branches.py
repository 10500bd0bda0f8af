"""Names of assembly branches, and signed measures of how far away their borders are.

Two configurations with the same motor positions are on different branches when a singularity lies
between them.  A branch is named by signs of determinants: with the motors locked (assembly: which side
the platform is on) and with the reference member locked (working: which way every leg is bent), one
sign an independent group of loops, plus meaning "as at home".  The measure of a group is that sign times
the smallest singular value that its block keeps, so it passes through zero where the sides meet.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Final

import numpy as np

from vincula.arrays import Matrix, Vector
from vincula.errors import ClosureError
from vincula.mechanism.branch_groups import SIDES, Group, Side, branch_groups
from vincula.mechanism.configuration import Configuration
from vincula.mechanism.samples import sample_configurations
from vincula.mechanism.watching import decided, measured
from vincula.model import LinearModel
from vincula.numerics.lapack import singular_values

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism

CLEAR: Final = 1e-3
"""A reduced determinant whose smallest factor is below this share of the regular one names no side."""


@dataclass(frozen=True, slots=True)
class Branch:
    """The name of an assembly branch.

    Attributes:
        assembly: Signs with the motors locked: + as at home, - other side, 0 singular, ? no sign.
        working: Signs with the reference member locked.
    """

    assembly: str
    working: str

    def __str__(self) -> str:
        return f"assembly {self.assembly or 'none'}, working {self.working or 'none'}"


@dataclass(frozen=True, slots=True, eq=False)
class Sided:
    """A group with what its signs are told against.

    Attributes:
        group: Its rows and columns.
        left: Orthonormal basis of its range where signs are plus, rows x rank; None where nothing is known.
        right: Orthonormal basis of the complement of its kernel there, columns x rank.
    """

    group: Group
    left: Matrix | None
    right: Matrix | None

    @property
    def rank(self) -> int | None:
        """Its rank in general, if it is known."""
        return None if self.left is None else self.left.shape[1]

    @property
    def square(self) -> bool:
        """Whether it has as many rows as columns and all are independent: it then has a determinant."""
        return len(self.group.rows) == len(self.group.columns) == self.rank

    def block(self, matrix: Matrix) -> Matrix:
        """Its block of [J_a J_p -G^T]."""
        return np.asarray(matrix[np.ix_(self.group.rows, self.group.columns)])


def branch_of(mechanism: Mechanism, q: Configuration) -> Branch:
    """The branch of a closed configuration; no signs where no reference member is named."""
    if mechanism.reference is None:
        return Branch("", "")
    here = mechanism.linearize(q)
    signs = {side: "".join(_word(m) for m in branch_measures(mechanism, here, side)) for side in SIDES}
    return Branch(signs["assembly"], signs["working"])


def branch_measures(mechanism: Mechanism, model: LinearModel, side: Side) -> Vector:
    """Signed measures of all groups of a side at one configuration.

    Sign times the smallest singular value that the group's block has in general, over the largest of
    [J_a J_p -G^T]: 0 on a singularity, NaN where no sign can be told, infinity where no rank can be lost.

    Args:
        mechanism: The mechanism.
        model: Its matrices at the configuration.
        side: `assembly` or `working`.
    """
    scale = model.ledger.scale or 1.0
    matrix, residual = model.ledger.matrix("all"), model.uncertainty.residual
    found = [_measure(one, one.block(matrix), residual) for one in sided_groups(mechanism)[side]]
    return np.array(found) / scale


@lru_cache(maxsize=16)
def sided_groups(mechanism: Mechanism) -> dict[Side, tuple[Sided, ...]]:
    """The groups of a mechanism with the bases that their signs are told against, made once.

    They are taken at home.  Where home is open, or singular in a group, a closed configuration near it
    stands for home there; where none is found, signs are those of plain determinants.
    """
    groups = branch_groups(mechanism)
    try:
        known = [mechanism.linearize().ledger.matrix("all")]
    except ClosureError:
        known = []
    if not known or any(_may_have_lost(g, known[0]) for side in SIDES for g in groups[side]):
        known = [mechanism.linearize(q).ledger.matrix("all") for q in sample_configurations(mechanism)]
    return {side: tuple(_sided(group, known) for group in groups[side]) for side in SIDES}


def _may_have_lost(group: Group, matrix: Matrix) -> bool:
    """Whether the block of a group could have a higher rank elsewhere."""
    block = matrix[np.ix_(group.rows, group.columns)]
    return bool(decided(block, 0.0).rank < min(block.shape))


def _sided(group: Group, known: list[Matrix]) -> Sided:
    """A group against the first of some configurations at which its rank is highest."""
    if not known:
        return Sided(group, None, None)
    blocks = [matrix[np.ix_(group.rows, group.columns)] for matrix in known]
    ranks = [decided(block, 0.0).rank for block in blocks]
    rank = max(ranks)
    base = measured(blocks[ranks.index(rank)], rank)
    return Sided(group, base.left[:, :rank], base.right[:, :rank])


def _measure(one: Sided, block: Matrix, residual: float) -> float:
    """The signed measure of a group, not yet relative to anything."""
    values = singular_values(block)
    rank = decided(block, residual, values).rank
    if one.left is None or one.right is None or rank > one.left.shape[1]:
        full = block.shape[0] == block.shape[1] == rank
        return float(np.linalg.slogdet(block)[0]) * _smallest(values, rank) if full else math.nan
    generic = one.left.shape[1]
    if rank < generic:
        return 0.0
    kept, reduced = _smallest(values, generic), one.left.T @ block @ one.right
    if generic and not one.square and singular_values(reduced)[-1] < CLEAR * kept:
        return math.nan
    return math.copysign(kept, float(np.linalg.slogdet(reduced)[0]))


def _smallest(values: Vector, rank: int) -> float:
    """The smallest singular value that is kept; infinity where none is."""
    return float(values[rank - 1]) if rank else math.inf


def _word(measure: float) -> str:
    if math.isnan(measure):
        return "?"
    return "0" if measure == 0.0 else "+" if measure > 0.0 else "-"
