"""Which choice of motors is best: designs of one mechanism, ranked by one number."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final

from vincula.analysis import indices
from vincula.analysis.ellipsoid import Ellipsoid
from vincula.analysis.indices import Part
from vincula.analysis.result import Analysis
from vincula.errors import UnknownNameError

CRITERIA: Final = {
    "kinematic": "smallest finite kinematic efficiency",
    "active-force": "smallest finite active force efficiency",
    "passive-force": "smallest finite passive force efficiency",
    "internal-force": "smallest finite internal force efficiency",
    "dual-force": "smallest finite dual force efficiency",
    "yoshikawa": "Yoshikawa's volume: product of the semi-axes of the kinematic ellipsoid",
    "inverse-condition": "shortest over longest semi-axis of the kinematic ellipsoid",
    "isotropy": "geometric over arithmetic mean of the squared semi-axes of the kinematic ellipsoid",
    "smallest-singular-value": "shortest semi-axis of the kinematic ellipsoid",
}
"""What designs can be ranked by; of all of them more is better."""
SAME_DIGITS: Final = 9
"""Numbers that agree to so many digits do not decide an order."""


@dataclass(frozen=True, slots=True, eq=False)
class RankedDesign:
    """One design in its place.

    Attributes:
        analysis: The analysis of the design.
        index: What it is ranked by; None where it has no such number.
        reason: Why it stands behind the others; empty for a design that is ranked by its number.
    """

    analysis: Analysis
    index: float | None
    reason: str


def ranked_designs(
    analyses: Iterable[Analysis], criterion: str = "kinematic", on: Part = "all"
) -> tuple[RankedDesign, ...]:
    """Designs from best to worst; equal ones stay in the order given.

    Designs that leave the member indeterminate come last, those that leave fewer motions first: with motors
    locked it still moves, and no efficiency makes up for that.  Before them come those for which the number
    does not exist.

    Args:
        analyses: The designs.
        criterion: One of `CRITERIA`.
        on: For the indices: translation, rotation or all components.

    Raises:
        UnknownNameError: No such criterion.
        MixedUnitsError: An index over metres and radians with weights that nobody chose.
    """
    if criterion not in CRITERIA:
        raise UnknownNameError("criterion", criterion, CRITERIA)
    return tuple(sorted((_judged(one, criterion, on) for one in analyses), key=_place))


def place_in_ranking(index: float | None, indeterminacy: int) -> tuple[int, int, float]:
    """Sorting key of a design: smaller is better; the one order in which designs are ranked.

    Designs that hold the member, by their number; those without the number; then by how many ways the member
    is left to move, fewest first.  Numbers that differ by rounding count as equal: mirror images stay in the
    order given, on every machine.

    Args:
        index: What it is ranked by, more being better; None where it has no such number.
        indeterminacy: Ways in which the member moves with all motors locked.
    """
    size = 0.0 if index is None else -float(f"{index:.{SAME_DIGITS}g}")
    if indeterminacy:
        return 2, indeterminacy, size
    return (1, 0, 0.0) if index is None else (0, 0, size)


def indeterminate_words(count: int) -> str:
    """Why a design stands behind all others; empty for one that holds the member.

    Args:
        count: Ways in which the member moves with all motors locked.
    """
    if not count:
        return ""
    ways = "1 way" if count == 1 else f"{count} ways"
    return f"the member is indeterminate: it moves in {ways} with all motors locked"


def criterion_value(analysis: Analysis, criterion: str, on: Part = "all") -> float:
    """The number that a design is ranked by; NaN where it has none.

    Args:
        analysis: The design.
        criterion: One of `CRITERIA`.
        on: For the indices: translation, rotation or all components.

    Raises:
        MixedUnitsError: An index over metres and radians with weights that nobody chose.
    """
    if criterion == "kinematic" or criterion.endswith("-force"):
        ellipsoid: Ellipsoid = getattr(analysis, criterion.replace("-", "_"))
        return min((float(value) for value in ellipsoid.finite), default=math.nan)
    function = {
        "yoshikawa": indices.yoshikawa_volume,
        "inverse-condition": indices.inverse_condition_number,
        "isotropy": indices.isotropy,
        "smallest-singular-value": indices.smallest_singular_value,
    }[criterion]
    return function(analysis.kinematic, on)


def _place(design: RankedDesign) -> tuple[int, int, float]:
    return place_in_ranking(design.index, design.analysis.ledger.summary.indeterminacy)


def _judged(analysis: Analysis, criterion: str, on: Part) -> RankedDesign:
    index = criterion_value(analysis, criterion, on)
    reason = indeterminate_words(analysis.ledger.summary.indeterminacy)
    if math.isnan(index):
        return RankedDesign(analysis, None, reason or f"it has no {CRITERIA[criterion]}")
    return RankedDesign(analysis, index, reason)
