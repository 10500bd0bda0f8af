"""What is checked in an MJCF document before MuJoCo sees it: numbers, names, sizes, what is refused.

All independent problems are found in one run; MuJoCo itself stops at its first.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from typing import Final

from vincula.files.digits import is_number
from vincula.files.limits import Limits
from vincula.files.mjcf_document import Document
from vincula.files.mjcf_size import check_size
from vincula.files.names import name_problem
from vincula.files.problems import Place, Problems, shown
from vincula.files.xmltree import Element

PLACING: Final = {
    "pos": 3,
    "quat": 4,
    "euler": 3,
    "axisangle": 4,
    "xyaxes": 6,
    "zaxis": 3,
    "axis": 3,
    "anchor": 3,
    "relpose": 7,
    "ref": 1,
    "offset": 3,
    "fromto": 6,
}
"""Attributes that place bodies, joints, sites, frames and loops, and how many numbers each has."""

PLACED: Final = frozenset({"body", "joint", "freejoint", "site", "frame", "replicate", "connect", "weld"})
"""Elements whose placing attributes make the mechanism."""

_SCALING: Final = frozenset({"gear", "coef", "polycoef", "qpos"})
"""Other attributes whose numbers become part of a mechanism."""

_DIRECTIONS: Final = {"axis": 3, "zaxis": 3, "axisangle": 3, "quat": 4}
_SHORTEST: Final = 1e-9
_LARGEST: Final = 1e12
_TURN: Final = 2 * math.pi * (1 + 1e-9)

_TEXTS: Final = frozenset((
    "name", "class", "childclass", "dclass", "file", "model", "joint", "joint1", "joint2", "jointinparent",
    "body", "body1", "body2", "site", "site1", "site2", "refsite", "cranksite", "slidersite", "tendon",
    "tendon1", "tendon2", "geom", "geom1", "geom2", "sidesite", "material", "mesh", "texture", "hfield",
    "target", "prefix", "objname", "refname", "key", "actuator", "sensor", "data", "content_type",
))  # fmt: skip
_NOT_FINITE: Final = re.compile(r"[+-]?(?:nan|inf|infinity)", re.IGNORECASE | re.ASCII)
_ANGLES: Final = {"euler": slice(0, 3), "axisangle": slice(3, 4)}

_REFUSED: Final = {
    "plugin": "plugins are not loaded",
    "flexcomp": "soft bodies are not rigid bodies",
    "flex": "equalities of soft bodies are not loops of rigid bodies",
    "flexvert": "equalities of soft bodies are not loops of rigid bodies",
    "flexstrain": "equalities of soft bodies are not loops of rigid bodies",
    "distance": "a distance equality is not supported; use connect, weld, joint or tendon",
}


_KINDS_BY_SECTION: Final = {
    "tendon": "tendon",
    "actuator": "motor",
    "equality": "equality",
    "keyframe": "key",
}
_KINDS_BY_TAG: Final = {"body": "body", "joint": "joint", "freejoint": "joint", "site": "site"}


def check_document(document: Document, limits: Limits) -> None:
    """Refuse a document with numbers, names or sizes that cannot be used.

    Raises:
        UnsupportedFeatureError: The only problems are elements that vincula cannot represent.
        FileError: Anything else is wrong; every independent problem is told.
    """
    problems = Problems(document.file)
    for part in document.all_documents():
        in_radians = angle_unit(part) == "radian"
        _check_tendons(part.root, problems)
        _check_duplicates(part.root, problems)
        for element in part.root.walk():
            _check_refused(element, problems)
            _check_name(element, problems, limits)
            _check_numbers(element, problems, in_radians=in_radians)
    problems.refuse_if_any()
    check_size(document, limits)


def angle_unit(document: Document) -> str:
    """`degree` or `radian`: the last word of the document's compiler elements."""
    units = [c.attributes["angle"] for c in document.root.find_all("compiler") if "angle" in c.attributes]
    return units[-1] if units else "degree"


def numbers_of(element: Element, attribute: str) -> list[str]:
    """The words of a numeric attribute."""
    return element.attributes.get(attribute, "").split()


def _check_refused(element: Element, problems: Problems) -> None:
    reason = _REFUSED.get(element.tag)
    if reason is None:
        return
    inside = element.parent.tag if element.parent is not None else ""
    if element.tag == "plugin":
        problems.add(element.place, reason, unsupported=True)
    elif element.tag == "flexcomp" or (inside == "equality" and element.attributes.get("active") != "false"):
        problems.add(element.place, f"not supported: {reason}", unsupported=True)


def _check_tendons(root: Element, problems: Problems) -> None:
    """Active equalities of tendons through space; where a default class may switch them off, not here."""
    if any(e.tag == "equality" and "active" in e.attributes for e in root.walk()):
        return
    in_space = {e.name for e in root.walk() if e.tag == "spatial"} - {""}
    for section in root.find_all("equality"):
        for element in section.find_all("tendon"):
            named = [element.attributes.get(key, "") for key in ("tendon1", "tendon2")]
            lengths = [name for name in named if name in in_space]
            if lengths and element.attributes.get("active") != "false":
                what = f"not supported: tendon {shown(lengths[0])} runs through space"
                problems.add(
                    element.place, f"{what}, so its length is no sum of joint values", unsupported=True
                )


def _check_duplicates(root: Element, problems: Problems) -> None:
    """Two parts of a kind with one name; names of what is copied are completed by MuJoCo."""
    first: dict[tuple[str, str], Element] = {}
    waiting = list(reversed(root.children))
    while waiting:
        element = waiting.pop()
        if element.tag not in ("default", "replicate", "asset"):
            waiting.extend(reversed(element.children))
        section = element.parent.tag if element.parent is not None else ""
        kind = _KINDS_BY_SECTION.get(section) or _KINDS_BY_TAG.get(element.tag, "")
        if not kind or not element.name:
            continue
        other = first.setdefault((kind, element.name), element)
        if other is not element:
            where = Place(other.file, other.line, other.column).text()
            problems.add(element.place, f"another {kind} has this name, at {where}")


def _check_name(element: Element, problems: Problems, limits: Limits) -> None:
    if not element.name:
        return
    expected = name_problem(element.name, limits)
    if expected:
        problems.add(element.place, got=shown(element.name), expected=expected)


def _check_numbers(element: Element, problems: Problems, *, in_radians: bool) -> None:
    for attribute, value in element.attributes.items():
        if element.tag in PLACED and attribute in PLACING:
            _check_placing(element, attribute, problems, in_radians=in_radians)
        elif attribute not in _TEXTS:
            bad = next(_not_finite(value), None)
            if bad is not None:
                what = f"{attribute}: got {shown(bad)}, expected finite numbers"
                problems.add(element.place, what)
            elif attribute in _SCALING:
                _check_sizes(element, attribute, problems)


def _not_finite(value: str) -> Iterator[str]:
    """Words of an attribute that holds numbers only, and are not finite ones."""
    words = value.split()
    if all(is_number(word) or _NOT_FINITE.fullmatch(word) for word in words):
        for word in words:
            if not is_number(word) or math.isinf(float(word)):
                yield word


def _expected_instead(word: str) -> str:
    """What a word of a placing attribute should be; empty when it is a number that can be used."""
    if _NOT_FINITE.fullmatch(word):
        return "a finite number"
    if not is_number(word):
        return "a number"
    size = abs(float(word))
    if math.isinf(size):
        return "a finite number"
    return f"a number of at most {_LARGEST:g}" if size > _LARGEST else ""


def _check_sizes(element: Element, attribute: str, problems: Problems) -> None:
    for word in numbers_of(element, attribute):
        if is_number(word) and abs(float(word)) > _LARGEST:
            what = f"{attribute}: got {shown(word)}, expected numbers of at most {_LARGEST:g}"
            problems.add(element.place, what)
            return


def _check_placing(element: Element, attribute: str, problems: Problems, *, in_radians: bool) -> None:
    words, count = numbers_of(element, attribute), PLACING[attribute]
    what = f"{attribute}: got"
    for word in words:
        expected = _expected_instead(word)
        if expected:
            problems.add(element.place, f"{what} {shown(word)}, expected {expected}")
            return
    if len(words) != count:
        expected = "1 number" if count == 1 else f"{count} numbers"
        problems.add(element.place, f"{what} {shown(element.attributes[attribute])}, expected {expected}")
        return
    values = [float(word) for word in words]
    if attribute in _DIRECTIONS and math.hypot(*values[: _DIRECTIONS[attribute]]) < _SHORTEST:
        problems.add(element.place, f"{what} {shown(element.attributes[attribute])}, which has no direction")
    angles = _ANGLES.get(attribute)
    if in_radians and angles is not None and any(abs(angle) > _TURN for angle in values[angles]):
        problems.add(
            element.place,
            f"{what} {shown(element.attributes[attribute])}, expected radians of at most one turn, as the "
            "compiler element declares; are these degrees?",
        )
