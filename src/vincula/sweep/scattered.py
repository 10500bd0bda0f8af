"""Scattered points of a sweep: random and low-discrepancy sets over ranges."""

from __future__ import annotations

import inspect
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final, Literal

import numpy as np

from vincula.arrays import Matrix, Vector, checked
from vincula.errors import ModelError
from vincula.sweep.points import Indices, Row, counted, named, pairs_of

MOST_SOBOL_POINTS: Final = 2**30
"""A Sobol sequence of 30 bits repeats after so many points."""


@dataclass(frozen=True, eq=False, init=False)
class RandomPoints(Row):
    """Independent points, evenly distributed over ranges.

    Args:
        ranges: Lowest and highest value by variable [m, rad].
        points: Number of points.
        seed: Seed; point i depends on it and on i alone.

    Raises:
        ModelError: A range that is empty or no range.
    """

    names: tuple[str, ...]
    number: int
    lower: Vector
    upper: Vector
    seed: int

    def __init__(self, ranges: Mapping[str, Sequence[float]], points: int, seed: int = 0) -> None:
        _set_ranges(self, ranges, points, seed)

    def at(self, indices: Indices) -> Matrix:
        """Consecutive points; counters instead of a running state give any stretch at once."""
        width, begin = len(self.names), int(indices[0]) * len(self.names)
        source = np.random.Philox(key=self.seed).advance(begin // 4)
        raw = source.random_raw(begin % 4 + len(indices) * width)[begin % 4 :]
        unit = (raw >> np.uint64(11)).astype(np.float64) * 2.0**-53
        return self.lower + unit.reshape(-1, width) * (self.upper - self.lower)

    def description(self) -> dict[str, Any]:
        """Ranges, number and seed."""
        return {"random": list(self.names), "lower": self.lower, "upper": self.upper, "points": self.number,
                "seed": self.seed}  # fmt: skip


@dataclass(frozen=True, eq=False, init=False)
class LowDiscrepancyPoints(Row):
    """Points that fill ranges more evenly than random ones (scrambled, by `scipy.stats.qmc`).

    Args:
        ranges: Lowest and highest value by variable [m, rad].
        points: Number of points; for `sobol` best a power of two.
        seed: Seed of the scrambling.
        sequence: `sobol` or `halton`.

    Raises:
        ModelError: A range that is empty or no range, or no such sequence.
    """

    names: tuple[str, ...]
    number: int
    lower: Vector
    upper: Vector
    seed: int
    sequence: Literal["sobol", "halton"]
    _running: list[tuple[Any, int]]

    def __init__(
        self,
        ranges: Mapping[str, Sequence[float]],
        points: int,
        seed: int = 0,
        sequence: Literal["sobol", "halton"] = "sobol",
    ) -> None:
        if sequence not in ("sobol", "halton"):
            raise ModelError(f"sequence is {sequence!r}: choose sobol or halton")
        if sequence == "sobol" and points > MOST_SOBOL_POINTS:
            raise ModelError(f"a Sobol sequence has at most {MOST_SOBOL_POINTS} points: choose halton")
        _set_ranges(self, ranges, points, seed)
        object.__setattr__(self, "_running", [])
        object.__setattr__(self, "sequence", sequence)

    def at(self, indices: Indices) -> Matrix:
        """Consecutive points."""
        from scipy.stats import qmc

        begin = int(indices[0])
        if self._running and self._running[0][1] == begin:
            engine, _ = self._running.pop()
            return self._next(engine, begin, len(indices))
        kind = qmc.Sobol if self.sequence == "sobol" else qmc.Halton
        word = "rng" if "rng" in inspect.signature(kind).parameters else "seed"
        engine = kind(len(self.names), scramble=True, **{word: np.random.default_rng(self.seed)})
        if self.sequence == "sobol" and begin:
            engine.fast_forward(begin)
        else:  # point i follows from i alone: fast_forward would draw all points before it
            engine.num_generated = begin
        return self._next(engine, begin, len(indices))

    def _next(self, engine: Any, begin: int, count: int) -> Matrix:
        """Points from where an engine stands; it is kept, because the next stretch is asked for next."""
        unit = _quiet(engine, count)
        self._running[:] = [(engine, begin + count)]
        found: Matrix = self.lower + unit * (self.upper - self.lower)
        return found

    def description(self) -> dict[str, Any]:
        """Sequence, ranges, number and seed."""
        return {self.sequence: list(self.names), "lower": self.lower, "upper": self.upper,
                "points": self.number, "seed": self.seed}  # fmt: skip


def _quiet(engine: Any, count: int) -> Matrix:
    """Numbers of an engine; that stretches of Sobol points are no powers of two is our doing."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="The balance properties", category=UserWarning)
        drawn: Matrix = engine.random(count)
    return drawn


def _set_ranges(target: RandomPoints | LowDiscrepancyPoints, ranges: Any, points: int, seed: int) -> None:
    pairs = pairs_of(ranges, "ranges")
    names = named([name for name, _ in pairs])
    bounds = np.array([checked(np.ravel(v), f"range of {name!r}", (2,)) for name, v in pairs])
    for name, (low, high) in zip(names, bounds, strict=True):
        if not low < high:
            raise ModelError(f"range of {name!r} is {low:g} to {high:g}: the first must be the smaller one")
    if isinstance(seed, bool) or not isinstance(seed, (int, np.integer)) or not 0 <= seed < 2**63:
        raise ModelError(f"seed is {seed!r}: give a whole number, 0 or more")
    object.__setattr__(target, "names", names)
    object.__setattr__(target, "number", counted(points))
    object.__setattr__(target, "lower", bounds[:, 0])
    object.__setattr__(target, "upper", bounds[:, 1])
    object.__setattr__(target, "seed", int(seed))
