"""Ranks and orders of the elimination, found once at sample configurations.

Lanes cannot pivot, so every order of rows and columns is fixed here: at the sample where it is best
conditioned.  Whether a rank found here holds at another configuration is certified there.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vincula.arrays import Matrix
from vincula.kernels.lanes.structure import Group, Structure, next_front
from vincula.numerics.lapack import pivots, qr_full, singular_values
from vincula.numerics.rank import decide_rank


@dataclass(slots=True, eq=False)
class Front:
    """One step of the elimination of passive joints.

    Attributes:
        blocks: Row blocks that enter here.
        children: Fronts whose rows enter here.
        columns: Joint columns: pivots first, then the others.
        pivots: How many of them are eliminated here.
        rows: Number of rows.
        rank: Rank of the pivot columns.
        member: Whether there are columns of the member's twist, after the others.
        order: Positions of columns in the order of reflections, the independent pivots first.
        reflections: How many reflections are made.
        handed: Rows handed on.
        left: Whether these are products with left null vectors; otherwise reflected rows.
        limb: The limb.
        root: Whether what is handed on are the reduced rows of the limb.
    """

    blocks: list[int]
    children: list[int]
    columns: list[int]
    pivots: int
    rows: int
    rank: int
    member: bool
    order: list[int]
    reflections: int
    handed: int
    left: bool
    limb: int
    root: bool


@dataclass(slots=True, eq=False)
class Samples:
    """Matrices A = [J_a J_p -G^T] at sample configurations, with their sizes.

    Attributes:
        matrices: m x (n_a + n_p + d) matrices, scaled.
        scales: Their largest singular values.
    """

    matrices: list[Matrix]
    scales: list[float]

    @staticmethod
    def of(matrices: Sequence[Matrix]) -> Samples:
        """Samples with their sizes."""
        return Samples(list(matrices), [float(max(singular_values(m), default=0.0)) for m in matrices])

    def __len__(self) -> int:
        return len(self.matrices)


def ordered(blocks: Sequence[Matrix], scales: Sequence[float]) -> tuple[int, list[int]]:
    """Rank of a matrix known at every sample, and its columns with independent ones first.

    The rank is the largest one found, the order that of the sample with the largest smallest value.
    """
    best = (-1, -1.0, 0)
    for k, (block, scale) in enumerate(zip(blocks, scales, strict=True)):
        decision = decide_rank(block, scale=scale)
        kept = decision.kept if decision.rank else 0.0
        best = max(best, (decision.rank, kept, -k))
    return best[0], [int(c) for c in pivots(blocks[-best[2]])]


class Eliminator:
    """Eliminates the passive joints limb by limb, at all samples at once."""

    def __init__(self, structure: Structure, samples: Samples) -> None:
        self.structure, self.samples = structure, samples
        self.fronts: list[Front] = []
        self._handed: list[list[Matrix]] = []

    def limb(self, index: int) -> list[Matrix]:
        """Fronts of one limb; its reduced rows (full width) at every sample."""
        blocks, columns = self.structure.limbs[index]
        if not blocks:
            return [m[:0] for m in self.samples.matrices]
        groups = [self.structure.group(block) for block in blocks]
        passive = {c for c in columns if c >= self.structure.motors}
        motors = [c for c in columns if c < self.structure.motors]
        while passive:
            merged, chosen = next_front(groups, passive)
            whole = Group.merged(merged)
            passive -= set(chosen)
            rest = [group for group in groups if group not in merged]
            root = not rest and not passive
            handed_on = self._front(index, whole, chosen, motors, root)
            groups = [*rest, handed_on]
            if root:
                return self._handed[-1]
        return self._last(index, groups, motors)

    def _last(self, index: int, groups: list[Group], motors: list[int]) -> list[Matrix]:
        """Rows of a limb that no passive joint moves, gathered."""
        self._front(index, Group.merged(groups), [], motors, True)
        return self._handed[-1]

    def _front(self, limb: int, whole: Group, chosen: list[int], motors: list[int], root: bool) -> Group:
        others = motors if root else sorted(whole.columns - set(chosen))
        member = root or whole.member
        width = self.samples.matrices[0].shape[1]
        twist = list(range(len(self.structure.occurs[0]), width)) if member else []
        stacked = [self._rows(whole, k) for k in range(len(self.samples))]
        rank, order = ordered([rows[:, chosen] for rows in stacked], self.samples.scales)
        left = [_left_null(rows[:, [chosen[c] for c in order[:rank]]]).T @ rows for rows in stacked]
        behind = [*others, *twist]
        handed, behind_order = ordered([rows[:, behind] for rows in left], self.samples.scales)
        full = handed == whole.rows - rank
        first = [*order, *(len(chosen) + c for c in behind_order)]
        if not full:
            first = [
                *order[:rank], *(len(chosen) + c for c in behind_order[:handed]), *order[rank:],
                *(len(chosen) + c for c in behind_order[handed:]),
            ]  # fmt: skip
            left = [_compressed(rows, [behind[c] for c in behind_order], handed) for rows in left]
        by_left = full and rank > 0 and 2 * handed * (rank + 1) <= 3 * rank * max(len(behind), 1)
        self.fronts.append(
            Front(
                whole.blocks, whole.children, [*chosen, *others], len(chosen), whole.rows, rank, member,
                first, rank + (0 if full else handed), handed, by_left, limb, root,
            )
        )  # fmt: skip
        self._handed.append(left)
        return Group(set(others), [], [len(self.fronts) - 1], handed, whole.member)

    def _rows(self, whole: Group, sample: int) -> Matrix:
        """All rows of a group at one sample, those of its blocks first."""
        first, count = self.structure.first, self.structure.rows
        matrix = self.samples.matrices[sample]
        own = [matrix[first[b] : first[b] + count[b]] for b in whole.blocks]
        return np.vstack([matrix[:0], *own, *(self._handed[c][sample] for c in whole.children)])


def _left_null(columns: Matrix) -> Matrix:
    """Orthonormal basis of what is orthogonal to independent columns."""
    return qr_full(columns)[:, columns.shape[1] :]


def _compressed(rows: Matrix, columns: list[int], rank: int) -> Matrix:
    """The same row space in `rank` rows."""
    return np.asarray((qr_full(rows[:, columns]).T @ rows)[:rank])
