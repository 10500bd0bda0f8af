"""One work unit: the points of a chunk evaluated, the same numbers whoever computes them.

Loops are closed from neighbour to neighbour.  The points of a chunk, in the order of a walk with short
steps, are cut into stretches; the first points of the stretches are closed one after the other, through
points on the straight lines between them where the way is long, and then all stretches go on side by side,
each point from the one before it in its stretch.  Only the chunk and its start decide what is computed.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from vincula.arrays import Matrix, Vector
from vincula.kernels.compiled import CompiledMechanism
from vincula.kernels.evaluation import FAILED, NO_CLOSURE, OK, Evaluation
from vincula.sweep.chunks import near_walk, walk
from vincula.sweep.inputs import Inputs
from vincula.sweep.ledger import MOST_REASONS

SHORTEST_STRETCH: Final = 32
"""Points of a stretch at least."""
MOST_STRETCHES: Final = 256
"""Stretches of a chunk at most: enough to fill all lanes of a kernel."""

Array = NDArray[Any]


@dataclass(frozen=True, slots=True, eq=False)
class Block:
    """What a chunk gives.

    Attributes:
        arrays: Numbers by quantity, points along the first axis in the chunk's row-major order.
        reasons: First point, last point and text of stretches of points that are not ok.
    """

    arrays: Mapping[str, Array]
    reasons: tuple[tuple[int, int, str], ...]

    @property
    def nbytes(self) -> int:
        """Size of the numbers."""
        return sum(array.nbytes for array in self.arrays.values())


@dataclass(frozen=True, slots=True, eq=False)
class Work:
    """Everything that the chunks of a sweep have in common; it pickles.

    Attributes:
        compiled: The mechanism.
        inputs: What the variables set.
        quantities: What is computed.
        scattered: Whether consecutive points are far from each other, as in random sets.
    """

    compiled: CompiledMechanism
    inputs: Inputs
    quantities: tuple[str, ...]
    scattered: bool

    @property
    def closes(self) -> bool:
        """Whether loops are closed."""
        return self.inputs.given != "configuration"

    def order(self, values: Matrix, extent: tuple[int, ...]) -> NDArray[np.int64]:
        """The order in which the points of a chunk are visited."""
        return near_walk(values) if self.scattered else walk(extent)

    def evaluate(
        self, values: Matrix, extent: tuple[int, ...], start: Vector | None, threads: int | None = 1
    ) -> Block:
        """The numbers of a chunk.

        Args:
            values: Its points, one row a point in row-major order, one column a variable.
            extent: Points along every dimension.
            start: A configuration near the first point of the walk; None where nothing is closed.
            threads: Threads inside the chunk.
        """
        if not self.closes:
            rows, parameters = self.inputs.rows(values)
            found = self._evaluation(rows, parameters, None, self.quantities, threads)
            return Block({name: found[name] for name in found.names}, _reasons(found))
        began = self.inputs.start.flat if start is None else start
        order = self.order(values, extent)
        march = _March(self, values[order], began, threads)
        return march.block(order)

    def _evaluation(
        self,
        rows: Matrix,
        parameters: Mapping[str, Vector],
        start: Array | None,
        quantities: tuple[str, ...],
        threads: int | None,
    ) -> Evaluation:
        return self.compiled.evaluate(
            rows,
            quantities,
            given=self.inputs.given,
            start=start,
            parameters=parameters,
            threads=threads,
        )

    def closed_at(self, values: Matrix, start: Vector, threads: int | None = 1) -> tuple[Array, Array]:
        """Configurations that close one after the other, and the status of each.

        Args:
            values: Points, one row a point, one column a variable.
            start: Where closing of the first one starts.
            threads: Threads to use.
        """
        rows, parameters = self.inputs.rows(values)
        found = self._evaluation(rows, parameters, start, ("configuration",), threads)
        return found["configuration"], found.status

    def each_from(
        self, values: Matrix, starts: Matrix, quantities: tuple[str, ...], threads: int | None
    ) -> Evaluation:
        """Points closed each from its own start."""
        rows, parameters = self.inputs.rows(values)
        return self._evaluation(rows, parameters, starts, quantities, threads)


class _March:
    """Stretches of one chunk, side by side."""

    def __init__(self, work: Work, walked: Matrix, start: Vector, threads: int | None) -> None:
        self._work, self._walked, self._threads = work, walked, threads
        count = len(walked)
        self._length = max(SHORTEST_STRETCH, math.ceil(count / MOST_STRETCHES))
        self._heads = np.arange(0, count, self._length)
        self._where = self._first_starts(start)

    def _first_starts(self, start: Vector) -> Matrix:
        """Configurations near the first point of every stretch."""
        firsts = self._walked[self._heads]
        if len(firsts) == 1:
            return np.array(start)[np.newaxis]
        parts = _parts(self._walked, firsts, self._length // 8)
        found, status = self._work.closed_at(_dense(firsts, parts), start, self._threads)
        last, near = np.cumsum(parts) - 1, []
        current = np.array(start)
        begin = 0
        for end in last:
            good = np.flatnonzero(_closed(status[begin : end + 1]))
            if len(good):
                current = found[begin + good[-1]]
            near.append(current)
            begin = end + 1
        return np.array(near)

    def block(self, order: NDArray[np.int64]) -> Block:
        """March through all stretches; the numbers in row-major order."""
        work, count = self._work, len(self._walked)
        asked = tuple(dict.fromkeys((*work.quantities, "configuration")))
        arrays: dict[str, Array] = {}
        told: list[tuple[int, str]] = []
        for step in range(self._length):
            at = self._heads + step
            lanes = np.flatnonzero(at < count)
            if not len(lanes):
                break
            at = at[lanes]
            found = work.each_from(self._walked[at], self._where[lanes], asked, self._threads)
            good = _closed(found.status)
            self._where[lanes[good]] = found["configuration"][good]
            for name in ("status", *work.quantities):
                part = found[name]
                if name not in arrays:
                    arrays[name] = np.empty((count, *part.shape[1:]), dtype=part.dtype)
                arrays[name][order[at]] = part
            for lane in np.flatnonzero(found.status != OK):
                told.append((int(order[at[lane]]), found.reason(int(lane))))  # noqa: PERF401
        return Block(arrays, _joined(sorted(told)))


def _closed(status: Array) -> NDArray[np.bool_]:
    good: NDArray[np.bool_] = (status != NO_CLOSURE) & (status != FAILED)
    return good


def _parts(walked: Matrix, firsts: Matrix, most: int) -> NDArray[np.int64]:
    """In how many steps to go to every first point from the one before it: none longer than the walk's."""
    span = np.ptp(walked, axis=0)
    scale = np.where(span > 0.0, span, 1.0)
    usual = float(np.linalg.norm(np.diff(walked, axis=0) / scale, axis=1).max(initial=0.0))
    far = np.linalg.norm(np.diff(firsts, axis=0) / scale, axis=1)
    parts = np.ceil(far / usual - 1e-9) if usual > 0.0 else np.ones(len(far))
    clipped = np.clip(parts, 1, max(1, most)).astype(np.int64)
    return np.concatenate([np.ones(1, dtype=np.int64), clipped])


def _dense(firsts: Matrix, parts: NDArray[np.int64]) -> Matrix:
    """The first points with points on the lines between them: `parts[k]` points up to first point k."""
    before = np.concatenate([firsts[:1], firsts[:-1]])
    pieces = [
        before[k] + (firsts[k] - before[k]) * (np.arange(1, n + 1) / n)[:, np.newaxis]
        for k, n in enumerate(parts)
    ]
    return np.concatenate(pieces)


def _reasons(found: Evaluation) -> tuple[tuple[int, int, str], ...]:
    return _joined([(int(k), found.reason(int(k))) for k in np.flatnonzero(found.status != OK)])


def _joined(told: list[tuple[int, str]]) -> tuple[tuple[int, int, str], ...]:
    """Consecutive points with the same reason as one stretch; not more than the ledger keeps."""
    joined: list[tuple[int, int, str]] = []
    for point, text in told:
        if joined and joined[-1][1] == point - 1 and joined[-1][2] == text:
            joined[-1] = (joined[-1][0], point, text)
        elif len(joined) < MOST_REASONS:
            joined.append((point, point, text))
        else:
            break
    return tuple(joined)
