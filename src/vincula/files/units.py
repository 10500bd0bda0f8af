"""The units that the numbers of a file are in, and the way from there to metres and radians."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from vincula.elementary import hypot
from vincula.files.expressions import Measured, exact_number
from vincula.files.traced_digits import doubt_of_direction
from vincula.mechanism.parts import Precision
from vincula.numerics.surds import ExactFloat, NotExactError, Surd
from vincula.spatial.units import UNITS
from vincula.traced import holds_traced

if TYPE_CHECKING:
    from vincula.files.schema import PrecisionEntry


@dataclass(frozen=True, slots=True)
class Units:
    """Units of length and angle of a file.

    Attributes:
        length: m, mm, cm or in.
        angle: rad or deg.
    """

    length: Literal["m", "mm", "cm", "in"] = "m"
    angle: Literal["rad", "deg"] = "rad"

    def metres(self, value: float) -> float:
        """A length of the file in metres."""
        size = UNITS["length"][self.length]
        per_metre = round(1.0 / size)
        # 333.3 mm / 1000 is the double next to 0.3333; 333.3 * 1e-3 is not always.
        return value / per_metre if size == 1.0 / per_metre else value * size

    def radians(self, value: float) -> float:
        """An angle of the file in radians."""
        return math.radians(value) if self.angle == "deg" else value

    def size(self, linear: bool) -> float:
        """One unit of length in metres, or one unit of angle in radians."""
        return UNITS["length"][self.length] if linear else UNITS["angle"][self.angle]

    def inside(self, value: float, linear: bool) -> float:
        """A value of an axis in metres or radians."""
        return self.metres(value) if linear else self.radians(value)

    @property
    def exact_metre(self) -> Surd:
        """One unit of length in metres, exactly."""
        return Surd.decimal({"m": "1", "mm": "1e-3", "cm": "1e-2", "in": "0.0254"}[self.length])

    @property
    def is_si(self) -> bool:
        """Whether nothing needs converting."""
        return self.length == "m" and self.angle == "rad"


SI = Units()
"""Metres and radians."""


class Scale:
    """Converts the numbers of one file and remembers how roughly they were typed."""

    def __init__(self, units: Units) -> None:
        self.units = units
        self._length = self._angle = 0.0

    def length(self, number: Measured) -> float:
        """A length in metres."""
        self._length = max(self._length, self.units.metres(number.half_unit))
        return _known(number, self.units.metres(number.value), self.units.exact_metre)

    def point(self, numbers: Sequence[Measured]) -> tuple[float, ...]:
        """A position in metres."""
        return tuple(self.length(number) for number in numbers)

    def direction(self, numbers: Sequence[Measured]) -> tuple[float, ...]:
        """A direction as it is; its digits count as an angle."""
        values = tuple(_known(number, number.value, Surd.of(1)) for number in numbers)
        size = hypot(*values)
        if size > 0.0:
            off = max(max(number.half_unit, number.angular_half_unit) for number in numbers)
            # Typed digits are those that Python prints: the shortest that give the same double.
            self._angle = max(self._angle, off / size, doubt_of_direction(values))
        return values

    def precision(self, base: Precision, declared: PrecisionEntry | None = None) -> Precision:
        """How roughly numbers are known: by their digits, or by what the file says instead of them.

        Args:
            base: What is known of the file below this one.
            declared: What the file says.
        """
        length, angle = self._length, self._angle
        if declared is not None:
            length = self.units.metres(declared.length.value) if declared.length else 0.0
            angle = self.units.radians(declared.angle.value) if declared.angle else 0.0
        return Precision(
            digits_length=max(length, base.digits_length),
            digits_angle=max(angle, base.digits_angle),
            tolerance_length=base.tolerance_length,
            tolerance_angle=base.tolerance_angle,
        )


def _known(number: Measured, value: float, unit: Surd) -> float:
    """A converted value that knows which number it stands for, where its digits do not say it."""
    if holds_traced(value) or (not number.computed and value == number.value):
        return value
    try:
        return ExactFloat(value, exact_number(number).number * unit)
    except NotExactError:
        return ExactFloat(value, None)
