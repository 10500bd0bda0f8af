"""Which points a sweep visits: grids, tables, paths (random and low-discrepancy sets: `scattered`).

A set of points is a value: the same words give the same numbers, and any stretch of it can be had
without the rest, so that memory does not grow with the number of points.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vincula.arrays import Matrix, Vector, checked
from vincula.errors import DuplicateNameError, ModelError, ShapeError

MOST_POINTS: Final = 10**10
"""Sweeps with more points are refused: nobody waits for them, and a typing error is likelier."""
POINT: Final = "point"
"""Name of the only dimension of all sets that are no grids."""
Indices = NDArray[np.int64]


class Points(ABC):
    """The points of a sweep: values of some variables, in order."""

    @property
    @abstractmethod
    def variables(self) -> tuple[str, ...]:
        """Names of what changes from point to point."""

    @property
    @abstractmethod
    def shape(self) -> tuple[int, ...]:
        """Number of points along every dimension."""

    @property
    @abstractmethod
    def dims(self) -> tuple[str, ...]:
        """Names of the dimensions."""

    @abstractmethod
    def at(self, indices: Indices) -> Matrix:
        """Values at some points.

        Args:
            indices: Places of the points in row-major order; for sets that are no grids consecutive.

        Returns:
            One row a point, one column a variable [m, rad].
        """

    @abstractmethod
    def description(self) -> dict[str, Any]:
        """What makes this set of points what it is, as plain values and arrays, for its fingerprint."""

    @property
    def count(self) -> int:
        """Number of points."""
        return math.prod(self.shape)


def named(names: Sequence[str]) -> tuple[str, ...]:
    """Names of variables, refused where there is none or one is given twice."""
    if not names:
        raise ModelError("a sweep needs at least one variable: a motor, joint, pose component or parameter")
    seen: set[str] = set()
    for name in names:
        if not isinstance(name, str) or not name:
            raise ModelError(f"the name of a variable is {name!r}: give the name of what changes")
        if name in seen:
            raise DuplicateNameError("variable", name)
        seen.add(name)
    return tuple(names)


def pairs_of(given: Any, what: str) -> list[tuple[str, Any]]:
    """Names with values, from a mapping or from a list of pairs (which may hold a name twice)."""
    if isinstance(given, Mapping):
        return list(given.items())
    try:
        return [(name, value) for name, value in given]
    except (TypeError, ValueError):
        raise ModelError(f"{what} maps names of variables to values, got {given!r}") from None


def _refuse_too_many(count: int) -> None:
    if count > MOST_POINTS:
        raise ModelError(
            f"the sweep has {count:.6g} points, at most {MOST_POINTS:.0e} are computed: give fewer points or "
            "larger steps"
        )
    if count < 1:
        raise ModelError("the sweep has no points: give at least one value for every variable")


@dataclass(frozen=True, eq=False, init=False)
class Grid(Points):
    """Every combination of the values of several variables; the last one changes fastest.

    Args:
        values: Values by variable [m, rad], as a mapping or as pairs.

    Attributes:
        axes: Values by variable.

    Raises:
        DuplicateNameError: Two variables of one name.
        ModelError: No values, or too many points.
        NonFiniteError: A value that is not finite.
    """

    axes: Mapping[str, Vector]

    def __init__(self, values: Mapping[str, ArrayLike] | Sequence[tuple[str, ArrayLike]]) -> None:
        pairs = pairs_of(values, "a grid")
        named([name for name, _ in pairs])
        axes = {name: checked(np.atleast_1d(v), f"values of {name!r}", (None,)) for name, v in pairs}
        object.__setattr__(self, "axes", axes)
        _refuse_too_many(math.prod(len(axis) for axis in axes.values()))

    @property
    def variables(self) -> tuple[str, ...]:
        """Names of the variables, one a dimension."""
        return tuple(self.axes)

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of values of every variable."""
        return tuple(len(axis) for axis in self.axes.values())

    @property
    def dims(self) -> tuple[str, ...]:
        """The variables."""
        return self.variables

    def at(self, indices: Indices) -> Matrix:
        """Values at some points, in any order."""
        places = np.unravel_index(indices, self.shape)
        return np.stack([axis[k] for axis, k in zip(self.axes.values(), places, strict=True)], axis=-1)

    def description(self) -> dict[str, Any]:
        """Values by variable."""
        return {"grid": dict(self.axes)}


class Row(Points):
    """Points along one dimension."""

    names: tuple[str, ...]
    number: int

    @property
    def variables(self) -> tuple[str, ...]:
        """Names of the variables."""
        return self.names

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of points."""
        return (self.number,)

    @property
    def dims(self) -> tuple[str, ...]:
        """One dimension, `point`."""
        return (POINT,)


@dataclass(frozen=True, eq=False, init=False)
class PointTable(Row):
    """Points given one by one: a column of values for every variable.

    Args:
        columns: Values by variable [m, rad], all of one length, as a mapping or as pairs.

    Raises:
        DuplicateNameError: Two columns of one name.
        ShapeError: Columns of different lengths.
        NonFiniteError: A value that is not finite.
    """

    names: tuple[str, ...]
    number: int
    values: Matrix

    def __init__(self, columns: Mapping[str, ArrayLike] | Sequence[tuple[str, ArrayLike]]) -> None:
        pairs = pairs_of(columns, "a table")
        names = named([name for name, _ in pairs])
        arrays = [checked(np.atleast_1d(v), f"column {name!r}", (None,)) for name, v in pairs]
        for name, array in zip(names, arrays, strict=True):
            if len(array) != len(arrays[0]):
                raise ShapeError(
                    f"column {name!r}", array.shape, f"({len(arrays[0])},) as column {names[0]!r}"
                )
        _refuse_too_many(len(arrays[0]))
        object.__setattr__(self, "names", names)
        object.__setattr__(self, "number", len(arrays[0]))
        object.__setattr__(self, "values", np.stack(arrays, axis=-1))

    def at(self, indices: Indices) -> Matrix:
        """Rows of the table."""
        return self.values[indices]

    def description(self) -> dict[str, Any]:
        """The whole table."""
        return {"table": list(self.names), "values": self.values}


@dataclass(frozen=True, eq=False, init=False)
class Polyline(Row):
    """Points along straight lines from waypoint to waypoint.

    Args:
        waypoints: Values by variable [m, rad], the same variables at every waypoint; two or more.
        points: Number of points, both ends included.  Each of the lines gets an equal share.

    Raises:
        ModelError: Fewer than two waypoints or points, or waypoints with different variables.
    """

    names: tuple[str, ...]
    number: int
    waypoints: Matrix

    def __init__(self, waypoints: Sequence[Mapping[str, float]], points: int) -> None:
        if len(waypoints) < 2:
            raise ModelError(f"a path needs two waypoints or more, got {len(waypoints)}")
        names = named(list(waypoints[0]))
        for waypoint in waypoints:
            if set(waypoint) != set(names):
                raise ModelError(
                    f"every waypoint must give the same variables: {list(names)}, one gives {list(waypoint)}"
                )
        rows = [[waypoint[name] for name in names] for waypoint in waypoints]
        object.__setattr__(self, "names", names)
        object.__setattr__(self, "number", counted(points, least=2))
        object.__setattr__(self, "waypoints", checked(rows, "waypoints", (None, len(names))))

    def at(self, indices: Indices) -> Matrix:
        """Points on the lines."""
        place = indices * ((len(self.waypoints) - 1) / (self.number - 1))
        line = np.minimum(place.astype(np.int64), len(self.waypoints) - 2)
        share = (place - line)[:, np.newaxis]
        found: Matrix = (1.0 - share) * self.waypoints[line] + share * self.waypoints[line + 1]
        return found

    def description(self) -> dict[str, Any]:
        """Waypoints and number of points."""
        return {"path": list(self.names), "waypoints": self.waypoints, "points": self.number}


def counted(points: int, least: int = 1) -> int:
    """A number of points, checked.

    Raises:
        ModelError: No whole number, too small or too large.
    """
    if isinstance(points, bool) or not isinstance(points, (int, np.integer)) or points < least:
        raise ModelError(f"points is {points!r}: give a whole number, {least} or more")
    _refuse_too_many(int(points))
    return int(points)
