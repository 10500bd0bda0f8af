"""What typed angles and directions may mean, of floats and of traced numbers.

Of floats it is asked of their digits (`meant`).  A traced number stands for many; as good as none of them has
few digits or is nearly zero, and one that has is not traced: it is built by itself.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

from vincula.elementary import hypot, is_less, nearest, smaller
from vincula.files.meant import CLOSE, NOTHING, angle_doubt, direction_doubt
from vincula.traced import Number, holds_traced

_DIGITS: Final = 1e12
_FRACTION: Final = 2e-4
"""A number of at most twelve decimals times 1e12 is this near to a whole number, others hardly ever."""
_PART: Final = math.pi / 12.0
_KNOWN: Final = (0.0, 1.0, 0.5, *(math.sqrt(x) for x in (1 / 2, 3 / 4, 1 / 3, 2 / 3)),
                 *(math.cos(k * _PART) for k in (1, 5)))  # fmt: skip
"""Components that a typed direction may mean."""


def doubt_of_angle(x: Number) -> float:
    """How far an angle is from the one that it probably means [rad].

    Raises:
        TypeError: A traced angle that may mean another one.
    """
    if not holds_traced(x):
        return angle_doubt(repr(x))
    count = nearest(x / _PART)
    away = abs(x - count * _PART)
    near = is_less(away, CLOSE * _PART * abs(count)) * _is_short(x)
    tiny = is_less(abs(x), NOTHING * (1.0 + 1e-9)) * is_less(0.0, abs(x))
    _refuse(near + tiny)
    return 0.0


def doubt_of_direction(values: Sequence[Number]) -> float:
    """Angle between a direction and the one that it probably means [rad].

    Raises:
        TypeError: A traced direction that may mean another one.
    """
    if not holds_traced(values):
        return direction_doubt([repr(value) for value in values])
    size = hypot(*values)
    unit: Number = is_less(abs(size - 1.0), 2.0 * CLOSE)
    tiny: Number = 0.0
    for x in values:
        distance = _nearest_known(abs(x))
        unit = unit * is_less(distance, CLOSE)
        if holds_traced(x):
            tiny = tiny + is_less(abs(x), NOTHING * size) * is_less(0.0, abs(x))
    short: Number = 0.0
    for x in values:
        short = short + _is_short(x) if holds_traced(x) else short
    _refuse(tiny + unit * short)
    return 0.0


def _nearest_known(x: Number) -> Number:
    found = abs(x - _KNOWN[0])
    for known in _KNOWN[1:]:
        found = smaller(found, abs(x - known))
    return found


def _is_short(x: Number) -> Number:
    """1 where a number has few digits (or looks like it), else 0."""
    scaled = x * _DIGITS
    return is_less(abs(scaled - nearest(scaled)), _FRACTION)


def _refuse(doubted: Number) -> None:
    """Refuse numbers whose doubt is not zero; for others of the trace it is a guard."""
    if not doubted == 0.0:
        raise TypeError("a number that may mean another one is not traced")
