"""Colours, lines, symbols and words of the figures: one place, legible in grey and to every eye.

Colours are those of Okabe and Ito, which remain distinct with the common colour-vision defects; no
distinction rests on colour alone.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from vincula.analysis.ellipsoid import Kind
from vincula.view.drawables import Role
from vincula.view.shapes import EllipsoidShape

INK = "#222222"
LINK = "#7a7a7a"
MEMBER = "#303a52"
PLATE = "#d9d9d9"
MEMBER_PLATE = "#aab4cc"
HATCH = "#8a8a8a"

RC: Any = {
    "font.family": ["DejaVu Sans"],
    "font.size": 7.0,
    "mathtext.fontset": "dejavusans",
    "axes.titlesize": 7.0,
    "axes.labelsize": 7.0,
    "axes.linewidth": 0.6,
    "axes.edgecolor": "#555555",
    "axes.unicode_minus": True,
    "text.parse_math": False,
    "xtick.labelsize": 6.5,
    "ytick.labelsize": 6.5,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.major.size": 2.5,
    "ytick.major.size": 2.5,
    "lines.solid_capstyle": "round",
    "lines.solid_joinstyle": "round",
    "svg.hashsalt": "vincula",
    "svg.fonttype": "path",
    "pdf.fonttype": 42,
    "savefig.dpi": 300,
    "path.simplify": False,
    "grid.color": "#dddddd",
    "grid.linewidth": 0.3,
}
"""What the figures set in matplotlib while they are made and saved; nothing stays set."""


@dataclass(frozen=True, slots=True)
class KindStyle:
    """How one kind of ellipsoid looks and is called.

    Attributes:
        short: Abbreviation of the paper.
        colour: Its colour.
        per: What one unit of motor effort is.
    """

    short: str
    colour: str
    per: str


KINDS: dict[Kind, KindStyle] = {
    "kinematic": KindStyle("KME", "#0072B2", "motor rates"),
    "active force": KindStyle("AFME", "#D55E00", "motor torques"),
    "passive force": KindStyle("PFME", "#009E73", "motor torques"),
    "dual force": KindStyle("OWFME", "#AA4499", "motor torques"),
}
"""Ellipsoids that can be drawn at the reference point."""

SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")

FILL: dict[Role, str] = {"motor": INK, "driven": "#9a9a9a", "passive": "white", "locked": "white"}
"""Fill of a joint symbol: black for motors, grey for joints behind a transmission, white for the rest."""

ROLE_WORDS: dict[Role, str] = {
    "motor": "motor",
    "driven": "driven by a motor",
    "passive": "passive",
    "locked": "locked",
}

JOINT_MARKERS: dict[str, str] = {
    "revolute": "o",
    "spherical": "h",
    "universal": "P",
    "cylindrical": "s",
    "screw": "d",
    "planar": "D",
    "fixed": "s",
    "prismatic": "s",
}
"""Symbols of matplotlib by joint type; a prismatic joint of the plane is a box turned along its axis."""


def efficiencies_text(shape: EllipsoidShape) -> str:
    """The efficiencies of an ellipsoid in a title: equal ones counted, three digits."""
    values = [float(x) for x in shape.efficiencies]
    if not values:
        return "no efficiencies"
    texts = [_number(value) for value in values]
    parts = []
    for text in dict.fromkeys(texts):
        count = texts.count(text)
        parts.append(f"{text} (×{count})" if count > 1 else text)
    return "λ = " + ", ".join(parts)


def unbounded_text(shape: EllipsoidShape) -> str:
    """Where an ellipsoid goes to infinity, in a title; empty for a bounded one."""
    infinite = sum(math.isinf(x) for x in shape.efficiencies)
    if not infinite:
        return ""
    if shape.infinite_direction is None:
        return f"unbounded along {infinite} directions"
    return "∞ along (" + ", ".join(_component(float(x)) for x in shape.infinite_direction) + ")"


def scale_text(shape: EllipsoidShape) -> str:
    """How long one unit is drawn, or what is drawn instead where nothing has a length."""
    bounded, free = shape.drawn.axes.shape[1], shape.drawn.lines.shape[1]
    if bounded:
        return f"1 {shape.unit} = {shape.scale:g} m"
    view = "shadow" if shape.view == "projection" else "cut"
    if not free:
        return f"{view}: zero only"
    return f"{view}: everything" if free == len(shape.drawn.components) else f"{view}: unbounded"


def note(shapes: Sequence[EllipsoidShape], planar: bool) -> str:
    """The line under a figure: what is drawn, of what."""
    where = "plane of the drawing" if planar else "three translations"
    said = []
    for view, words in (
        ("projection", f"shadow on the {where}"),
        ("section", f"cut by the {where}, moment zero" if planar else f"cut by the {where}, moments zero"),
    ):
        names = list(dict.fromkeys(KINDS[s.kind].short for s in shapes if s.view == view))
        if names:
            said.append(f"{', '.join(names)}: {words}")
    if not said:
        return ""
    said.append("motor rates or torques of norm one; λ: efficiencies of the whole ellipsoid")
    return "; ".join(said) + "."


def power_text(value: float) -> str:
    """A number at a tick of a logarithmic axis: powers of ten with superscripts, others as they are."""
    exponent = round(math.log10(value)) if value > 0.0 else 0
    if value <= 0.0 or not math.isclose(value, 10.0**exponent) or -3 <= exponent <= 3:
        return f"{value:g}"
    return f"10{str(exponent).translate(SUPERSCRIPTS)}"


def _component(value: float) -> str:
    text = f"{value:.2f}"
    return "0" if float(text) == 0.0 else text.replace("-", "−")


def _number(value: float) -> str:
    if math.isnan(value):
        return "undefined"
    if math.isinf(value):
        return "∞"
    if value == 0.0:
        return "0"
    exponent = math.floor(math.log10(abs(value)))
    if 3 <= exponent < 5:
        return f"{float(f'{value:.3g}'):.0f}"
    if -4 < exponent < 3:
        return f"{value:#.3g}".removesuffix(".")
    mantissa, power = f"{value:.2e}".split("e")
    return f"{mantissa}·10{str(int(power)).translate(SUPERSCRIPTS)}"
