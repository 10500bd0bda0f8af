"""Numbers and names of XML attributes and texts, with every problem told at its place."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final

import numpy as np

from vincula.arrays import Matrix, Vector
from vincula.files.digits import half_unit, is_number
from vincula.files.limits import LARGEST_NUMBER
from vincula.files.meant import angle_doubt, direction_doubt
from vincula.files.names import name_problem
from vincula.files.problems import Problems, shown
from vincula.files.xmltree import Element
from vincula.mechanism.parts import SMALLEST_DIRECTION

_LIMITS: Final = ("lower", "upper", "velocity", "effort")
"""Limits may be as large as numbers can be: files write the largest number there is for none."""


@dataclass
class TypedDigits:
    """Half units of the last typed digits, the largest so far."""

    length: float = 0.0
    angle: float = 0.0


class XmlValues:
    """Reads values of elements; what is wrong goes to the problems, and a default is returned.

    Args:
        problems: Where problems go.
        digits: Where the typed digits of kinematic numbers are kept.
    """

    def __init__(self, problems: Problems, digits: TypedDigits) -> None:
        self.problems, self.digits = problems, digits

    def name(self, element: Element, attribute: str = "name", *, what: str = "") -> str:
        """A required name; empty after a problem."""
        text = element.get(attribute)
        kind = what or f"attribute {attribute!r}"
        if text is None:
            self.problems.add(element.place, f"{kind} is missing")
            return ""
        wrong = name_problem(text)
        if wrong:
            self.problems.add(element.place, got=shown(text), expected=wrong)
            return ""
        return text

    def child_link(self, element: Element, tag: str, attribute: str = "link") -> str:
        """The link named by a child element such as `<parent link="..."/>`."""
        children = list(element.find_all(tag))
        if len(children) != 1:
            self.problems.add(element.place, f"expected one <{tag} {attribute}=...>, got {len(children)}")
            return ""
        return self.name(children[0], attribute)

    def numbers(self, element: Element, text: str, count: int, *, what: str, unit: str = "") -> Vector | None:
        """Exactly `count` finite numbers of a text, or None after a problem.

        Args:
            element: Where the text stands.
            text: The text.
            count: How many numbers.
            what: What they are, for messages.
            unit: `length` or `angle` when typed digits count.
        """
        words = text.split()
        if len(words) != count:
            self.problems.add(
                element.place, got=f"{what}={shown(text)} ({len(words)} numbers)", expected=f"{count} numbers"
            )
            return None
        values = [self._number(element, word, what, unit) for word in words]
        return None if None in values else np.array(values, dtype=float)

    def number(
        self, element: Element, attribute: str, *, default: float | None = None, unit: str = ""
    ) -> float | None:
        """One finite number of an attribute; the default when it is absent, None after a problem."""
        text = element.get(attribute)
        if text is None:
            return default
        return self._number(element, text.strip(), attribute, unit)

    def _number(self, element: Element, word: str, what: str, unit: str) -> float | None:
        value = float(word) if is_number(word) and len(word) <= 400 else math.nan
        if not math.isfinite(value):
            self.problems.add(
                element.place, got=f"{what}={shown(word)}", expected="a finite number such as 0.25 or 1e-3"
            )
            return None
        if abs(value) > LARGEST_NUMBER and what not in _LIMITS:
            self.problems.add(
                element.place,
                got=f"{what}={shown(word)}",
                expected=f"a number of at most {LARGEST_NUMBER:g} in size",
            )
            return None
        if unit == "length":
            self.digits.length = max(self.digits.length, half_unit(word))
        elif unit == "angle":
            self.digits.angle = max(self.digits.angle, half_unit(word, length=False))
        return value

    def direction(self, element: Element, text: str, *, what: str) -> Vector | None:
        """A unit vector; any length that is not nearly zero is accepted."""
        vector = self.numbers(element, text, 3, what=what, unit="angle")
        if vector is None:
            return None
        size = float(np.linalg.norm(vector))
        if not size >= SMALLEST_DIRECTION:
            self.problems.add(
                element.place, got=f"{what}={shown(text)}", expected="a direction: a vector of length one"
            )
            return None
        self.digits.angle = max(self.digits.angle, direction_doubt(text.split()))
        return vector if abs(size - 1.0) < 1e-15 else vector / size

    def angles(self, element: Element, text: str, *, what: str, degrees: bool = False) -> Matrix | None:
        """Rotation of fixed-axis roll, pitch, yaw [rad]; more than 2 pi must be degrees: refused."""
        values = self.numbers(element, text, 3, what=what, unit="angle")
        if values is None:
            return None
        doubt = max(angle_doubt(word, degrees=degrees) for word in text.split())
        self.digits.angle = max(self.digits.angle, math.radians(doubt) if degrees else doubt)
        if degrees:
            values = np.radians(values)
        if float(np.abs(values).max()) > 2 * math.pi + 1e-3:
            self.problems.add(
                element.place,
                got=f"{what}={shown(text)}",
                expected="radians between -2 pi and 2 pi (degrees?)",
            )
            return None
        return rotation_from_rpy(values)

    def only(self, element: Element, known: Iterable[str]) -> None:
        """Refuse child elements that are not known, with a suggestion."""
        choices = list(known)
        for child in element.children:
            if child.tag not in choices:
                self.problems.add(
                    child.place,
                    f"<{child.tag}> is not understood in <{element.tag}>",
                    name=child.tag,
                    choices=choices,
                )


def rotation_from_rpy(angles: Vector) -> Matrix:
    """Rotation Rz(yaw) Ry(pitch) Rx(roll) of URDF and SDF [rad]."""
    (cr, cp, cy), (sr, sp, sy) = np.cos(angles), np.sin(angles)
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )
