"""How exactly the numbers of an MJCF document are known, from the digits they were typed with."""

from __future__ import annotations

import math
from typing import Final

from vincula.files.digits import half_unit
from vincula.files.meant import angle_doubt, direction_doubt
from vincula.files.mjcf_checks import PLACED, PLACING, angle_unit, numbers_of
from vincula.files.mjcf_document import Document
from vincula.files.xmltree import Element
from vincula.mechanism.parts import Precision

_SITE_REFERENCES: Final = ("site1", "site2")


def typed_precision(document: Document) -> Precision:
    """Half a unit of the last typed digit, the largest over everything that makes the mechanism.

    Where a free body stands at first is no dimension, nor is a site unless a loop closes at it, nor
    the zero of a joint (`ref`): their digits do not count.
    """
    length = angle = 0.0
    for part in document.all_documents():
        unit = math.pi / 180 if angle_unit(part) == "degree" else 1.0
        closing = _closing_sites(part)
        for element in part.root.walk():
            if element.tag not in PLACED or _is_no_dimension(element, closing):
                continue
            for attribute in PLACING:
                if attribute in element.attributes:
                    far, turned = _errors(attribute, numbers_of(element, attribute), unit)
                    length, angle = max(length, far), max(angle, turned)
    return Precision(digits_length=length, digits_angle=angle)


def _closing_sites(document: Document) -> set[str]:
    return {
        element.attributes[key]
        for element in document.root.walk()
        if element.tag in ("connect", "weld")
        for key in _SITE_REFERENCES
        if key in element.attributes
    }


def _is_no_dimension(element: Element, closing: set[str]) -> bool:
    if element.tag == "site":
        return element.name not in closing
    if element.tag == "body":
        return any(c.tag == "freejoint" or c.attributes.get("type") == "free" for c in element.children)
    return False


def _errors(attribute: str, words: list[str], unit: float) -> tuple[float, float]:
    """Errors of one attribute as a length [m] and an angle [rad]; `unit` is one typed angle in radians."""
    if attribute in ("pos", "anchor"):
        return max(map(half_unit, words)), 0.0
    if attribute == "relpose":
        return max(map(half_unit, words[:3])), 2 * _direction_error(words[3:], quaternion=True)
    if attribute == "quat":
        return 0.0, 2 * _direction_error(words, quaternion=True)
    if attribute == "euler":
        return 0.0, max(_angular(word, unit) for word in words)
    if attribute == "axisangle":
        return 0.0, max(_direction_error(words[:3]), _angular(words[3], unit))
    if attribute == "xyaxes":
        return 0.0, max(_direction_error(words[:3]), _direction_error(words[3:]))
    if attribute in ("axis", "zaxis"):
        return 0.0, _direction_error(words)
    return 0.0, 0.0


def _direction_error(words: list[str], *, quaternion: bool = False) -> float:
    size = math.hypot(*map(float, words))
    if not size > 0:
        return 0.0
    rounded = max(half_unit(word, length=False) for word in words) / size
    return max(rounded, direction_doubt(words, quaternion=quaternion))


def _angular(word: str, unit: float) -> float:
    doubt = angle_doubt(word, degrees=unit != 1.0)
    return unit * max(half_unit(word, length=False), doubt)
