"""The load report: everything of a file that was used, ignored or repaired, with counts that add up."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field, replace
from typing import Any, Literal

from vincula.errors import listing
from vincula.files.units import SI, Units

Fate = Literal["used", "ignored", "repaired"]


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
    """

    file: str
    format: str
    entries: list[Entry] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    units: Units = SI
    snapped: list[str] = field(default_factory=list)

    def used(self, kind: str, name: str = "", detail: str = "", count: int = 1) -> None:
        """Record an element that is part of the mechanism now."""
        self.entries.append(Entry("used", kind, name, detail, count))

    def ignored(self, kind: str, name: str = "", reason: str = "", count: int = 1) -> None:
        """Record an element that has no part in the mechanism, and why."""
        self.entries.append(Entry("ignored", kind, name, reason, count))

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

    def counts(self) -> dict[str, dict[str, int]]:
        """For every kind, how many elements there are in all and how many of each fate."""
        kinds = dict.fromkeys(entry.kind for entry in self.entries)
        table = {}
        for kind in kinds:
            tally: Counter[str] = Counter()
            for entry in self.entries:
                if entry.kind == kind:
                    tally[entry.fate] += entry.count
            table[kind] = {
                "total": tally.total(),
                "used": tally["used"],
                "ignored": tally["ignored"],
                "repaired": tally["repaired"],
            }
        return table

    def to_dict(self) -> dict[str, Any]:
        """The report as plain values for JSON."""
        return {
            "file": self.file,
            "format": self.format,
            "units": {"length": self.units.length, "angle": self.units.angle},
            "counts": self.counts(),
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
            shares = [f"{count[fate]} {fate}" for fate in ("used", "ignored", "repaired") if count[fate]]
            lines.append(f"  {kind}: {count['total']} ({', '.join(shares)})")
        for fate in ("ignored", "repaired"):
            lines.extend(f"  {fate}: {text}" for text in self._grouped(fate))
        lines.extend(f"  note: {note}" for note in self.notes)
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
