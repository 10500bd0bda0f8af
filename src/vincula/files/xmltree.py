"""XML to a plain tree that knows where every element stands; the limits hold while it is read.

The document goes to expat in one piece.  Document types (and with them entities, and everything
external) are refused at their first character.  One fault is tolerated, because many hand-written
models have it and it changes nothing: a comment with two hyphens inside.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Final, NoReturn, overload
from xml.parsers import expat

from vincula.errors import FileError
from vincula.files.limits import DEFAULT_LIMITS, Deadline, Limits
from vincula.files.problems import Place, shown
from vincula.files.report import LoadReport
from vincula.files.source import Source

_CHECK_EVERY: Final = 1024
_LONGEST_PATH: Final = 160


@dataclass(slots=True, eq=False)
class Element:
    """One element.

    Attributes:
        tag: Its tag.
        attributes: Its attributes, in the order of the file.
        file: The file that it stands in, as shown to the user.
        line: Line of its start tag, from 1.
        column: Column of its start tag in characters, from 1.
        parent: The element around it; None for the root.
        children: Elements inside it.
        characters: Text directly inside it, blanks at the ends removed.
        read: Attributes that a reader has asked for; None while nothing was asked of the element at all.
        left_out: Whether a reader has told that it ignores the element and everything inside it.
    """

    tag: str
    attributes: dict[str, str]
    file: str
    line: int
    column: int
    parent: Element | None = None
    children: list[Element] = field(default_factory=list)
    characters: str = ""
    read: set[str] | None = None
    left_out: bool = False

    @overload
    def get(self, attribute: str) -> str | None: ...

    @overload
    def get(self, attribute: str, default: str) -> str: ...

    def get(self, attribute: str, default: str | None = None) -> str | None:
        """An attribute, which counts as read from now on; the default when there is none."""
        self.note_read(attribute)
        return self.attributes.get(attribute, default)

    @property
    def text(self) -> str:
        """Its text; the element counts as read from now on."""
        self.note_read()
        return self.characters

    def note_read(self, attribute: str = "") -> None:
        """Keep that a reader makes use of the element, and of an attribute."""
        self.read = set() if self.read is None else self.read
        self.read.add(attribute)

    @property
    def name(self) -> str:
        """The `name` attribute, empty when there is none."""
        return self.attributes.get("name", "")

    @property
    def path(self) -> str:
        """`robot/joint[@name='elbow']/axis`; the middle of a long path is left out."""
        steps: list[str] = []
        element: Element | None = self
        while element is not None:
            name = f"[@name={shown(element.name, 40)}]" if element.name else ""
            steps.append(f"{element.tag}{name}")
            element = element.parent
        steps.reverse()
        while len(steps) > 3 and sum(map(len, steps)) + len(steps) > _LONGEST_PATH:
            steps[1:3] = ["..."]
        return "/".join(steps)

    @property
    def place(self) -> Place:
        """Where it stands, for messages."""
        return Place(self.file, self.line, self.column, self.path)

    def walk(self) -> Iterator[Element]:
        """The element and everything inside it, in the order of the file."""
        waiting = [self]
        while waiting:
            element = waiting.pop()
            yield element
            waiting.extend(reversed(element.children))

    def find_all(self, tag: str) -> Iterator[Element]:
        """Its children with a tag; each counts as read when it is given."""
        for child in self.children:
            if child.tag == tag:
                child.note_read()
                yield child


def parse_xml(source: Source, limits: Limits = DEFAULT_LIMITS, report: LoadReport | None = None) -> Element:
    """The root element of an XML document.

    Args:
        source: The text.
        limits: How much it may hold.
        report: Where repaired comments are recorded; without it they are repaired in silence.

    Raises:
        FileError: Not well-formed, a document type, or over a limit; tells the place.
    """
    source.refuse_larger_than(limits.xml_bytes, "XML file")
    text, lines = without_hyphens(source.text)
    if report is not None:
        for line in lines:
            report.repaired("comment", "", f"line {line}: '--' inside a comment is not XML; it was skipped")
    return _TreeBuilder(source, text, limits).build()


def without_hyphens(text: str) -> tuple[str, list[int]]:
    """The text with every comment that holds two hyphens blanked, so that lines and columns stay.

    Returns:
        The text, and the lines on which such comments begin.
    """
    pieces: list[str] = []
    lines: list[int] = []
    done = onward = line = counted = 0
    while found := _VERBATIM.search(text, onward):
        at, close = found.start(), _CLOSING[found.group()]
        stop = text.find(close, found.end())
        if stop < 0:
            break
        if close == "-->" and ("--" in (body := text[at + 4 : stop]) or body.endswith("-")):
            pieces += [text[done : at + 4], _INK.sub(" ", body)]
            line += text.count("\n", counted, at)
            counted, done = at, stop
            lines.append(line + 1)
        onward = stop + len(close)
    return "".join([*pieces, text[done:]]), lines


_CLOSING: Final = {"<!--": "-->", "<![CDATA[": "]]>", "<?": "?>"}
_VERBATIM: Final = re.compile("|".join(map(re.escape, _CLOSING)))
_INK: Final = re.compile(r"[^\n]")


class _TreeBuilder:
    """Expat's handlers."""

    def __init__(self, source: Source, text: str, limits: Limits) -> None:
        self._source, self._text, self._limits = source, text, limits
        self._deadline = Deadline(source.file, limits)
        self._parser = expat.ParserCreate(encoding="utf-8")
        self._parser.StartElementHandler = self._start
        self._parser.EndElementHandler = self._end
        self._parser.CharacterDataHandler = self._characters
        self._parser.StartDoctypeDeclHandler = self._doctype
        self._parser.buffer_text = True
        self._root: Element | None = None
        self._open: list[Element] = []
        self._texts: list[list[str]] = []
        self._count = 0

    def build(self) -> Element:
        try:
            self._parser.Parse(self._text.encode("utf-8"), True)
        except expat.ExpatError as error:
            line = self._source.text.split("\n", error.lineno)[: error.lineno][-1]
            template = "; <% ... %> is a template (ERB): expand it first" if "<%" in line else ""
            reason = f"{expat.ErrorString(error.code)}{template}{self._unclosed()}"
            self._refuse(reason, error.lineno, error.offset + 1)
        if self._root is None:
            self._refuse("there is no element", 1, 1)
        return self._root

    def _unclosed(self) -> str:
        if not self._open:
            return ""
        last = self._open[-1]
        return f"; <{last.tag}> of line {last.line} is open"

    def _start(self, tag: str, attributes: dict[str, str]) -> None:
        parser, limits, waiting = self._parser, self._limits, self._open
        line, column = parser.CurrentLineNumber, parser.CurrentColumnNumber + 1
        self._count += 1
        if self._count % _CHECK_EVERY == 0:
            self._deadline.check(line, column)
        if self._count > limits.nodes:
            self._refuse(f"more than {limits.nodes} elements", line, column)
        if len(waiting) >= limits.depth:
            self._refuse(f"elements are nested more than {limits.depth} deep", line, column)
        if len(tag) > limits.name_characters:
            self._refuse(
                f"an element has a name of more than {limits.name_characters} characters", line, column
            )
        if attributes:
            self._check_attributes(attributes, line, column)
        parent = waiting[-1] if waiting else None
        element = Element(tag, attributes, self._source.file, line, column, parent)
        if parent is None:
            self._root = element
        else:
            parent.children.append(element)
        waiting.append(element)
        self._texts.append([])

    def _check_attributes(self, attributes: dict[str, str], line: int, column: int) -> None:
        if len(attributes) > self._limits.attributes:
            self._refuse(f"more than {self._limits.attributes} attributes at one element", line, column)
        most = self._limits.attribute_characters
        for name, value in attributes.items():
            if len(value) > most or len(name) > self._limits.name_characters:
                self._refuse(f"attribute {shown(name)} has more than {most} characters", line, column)

    def _end(self, _tag: str) -> None:
        self._open.pop().characters = "".join(self._texts.pop()).strip()

    def _characters(self, data: str) -> None:
        if self._texts:
            self._texts[-1].append(data)

    def _doctype(self, *_: object) -> None:
        line, column = self._parser.CurrentLineNumber, self._parser.CurrentColumnNumber + 1
        self._refuse("document types and entities are not read; remove <!DOCTYPE ...>", line, column)

    def _refuse(self, message: str, line: int, column: int) -> NoReturn:
        raise FileError(f"{Place(self._source.file, line, column).text()}: {message}")


def refuse_element(element: Element, message: str) -> NoReturn:
    """Refuse one element at once.

    Raises:
        FileError: Always.
    """
    raise FileError(f"{element.place.text()}: {message}")
