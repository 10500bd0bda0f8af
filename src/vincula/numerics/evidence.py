"""What is known about doubtful ranks beside the matrices: readings, assumptions, proofs, near singularities.

A model carries its evidence; the ledger heeds it, and results tell it.  Nothing here decides a rank.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final

from vincula.numerics.counts import SummaryCounts


@dataclass(frozen=True, slots=True)
class Certificate:
    """What is proved about the rank of one matrix.

    Attributes:
        rank: The rank is at least this.
        exact: Whether it is this.
        singular_values: Enclosures (lower, upper) of the singular values of the scaled matrix with its
            uncertainties, largest first; empty where exact data made them needless.
    """

    rank: int
    exact: bool
    singular_values: tuple[tuple[float, float], ...] = ()


@dataclass(frozen=True, slots=True)
class Reading:
    """The same file with some numbers read as what they probably mean.

    Attributes:
        snapped: The numbers, each with its place: `1.57 means pi/2 (robot.urdf:8, joint 'o1', rpy)`.
        summary: The summary counts then; None if the mechanism is refused.
        refused: Why it is refused, empty otherwise.
    """

    snapped: tuple[str, ...]
    summary: SummaryCounts | None
    refused: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class NearestSingular:
    """The singular configuration that was found nearest to a doubtful one.

    Attributes:
        distance: How far away it is: length of the step in radians and metres / L.
        largest: The axis that moves most on the way there, with its displacement [rad or m].
        residual: What the equations leave there (loops closed, one more motion), scaled units.
        kantorovich: h of those equations there: below 1/2 such a configuration is proved to be near.
        configuration: Values by joint.
        joints: Shares of joints in the additional motion, largest first.
    """

    distance: float
    largest: tuple[str, float]
    residual: float
    kantorovich: float
    configuration: Mapping[str, tuple[float, ...]]
    joints: Mapping[str, float]


@dataclass(frozen=True, slots=True, eq=False)
class Evidence:
    """What is known about doubts beside the matrices.

    Attributes:
        assume_singular: Doubtful singular values are taken as zero.
        snapped: Numbers of the file that were read as others on request.
        reading: What other readings of typed numbers lead to.
        nearest: The nearest singular configuration; None where none was found or looked for.
        certificates: Proofs by name of the matrix.
        basis: What the proofs rest on, in words.
    """

    assume_singular: bool = False
    snapped: tuple[str, ...] = ()
    reading: Reading | None = None
    nearest: NearestSingular | None = None
    certificates: Mapping[str, Certificate] = field(default_factory=dict)
    basis: str = ""


NO_EVIDENCE: Final = Evidence()
"""Nothing beside the matrices."""
