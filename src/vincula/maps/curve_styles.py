"""How singular curves look and what they are called, by kind: one place for maps and for plots of sweeps."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final


@dataclass(frozen=True, slots=True)
class CurveStyle:
    """How curves of one kind look.

    Attributes:
        label: What a legend says.
        colour: Colour, of those that remain distinct with the common colour-vision defects.
        dashes: Lengths of dashes and gaps, in units of the width; none for a solid line.
        width: Width of the line [points].
    """

    label: str
    colour: str
    dashes: tuple[float, ...]
    width: float


CURVES: Final = {
    "platform free": CurveStyle("member free with motors locked", "#D55E00", (), 1.5),
    "motors without authority": CurveStyle("motors lose authority", "#0072B2", (5.0, 1.6), 1.5),
    "internal": CurveStyle("inner degeneracy", "#AA4499", (1.2, 1.2), 1.4),
    "limit": CurveStyle("joint limit", "#666666", (), 0.8),
    "turn": CurveStyle("variables turn back", "#666666", (3.0, 1.2, 1.0, 1.2), 0.9),
    "lost": CurveStyle("edge of what was followed", "#bbbbbb", (), 0.8),
}
"""Line styles: told apart by colour and by dashes."""
