"""Problems found in a file, collected so that one run tells the user all of them.

A problem reads `file:line:col: path: got ..., expected ...; did you mean ...?`.  At most 50 are kept.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final, NoReturn

from vincula.errors import FileError, UnsupportedFeatureError, listing

MOST_PROBLEMS: Final = 50
"""How many problems are told in one run."""


@dataclass(frozen=True, slots=True)
class Place:
    """Where something is written.

    Attributes:
        file: The file as the user named it.
        line: Line, from 1; 0 when unknown.
        column: Column in characters, from 1; 0 when unknown.
        path: Path of the element, `joints[o3]/axis` or `robot/joint[@name='elbow']/axis`.
    """

    file: str
    line: int = 0
    column: int = 0
    path: str = ""

    def text(self) -> str:
        """`file:line:col: path`, without the parts that are unknown."""
        where = self.file
        if self.line:
            where += f":{self.line}:{self.column}" if self.column else f":{self.line}"
        return f"{where}: {self.path}" if self.path else where


class Problems:
    """The problems of one file; `refuse_if_any` turns them into one `FileError`."""

    def __init__(self, file: str, most: int = MOST_PROBLEMS) -> None:
        self._file, self._most = file, most
        self._found: list[tuple[tuple[int, int], str]] = []
        self._texts: set[str] = set()
        self._dropped = 0
        self._only_unsupported = True

    def __len__(self) -> int:
        return len(self._found) + self._dropped

    @property
    def full(self) -> bool:
        """Whether no more problems will be told, so that looking for them is of no use."""
        return len(self._found) >= self._most

    def add(
        self,
        place: Place,
        message: str = "",
        *,
        got: str = "",
        expected: str = "",
        name: str = "",
        choices: Iterable[str] = (),
        unsupported: bool = False,
    ) -> None:
        """Keep a problem.

        Args:
            place: Where it is.
            message: What is wrong, when got and expected do not say it.
            got: What is written, already made printable (`shown`).
            expected: What was expected.
            name: The word that was not understood, for the suggestion.
            choices: The words that would be understood.
            unsupported: The file is right, but vincula cannot represent what it says.
        """
        self._only_unsupported = self._only_unsupported and unsupported
        if self.full:
            self._dropped += 1
            return
        parts = [message] if message else []
        if got:
            parts.append(f"got {got}")
        if expected:
            parts.append(f"expected {expected}")
        text = f"{place.text()}: {', '.join(parts)}{suggestion(name, choices)}"
        if text in self._texts:
            return
        self._texts.add(text)
        self._found.append(((place.line, place.column), text))

    def refuse_if_any(self) -> None:
        """Raise what was found.

        Raises:
            UnsupportedFeatureError: Everything found is of the kind "understood, not supported".
            FileError: Anything else was found.
        """
        if self._found:
            self.refuse()

    def refuse(self) -> NoReturn:
        """Raise what was found, in the order of the file (see `refuse_if_any`)."""
        texts = [text for _, text in sorted(self._found, key=lambda found: found[0])]
        kind = UnsupportedFeatureError if self._only_unsupported else FileError
        message = texts[0]
        if len(self) > 1:
            count = f"more than {len(texts)}" if self._dropped else str(len(texts))
            more = f"\n(the first {len(texts)} are shown)" if self._dropped else ""
            message = f"{self._file}: {count} problems\n" + "\n".join(texts) + more
        raise kind(message, texts)


def suggestion(name: str, choices: Iterable[str]) -> str:
    """`; did you mean 'x'?` or `; known: a, b, c` for a word that is not among the choices."""
    known = [choice for choice in choices if choice]
    if not known:
        return ""
    near = difflib.get_close_matches(name[:100], known[:1000], n=1) if name else []
    if near:
        return f"; did you mean {shown(near[0])}?"
    return f"; known: {listing(known)}"


def shown(value: object, most: int = 60) -> str:
    """A value of a file for a message: quoted when text, unprintable characters escaped, cut to size."""
    if isinstance(value, str):
        cut = value if len(value) <= most else value[: most - 3] + "..."
        quote = '"' if "'" in cut and '"' not in cut else "'"
        escaped = "".join(c if c.isprintable() and c not in ("\\", quote) else _escape(c) for c in cut)
        return f"{quote}{escaped}{quote}"
    if value is None:
        return "nothing"
    if isinstance(value, bool):
        return "true" if value else "false"
    text = repr(value)
    return text if len(text) <= most else text[: most - 3] + "..."


def form_of(value: object) -> str:
    """A value of a file for a message; of lists and tables only what they are."""
    if isinstance(value, list):
        return f"a list of {len(value)}"
    if isinstance(value, dict):
        return f"a table of {len(value)}"
    return shown(value)


def _escape(character: str) -> str:
    return character.encode("unicode_escape").decode("ascii") if character != "'" else "\\'"
