"""JSON as a tree with the line and column of every value; strict, with limits.

The standard library's decoder keeps no positions, accepts NaN and keeps the last of two equal keys.
"""

from __future__ import annotations

import json
import re
from bisect import bisect_right
from typing import Final, NoReturn

from vincula.errors import FileError
from vincula.files.limits import DEFAULT_LIMITS, Deadline, Limits
from vincula.files.problems import Place, Problems, shown
from vincula.files.source import Source
from vincula.files.tree import Document, Items, Leaf, Node, Table, number

_BLANK: Final = re.compile(r"[ \t\n]*")
_STRING: Final = re.compile(r'"(?:[^"\\\x00-\x1f]|\\["\\/bfnrt]|\\u[0-9a-fA-F]{4})*"')
_WORD: Final = re.compile(r"[^\s,:\[\]{}\"']+")
_ENDS: Final = "the file ends in the middle of a list or table"
_CONSTANTS: Final = {"true": True, "false": False, "null": None}


def read_json(source: Source, limits: Limits = DEFAULT_LIMITS) -> Document:
    """The tree of a JSON file.

    Raises:
        FileError: Not JSON, or a limit passed; with line and column.
    """
    source.refuse_larger_than(limits.json_bytes, "JSON file")
    _refuse_too_many_commas(source, limits)
    reader = _Reader(source, limits)
    root = reader.value((), 0)
    reader.end()
    return Document(source.file, root, "JSON", reader.problems)


def _refuse_too_many_commas(source: Source, limits: Limits) -> None:
    """Refuse at once what the reader would refuse later: there are more values than commas."""
    commas = _STRING.sub("", source.text).count(",")
    if commas >= limits.nodes:
        raise FileError(f"{source.file}:1:1: more than {limits.nodes} values ({commas} commas)")


class _Reader:
    """A recursive-descent reader; the depth limit keeps the recursion shallow."""

    def __init__(self, source: Source, limits: Limits) -> None:
        self.problems = Problems(source.file)
        self._text, self._file, self._limits = source.text, source.file, limits
        self._deadline = Deadline(source.file, limits)
        self._lines = [0, *(m.end() for m in re.finditer("\n", source.text))]
        self._at = 0
        self._nodes = 0
        self._blank()

    def value(self, path: tuple[str, ...], depth: int) -> Node:
        """The value that begins here."""
        self._nodes += 1
        if self._nodes > self._limits.nodes:
            self._refuse(f"more than {self._limits.nodes} values")
        if self._nodes % 1024 == 0:
            self._deadline.check()
        if depth > self._limits.depth:
            self._refuse(f"nested deeper than {self._limits.depth} levels")
        line, column = self._position(self._at)
        character = self._text[self._at : self._at + 1]
        if character == "{":
            return self._table(path, depth, line, column)
        if character == "[":
            return Items(self._items(path, depth), line, column)
        if character == '"':
            return Leaf(self._string(), line, column)
        return Leaf(self._word(), line, column)

    def end(self) -> None:
        """Refuse anything after the value."""
        if self._at < len(self._text):
            self._refuse("expected the end of the file after the value")

    def _items(self, path: tuple[str, ...], depth: int) -> tuple[Node, ...]:
        self._step()
        items: list[Node] = []
        while not self._closes("]", bool(items)):
            items.append(self.value((*path, f"[{len(items)}]"), depth + 1))
            self._blank()
        return tuple(items)

    def _table(self, path: tuple[str, ...], depth: int, line: int, column: int) -> Table:
        self._step()
        entries: dict[str, Node] = {}
        keys: dict[str, tuple[int, int]] = {}
        count = 0
        while not self._closes("}", count > 0):
            count += 1
            place = self._position(self._at)
            if self._text[self._at : self._at + 1] != '"':
                ended = self._at >= len(self._text)
                self._refuse(_ENDS if ended else "expected a key in double quotes")
            key = self._string()
            self._blank()
            if self._text[self._at : self._at + 1] != ":":
                self._refuse("expected ':' after the key")
            self._step()
            value = self.value((*path, key), depth + 1)
            self._blank()
            if key in entries:
                where = Place(self._file, *place, "/".join((*path, key)).replace("/[", "["))
                self.problems.add(where, f"the key {shown(key)} is already in line {keys[key][0]}")
                continue
            entries[key], keys[key] = value, place
        return Table(entries, keys, line, column)

    def _closes(self, bracket: str, after_item: bool) -> bool:
        """Whether the list or table ends here; walks over the comma between items."""
        character = self._text[self._at : self._at + 1]
        if character == bracket:
            self._step()
            return True
        if not after_item:
            return False
        if character != ",":
            self._refuse(_ENDS if not character else f"expected ',' or '{bracket}'")
        self._step()
        if self._text[self._at : self._at + 1] == bracket:
            self._refuse("expected a value after ','")
        return False

    def _string(self) -> str:
        match = _STRING.match(self._text, self._at)
        if match is None:
            self._refuse("expected a text that ends in the same line, with JSON escapes only")
        self._at = match.end()
        return str(json.loads(match.group()))

    def _word(self) -> int | float | bool | str | None:
        match = _WORD.match(self._text, self._at)
        if match is None:
            self._refuse(
                "expected a value" if self._at < len(self._text) else "the file ends where a value is due"
            )
        word = match.group()
        if word in _CONSTANTS:
            self._at = match.end()
            return _CONSTANTS[word]
        if len(word) > self._limits.number_characters:
            self._refuse(
                f"got {shown(word, 20)}, expected at most {self._limits.number_characters} characters"
            )
        found = number(word)
        if found is None and word[0] not in "+-.0123456789":
            self._refuse(
                f"got {shown(word)}, expected a number, a text in double quotes, true, false or null"
            )
        if found is None or word[0] in "+.":
            self._refuse(f"got {shown(word)}, expected a number as JSON writes it")
        self._at = match.end()
        return found

    def _step(self) -> None:
        self._at += 1
        self._blank()

    def _blank(self) -> None:
        match = _BLANK.match(self._text, self._at)
        self._at = match.end() if match else self._at

    def _position(self, index: int) -> tuple[int, int]:
        line = bisect_right(self._lines, index)
        return line, index - self._lines[line - 1] + 1

    def _refuse(self, message: str) -> NoReturn:
        raise FileError(f"{Place(self._file, *self._position(self._at)).text()}: {message}")
