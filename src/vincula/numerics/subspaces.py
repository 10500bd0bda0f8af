"""Bases that belong to decided ranks: kernels, left kernels, complements; and their transport.

Every basis here has its dimension from the rank ledger: nothing in this file looks at the size of a
singular value.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from vincula.arrays import Matrix
from vincula.numerics.lapack import qr_full, svd

if TYPE_CHECKING:
    from vincula.numerics.ledger import MatrixName, RankLedger

TIE = 1e-6
"""Rows that stick out equally to this much count as equal: the first one leads."""


def kernel(matrix: Matrix, rank: int) -> Matrix:
    """Orthonormal basis of the kernel, n x (n - rank)."""
    return svd(matrix)[2][:, rank:]


def left_kernel(matrix: Matrix, rank: int) -> Matrix:
    """Orthonormal basis of the left kernel, m x (m - rank); QR suffices at full column rank."""
    if rank == matrix.shape[1]:
        return qr_full(matrix)[:, rank:]
    return svd(matrix)[0][:, rank:]


def complement(space: Matrix, inside: Matrix, count: int) -> Matrix:
    """The `count` directions of `space` that lie farthest from `inside`.

    Args:
        space: n x k orthonormal basis.
        inside: n x j orthonormal basis of the subspace to stay away from.
        count: Dimension wanted, from the ledger.
    """
    apart = space - inside @ (inside.T @ space)
    return space @ svd(apart)[2][:, :count]


def span(columns: Matrix, rank: int) -> Matrix:
    """Orthonormal basis of the range of `columns`, n x rank."""
    return svd(columns)[0][:, :rank]


def leading_rows(basis: Matrix, count: int) -> list[int]:
    """Independent rows, each the first of those that stick out most beside the ones before.

    Depends on the subspace only, not on its basis.
    """
    left = np.array(basis)
    chosen: list[int] = []
    for _ in range(count):
        lengths = np.linalg.norm(left, axis=1)
        lengths[chosen] = -1.0
        chosen.append(int(np.argmax(lengths >= (1.0 - TIE) * lengths.max())))
        if lengths[chosen[-1]] <= 0.0:
            continue
        direction = left[chosen[-1]] / lengths[chosen[-1]]
        left = left - np.outer(left @ direction, direction)
    return chosen


def settled(basis: Matrix) -> Matrix:
    """The orthonormal basis of a subspace that is triangular on its leading rows.

    Settles the freedom of turning inside a subspace: the same for every machine and every algorithm.
    """
    size, count = basis.shape
    if count < 2:
        return basis
    if count == size:
        # The whole space: elimination would find the identity, in time that grows with size cubed.
        return np.eye(size)
    turn = np.linalg.qr(basis[leading_rows(basis, count)].T)[0]
    return np.asarray(basis @ turn)


def transported(basis: Matrix, previous: Matrix) -> Matrix:
    """The same subspace as `basis`, in the basis nearest to `previous` (orthogonal Procrustes).

    Along a path raw singular vectors jump; transported ones turn no more than the subspace does.

    Args:
        basis: n x k orthonormal basis here.
        previous: n x k orthonormal basis one step before.
    """
    left, _, right = svd(basis.T @ previous)
    return basis @ (left @ right.T)


def projector_distance(first: Matrix, second: Matrix) -> float:
    """Sine of the largest angle between two subspaces (orthonormal bases); 1 for different dimensions."""
    if first.shape[1] != second.shape[1]:
        return 1.0
    apart = second - first @ (first.T @ second)
    return float(np.linalg.norm(apart, 2)) if apart.size else 0.0


@dataclass(frozen=True, eq=False)
class Subspaces:
    """Kernels and ranges of the scaled matrices of one model, computed on demand and only once.

    Coordinates are scaled; columns are ordered (q_a, q_p, u), and the member part is -G^T as in (1).
    A view: what was computed is kept by the ledger, which does not point back here.
    """

    ledger: RankLedger
    kept: dict[str, tuple[Matrix, ...]] = field(repr=False)

    def kernel(self, name: MatrixName) -> Matrix:
        """Orthonormal kernel of one of the eight matrices."""
        key = f"kernel of {name}"
        if key not in self.kept:
            self.kept[key] = (kernel(self.ledger.matrix(name), self.ledger.rank(name)),)
        return self.kept[key][0]

    def left_kernel(self, name: MatrixName) -> Matrix:
        """Orthonormal left kernel of one of the eight matrices."""
        key = f"left kernel of {name}"
        if key not in self.kept:
            self.kept[key] = (left_kernel(self.ledger.matrix(name), self.ledger.rank(name)),)
        return self.kept[key][0]

    @property
    def motions_and_equilibria(self) -> tuple[Matrix, Matrix]:
        """Orthonormal bases of M = {(q_a, u)} and of its complement F = {(tau, w)}: theory page, 4.

        Both come from one orthogonal matrix, so that tau.q_a + w.u = 0 to rounding.
        """
        if "relation" not in self.kept:
            self.kept["relation"] = self._relation()
        motions, equilibria = self.kept["relation"]
        return motions, equilibria

    def _relation(self) -> tuple[Matrix, Matrix]:
        ledger, elimination = self.ledger, self.ledger.elimination
        if elimination is not None and ledger.rank("passive") == len(elimination.coupling):
            right = elimination.reduced_svd[2]
        else:
            z = self.left_kernel("passive")
            right = svd(z.T @ np.hstack([ledger.matrix("active"), ledger.matrix("member")]))[2]
        # Contradictory decisions (flagged by the counts) must not make a negative dimension.
        rank = max(0, ledger.rank("all") - ledger.rank("passive"))
        return right[:, rank:], right[:, :rank]
