"""The snapping test for native files: a tree with numbers replaced by what they probably mean.

Replaced are coordinates of directions and points, and numbers and parameters that stand as angles in
sin, cos or tan; expressions stay, they say what they mean.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Final

from vincula.files.expressions import is_expression
from vincula.files.meant import Meant, meant_angle
from vincula.files.snapping import Part, Snap, Snapping
from vincula.files.tree import Document, Items, Leaf, Node, Table, TypedNumber, number

_POINTS: Final = ("at",)
_DIRECTIONS: Final = ("axis", "axes", "normal", "line", "x", "z")
_SECTIONS: Final = ("joints", "contacts", "frames", "bodies")
_ANGULAR: Final = re.compile(
    r"\b(?P<before>(?:sin|cos|tan)\(\s*[-+]?\s*)(?:\$(?P<name>[A-Za-z_]\w*)|(?P<number>[0-9]*\.[0-9]+))"
)


def snapped_tree(document: Document, snapping: Snapping) -> Document:
    """The document with its numbers replaced; what was replaced is added to `snapping`."""
    if not isinstance(document.root, Table):
        return document
    root = document.root
    angular = {m["name"] for text in _texts(root) for m in _ANGULAR.finditer(text) if m["name"]}
    writer = _Writer(document, snapping, _typed_lengths(root))
    entries = {
        key: writer.section(node, key) if key in _SECTIONS else writer.expressions(node, (key,))
        for key, node in root.entries.items()
    }
    table = entries.get("parameters")
    if isinstance(table, Table):
        entries["parameters"] = replace(
            table,
            entries={
                name: writer.angle(node, ("parameters", name)) if name in angular else node
                for name, node in table.entries.items()
            },
        )
    return replace(document, root=replace(root, entries=entries))


class _Writer:
    def __init__(self, document: Document, snapping: Snapping, lengths: Sequence[str]) -> None:
        self._document, self._snapping, self._lengths = document, snapping, lengths

    def section(self, node: Node, key: str) -> Node:
        """A list of joints or contacts, or a table of frames or bodies."""
        if isinstance(node, Items):
            items = tuple(self._part(item, (key, k)) for k, item in enumerate(node.items))
            return replace(node, items=items)
        if isinstance(node, Table):
            parts = {name: self._part(part, (key, name)) for name, part in node.entries.items()}
            return replace(node, entries=parts)
        return node

    def _part(self, node: Node, location: tuple[str | int, ...]) -> Node:
        if not isinstance(node, Table):
            return node
        entries: dict[str, Node] = {}
        for key, value in node.entries.items():
            kind: list[Part] | None = None
            if key in _POINTS:
                kind = [("length", 1)]
            elif key in _DIRECTIONS:
                kind = [("direction", 1)]
            place = (*location, key)
            entries[key] = (
                self.expressions(value, place) if kind is None else self._vector(value, place, kind)
            )
        return replace(node, entries=entries)

    def _vector(self, node: Node, location: tuple[str | int, ...], kind: list[Part]) -> Node:
        """Coordinates, a list of coordinates (axes), or `{in: ..., xyz: [...]}`."""
        if isinstance(node, Table):
            inner = {
                key: self._vector(value, (*location, key), kind) if key == "xyz" else value
                for key, value in node.entries.items()
            }
            return replace(node, entries=inner)
        if not isinstance(node, Items):
            return node
        if any(not isinstance(item, Leaf) for item in node.items):
            items = tuple(self._vector(item, (*location, k), kind) for k, item in enumerate(node.items))
            return replace(node, items=items)
        words = [_word(item) for item in node.items]
        count = len(words)
        parts: list[Part] = [(kind[0][0], count)]
        meanings = self._snapping.words(words, parts, self._lengths) if all(words) else None
        if meanings is None:
            items = tuple(self.expressions(item, (*location, k)) for k, item in enumerate(node.items))
            return replace(node, items=items)
        items = tuple(
            item if meant is None else self._replaced(item, word, meant, location)
            for item, word, meant in zip(node.items, words, meanings, strict=True)
        )
        return replace(node, items=items)

    def angle(self, node: Node, location: tuple[str | int, ...]) -> Node:
        """A parameter that is used as an angle."""
        word = _word(node)
        meant = meant_angle(word) if word else None
        return node if meant is None else self._replaced(node, word, meant, location)

    def expressions(self, node: Node, location: tuple[str | int, ...]) -> Node:
        """Anything else, with the angles typed inside its expressions replaced."""
        if isinstance(node, Items):
            items = tuple(self.expressions(item, (*location, k)) for k, item in enumerate(node.items))
            return replace(node, items=items)
        if isinstance(node, Table):
            inner = {key: self.expressions(value, (*location, key)) for key, value in node.entries.items()}
            return replace(node, entries=inner)
        if not isinstance(node.value, str) or not is_expression(node.value):
            return node

        def other(match: re.Match[str]) -> str:
            meant = meant_angle(match["number"]) if match["number"] else None
            if meant is None:
                return match[0]
            self._tell(node, match["number"], meant, location)
            return f"{match['before']}{meant.words}"

        return replace(node, value=_ANGULAR.sub(other, node.value))

    def _replaced(self, node: Node, word: str, meant: Meant, location: tuple[str | int, ...]) -> Node:
        self._tell(node, word, meant, location)
        value = meant.words if is_expression(meant.words) else number(repr(meant.value))
        return Leaf(value, node.line, node.column)

    def _tell(self, node: Node, word: str, meant: Meant, location: tuple[str | int, ...]) -> None:
        place = self._document.place(location)
        path, _, what = place.path.rpartition("/")
        placed = replace(place, line=node.line, column=node.column)
        self._snapping.found.append(Snap(placed, path, what, word, meant.words))


def _word(node: Node) -> str:
    """A typed number as its text; empty for anything else."""
    if not isinstance(node, Leaf) or isinstance(node.value, (bool, str)) or node.value is None:
        return ""
    return node.value.text if isinstance(node.value, TypedNumber) else str(node.value)


def _texts(node: Node) -> Iterator[str]:
    if isinstance(node, Leaf):
        if isinstance(node.value, str):
            yield node.value
        return
    for child in node.items if isinstance(node, Items) else node.entries.values():
        yield from _texts(child)


def _typed_lengths(root: Table) -> list[str]:
    """Typed coordinates of all points."""
    return [
        word
        for section in _SECTIONS
        for word in _coordinates(root.entries.get(section), inside=False)
    ]  # fmt: skip


def _coordinates(node: Node | None, *, inside: bool) -> Iterator[str]:
    if isinstance(node, Leaf):
        if inside and _word(node):
            yield _word(node)
    elif isinstance(node, Items):
        for item in node.items:
            yield from _coordinates(item, inside=inside)
    elif isinstance(node, Table):
        for key, value in node.entries.items():
            yield from _coordinates(value, inside=inside or key in _POINTS)
