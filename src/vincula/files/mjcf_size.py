"""How large an MJCF model becomes when replicates, composites and attached models are written out."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

from vincula.files.digits import is_number
from vincula.files.limits import Limits
from vincula.files.mjcf_document import Document
from vincula.files.xmltree import Element, refuse_element

_COUNTED: Final = 10**12
_LONGEST_COUNT: Final = 20


@dataclass(frozen=True, slots=True)
class _Size:
    """What an element becomes after copies are made."""

    bodies: int = 0
    joints: int = 0
    elements: int = 0

    def __add__(self, other: _Size) -> _Size:
        return _Size(self.bodies + other.bodies, self.joints + other.joints, self.elements + other.elements)

    def times(self, count: int) -> _Size:
        return _Size(self.bodies * count, self.joints * count, self.elements * count)


def check_size(document: Document, limits: Limits) -> None:
    """Refuse a document that grows over the limits when MuJoCo makes all its copies.

    Raises:
        FileError: More bodies, joints or elements than the limits allow.
    """
    size = _size(document.root, {}, document)
    for kind, most in (("bodies", limits.bodies), ("joints", limits.joints), ("elements", limits.nodes)):
        count = getattr(size, kind)
        if count > most:
            many = f"{count} {kind}" if count < _COUNTED else f"more than {_COUNTED} {kind}"
            refuse_element(document.root, f"the model has {many} with all copies, at most {most} are read")


def _size(element: Element, known: dict[int, _Size], document: Document) -> _Size:
    if id(element) in known:
        return known[id(element)]
    size = _Size(elements=1)
    for child in element.children:
        size += _size(child, known, document)
    if element.tag == "body":
        size += _Size(bodies=1)
    elif element.tag in ("joint", "freejoint"):
        size += _Size(joints=1)
    elif element.tag == "replicate":
        size = size.times(_count(element))
    elif element.tag == "composite":
        copies = _count(element)
        size += _Size(bodies=copies, joints=copies, elements=copies)
    elif element.tag == "attach":
        for model, attached in document.models:
            if element.attributes.get("model") in (model.name, "", None) or not model.name:
                size += _size(attached.root, known, attached)
    known[id(element)] = size
    return size


def _count(element: Element) -> int:
    """How many copies a replicate or composite makes; what is no number MuJoCo refuses itself."""
    copies = 1
    for word in element.attributes.get("count", "1").split():
        if is_number(word) and len(word) < _LONGEST_COUNT:
            copies *= max(1, math.ceil(abs(float(word))))
        else:
            copies *= 10**9
    return copies
