"""How exactly a typed number is known: half a unit of its last digit.

A number counts as rounded when it was typed with at least four digits after the point; a length only
if four of its digits are significant as well: 1.5708 and 0.02645 may be rounded, 1.57 and 0.0061 are
taken as meant.  So 6.1 mm is exact whether it is typed in millimetres or in metres.  Angles and
components of directions have no such choice of unit: 0.00001 beside 1.0000 is a rounded direction.
"""

from __future__ import annotations

import re
from typing import Final

FEWEST_DIGITS: Final = 4
"""Numbers with fewer digits after the point, lengths with fewer significant ones, are exact."""

_NUMBER: Final = re.compile(r"[+-]?(?:([0-9]+)\.?([0-9]*)|\.([0-9]+))(?:[eE]([+-]?[0-9]+))?")


def is_number(text: str) -> bool:
    """Whether a text is a decimal number as files write it (`1e-5`, not `0x10`, `1_000` or `nan`)."""
    return _NUMBER.fullmatch(text) is not None


def half_unit(text: str, *, length: bool = True) -> float:
    """Half a unit of the last digit of a typed number, in its own unit; 0 where it counts as exact.

    Args:
        text: The number as it was typed; `1.5708` gives 5e-5, `1.2345e-3` gives 5e-8, `1.57` gives 0.
        length: False for angles and components of directions, of which few digits need be significant.
    """
    match = _NUMBER.fullmatch(text)
    if match is None:
        return 0.0
    before, after = match[1] or "", match[2] or match[3] or ""
    if len(after) < FEWEST_DIGITS:
        return 0.0
    if length and len((before + after).lstrip("0")) < FEWEST_DIGITS:
        return 0.0
    power = int(match[4] or 0) - len(after)
    return 0.5 * 10.0**power if -300 < power < 300 else 0.0


def last_unit(text: str) -> float:
    """One unit of the last digit of a typed number, however few digits it has; 0 for other texts."""
    match = _NUMBER.fullmatch(text)
    if match is None:
        return 0.0
    power = int(match[4] or 0) - len(match[2] or match[3] or "")
    return float(f"1e{power}") if -300 < power < 300 else 0.0


def significant_digits(text: str) -> int:
    """Digits of a typed number from its first one that is not zero; 0 for other texts."""
    match = _NUMBER.fullmatch(text)
    return 0 if match is None else len(((match[1] or "") + (match[2] or match[3] or "")).lstrip("0"))
