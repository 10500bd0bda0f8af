"""Units of length and angle that things may be given in; inside, everything is in metres and radians."""

from __future__ import annotations

import math
import re
from typing import Final, Literal

from vincula.errors import ModelError, NonFiniteError, listing

Dimension = Literal["length", "angle", "number"]

UNITS: Final[dict[Dimension, dict[str, float]]] = {
    "length": {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "in": 0.0254},
    "angle": {"rad": 1.0, "deg": math.pi / 180.0},
    "number": {},
}
"""Size of every unit in metres or radians, by dimension."""

_NUMBER = r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"
_QUANTITY = re.compile(rf"\s*({_NUMBER})\s*([A-Za-z]*)\s*", re.ASCII)


def quantity(value: float | str, dimension: Dimension, what: str = "value") -> float:
    """A number in metres or radians from a number, or from a text with a unit like `1.5deg` or `20 mm`.

    Args:
        value: A number (metres, radians), or a text: a number and, if wanted, a unit.
        dimension: `length`, `angle` or `number` (no unit).
        what: What it is, for messages.

    Raises:
        ModelError: The text is not a number, or its unit is not one of this dimension.
        NonFiniteError: NaN or infinity.
    """
    if isinstance(value, str):
        number, unit = _split(value, what)
        sizes = UNITS[dimension]
        if unit and unit not in sizes:
            raise ModelError(f"{what} is {value!r}: the unit {unit!r} is not one of {listing(sizes)}")
        result = number * sizes.get(unit, 1.0)
    elif isinstance(value, bool):
        raise ModelError(f"{what} is {value!r}: give a number, or a text like {_example(dimension)!r}")
    else:
        result = float(value)
    if not math.isfinite(result):
        raise NonFiniteError(what, (), result)
    return result


def _split(text: str, what: str) -> tuple[float, str]:
    found = _QUANTITY.fullmatch(text)
    if found is None:
        raise ModelError(f"{what} is {text!r}: give a number, with a unit if wanted (1.5, 20mm, 30deg)")
    return float(found[1]), found[2]


def _example(dimension: Dimension) -> str:
    return {"length": "20mm", "angle": "30deg", "number": "1.5"}[dimension]
