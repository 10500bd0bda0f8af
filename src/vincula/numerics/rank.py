"""The only place that decides what is zero: the rank of a matrix, and whether a number is negligible.

Source: numerics page, steps 2 and 3.  A singular value counts when it is above what rounding, loop
closure, typed digits and manufacturing tolerance can tell from zero; when the answer would change
within the margins it is *doubtful*, and says which of these causes decides.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

import numpy as np

from vincula.arrays import Matrix, Vector
from vincula.numerics.lapack import singular_values

if TYPE_CHECKING:
    from vincula.numerics.evidence import Certificate

EPS = float(np.finfo(float).eps)
ROUNDING_FACTOR = 10.0
"""Rounding uncertainty is this times max(m, n) eps, relative to the largest singular value."""
SAFETY = 10.0
"""A singular value this many times above the uncertainty is certainly not zero; one this many times
below rounding certainly is.  (The band below rounding matters: a Stewart platform 1e-12 rad off its
singularity has true singular values of 5e-14, above actual but below worst-case rounding.)"""

Status = Literal["certain", "doubtful", "assumed", "exact", "certified_lower"]
"""certain and doubtful: by the margins.  assumed: doubtful singular values were taken as zero on request.
exact: proved.  certified_lower: proved that it is not lower, and by the margins not higher."""
Proof = Literal["", "assumed", "exact", "certified_lower"]
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
        proof: What the rank rests on beside the margins.
        certificate: What is proved about it.
    """

    name: str
    shape: tuple[int, int]
    rank: int
    rank_min: int
    rank_max: int
    singular_values: Vector
    cutoff: float
    cutoffs: Mapping[str, float]
    proof: Proof = ""
    certificate: Certificate | None = None

    @property
    def status(self) -> Status:
        """`doubtful` when something within the margins changes the rank, else what the rank rests on."""
        if self.proof in ("assumed", "exact"):
            return self.proof
        if self.rank_min != self.rank_max:
            return "doubtful"
        return self.proof or "certain"

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
    rounding = size * rounding_unit(*matrix.shape)
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


def resolved(
    decision: RankDecision, certificate: Certificate | None, *, assume_singular: bool = False
) -> RankDecision:
    """A decision with what is proved, and then what is assumed, put in.

    Args:
        decision: The decision by the margins.
        certificate: What is proved about the rank.
        assume_singular: Take singular values that are still doubtful as zero.
    """
    if certificate is not None:
        proved = certificate.rank
        if certificate.exact:
            return replace(
                decision,
                rank=proved,
                rank_min=proved,
                rank_max=proved,
                proof="exact",
                certificate=certificate,
            )
        low, high = max(decision.rank_min, proved), max(decision.rank_max, proved)
        rank = max(decision.rank, proved)
        decision = replace(
            decision, rank=rank, rank_min=low, rank_max=high, certificate=certificate,
            proof="certified_lower" if rank == proved else "",
        )  # fmt: skip
    if assume_singular and decision.status == "doubtful":
        return replace(decision, rank=decision.rank_min, proof="assumed")
    return decision


def rounding_unit(rows: int, columns: int) -> float:
    """Relative rounding uncertainty of the singular values of a rows x columns matrix."""
    return ROUNDING_FACTOR * max(rows, columns) * EPS


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
