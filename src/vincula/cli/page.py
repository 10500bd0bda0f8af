"""A report on the terminal: headings, facts, tables and sentences, in the order they were added."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Literal

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table as RichTable

INDENT: Final = 2
"""Blanks before everything but headings."""


@dataclass(frozen=True, slots=True)
class Column:
    """A column of a table.

    Attributes:
        title: Its heading; a second line holds the unit.
        justify: `right` for numbers.
        fold: True when long texts may be broken over several lines.
    """

    title: str
    justify: Literal["left", "right"] = "left"
    fold: bool = False


@dataclass(frozen=True, slots=True)
class Table:
    """Columns and rows of texts.

    Attributes:
        columns: The columns.
        rows: The rows, a text a column.
    """

    columns: Sequence[Column]
    rows: Sequence[Sequence[str]]

    def drawn(self) -> RichTable:
        """The table as the terminal library wants it."""
        from rich.box import SIMPLE_HEAD
        from rich.table import Table as RichTable

        table = RichTable(box=SIMPLE_HEAD, show_edge=False, pad_edge=False, header_style="dim")
        for column in self.columns:
            table.add_column(
                column.title,
                justify=column.justify,
                no_wrap=not column.fold,
                overflow="fold" if column.fold else "ellipsis",
            )
        for row in self.rows:
            table.add_row(*row)
        return table


class Page:
    """Collects what a command has to say; `show` prints it, as wide as the terminal allows."""

    def __init__(self) -> None:
        self._parts: list[Callable[[Console], None]] = []

    def heading(self, title: str, note: str = "") -> None:
        """A heading with a remark behind it, after an empty line."""
        first = not self._parts

        def print_heading(console: Console) -> None:
            from rich.text import Text

            if not first:
                console.print()
            text = Text(title, style="bold")
            if note:
                text.append(f"  {note}", style="not bold")
            console.print(text)

        self._parts.append(print_heading)

    def sentence(self, text: str, mark: str = "") -> None:
        """A sentence, wrapped; `mark` stands before its first line."""

        def print_sentence(console: Console) -> None:
            first = " " * INDENT + (f"{mark} " if mark else "")
            for line in text.splitlines():
                for part in textwrap.wrap(
                    line,
                    console.width,
                    initial_indent=first,
                    subsequent_indent=" " * len(first),
                    break_long_words=False,
                    break_on_hyphens=False,
                ) or [""]:
                    console.print(part, soft_wrap=True)
                first = " " * len(first)

        self._parts.append(print_sentence)

    def facts(self, rows: Iterable[tuple[str, str]]) -> None:
        """Pairs of a label and a text, the texts aligned; pairs without a text are left out."""
        shown = [(label, text) for label, text in rows if text]

        def print_facts(console: Console) -> None:
            from rich.table import Table as RichTable

            table = RichTable.grid(padding=(0, 2))
            table.add_column(no_wrap=True, style="dim")
            table.add_column(overflow="fold")
            for label, text in shown:
                table.add_row(label, text)
            _print_indented(console, table)

        self._parts.append(print_facts)

    def table(self, *choices: Table) -> None:
        """A table with a line under its head: the first of the choices that fits the width, else the last."""

        def print_table(console: Console) -> None:
            from rich.measure import Measurement

            drawn = [choice.drawn() for choice in choices]
            room = console.width - INDENT
            fitting = (
                table
                for table in drawn
                if Measurement.get(console, console.options.update(max_width=10_000), table).maximum <= room
            )
            _print_indented(console, next(fitting, drawn[-1]))

        self._parts.append(print_table)

    @property
    def width(self) -> int:
        """Columns of the terminal."""
        return _console().width

    @property
    def height(self) -> int:
        """Lines that the page takes."""
        return len(self._lines(_console()))

    def show(self) -> None:
        """Print the page on stdout; without blanks at line ends where that is no terminal."""
        import click

        console = _console()
        if console.is_terminal:
            self._print(console)
            return
        click.echo("\n".join(line.rstrip() for line in self._lines(console)))

    def _lines(self, console: Console) -> list[str]:
        with console.capture() as captured:
            self._print(console)
        return captured.get().splitlines()

    def _print(self, console: Console) -> None:
        for part in self._parts:
            part(console)


def _console() -> Console:
    from rich.console import Console

    return Console(markup=False, highlight=False, emoji=False)


def _print_indented(console: Console, table: object) -> None:
    from rich.padding import Padding

    console.print(Padding(table, (0, 0, 0, INDENT)))  # type: ignore[arg-type]


def number(value: float, digits: int = 5) -> str:
    """A number for a table: `digits` significant digits, no trailing noise, `inf` for infinity."""
    if value != value:
        return "-"
    if value in (float("inf"), float("-inf")):
        return "inf" if value > 0 else "-inf"
    return f"{0.0 if value == 0 else value:.{digits}g}"


def combination(values: Iterable[float], names: Sequence[str], width: int = 10_000, most: int = 12) -> str:
    """A vector as a sum over its components: `0.894 vy - 0.447 wz`.

    Args:
        values: The components.
        names: Their names.
        width: Lines are broken between terms so that they are at most this long.
        most: Terms before the rest is only counted.  Terms below a thousandth of the largest are left out.
    """
    pairs = list(zip(values, names, strict=True))
    largest = max((abs(value) for value, _ in pairs), default=0.0)
    kept = [(value, name) for value, name in pairs if value and abs(value) >= 1e-3 * largest]
    if not kept:
        return "0"
    lines = [""]
    for value, name in kept[:most]:
        sign = "- " if value < 0 else "+ "
        if lines == [""]:
            sign = "-" if value < 0 else ""
        term = f"{sign}{abs(value):.3g} {name}"
        if lines[-1] and len(lines[-1]) + 1 + len(term) > width:
            lines.append(term)
        else:
            lines[-1] += f" {term}" if lines[-1] else term
    more = len(kept) - most
    return "\n".join(lines) + (f" ... ({more} more)" if more > 0 else "")


def few(names: Iterable[str], room: int, *, separator: str = ", ") -> str:
    """As many names as fit into `room` characters, at least one; the rest is counted."""
    everything = list(names)
    for count in range(len(everything), 1, -1):
        more = len(everything) - count
        text = separator.join(everything[:count]) + (f" ... ({more} more)" if more else "")
        if len(text) <= room:
            return text
    more = len(everything) - 1
    return "".join(everything[:1]) + (f" ... ({more} more)" if more > 0 else "")


def point(values: Iterable[float]) -> str:
    """A point as `(x, y, z)` with short numbers."""
    return "(" + ", ".join(number(value, 4) for value in values) + ")"


def plural(count: int, singular: str, several: str = "") -> str:
    """`1 loop`, `2 loops`, `no loops`."""
    word = singular if count == 1 else several or f"{singular}s"
    return f"{count or 'no'} {word}"
