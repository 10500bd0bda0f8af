"""A file as a plain tree that remembers where everything is written and how numbers were typed."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Final

from vincula.files.digits import half_unit
from vincula.files.problems import Place, Problems

Location = Sequence[str | int]
"""Keys and indices that lead from the root to a node."""


class TypedNumber(float):
    """A decimal number of a file, with half a unit of its last typed digit.

    Only numbers with at least four digits after the point are taken for rounded ones (0.7071, 1.5708);
    shorter ones are exact (see `digits`).

    Attributes:
        half_unit: Half a unit of the last digit of a length, 0 for numbers taken as exact.
        angular_half_unit: The same of an angle or a component of a direction.
        text: The number as it was typed.
    """

    half_unit: float
    angular_half_unit: float
    text: str

    def __new__(cls, text: str) -> TypedNumber:
        """The number that `text` spells."""
        number = super().__new__(cls, text)
        number.half_unit, number.text = half_unit(text), text
        number.angular_half_unit = half_unit(text, length=False)
        return number

    def __repr__(self) -> str:
        return self.text


@dataclass(frozen=True, slots=True)
class Leaf:
    """A single value.

    Attributes:
        value: Text, number (`int` or `TypedNumber`), truth value or None.
        line: Line, from 1.
        column: Column, from 1.
    """

    value: str | int | float | bool | None
    line: int
    column: int


@dataclass(frozen=True, slots=True)
class Items:
    """A list."""

    items: tuple[Node, ...]
    line: int
    column: int


@dataclass(frozen=True, slots=True)
class Table:
    """A mapping from text to values.

    Attributes:
        entries: The values by key.
        keys: Line and column of every key.
        line: Line of the first key.
        column: Its column.
    """

    entries: dict[str, Node]
    keys: dict[str, tuple[int, int]]
    line: int
    column: int


Node = Leaf | Items | Table


@dataclass(frozen=True, slots=True)
class Document:
    """A parsed file.

    Attributes:
        file: The file as the user named it.
        root: Its tree.
        syntax: `YAML` or `JSON`.
        problems: What has been found wrong so far.
    """

    file: str
    root: Node
    syntax: str
    problems: Problems = field(compare=False)

    def plain(self) -> Any:
        """The whole tree as dicts, lists and values."""
        return plain(self.root)

    def node(self, location: Location) -> Node | None:
        """The node at a location, None where there is none."""
        node: Node | None = self.root
        for step in location:
            node = _child(node, step)
        return node

    def place(self, location: Location, *, at_key: bool = False) -> Place:
        """Where a location is written; the nearest thing around it when it is not in the file.

        Args:
            location: Keys and indices from the root.
            at_key: Point at the key of the last step instead of at its value.
        """
        node, path = self.root, ""
        line, column = node.line, node.column
        for index, step in enumerate(location):
            last = index == len(location) - 1
            child = _child(node, step)
            path = _path_with(path, step, child)
            if last and at_key and isinstance(node, Table) and step in node.keys:
                line, column = node.keys[str(step)]
                break
            if child is None:
                break
            node = child
            line, column = node.line, node.column
        return Place(self.file, line, column, path)


def _child(node: Node | None, step: str | int) -> Node | None:
    if isinstance(node, Table) and isinstance(step, str):
        return node.entries.get(step)
    if isinstance(node, Items) and isinstance(step, int) and 0 <= step < len(node.items):
        return node.items[step]
    return None


def _path_with(path: str, step: str | int, child: Node | None) -> str:
    if isinstance(step, str):
        label = step if step.isprintable() and len(step) < 60 else "..."
        return f"{path}/{label}" if path else label
    name = child.entries.get("name") if isinstance(child, Table) else None
    if (
        isinstance(name, Leaf)
        and isinstance(name.value, str)
        and name.value.isprintable()
        and len(name.value) < 60
    ):
        return f"{path}[{name.value}]"
    return f"{path}[{step}]"


def plain(node: Node) -> Any:
    """A node as dicts, lists and values; numbers stay `TypedNumber`."""
    if isinstance(node, Leaf):
        return node.value
    if isinstance(node, Items):
        return [plain(item) for item in node.items]
    return {key: plain(value) for key, value in node.entries.items()}


_NUMBER: Final = re.compile(r"[-+]?(?:(?:0|[1-9][0-9]*)(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][-+]?[0-9]+)?")
_INTEGER: Final = re.compile(r"[-+]?(?:0|[1-9][0-9]{0,15})")


def number(text: str) -> int | TypedNumber | None:
    """The number that a plain decimal text spells, None for any other text.

    Octal-looking, hexadecimal, grouped and sexagesimal texts are no numbers: programs disagree
    about them.  Overflow gives infinity, which is refused where a number is used.
    """
    if _INTEGER.fullmatch(text):
        return int(text)
    if _NUMBER.fullmatch(text):
        return TypedNumber(text)
    return None
