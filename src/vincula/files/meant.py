"""What a typed number was probably meant to be: 1.57 for pi/2, 0.7071 for a root of 1/2, 0.00002 for 0.

An angle means a multiple of pi/12 when it is within five units of its last digit and within a
thousandth of it, and has three significant digits: 1.57, 1.5708, 3.1415, and 1.57075, which is half of
3.1415 and 4.6 units away from pi/2.  An angle or component below `NOTHING` means 0.  A direction means
one whose components are roots of simple fractions.  Nothing here changes a number: readers count the
distance as doubt, and `snapping` puts the other number in on request.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Final

from vincula.files.digits import last_unit, significant_digits

MOST_UNITS: Final = 5.0
"""How many units of its last digit a number may be away from what it means."""
CLOSE: Final = 1e-3
"""How far it may be away, relative to itself."""
NOTHING: Final = 5e-5
"""Angles [rad] and components of unit vectors below this mean zero."""
FEWEST: Final = 3
"""Numbers with fewer significant digits are taken as they are."""
_SAME: Final = 1e-14
"""Relative difference of doubles that are the same number written twice."""

_PARTS_OF_A_TURN: Final = 12
_COSINES: Final = {math.cos(k * math.pi / 12): f"cos({k}*pi/12)" for k in (1, 5)}
_ROOTS: Final = {1.0: "1", 0.0: "0", 0.5: "1/2"} | {
    math.sqrt(Fraction(*pair)): f"sqrt({pair[0]}/{pair[1]})" for pair in ((1, 2), (3, 4), (1, 3), (2, 3))
}
_COMPONENTS: Final = _ROOTS | _COSINES
_HALF_TURNS: Final = {math.cos(k * math.pi / 24): f"cos({k}*pi/24)" for k in range(1, 12)}
_QUATERNIONS: Final = (
    _HALF_TURNS
    | {math.sqrt(0.5) * cosine: f"sqrt(1/2)*{words}" for cosine, words in _HALF_TURNS.items()}
    | _ROOTS
)

_MOST_PARTS: Final = 1e9
"""An angle of more parts of a turn is none; nothing is known about what it means."""


@dataclass(frozen=True, slots=True)
class Meant:
    """What a number probably means.

    Attributes:
        value: The number that is meant, in the unit that was typed.
        words: The same for people, as an expression of native files: `pi/2`, `sqrt(1/2)`, `90`.
    """

    value: float
    words: str


def meant_angle(text: str, *, degrees: bool = False) -> Meant | None:
    """The multiple of pi/12 (15 degrees) that a typed angle means; None where it is taken as it is."""
    value, part = float(text), 15.0 if degrees else math.pi / _PARTS_OF_A_TURN
    if not abs(value) < _MOST_PARTS * part:
        return None
    count = round(value / part)
    target = count * 15.0 if degrees else math.pi * count / _PARTS_OF_A_TURN
    away = abs(value - target)
    if away <= _SAME * part:
        return None
    if count == 0:
        return Meant(0.0, "0") if away <= (math.degrees(NOTHING) if degrees else NOTHING) else None
    if not _near(text, away, target):
        return None
    return Meant(target, f"{target:g}" if degrees else _in_pi(count))


def meant_direction(words: Sequence[str]) -> tuple[Meant, ...] | None:
    """The components that a typed direction means; None where it is taken as it is."""
    return _meant_unit(words, _COMPONENTS)


def meant_quaternion(words: Sequence[str]) -> tuple[Meant, ...] | None:
    """The same for a quaternion: turns by multiples of pi/12, and what two such turns make."""
    return _meant_unit(words, _QUATERNIONS)


def meant_length(text: str, others: Sequence[str]) -> Meant | None:
    """The one longer number among `others` that a typed length is a rounding of; None for no or several."""
    value, digits = abs(float(text)), significant_digits(text)
    if digits < FEWEST:
        return None
    half = 0.5 * last_unit(text) * (1.0 + 1e-9)
    found = {
        abs(float(other)): other.lstrip("+-")
        for other in others
        if significant_digits(other) > digits and _SAME * value < abs(abs(float(other)) - value) <= half
    }
    if len(found) != 1:
        return None
    (target, written), sign = next(iter(found.items())), math.copysign(1.0, float(text))
    return Meant(sign * target, ("-" if sign < 0.0 else "") + written)


def angle_doubt(text: str, *, degrees: bool = False) -> float:
    """How far a typed angle is from the one that it probably means [as typed]; 0 where it means itself."""
    meant = meant_angle(text, degrees=degrees)
    return 0.0 if meant is None else abs(meant.value - float(text))


def direction_doubt(words: Sequence[str], *, quaternion: bool = False) -> float:
    """Angle between a typed direction and the one that it probably means [rad]; of quaternions half of it."""
    meant = meant_quaternion(words) if quaternion else meant_direction(words)
    if meant is None:
        return 0.0
    typed, target = [float(word) for word in words], [one.value for one in meant]
    sizes = math.hypot(*typed), math.hypot(*target)
    return math.dist([x / sizes[0] for x in typed], [x / sizes[1] for x in target])


def _near(text: str, away: float, target: float) -> bool:
    units = MOST_UNITS * last_unit(text) * (1.0 + 1e-9)
    return significant_digits(text) >= FEWEST and away <= min(units, CLOSE * abs(target))


def _in_pi(count: int) -> str:
    part = Fraction(count, _PARTS_OF_A_TURN)
    times = {1: "", -1: "-"}.get(part.numerator, f"{part.numerator}*")
    return f"{times}pi" + (f"/{part.denominator}" if part.denominator > 1 else "")


def _meant_unit(words: Sequence[str], known: dict[float, str]) -> tuple[Meant, ...] | None:
    """Components of a vector of length one; tiny ones are zero whatever its length."""
    values = [float(word) for word in words]
    size = math.hypot(*values)
    if not (math.isfinite(size) and size > 0.0):
        return None
    whole = _all_known(words, values, size, known)
    if whole is None:
        # Not a direction that is known as a whole: what is tiny beside it still means zero.
        whole = tuple(
            Meant(0.0, "0") if abs(value) <= NOTHING * size else Meant(value, word)
            for word, value in zip(words, values, strict=True)
        )
    length = math.hypot(*(one.value for one in whole))
    if math.dist([v / size for v in values], [one.value / length for one in whole]) <= _SAME:
        return None
    return whole


def _all_known(
    words: Sequence[str], values: Sequence[float], size: float, known: dict[float, str]
) -> tuple[Meant, ...] | None:
    """Every component as a known number, if those make a vector of length one."""
    if abs(size - 1.0) > 2.0 * CLOSE:
        return None
    found = []
    for word, value in zip(words, values, strict=True):
        target = min(known, key=lambda one: abs(one - abs(value)))
        away = abs(target - abs(value))
        few = significant_digits(word) < FEWEST
        # 0.5 beside 0.866 is meant exactly, 0.6 beside 0.8 is no known number.
        if away > (_SAME if few and target else NOTHING if not target else CLOSE) or (
            not few and target and away > MOST_UNITS * last_unit(word) * (1.0 + 1e-9)
        ):
            return None
        sign = "-" if value < 0.0 and target else ""
        found.append(Meant(math.copysign(target, value) if target else 0.0, f"{sign}{known[target]}"))
    return tuple(found) if abs(math.hypot(*(one.value for one in found)) - 1.0) <= 1e-12 else None
