"""The load report: everything of a file that was used, ignored or repaired, with counts that add up."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Literal

from vincula.errors import listing
from vincula.files.units import SI, Units

if TYPE_CHECKING:
    from vincula.files.xmltree import Element

Fate = Literal["used", "ignored", "repaired"]
FATES: tuple[Fate, ...] = ("used", "ignored", "repaired")


@dataclass(frozen=True, slots=True)
class Entry:
    """What became of one element of a file.

    Attributes:
        fate: used, ignored or repaired (used, after a change that the detail states).
        kind: What it is: joint, motor, equality, geom ...
        name: Its name, empty for what has none.
        detail: What it was used as, why it was ignored, how it was repaired.
        count: How many equal elements the entry stands for.
    """

    fate: Fate
    kind: str
    name: str = ""
    detail: str = ""
    count: int = 1

    @property
    def is_motor(self) -> bool:
        """Whether it was used as a motor, and as nothing else."""
        named = self.kind in ("motor", "transmission")
        return self.fate == "used" and (
            named or (self.kind == "ros2_control joint" and self.detail.startswith("motor"))
        )


@dataclass
class LoadReport:
    """What a reader did with a file.

    Attributes:
        file: The file as the user named it.
        format: The format that was recognised.
        entries: One entry an element, in the order of reading.
        notes: Facts about the whole that the user should know.
        units: Units of the numbers in the file, and so of configurations for it.
        snapped: Numbers that were read as others because that was asked for, each with its place.
        contents: For everything that the files are made of (elements and attributes of XML, values of YAML
            and JSON), how many of each fate there are, inner ones too.
    """

    file: str
    format: str
    entries: list[Entry] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    units: Units = SI
    snapped: list[str] = field(default_factory=list)
    contents: dict[str, Counter[Fate]] = field(default_factory=dict)

    def used(self, kind: str, name: str = "", detail: str = "", count: int = 1) -> None:
        """Record an element that is part of the mechanism now."""
        self.entries.append(Entry("used", kind, name, detail, count))

    def ignored(
        self, kind: str, name: str = "", reason: str = "", count: int = 1, of: Element | None = None
    ) -> None:
        """Record an element that has no part in the mechanism, and why.

        Args:
            kind: What it is.
            name: Its name, or that of what it belongs to.
            reason: Why it is ignored.
            count: How many equal ones there are.
            of: The element of an XML file; everything inside it counts as ignored too.
        """
        self.entries.append(Entry("ignored", kind, name, reason, count))
        if of is not None:
            of.left_out = True

    def repaired(self, kind: str, name: str = "", detail: str = "", count: int = 1) -> None:
        """Record an element that was used after a change; instead of a record that it was used as it is."""
        same = [e for e in self.entries if name and (e.fate, e.kind, e.name) == ("used", kind, name)]
        if same:
            self.entries.remove(same[0])
        self.entries.append(Entry("repaired", kind, name, detail, count))

    def note(self, text: str) -> None:
        """Record a fact about the whole, once."""
        if text not in self.notes:
            self.notes.append(text)

    def contain(self, kind: str, fates: Counter[Fate]) -> None:
        """Add to what the files are made of."""
        self.contents.setdefault(kind, Counter()).update(fates)

    def extend(self, base: LoadReport, *, new_motors: bool = False) -> None:
        """Put the report of a base file before this one's entries.

        Args:
            base: The report.
            new_motors: Whether this file names motors, which replace those of the base.
        """
        unused = "its motors are replaced by those of the overlay"
        self.entries[:0] = [
            replace(entry, fate="ignored", detail=unused) if new_motors and entry.is_motor else entry
            for entry in base.entries
        ]
        self.notes[:0] = [note for note in base.notes if note not in self.notes]
        self.snapped[:0] = base.snapped
        for kind, fates in base.contents.items():
            self.contain(kind, fates)

    def counts(self) -> dict[str, dict[str, int]]:
        """For every kind, how many elements there are in all and how many of each fate."""
        kinds = dict.fromkeys(entry.kind for entry in self.entries)
        table = {}
        for kind in kinds:
            tally: Counter[Fate] = Counter()
            for entry in self.entries:
                if entry.kind == kind:
                    tally[entry.fate] += entry.count
            table[kind] = _shares(tally)
        return table

    def to_dict(self) -> dict[str, Any]:
        """The report as plain values for JSON."""
        return {
            "file": self.file,
            "format": self.format,
            "units": {"length": self.units.length, "angle": self.units.angle},
            "counts": self.counts(),
            "contents": {kind: _shares(fates) for kind, fates in self.contents.items()},
            "entries": [
                {"fate": e.fate, "kind": e.kind, "name": e.name, "detail": e.detail, "count": e.count}
                for e in self.entries
            ],
            "notes": list(self.notes),
            "snapped": list(self.snapped),
        }

    def __str__(self) -> str:
        lines = [f"{self.file} ({self.format})"]
        for kind, count in self.counts().items():
            lines.append(f"  {kind}: {_in_words(Counter({fate: count[fate] for fate in FATES}))}")
        for fate in ("ignored", "repaired"):
            lines.extend(f"  {fate}: {text}" for text in self._grouped(fate))
        lines.extend(f"  note: {note}" for note in self.notes)
        lines.extend(f"  {kind} in all: {_in_words(fates)}" for kind, fates in self.contents.items())
        return "\n".join(lines)

    def _grouped(self, fate: str) -> list[str]:
        """Entries of one fate, those with the same kind and reason on one line."""
        groups: dict[tuple[str, str], list[Entry]] = {}
        for entry in self.entries:
            if entry.fate == fate:
                groups.setdefault((entry.kind, entry.detail), []).append(entry)
        lines = []
        for (kind, detail), members in groups.items():
            names = [entry.name for entry in members if entry.name]
            count = sum(entry.count for entry in members)
            who = f"{kind} {listing(names, 6)}" if names and count == len(names) else f"{count} {kind}"
            lines.append(f"{who}: {detail}" if detail else who)
        return lines


def _shares(fates: Counter[Fate]) -> dict[str, int]:
    return {"total": fates.total(), **{fate: fates[fate] for fate in FATES}}


def _in_words(fates: Counter[Fate]) -> str:
    """`12 (10 used, 2 ignored)`."""
    shares = [f"{fates[fate]} {fate}" for fate in FATES if fates[fate]]
    return f"{fates.total()} ({', '.join(shares)})"
