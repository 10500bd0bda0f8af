"""SWEEP.yaml: what to compute where, with every problem told at its line and column."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, NoReturn

import numpy as np

from vincula.arrays import Vector
from vincula.errors import FileError, VinculaError
from vincula.files.limits import DEFAULT_LIMITS, Limits
from vincula.files.schema_problems import validated
from vincula.files.schema_values import Context
from vincula.files.source import open_source
from vincula.files.sweep_schema import Amount, RangeEntry, SweepEntry
from vincula.files.sweep_table import read_columns
from vincula.files.tree import Document, Location
from vincula.files.treefile import read_tree
from vincula.files.units import Units
from vincula.files.versions import check_version
from vincula.sweep.points import MOST_POINTS, Grid, Points, PointTable, Polyline
from vincula.sweep.scattered import LowDiscrepancyPoints, RandomPoints

KINDS: Final = ("grid", "path", "random", "low-discrepancy", "table")
"""Keys that say where a sweep goes; a file has one of them."""
LONGEST_AXIS: Final = 10_000_000
"""Most values of one variable of a grid."""

UnitOf = Callable[[str], str]
"""Unit of a variable: m, rad, 1, or empty where it is in the units of the model file."""


@dataclass(frozen=True, slots=True)
class SweepFile:
    """A sweep file that fits its schema.

    Attributes:
        document: The file, for messages.
        entry: Its content.
        folder: The folder that its paths start from.
    """

    document: Document
    entry: SweepEntry
    folder: Path

    def path(self, text: str) -> Path:
        """A path of the file, from the file's own folder."""
        return self.folder / text

    @property
    def kind(self) -> str:
        """Which of `KINDS` says where it goes."""
        return next(kind for kind in KINDS if getattr(self.entry, kind.replace("-", "_")) is not None)

    def variables(self) -> tuple[str, ...]:
        """Names of the variables, in order."""
        entry = self.entry
        if entry.grid is not None:
            return tuple(entry.grid)
        if entry.path is not None:
            return tuple(entry.path.through[0])
        scattered = entry.random or entry.low_discrepancy
        return tuple(scattered.ranges) if scattered is not None else tuple(self._table())

    def points(self, unit_of: UnitOf, units: Units) -> Points:
        """Where the sweep goes, in metres and radians.

        Args:
            unit_of: Unit of a variable by name.
            units: Units of the model file, which numbers without a unit are in.

        Raises:
            FileError: A value that cannot be used, with its place.
        """
        reader = _Amounts(self, unit_of, units)
        entry = self.entry
        try:
            if entry.grid is not None:
                return reader.grid(entry.grid)
            if entry.path is not None:
                rows = [reader.named(("path", "through", k), row) for k, row in enumerate(entry.path.through)]
                return Polyline(rows, entry.path.points)
            if entry.low_discrepancy is not None:
                low = entry.low_discrepancy
                ranges = reader.ranges(("low-discrepancy", "ranges"), low.ranges)
                return LowDiscrepancyPoints(ranges, low.points, low.seed, low.sequence)
            if entry.random is not None:
                ranges = reader.ranges(("random", "ranges"), entry.random.ranges)
                return RandomPoints(ranges, entry.random.points, entry.random.seed)
            return PointTable({name: reader.column(name, column) for name, column in self._table().items()})
        except FileError:
            raise
        except VinculaError as error:
            self.refuse((self.kind,), error)

    def _table(self) -> dict[str, Vector]:
        return read_columns(self.path(self.entry.table or ""))

    def refuse(self, location: Location, error: VinculaError) -> NoReturn:
        """Refuse something of the file that turned out wrong later.

        Raises:
            FileError: Always: the error with its place.
        """
        raise FileError(f"{self.document.place(location).text()}: {error}") from error


def read_sweep(path: str | os.PathLike[str], limits: Limits = DEFAULT_LIMITS) -> SweepFile:
    """A sweep file, YAML or JSON, checked against its schema.

    Raises:
        FileError: It cannot be read or does not fit; every problem with file, line and column.
    """
    document = read_tree(open_source(path, limits), limits)
    check_version(document, "sweep", "sweep file")
    entry = validated(document, SweepEntry, Context(limits=limits))
    if entry is None:
        document.problems.refuse()
    present = [kind for kind in KINDS if document.node([kind]) is not None]
    if len(present) != 1:
        place = document.place([present[1]] if len(present) > 1 else [], at_key=len(present) > 1)
        got = " and ".join(present) or "nothing that says where the sweep goes"
        document.problems.add(place, got=got, expected=f"one of the keys {', '.join(KINDS)}")
    document.problems.refuse_if_any()
    return SweepFile(document, entry, Path(document.file).parent)


class _Amounts:
    """Numbers of a sweep file in metres and radians."""

    def __init__(self, file: SweepFile, unit_of: UnitOf, units: Units) -> None:
        self._file, self._unit_of, self._units = file, unit_of, units

    def number(self, location: Location, name: str, amount: Amount) -> float:
        unit = self._unit_of(name)
        if not amount.unit and unit in ("m", "rad"):
            return self._units.inside(amount.value, unit == "m")
        value = amount.inside("" if unit not in ("m", "rad", "1") else unit)  # type: ignore[arg-type]
        if value is None and unit == "":
            value = self._of_parameter(amount)
        if value is None:
            expected = {"m": "a length", "rad": "an angle", "1": "a plain number"}[unit]
            self._refuse(location, f"{amount.value:g}{amount.unit}", expected)
        return value

    def _of_parameter(self, amount: Amount) -> float:
        """A parameter is in the units of the model file."""
        linear = amount.unit in ("m", "mm", "cm", "in")
        value = amount.inside("m" if linear else "rad")
        return (value if value is not None else amount.value) / self._units.size(linear)

    def named(self, location: Location, row: Mapping[str, Amount]) -> dict[str, float]:
        return {name: self.number((*location, name), name, amount) for name, amount in row.items()}

    def column(self, name: str, column: Vector) -> Vector:
        unit = self._unit_of(name)
        return column * self._units.size(unit == "m") if unit in ("m", "rad") else column

    def ranges(self, location: Location, given: Mapping[str, Sequence[Amount]]) -> dict[str, list[float]]:
        return {
            name: [self.number((*location, name, k), name, amount) for k, amount in enumerate(pair)]
            for name, pair in given.items()
        }

    def grid(self, given: Mapping[str, Any]) -> Grid:
        counts = {name: self._count(name, axis) for name, axis in given.items()}
        total = math.prod(counts.values())
        if total > MOST_POINTS:
            self._refuse(("grid",), f"{total:.6g} points", f"at most {MOST_POINTS:.0e}")
        values: dict[str, Any] = {}
        for name, axis in given.items():
            if isinstance(axis, RangeEntry):
                low, high, step = self._range(name, axis)
                last = low + (counts[name] - 1) * step if step is not None else high
                values[name] = np.linspace(low, last, counts[name])
            else:
                place = ("grid", name)
                values[name] = [self.number((*place, k), name, amount) for k, amount in enumerate(axis)]
        return Grid(values)

    def _range(self, name: str, axis: RangeEntry) -> tuple[float, float, float | None]:
        place = ("grid", name)
        low = self.number((*place, "from"), name, axis.from_)
        high = self.number((*place, "to"), name, axis.to)
        step = None if axis.step is None else self.number((*place, "step"), name, axis.step)
        return low, high, step

    def _count(self, name: str, axis: Any) -> int:
        """Number of values of a variable, before any of them exists."""
        if not isinstance(axis, RangeEntry):
            return len(axis)
        place = ("grid", name)
        if (axis.points is None) == (axis.step is None):
            got = "neither `points` nor `step`" if axis.points is None else "both `points` and `step`"
            self._refuse(place, got, "one of them")
        low, high, step = self._range(name, axis)
        if axis.points is not None:
            count = axis.points
            if count < 1 or (count == 1 and low != high):
                self._refuse((*place, "points"), str(count), "2 or more points from one value to another")
        elif step is None or step == 0.0 or (high - low) * step < 0.0:
            self._refuse((*place, "step"), f"{step:g}", "a step that leads from the first value to the last")
        else:
            count = math.floor((high - low) / step * (1.0 + 1e-12) + 1e-9) + 1
        if count > LONGEST_AXIS:
            key = "points" if axis.points is not None else "step"
            self._refuse(
                (*place, key), f"{count:.6g} values", f"at most {LONGEST_AXIS} values of one variable"
            )
        return count

    def _refuse(self, location: Location, got: str, expected: str) -> NoReturn:
        place = self._file.document.place(location)
        raise FileError(f"{place.text()}: got {got}, expected {expected}")
