"""The only place that decides what is zero: the rank of a matrix, and the ledger of a model's ranks.

Source: numerics page, steps 1 to 3.  A singular value counts when it is above what rounding, loop
closure, typed digits and manufacturing tolerance can tell from zero; when the answer would change
within the margins it is *doubtful*, and says which of these causes decides.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Literal

import numpy as np

from vincula.arrays import Matrix, Vector, frozen
from vincula.numerics.counts import Ranks, SummaryCounts, TwelveCounts
from vincula.numerics.lapack import singular_values

if TYPE_CHECKING:
    from vincula.labels import ScaledMatrices, Uncertainty
    from vincula.model import LinearModel
    from vincula.numerics.subspaces import Subspaces

EPS = float(np.finfo(float).eps)
ROUNDING_FACTOR = 10.0
"""Rounding uncertainty is this times max(m, n) eps, relative to the largest singular value."""
SAFETY = 10.0
"""A singular value this many times above the uncertainty is certainly not zero; one this many times
below rounding certainly is.  (The band below rounding matters: a Stewart platform 1e-12 rad off its
singularity has true singular values of 5e-14, above actual but below worst-case rounding.)"""

Status = Literal["certain", "doubtful"]
MatrixName = Literal[
    "active", "passive", "member", "active+passive", "active+member", "passive+member", "all", "triple"
]
MATRIX_NAMES: tuple[MatrixName, ...] = (
    "active", "passive", "member", "active+passive", "active+member", "passive+member", "all", "triple"
)  # fmt: skip
_NO_PARTS: Mapping[str, float] = {}


@dataclass(frozen=True, slots=True, eq=False)
class RankDecision:
    """The rank of one matrix, with everything that decided it.

    Attributes:
        name: What the matrix is, in words.
        shape: Its shape.
        rank: Singular values above the cutoff.
        rank_min: Those above `SAFETY` times the cutoff: certainly not zero.
        rank_max: Those above rounding / `SAFETY`: not certainly zero.
        singular_values: All of them, largest first (scaled units).
        cutoff: The uncertainty Delta, same units.
        cutoffs: Its parts: rounding, and closure, digits, tolerance where they are not zero.
    """

    name: str
    shape: tuple[int, int]
    rank: int
    rank_min: int
    rank_max: int
    singular_values: Vector
    cutoff: float
    cutoffs: Mapping[str, float]

    @property
    def status(self) -> Status:
        """`certain` when nothing within the margins changes the rank, else `doubtful`."""
        return "certain" if self.rank_min == self.rank_max else "doubtful"

    @property
    def deciding(self) -> str:
        """The largest part of the uncertainty."""
        return max(self.cutoffs, key=lambda part: self.cutoffs[part])

    @property
    def kept(self) -> float:
        """Smallest singular value that counts: the distance to the nearest matrix of lower rank."""
        return float(self.singular_values[self.rank - 1]) if self.rank else float("inf")

    @property
    def dropped(self) -> float:
        """Largest singular value that does not count; 0 when all do."""
        values = self.singular_values
        return float(values[self.rank]) if self.rank < len(values) else 0.0

    @property
    def gap(self) -> float:
        """How many times the smallest kept value is larger than the largest dropped one."""
        return self.kept / self.dropped if self.dropped > 0.0 else float("inf")

    @property
    def doubtful_values(self) -> tuple[float, ...]:
        """Singular values between rounding and the safe side of the cutoff."""
        return tuple(float(v) for v in self.singular_values[self.rank_min : self.rank_max])


def decide_rank(
    matrix: Matrix,
    *,
    name: str = "matrix",
    scale: float | None = None,
    uncertainty: Mapping[str, float] = _NO_PARTS,
    values: Vector | None = None,
) -> RankDecision:
    """The rank of a matrix; every rank in vincula is decided here.

    Args:
        matrix: m x n, in scaled units.
        name: What it is, for messages.
        scale: Size that uncertainties are relative to; its largest singular value by default.  The
            matrices of one model share the scale of the largest, so that a block that is all
            rounding error has rank 0, and adding columns never lowers a rank.
        uncertainty: Relative uncertainties beyond rounding, by cause.
        values: Its singular values, if they are known already.
    """
    sigma = singular_values(matrix) if values is None else values
    size = scale if scale is not None else (float(sigma[0]) if len(sigma) else 0.0)
    rounding = size * ROUNDING_FACTOR * max(matrix.shape, default=0) * EPS
    parts = {"rounding": rounding}
    for cause, relative in uncertainty.items():
        if relative > 0.0:
            parts[cause] = size * relative
    cutoff = sum(parts.values())
    return RankDecision(
        name=name,
        shape=(matrix.shape[0], matrix.shape[1]),
        rank=_above(sigma, cutoff),
        rank_min=_above(sigma, SAFETY * cutoff),
        rank_max=_above(sigma, rounding / SAFETY),
        singular_values=sigma,
        cutoff=cutoff,
        cutoffs=parts,
    )


def negligible(value: float, scale: float, doubt: float = 0.0) -> bool:
    """Whether a length is zero beside `scale`: a rank decision about one number.

    Args:
        value: A non-negative length.
        scale: What it was computed from.
        doubt: Relative uncertainty of the subspaces involved (`RankLedger.subspace_doubt`).
    """
    return value <= scale * (SAFETY * ROUNDING_FACTOR * 10 * EPS + doubt)


def _above(sigma: Vector, cutoff: float) -> int:
    return int(np.count_nonzero(sigma > cutoff))


@dataclass(frozen=True, eq=False)
class RankLedger:
    """The eight ranks of one model (theory page, section 3), decided on demand and only once.

    Attributes:
        scaled: J_a, J_p and G^T in scaled units.
        residual: Closure residual in scaled units.
        digits: Half a unit of the last typed digit in scaled units.
        tolerance: Manufacturing tolerance in scaled units.
        curvature: Bound K on the second derivatives of the loop equations in scaled units.
    """

    scaled: ScaledMatrices
    residual: float = 0.0
    digits: float = 0.0
    tolerance: float = 0.0
    curvature: float = 1.0
    _decisions: dict[str, RankDecision] = field(default_factory=dict, repr=False)

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
            self._decisions[name] = decide_rank(
                matrix,
                name=_WORDS[name],
                scale=self.scale,
                uncertainty=self._uncertainty(matrix, values),
                values=values,
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
        """The decided rank of one of the eight matrices."""
        return self.decision(name).rank

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
            parts["closure"] = rho / sigma if rho < 0.5 * sigma * sigma else (2.0 * rho) ** 0.5
        return parts

    @cached_property
    def subspace_doubt(self) -> float:
        """Relative error to expect of kernels and ranges: the cutoff over the smallest kept value."""
        full = self.decision("all")
        return min(1.0, full.cutoff / full.kept)

    @cached_property
    def subspaces(self) -> Subspaces:
        """Kernels and ranges that belong to these ranks."""
        from vincula.numerics.subspaces import Subspaces

        return Subspaces(self)

    @cached_property
    def summary(self) -> SummaryCounts:
        """The summary counts; they need four of the eight ranks."""
        return self._summary_of("rank")

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
        """Doubtful when any decision made so far is."""
        return "doubtful" if self.doubtful else "certain"

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
        needed: tuple[MatrixName, ...] = ("passive", "active+passive", "passive+member", "all")
        r_p, r_ap, r_po, r_apo = (int(getattr(self.decision(name), field_name)) for name in needed)
        return SummaryCounts.from_ranks(self._rows, *self._widths, r_p, r_ap, r_po, r_apo)


_WORDS: dict[MatrixName, str] = {
    "active": "active constraints",
    "passive": "passive constraints",
    "member": "member constraints",
    "active+passive": "active+passive constraints",
    "active+member": "active+member constraints",
    "passive+member": "passive+member constraints",
    "all": "all constraints",
    "triple": "test matrix [[J_a J_p 0] [J_a 0 G^T]]",
}
