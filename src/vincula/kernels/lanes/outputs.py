"""Where results of one configuration stand in the workspace: sections behind the slot `OUTPUT`.

The places depend on the mechanism alone, not on what is wanted; sections that are not wanted hold anything.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from vincula.numerics.counts import SummaryCounts

MOTIONS: Final = 1
"""Wanted: directions of the kinematic ellipsoid."""
EFFORTS: Final = 2
"""Wanted: directions of the force ellipsoids."""
REST: Final = 4
"""Wanted: twists that no motor drives, rates that leave the member at rest."""
COUNTS: Final = 8
"""Wanted: lanes that are certain of all twelve counts."""
BOUNDS: Final = 16
"""Wanted: bounds on the errors of the efficiencies."""
RECIPROCALS: Final = 32
"""Wanted: efficiencies of forces."""
SHARED: Final = 64
"""Told: results of motions and of efforts are weighed alike, so directions are the same but for signs."""

STATUS: Final = 0
"""Slot, from `OUTPUT` on: 0 certain, `OPENED`, or `UNKNOWN`."""
RESIDUAL: Final = 1
"""Slot of the largest gap, in units of the characteristic length."""
ANGLE: Final = 2
"""Slot of the uncertainty of the motions [rad]."""
LIMITS: Final = 3
"""Slots of infinity, zero and NaN."""
FIRST: Final = 6
"""Slot of the first efficiency; what follows is in the order of `sections`."""

CONSTANT: Final = {"infinity": float("inf"), "zero": 0.0, "nothing": float("nan")}
"""Sections of one number that is repeated as often as it is asked for."""

OPENED: Final = 2
"""Status of a lane whose loops are certainly open."""
UNKNOWN: Final = 4
"""Status of a lane for the reference path."""


@dataclass(frozen=True, slots=True)
class Section:
    """Consecutive slots.

    Attributes:
        first: The first of them, from `OUTPUT` on.
        shape: What they are: entries, or entries x components.
    """

    first: int
    shape: tuple[int, ...]

    @property
    def size(self) -> int:
        """Number of slots."""
        count = 1
        for length in self.shape:
            count *= length
        return count


def sections(counts: SummaryCounts, motors: int, twist: int) -> dict[str, Section]:
    """All sections by name, in order.

    Args:
        counts: The summary counts of certain lanes.
        motors: Number of motors.
        twist: Number of twist components.
    """
    finite = counts.coordinated
    shapes = {
        "efficiencies": (finite,), "bounds": (finite,), "reciprocals": (finite,),
        "twists": (finite, twist), "rates": (finite, motors),
        "wrenches": (finite, twist), "torques": (finite, motors),
        "free": (counts.indeterminacy, twist), "idle": (counts.redundancy, motors),
    }  # fmt: skip
    found = {
        "residual": Section(RESIDUAL, ()),
        "angle": Section(ANGLE, ()),
        "infinity": Section(LIMITS, ()),
        "zero": Section(LIMITS + 1, ()),
        "nothing": Section(LIMITS + 2, ()),
    }
    at = FIRST
    for name, shape in shapes.items():
        found[name] = Section(at, shape)
        at += found[name].size
    return found


def output_slots(counts: SummaryCounts, motors: int, twist: int) -> int:
    """Number of slots of all results of one configuration."""
    last = sections(counts, motors, twist)["idle"]
    return last.first + last.size
