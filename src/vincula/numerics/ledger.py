"""The ledger: the eight ranks of one model, decided once, and everything that is counted from them.

Source: numerics page, steps 2 and 3; theory page, section 3.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from math import sqrt
from typing import TYPE_CHECKING, Literal

import numpy as np

from vincula.arrays import Matrix, Vector, frozen
from vincula.numerics.counts import Ranks, SummaryCounts, TwelveCounts
from vincula.numerics.elimination import Elimination
from vincula.numerics.evidence import NO_EVIDENCE, Evidence
from vincula.numerics.lapack import singular_values
from vincula.numerics.rank import SAFETY, RankDecision, Status, decide_rank, resolved, rounding_unit
from vincula.numerics.subspaces import Subspaces

if TYPE_CHECKING:
    from vincula.labels import ScaledMatrices, Uncertainty
    from vincula.model import LinearModel

MatrixName = Literal[
    "active", "passive", "member", "active+passive", "active+member", "passive+member", "all", "triple"
]
MATRIX_NAMES: tuple[MatrixName, ...] = (
    "active", "passive", "member", "active+passive", "active+member", "passive+member", "all", "triple"
)  # fmt: skip


@dataclass(frozen=True, eq=False)
class RankLedger:
    """The eight ranks of one model (theory page, section 3), decided on demand and only once.

    Attributes:
        scaled: J_a, J_p and G^T in scaled units.
        residual: Closure residual in scaled units.
        digits: Half a unit of the last typed digit in scaled units.
        tolerance: Manufacturing tolerance in scaled units.
        curvature: Bound K on the second derivatives of the loop equations in scaled units.
        evidence: Readings, assumptions and proofs beside the matrices.
    """

    scaled: ScaledMatrices
    residual: float = 0.0
    digits: float = 0.0
    tolerance: float = 0.0
    curvature: float = 1.0
    evidence: Evidence = NO_EVIDENCE
    _decisions: dict[str, RankDecision] = field(default_factory=dict, repr=False)
    _ranks: dict[str, int] = field(default_factory=dict, repr=False)
    _bounds: dict[str, float] = field(default_factory=dict, repr=False)
    _bases: dict[str, tuple[Matrix, ...]] = field(default_factory=dict, repr=False)

    @staticmethod
    def of_model(model: LinearModel) -> RankLedger:
        """The ledger of a model; use `model.ledger`, which keeps it."""
        size = 1.0 if model.length is None else model.length
        known: Uncertainty = model.uncertainty
        return RankLedger(
            scaled=model.scaled,
            residual=known.residual / size,
            digits=known.digits_length / size + known.digits_angle,
            tolerance=known.tolerance_length / size + known.tolerance_angle,
            curvature=known.curvature,
            evidence=model.evidence,
        )

    def matrix(self, name: MatrixName) -> Matrix:
        """One of the eight scaled matrices, columns in the order (q_a, q_p, u), member part -G^T."""
        a, p, o = self.scaled.active, self.scaled.passive, self._member
        if name == "triple":
            return np.block([[a, p, np.zeros_like(o)], [a, np.zeros_like(p), o]])
        if name == "all":
            return self._all
        blocks = {"active": a, "passive": p, "member": o}
        return np.hstack([blocks[part] for part in name.split("+")])

    def decision(self, name: MatrixName) -> RankDecision:
        """The rank of one of the eight matrices."""
        if name not in self._decisions:
            matrix = self.matrix(name)
            values = self._values_of_all if name == "all" else singular_values(matrix)
            decision = decide_rank(
                matrix,
                name=_WORDS[name],
                scale=self.scale,
                uncertainty=self._uncertainty(matrix, values),
                values=values,
            )
            known = self.evidence
            self._decisions[name] = resolved(
                decision, known.certificates.get(name), assume_singular=known.assume_singular
            )
        return self._decisions[name]

    @property
    def names(self) -> tuple[MatrixName, ...]:
        """The eight matrices."""
        return MATRIX_NAMES

    def decided(self, name: MatrixName) -> bool:
        """Whether this rank was asked for already."""
        return name in self._decisions

    def rank(self, name: MatrixName) -> int:
        """The decided rank of one of the eight matrices.

        Where full rank is proved without singular values, they are not computed: the decision would
        be the same, and certain.
        """
        if name not in self._ranks:
            if not self._needs_values(name) and self._proved_full(name):
                n_a, n_p, n_o = self._widths
                width = {"passive": 0, "active+passive": n_a, "passive+member": n_o, "all": n_a + n_o}[name]
                self._ranks[name] = min(self._rows, n_p + width)
            else:
                self._ranks[name] = self.decision(name).rank
        return self._ranks[name]

    def _needs_values(self, name: MatrixName) -> bool:
        return name in self._decisions or name in self.evidence.certificates

    @cached_property
    def scale(self) -> float:
        """Largest singular value of [J_a J_p -G^T]: what every uncertainty of the model is relative to."""
        values = self._values_of_all
        return float(values[0]) if len(values) else 0.0

    @cached_property
    def uncertainty(self) -> Mapping[str, float]:
        """Relative uncertainties of [J_a J_p -G^T] beyond rounding, by cause."""
        return self._uncertainty(self._all, self._values_of_all)

    def _uncertainty(self, matrix: Matrix, values: Vector) -> Mapping[str, float]:
        """Relative uncertainties of one matrix beyond rounding, by cause.

        Closure goes by the Kantorovich number h = K rho / sigma^2 of the matrix itself: whoever closed
        the loops held some joints, and the error of the others grows with the smallest singular value
        of *their* columns, not of all columns together.
        """
        parts = {"digits": self.digits, "tolerance": self.tolerance}
        rho = self.curvature * self.residual
        if rho > 0.0:
            sigma = decide_rank(matrix, scale=self.scale, uncertainty=parts, values=values).kept
            parts["closure"] = _closure_error(rho, sigma)
        return parts

    @cached_property
    def subspace_doubt(self) -> float:
        """Relative error to expect of kernels and ranges: the cutoff over the smallest kept value."""
        if "all" not in self._decisions and self._proved_full("all"):
            return min(1.0, self._proof_cutoff("all") / self._bound("all"))
        full = self.decision("all")
        return min(1.0, full.cutoff / full.kept)

    @property
    def subspaces(self) -> Subspaces:
        """Kernels and ranges that belong to these ranks."""
        return Subspaces(self, self._bases)

    @cached_property
    def summary(self) -> SummaryCounts:
        """The summary counts; they need four of the eight ranks."""
        ranks = (self.rank(name) for name in _SUMMARY)
        return SummaryCounts.from_ranks(self._rows, *self._widths, *ranks)

    @cached_property
    def scenarios(self) -> tuple[SummaryCounts, SummaryCounts]:
        """The summary counts if all doubtful singular values are zero, and if none is."""
        return self._summary_of("rank_min"), self._summary_of("rank_max")

    @cached_property
    def ranks(self) -> Ranks:
        """All eight ranks."""
        return Ranks(*(self.rank(name) for name in MATRIX_NAMES))

    @cached_property
    def counts(self) -> TwelveCounts:
        """The twelve counts of the theory page."""
        return TwelveCounts.from_ranks(self._rows, *self._widths, self.ranks)

    @property
    def doubtful(self) -> tuple[RankDecision, ...]:
        """The decisions made so far that are doubtful."""
        return tuple(d for d in self._decisions.values() if d.status == "doubtful")

    @property
    def status(self) -> Status:
        """Doubtful when any decision made so far is, or when another reading of the file has other counts."""
        if self.doubtful or self.contested:
            return "doubtful"
        found = {decision.status for decision in self._decisions.values()}
        if "assumed" in found:
            return "assumed"
        if not self.evidence.certificates or "certain" in found:
            return "certain"
        return "certified_lower" if "certified_lower" in found else "exact"

    @cached_property
    def contested(self) -> bool:
        """Whether typed numbers, read as what they probably mean, give other counts than these.

        Proofs and assumptions settle that: whoever asked for them has chosen the reading.
        """
        known = self.evidence
        if known.reading is None or known.assume_singular or known.certificates:
            return False
        return known.reading.summary not in (None, self.summary)

    @cached_property
    def _member(self) -> Matrix:
        return frozen(-self.scaled.member)

    @cached_property
    def _all(self) -> Matrix:
        return frozen(np.hstack([self.scaled.active, self.scaled.passive, self._member]))

    @cached_property
    def _values_of_all(self) -> Vector:
        return frozen(singular_values(self._all))

    @property
    def _rows(self) -> int:
        return int(self.scaled.active.shape[0])

    @property
    def _widths(self) -> tuple[int, int, int]:
        s = self.scaled
        return int(s.active.shape[1]), int(s.passive.shape[1]), int(s.member.shape[1])

    def _summary_of(self, field_name: Literal["rank", "rank_min", "rank_max"]) -> SummaryCounts:
        ranks = (int(getattr(self.decision(name), field_name)) for name in _SUMMARY)
        return SummaryCounts.from_ranks(self._rows, *self._widths, *ranks)

    @cached_property
    def elimination(self) -> Elimination | None:
        """The passive joints eliminated from the columns (q_a, u); None without full column rank."""
        return Elimination.of(self.scaled.passive, np.hstack([self.scaled.active, self._member]))

    def _proved_full(self, name: MatrixName) -> bool:
        """Whether full rank is certain from a bound on the smallest singular value."""
        if name not in _SUMMARY or self.elimination is None:
            return False
        return self._bound(name) > 2.0 * SAFETY * self._proof_cutoff(name)

    def _bound(self, name: MatrixName) -> float:
        """Lower bound of the smallest singular value of one of the four summary matrices."""
        if name not in self._bounds and self.elimination is not None:
            n_a = self._widths[0]
            columns = {"passive": slice(0, 0), "active+passive": slice(0, n_a),
                       "passive+member": slice(n_a, None), "all": slice(None)}[name]  # fmt: skip
            self._bounds[name] = self.elimination.smallest_singular_value(columns)
        return self._bounds[name]

    def _proof_cutoff(self, name: MatrixName) -> float:
        """An upper bound of the cutoff of a summary matrix, without singular values."""
        rho, relative = self.curvature * self.residual, self._proof_unit
        if rho > 0.0:
            relative += _closure_error(rho, self._bound(name))
        return self._proof_scale * relative

    @cached_property
    def _proof_unit(self) -> float:
        return rounding_unit(self._rows, sum(self._widths)) + self.digits + self.tolerance

    @cached_property
    def _proof_scale(self) -> float:
        blocks = (self.scaled.active, self.scaled.passive, self.scaled.member)
        return sqrt(sum(float(np.vdot(block, block)) for block in blocks))


def _closure_error(rho: float, sigma: float) -> float:
    """How far the true configuration may be: Kantorovich's h = rho / sigma^2 < 1/2, or a fold."""
    return rho / sigma if rho < 0.5 * sigma * sigma else (2.0 * rho) ** 0.5


_SUMMARY: tuple[MatrixName, ...] = ("passive", "active+passive", "passive+member", "all")
_WORDS: dict[MatrixName, str] = {
    "active": "active constraints",
    "passive": "passive constraints",
    "member": "member constraints",
    "active+passive": "active+passive constraints",
    "active+member": "active+member constraints",
    "passive+member": "passive+member constraints",
    "all": "active+passive+member constraints",
    "triple": "test matrix [[J_a J_p 0] [J_a 0 G^T]]",
}
