"""J_a, J_p and G^T with exact entries, up to invertible changes of rows and columns that keep every rank."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from vincula.arrays import Matrix
from vincula.numerics.ledger import MatrixName
from vincula.numerics.surds import ZERO, Surd

ExactMatrix = Sequence[Sequence[Surd]]
"""Rows of exact numbers."""


@dataclass(frozen=True, slots=True)
class ExactBlocks:
    """The three blocks of (1), with rows in common.

    Attributes:
        active: Rows of J_a.
        passive: Rows of J_p.
        member: Rows of G^T.
        basis: What is taken as exact, in words.
    """

    active: ExactMatrix
    passive: ExactMatrix
    member: ExactMatrix
    basis: str

    @staticmethod
    def of_doubles(active: Matrix, passive: Matrix, member: Matrix) -> ExactBlocks:
        """Doubles as the binary fractions that they are."""
        from fractions import Fraction

        def exact(matrix: Matrix) -> ExactMatrix:
            return [[Surd.of(Fraction(float(x))) for x in row] for row in matrix]

        return ExactBlocks(
            exact(active), exact(passive), exact(member), "the matrices as given, every double exact"
        )

    def matrix(self, name: MatrixName) -> ExactMatrix:
        """One of the eight matrices of theory page, section 3; signs of blocks do not change its rank."""
        blocks = {"active": self.active, "passive": self.passive, "member": self.member}
        if name == "triple":
            upper = _beside(self.active, self.passive, _zeros(self.member))
            return [*upper, *_beside(self.active, _zeros(self.passive), self.member)]
        parts = ("active", "passive", "member") if name == "all" else name.split("+")
        return _beside(*(blocks[part] for part in parts))


def _beside(*blocks: ExactMatrix) -> ExactMatrix:
    return [[entry for row in rows for entry in row] for rows in zip(*blocks, strict=True)]


def _zeros(block: ExactMatrix) -> ExactMatrix:
    return [[ZERO] * len(row) for row in block]
