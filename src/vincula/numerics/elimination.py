"""Passive joints eliminated by one QR factorisation, with a proof of full rank where there is one.

J_p = Q [R; 0] turns [J_p S] into [R B; 0 C] for any further columns S.  C is the reduced matrix of the
relation (theory page, section 4).  If R is regular and C has full rank, the (one-sided) inverse

    [R^-1  -R^-1 B C^+;  0  C^+]

bounds the smallest singular value of [J_p S] from below, at a fraction of the cost of computing it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import sqrt

import numpy as np

from vincula.arrays import Matrix, Vector
from vincula.numerics.lapack import inverse_of_triangle, qr_applied, singular_values, svd


@dataclass(frozen=True, eq=False)
class Elimination:
    """J_p eliminated from further columns.

    Attributes:
        inverse: Frobenius norm of R^-1; 0 without passive columns.
        coupling: R^-1 B, n_p x k.
        reduced: C, (m - n_p) x k.
    """

    inverse: float
    coupling: Matrix
    reduced: Matrix

    @staticmethod
    def of(passive: Matrix, others: Matrix) -> Elimination | None:
        """Eliminate `passive` (m x n_p) from `others` (m x k); None if it has not full column rank.

        Only an exact zero on the diagonal of R is refused here; a tiny one gives a weak bound.
        """
        m, n = passive.shape
        if n > m:
            return None
        if n == 0:
            return Elimination(0.0, others[:0], others)
        triangle, turned = qr_applied(passive, others)
        inverse = inverse_of_triangle(triangle)
        if inverse is None:
            return None
        return Elimination(sqrt(float(np.vdot(inverse, inverse))), inverse @ turned[:n], turned[n:])

    @cached_property
    def reduced_svd(self) -> tuple[Matrix, Vector, Matrix]:
        """Full decomposition of C; its right vectors are motions and equilibria of the relation."""
        return svd(self.reduced)

    def smallest_singular_value(self, columns: slice) -> float:
        """A lower bound of the smallest singular value of J_p with some of the other columns.

        0 when there is no bound: the reduced block has not full rank.
        """
        squares = self.inverse**2
        reduced = self.reduced[:, columns]
        if 0 not in reduced.shape:
            whole = reduced.shape == self.reduced.shape
            lowest = float((self.reduced_svd[1] if whole else singular_values(reduced))[-1])
            if lowest == 0.0:
                return 0.0
            coupling = self.coupling[:, columns]
            squares += (1.0 + float(np.vdot(coupling, coupling))) / lowest**2
        return 1.0 / sqrt(squares) if squares else float("inf")
