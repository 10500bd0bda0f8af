"""An MJCF document written out again for MuJoCo, so that it sees only what we have read and checked.

Every element begins on a line of its own, numbered through all documents, so that a line in one of
MuJoCo's messages leads back to the element wherever it was included from.  Two versions are
written: a complete one, for MuJoCo to check against its schema, and a bare one to compile: bodies,
joints, sites, loops and motors, without geoms and assets, every body and joint with unit inertia, and
without forces, because MuJoCo steps every model once that it compiles.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Final
from xml.sax.saxutils import quoteattr

from vincula.files.mjcf_document import Document
from vincula.files.xmltree import Element

_UNIT_INERTIA: Final = '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>'
_NO_SIMULATION: Final = '<compiler><lengthrange mode="none"/></compiler>'

_OPTIONS_KEPT: Final = frozenset(("actuatorgroupdisable",))

_LEFT_OUT: Final = frozenset(
    ("size", "visual", "statistic", "custom", "deformable", "contact", "sensor", "extension")
)
_LEFT_OUT_INSIDE: Final = frozenset(("geom", "camera", "light", "inertial", "skin", "lengthrange"))
_TREE: Final = frozenset(("worldbody", "body", "frame", "replicate", "spatial", "compiler", "composite"))

CHANGING_THE_TREE: Final = {
    "fusestatic": "bodies without joints are kept under their names",
    "alignfree": "frames of free bodies stay as they are written",
}
"""Compiler attributes that would change bodies and frames, and what is done instead."""

_ABOUT_MASSES: Final = frozenset((
    "discardvisual", "inertiafromgeom", "inertiagrouprange", "settotalmass", "boundmass", "boundinertia",
    "balanceinertia", "saveinertial", "usethread", "exactmeshinertia", "fitaabb",
))  # fmt: skip
_COMPILER_LEFT_OUT: Final = _ABOUT_MASSES.union(CHANGING_THE_TREE)


@dataclass(slots=True)
class Written:
    """A document as text for MuJoCo.

    Attributes:
        text: The main document.
        files: Texts of attached models by the file name that stands in the text.
        elements: The element that begins on each line of any of the texts.
    """

    text: str = ""
    files: dict[str, str] = field(default_factory=dict)
    elements: dict[int, Element] = field(default_factory=dict)


def write_complete(document: Document) -> Written:
    """Everything, for the schema check."""
    return _Writer(bare=False).written(document)


def write_bare(document: Document, disabled: Iterable[str]) -> Written:
    """What makes the mechanism, for compiling.

    Args:
        document: The document.
        disabled: Flags of MuJoCo's engine to switch off.
    """
    return _Writer(bare=True, disabled=disabled).written(document)


class _Writer:
    """Writes documents one after the other; lines are numbered on through all of them."""

    def __init__(self, *, bare: bool, disabled: Iterable[str] = ()) -> None:
        self._bare = bare
        flags = "".join(f' {flag}="disable"' for flag in disabled)
        self._settings = f"{_NO_SIMULATION}<option><flag{flags}/></option>"
        self._line = 1
        self._files: dict[str, str] = {}
        self._elements: dict[int, Element] = {}
        self._names: dict[int, str] = {}

    def written(self, document: Document) -> Written:
        text = self._document(document)
        return Written(text, self._files, self._elements)

    def _document(self, document: Document) -> str:
        for element, model in document.models:
            name = f"attached-model-{len(self._files) + 1}.xml"
            self._names[id(element)] = name
            self._files[name] = ""
            self._files[name] = self._document(model)
        # Blank lines make the line numbers of this text unlike those of any other.
        lines = [""] * (self._line - 1)
        self._write(document.root, lines)
        return "\n".join(lines)

    def _write(self, element: Element, lines: list[str]) -> None:
        attributes = self._attributes(element)
        words = "".join(f" {name}={quoteattr(value)}" for name, value in attributes.items())
        children = [child for child in element.children if not self._drops(element, child)]
        self._elements[self._line] = element
        self._line += 1
        extra = self._extra(element)
        if not children and not extra:
            lines.append(f"<{element.tag}{words}/>")
            return
        lines.append(f"<{element.tag}{words}>{extra}")
        for child in children:
            self._write(child, lines)
        lines[-1] += f"</{element.tag}>"

    def _drops(self, element: Element, child: Element) -> bool:
        if not self._bare:
            return False
        if element.parent is None and child.tag in _LEFT_OUT:
            return True
        if element.tag == "asset":
            return child.tag != "model"
        if element.tag == "composite":
            return child.tag == "skin"
        if element.tag == "equality":
            return child.tag.startswith("flex")
        return element.tag in _TREE and child.tag in _LEFT_OUT_INSIDE

    def _extra(self, element: Element) -> str:
        if not self._bare:
            return ""
        if element.tag == "body":
            return _UNIT_INERTIA
        return self._settings if element.parent is None else ""

    def _attributes(self, element: Element) -> dict[str, str]:
        attributes = dict(element.attributes)
        if id(element) in self._names:
            attributes["file"] = self._names[id(element)]
        if self._bare:
            # The material of a site or tendon is an asset, and those are left out.
            attributes.pop("material", None)
        if self._bare and element.tag == "compiler":
            attributes = {name: value for name, value in attributes.items() if name not in _COMPILER_LEFT_OUT}
        if self._bare and element.tag == "option":
            attributes = {name: value for name, value in attributes.items() if name in _OPTIONS_KEPT}
        if self._bare and element.tag in ("joint", "freejoint"):
            attributes.pop("align", None)
        if self._bare and element.tag == "joint" and _in_tree(element):
            attributes["armature"] = "1"
        return attributes


def _in_tree(element: Element) -> bool:
    return element.parent is not None and element.parent.tag in _TREE - {"spatial", "composite"}
