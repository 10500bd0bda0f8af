"""YAML 1.2 as a tree, read event by event so that limits hold before memory is spent.

Only plain data is accepted: no tags, no second document, no other version, no equal keys.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any, Final, NoReturn

from vincula.errors import FileError
from vincula.files.limits import DEFAULT_LIMITS, Deadline, Limits
from vincula.files.problems import Place, Problems, shown
from vincula.files.source import Source
from vincula.files.tree import Document, Items, Leaf, Node, Table, number

Event = Any
"""An event of ruamel.yaml, whose base class declares none of its fields."""

_TRUTH: Final = {word: word[0] in "tT" for word in ("true", "True", "TRUE", "false", "False", "FALSE")}
_WORD: Final = re.compile(r"[^\s,\[\]{}:\"'#]+")
_NOTHING: Final = ("", "~", "null", "Null", "NULL")


def read_yaml(source: Source, limits: Limits = DEFAULT_LIMITS) -> Document:
    """The tree of a YAML file.

    Raises:
        FileError: Not YAML, more than one document, tags, a limit passed; with line and column.
    """
    source.refuse_larger_than(limits.yaml_bytes, "YAML file")
    _refuse_endless_words(source, limits)
    reader = _Reader(source, limits)
    root = reader.document()
    return Document(source.file, root, "YAML", reader.problems)


def _refuse_endless_words(source: Source, limits: Limits) -> None:
    """Refuse a million digits before the scanner walks through them."""
    words = _WORD.finditer(source.text)
    found = next((word for word in words if word.end() - word.start() > limits.attribute_characters), None)
    if found:
        line = source.text.count("\n", 0, found.start()) + 1
        column = found.start() - source.text.rfind("\n", 0, found.start())
        what = shown(found.group(), 20)
        raise FileError(
            f"{source.file}:{line}:{column}: got {what}, expected words of at most "
            f"{limits.attribute_characters} characters"
        )


class _Reader:
    """Builds the tree from the events of one document."""

    def __init__(self, source: Source, limits: Limits) -> None:
        self.problems = Problems(source.file)
        self._file, self._limits = source.file, limits
        self._deadline = Deadline(source.file, limits)
        self._events = self._stream(source.text)
        self._nodes = self._aliases = self._seen = 0
        self._anchors: dict[str, tuple[Node, int]] = {}
        self._open_anchors: set[str] = set()

    def _stream(self, text: str) -> Iterator[Event]:
        from ruamel.yaml.error import MarkedYAMLError, YAMLError

        from vincula.files.yamlscanner import yaml_events

        try:
            yield from yaml_events(text)
        except MarkedYAMLError as error:
            mark = error.problem_mark or error.context_mark
            line, column = (mark.line + 1, mark.column + 1) if mark else (1, 1)
            message = _in_words(str(error.problem or error.context or "not YAML"))
            raise FileError(f"{Place(self._file, line, column).text()}: {message}") from None
        except YAMLError as error:
            raise FileError(f"{self._file}: not YAML: {shown(str(error), 200)}") from None
        except (ValueError, OverflowError, IndexError, AttributeError, TypeError, AssertionError) as error:
            # The scanner lets some malformed escapes and directives through as bare Python errors.
            raise FileError(f"{self._file}: not YAML: {shown(str(error), 200)}") from None

    def document(self) -> Node:
        """The only document of the stream."""
        self._next("StreamStart")
        start = self._next()
        if _kind(start) == "StreamEnd":
            raise FileError(f"{self._file}:1:1: the file holds comments only, expected a document")
        if getattr(start, "version", None) not in (None, (1, 2)) or getattr(start, "tags", None):
            self._refuse(start, "expected YAML 1.2 without %TAG and other %YAML directives")
        root = self._node(self._next(), (), 0)
        self._next("DocumentEnd")
        after = self._next()
        if _kind(after) != "StreamEnd":
            self._refuse(after, "got a second document, expected one document a file")
        return root

    def _next(self, _expected: str = "") -> Event:
        self._seen += 1
        if self._seen % 256 == 0:
            self._deadline.check()
        return next(self._events)

    def _node(self, event: Event, path: tuple[str, ...], depth: int) -> Node:
        kind = _kind(event)
        if kind == "Alias":
            return self._alias(event)
        self._count(event)
        if depth > self._limits.depth:
            self._refuse(event, f"nested deeper than {self._limits.depth} levels")
        if getattr(event, "tag", None) is not None:
            self._refuse(
                event, f"got the tag {shown(str(event.tag))}, expected plain values: tags are not read"
            )
        anchor, before = event.anchor, self._nodes
        if anchor is not None:
            self._open_anchors.add(anchor)
        line, column = _position(event)
        node: Node
        if kind == "Scalar":
            node = Leaf(_value(event), line, column)
        elif kind == "SequenceStart":
            node = Items(tuple(self._items(path, depth)), line, column)
        else:
            node = self._table(event, path, depth)
        if anchor is not None:
            self._open_anchors.discard(anchor)
            self._anchors[anchor] = (node, self._nodes - before + 1)
        return node

    def _items(self, path: tuple[str, ...], depth: int) -> Iterator[Node]:
        index = 0
        while _kind(event := self._next()) != "SequenceEnd":
            yield self._node(event, (*path, f"[{index}]"), depth + 1)
            index += 1

    def _table(self, start: Event, path: tuple[str, ...], depth: int) -> Table:
        entries: dict[str, Node] = {}
        keys: dict[str, tuple[int, int]] = {}
        while _kind(event := self._next()) != "MappingEnd":
            key = self._key(event)
            line, column = _position(event)
            value = self._node(self._next(), (*path, key), depth + 1)
            if key in entries:
                place = Place(self._file, line, column, "/".join((*path, key)).replace("/[", "["))
                self.problems.add(place, f"the key {shown(key)} is already in line {keys[key][0]}")
                continue
            entries[key], keys[key] = value, (line, column)
        return Table(entries, keys, *_position(start))

    def _key(self, event: Event) -> str:
        self._count(event)
        if _kind(event) == "Alias":
            node = self._alias(event)
            value = node.value if isinstance(node, Leaf) else None
            if isinstance(value, str):
                return value
        elif _kind(event) == "Scalar" and getattr(event, "tag", None) is None:
            if event.anchor is not None:
                self._anchors[event.anchor] = (Leaf(_text(event), *_position(event)), 1)
            return _text(event)
        return self._refuse(event, "expected a plain text as key")

    def _alias(self, event: Event) -> Node:
        name = str(event.anchor)
        self._aliases += 1
        if self._aliases > self._limits.aliases:
            self._refuse(event, f"more than {self._limits.aliases} aliases")
        if name in self._open_anchors:
            self._refuse(event, f"the alias {shown(name)} stands inside of what it stands for")
        if name not in self._anchors:
            self._refuse(event, f"the alias {shown(name)} has no anchor before it")
        node, size = self._anchors[name]
        self._count(event, size)
        return node

    def _count(self, event: Event, nodes: int = 1) -> None:
        self._nodes += nodes
        if self._nodes > self._limits.yaml_nodes:
            self._refuse(
                event, f"more than {self._limits.yaml_nodes} values (aliases count as what they stand for)"
            )

    def _refuse(self, event: Event, message: str) -> NoReturn:
        raise FileError(f"{Place(self._file, *_position(event)).text()}: {message}")


def _kind(event: Event) -> str:
    return type(event).__name__.removesuffix("Event")


def _position(event: Event) -> tuple[int, int]:
    mark: Any = event.start_mark
    return (mark.line + 1, mark.column + 1) if mark is not None else (1, 1)


def _text(event: Event) -> str:
    """The text of a scalar; pairs of surrogates, as JSON escapes them, are one character."""
    text = str(event.value)
    if text.isascii() or not any("\ud800" <= character <= "\udfff" for character in text):
        return text
    return text.encode("utf-16", "surrogatepass").decode("utf-16", "surrogatepass")


def _value(event: Any) -> str | int | float | bool | None:
    """The value of a scalar by the core schema of YAML 1.2, numbers in plain decimal only."""
    text = _text(event)
    if event.style is not None:
        return text
    if text in _NOTHING:
        return None
    if text in _TRUTH:
        return _TRUTH[text]
    found = number(text)
    return text if found is None else found


_WORDS: Final = {
    "found character '\\t' that cannot start any token": "got a tab, expected blanks for indentation",
    "did not find expected ',' or ']'": "expected ',' or ']'",
    "did not find expected ',' or '}'": "expected ',' or '}'",
}


def _in_words(problem: str) -> str:
    text = " ".join(problem.split())
    if "'<stream end>'" in text:
        return "the file ends in the middle of a list or table"
    return _WORDS.get(text, f"not YAML: {text}" if text.isprintable() else f"not YAML: {shown(text, 200)}")
