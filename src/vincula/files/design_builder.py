"""A native file as a function of any of its numbers: declared parameters by name, others by path.

A path is written as in messages: `joints[o3]/at[0]`, `contacts[c1]/normal[2]`, `frames/tip/at[1]`.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any, Final

from vincula.errors import UnknownNameError
from vincula.files.builder import Change, changed_mechanism, declared_values
from vincula.files.expressions import ExpressionError, Measured, evaluate
from vincula.files.limits import DEFAULT_LIMITS
from vincula.files.load import EXAMPLE, load
from vincula.files.native import read_native
from vincula.files.parameters import declared, parameter_values
from vincula.files.source import open_source
from vincula.files.tree import Document, Items, Leaf, Node, Table
from vincula.files.treefile import read_tree
from vincula.files.units import Units
from vincula.mechanism.drawn_mechanism import Outline
from vincula.mechanism.mechanism import Mechanism

_NO_DESIGN: Final = ("parameters", "precision", "vincula")
"""Sections whose numbers are no dimensions to be named by path."""


@dataclass(frozen=True, slots=True)
class Expression:
    """An expression of a design file as a function of the variables.

    Attributes:
        text: The expression, variables written `$name`.
    """

    text: str

    def __call__(self, values: Mapping[str, float]) -> float:
        """Its value.

        Raises:
            ExpressionError: It has none at these values, or is not in the grammar.
        """
        known = {name: Measured(value, computed=True) for name, value in values.items()}
        return evaluate(self.text, known).value


@dataclass(frozen=True)
class NumbersBuilder:
    """The mechanism of a native file or an example, as a function of parameters and of numbers by path.

    Names that are no Python names are given with `**`: `builder(**{"joints[o3]/at[0]": 0.1})`.

    Attributes:
        path: The file, or `example:NAME`.
        settings: Declared parameters at other values than the declared ones.
        changes: What is done to every mechanism, in order.
    """

    path: str
    settings: tuple[tuple[str, float | str], ...] = ()
    changes: tuple[Change, ...] = ()

    def __call__(self, **values: float) -> Mechanism:
        """The mechanism with some numbers at other values, in the units of the file.

        Raises:
            UnknownNameError: No such parameter, and no number at such a path.
            FileError: The file cannot be read.
            ModelError: Values that are no geometry.
        """
        for name in values:
            if name not in self.parameters:
                raise UnknownNameError("parameter or number", name, near(name, self.parameters))
        numbers = {name: value for name, value in values.items() if name in self._paths}
        settings: dict[str, Any] = {
            **dict(self.settings),
            **{n: v for n, v in values.items() if n not in numbers},
        }
        made = self._changed(numbers, settings) if numbers else load(self.path, settings)
        return changed_mechanism(made, self.changes)

    def outline(self, **values: Any) -> Outline:
        """What is drawn with traced numbers: the geometry of many mechanisms at once.

        Raises:
            TypeError: Something that cannot be traced depends on them.
            ModelError: Values that are no geometry.
        """
        from vincula.files.outlines import changed, outline_of_document, outline_of_example

        numbers = {name: value for name, value in values.items() if name in self._paths}
        settings = {**dict(self.settings), **{n: v for n, v in values.items() if n not in numbers}}
        if self.path.startswith(EXAMPLE):
            return changed(outline_of_example(self.path, settings), self.changes)
        if self._document is None:
            raise TypeError("XML files are not traced")
        return changed(outline_of_document(self._with_numbers(numbers), self.path, settings), self.changes)

    def _with_numbers(self, numbers: Mapping[str, Any]) -> Document:
        """The tree of the file, read anew, with other numbers at some paths."""
        document = read_tree(open_source(self.path, DEFAULT_LIMITS), DEFAULT_LIMITS)
        where = {document.place(place).path: place for place, _ in _leaves(document.root, ())}
        root: Node = document.root
        for name, value in numbers.items():
            root = _with(root, where[name], value)
        return replace(document, root=root)

    @cached_property
    def parameters(self) -> Mapping[str, float]:
        """Declared parameters and numbers by path, with the values that they have."""
        fixed = {n: float(v) for n, v in self.settings if isinstance(v, (int, float))}
        return {**declared_values(self.path), **self._paths, **fixed}

    @cached_property
    def units(self) -> Units:
        """Units of the numbers."""
        if self.path.startswith(EXAMPLE):
            return Units()
        from vincula.files.load import load_with_report

        return load_with_report(self.path, dict(self.settings))[1].units

    @cached_property
    def _document(self) -> Document | None:
        """The tree of the file; None for an example or an XML file."""
        if self.path.startswith(EXAMPLE):
            return None
        source = open_source(self.path, DEFAULT_LIMITS)
        return None if source.text.lstrip().startswith("<") else read_tree(source, DEFAULT_LIMITS)

    @cached_property
    def _paths(self) -> dict[str, float]:
        """Every number of the file by its path."""
        document = self._document
        if document is None:
            return {}
        parameters = parameter_values(document, dict(self.settings), Units())
        found: dict[str, float] = {}
        for location, leaf in _leaves(document.root, ()):
            if location[0] in _NO_DESIGN or isinstance(leaf.value, bool):
                continue
            value = _number(leaf, parameters)
            if value is not None:
                found[document.place(location).path] = value
        return found

    def _changed(self, numbers: Mapping[str, float], settings: Mapping[str, Any]) -> Mechanism:
        document = self._with_numbers({name: float(value) for name, value in numbers.items()})
        folder = Path(self.path).parent

        def base(file: str) -> Any:
            from vincula.files.load import load_with_report
            from vincula.files.native import Loaded

            inner = file if file.startswith(EXAMPLE) else str(folder / file)
            own = {n: v for n, v in settings.items() if n not in declared(document)}
            return Loaded(*load_with_report(inner, own), tuple(own))

        return read_native(document, Path(self.path).stem, base, settings).mechanism


def near(name: str, known: Mapping[str, float]) -> list[str]:
    """The names that are like one, first; then the others."""
    close = difflib.get_close_matches(name, known, n=5, cutoff=0.4)
    return [*close, *(other for other in known if other not in close)]


def _leaves(node: Node, location: tuple[str | int, ...]) -> Iterator[tuple[tuple[str | int, ...], Leaf]]:
    if isinstance(node, Leaf):
        if location:
            yield location, node
    elif isinstance(node, Items):
        for k, item in enumerate(node.items):
            yield from _leaves(item, (*location, k))
    else:
        for key, item in node.entries.items():
            yield from _leaves(item, (*location, key))


def _number(leaf: Leaf, parameters: Mapping[str, Measured]) -> float | None:
    """The number of a leaf, of an expression its value; None for anything else."""
    from vincula.files.expressions import is_expression

    if isinstance(leaf.value, (int, float)):
        return float(leaf.value)
    if isinstance(leaf.value, str) and is_expression(leaf.value):
        try:
            return evaluate(leaf.value, parameters).value
        except ExpressionError:
            return None
    return None


def _with(node: Node, location: Sequence[str | int], value: Any) -> Node:
    """A tree with another number at one place."""
    if not location:
        # A number of a design is as exact as it is: it was not typed.
        return replace(node, value=value) if isinstance(node, Leaf) else node
    step, rest = location[0], location[1:]
    if isinstance(node, Table):
        return replace(node, entries={**node.entries, str(step): _with(node.entries[str(step)], rest, value)})
    if isinstance(node, Items) and isinstance(step, int):
        items = list(node.items)
        items[step] = _with(items[step], rest, value)
        return replace(node, items=tuple(items))
    return node
