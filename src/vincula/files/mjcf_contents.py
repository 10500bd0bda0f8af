"""What of an MJCF file is used, to the last attribute: MuJoCo reads it all, the mechanism keeps some."""

from __future__ import annotations

from collections import Counter
from typing import Final

from vincula.files.contents import account_repairs
from vincula.files.mjcf_document import Document
from vincula.files.report import Fate, LoadReport
from vincula.files.xmltree import Element

_PLACED: Final = ("name", "pos", "quat", "axisangle", "xyaxes", "zaxis", "euler")
_EQUALITY: Final = (
    "name", "class", "active", "body1", "body2", "site1", "site2", "anchor", "relpose", "torquescale",
    "joint1", "joint2", "tendon1", "tendon2", "polycoef",
)  # fmt: skip
_MOTOR: Final = (
    "name", "class", "joint", "jointinparent", "tendon", "gear", "group", "forcerange", "forcelimited",
)  # fmt: skip
_ATTRIBUTES: Final[dict[str, tuple[str, ...]]] = {
    "mujoco": ("model",),
    "include": ("file",),
    "compiler": ("angle", "eulerseq", "autolimits", "coordinate"),
    "option": ("actuatorgroupdisable",),
    "flag": ("equality",),
    "default": ("class",),
    "body": (*_PLACED, "childclass", "mocap"),
    "frame": (*_PLACED, "childclass"),
    "site": (*_PLACED, "class", "fromto"),
    "replicate": ("count", "offset", "euler", "sep", "childclass"),
    "composite": (
        "prefix",
        "type",
        "count",
        "offset",
        "spacing",
        "vertex",
        "initial",
        "curve",
        "size",
        "quat",
    ),
    "attach": ("model", "body", "prefix"),
    "model": ("name", "file"),
    "joint": (
        *("name", "class", "type", "pos", "axis", "ref", "range", "limited", "actuatorfrcrange"),
        *("actuatorfrclimited", "coef", "joint", "kind"),
    ),
    "freejoint": ("name",),
    "fixed": ("name", "class"),
    "key": ("name", "qpos", "mpos", "mquat"),
    **dict.fromkeys(("connect", "weld", "equality"), _EQUALITY),
    **dict.fromkeys(
        (
            "motor",
            "general",
            "position",
            "velocity",
            "intvelocity",
            "damper",
            "cylinder",
            "muscle",
            "dcmotor",
        ),
        _MOTOR,
    ),
}
"""Attributes that make the mechanism; of elements that are not here nothing does."""

_SECTIONS: Final = {"equality": "equality", "actuator": "motor", "tendon": "tendon"}
"""Sections whose elements the compiled model names, and what they are called in the report."""
_WRAPPERS: Final = ("worldbody", "keyframe", *_SECTIONS)


def account_document(document: Document, report: LoadReport) -> None:
    """Count the elements and attributes of a document, its includes and the models attached to it.

    Loops, motors and tendons have the fate that the compiled model gave them.
    """
    elements: Counter[Fate] = Counter()
    attributes: Counter[Fate] = Counter()
    left: Counter[str] = Counter()
    for part in document.all_documents():
        told = _told(part, report)
        waiting = [(part.root, True)]
        for holder in part.holders:
            _count(holder, True, elements, attributes, left)
        while waiting:
            element, around = waiting.pop()
            used = around and _is_used(element, told)
            _count(element, used, elements, attributes, left)
            waiting += [(child, used) for child in element.children]
    for name, count in left.items():
        report.ignored("attribute", name, "settings of the simulator, not of the mechanism", count)
    report.contain("elements", elements)
    report.contain("attributes", attributes)
    account_repairs(report)


def _count(
    element: Element, used: bool, elements: Counter[Fate], attributes: Counter[Fate], left: Counter[str]
) -> None:
    """Count one element, not what is inside it; and by name what a used one has that is not used."""
    elements["used" if used else "ignored"] += 1
    known = _known(element) if used else ()
    for attribute in element.attributes:
        attributes["used" if attribute in known else "ignored"] += 1
        if used and attribute not in known:
            left[f"{element.tag}/@{attribute}"] += 1


def _known(element: Element) -> tuple[str, ...]:
    around = element.parent.tag if element.parent is not None else ""
    return _EQUALITY if around == "equality" else _ATTRIBUTES.get(element.tag, ())


def _is_used(element: Element, told: dict[int, bool]) -> bool:
    """Whether an element is used, where the one around it is."""
    around = element.parent.tag if element.parent is not None else ""
    if id(element) in told:
        return told[id(element)]
    if element.tag == "asset":
        return any(child.tag == "model" for child in element.children)
    return element.tag in _ATTRIBUTES or element.tag in _WRAPPERS or around in ("equality", "composite")


def _told(document: Document, report: LoadReport) -> dict[int, bool]:
    """By element, whether the report says that it was used; elements and entries are in one order."""
    found: dict[int, bool] = {}
    for section, kind in _SECTIONS.items():
        inside = [
            element
            for part in document.root.find_all(section)
            for element in part.children
            if not element.tag.startswith("flex")
        ]
        entries = [entry for entry in report.entries if entry.kind == kind][: len(inside)]
        for element, entry in zip(inside, entries, strict=False):
            found[id(element)] = entry.fate != "ignored"
    return found
