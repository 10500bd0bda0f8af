"""One work unit: the points of a chunk evaluated, the same numbers whoever computes them.

Loops are closed from neighbour to neighbour, from the start that was fixed for the chunk before the run:
those of a grid from row to row, scattered ones in the order of a walk with short steps.  Only the chunk and
its start decide what is computed.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vincula.arrays import Matrix, Vector
from vincula.kernels.compiled import CompiledMechanism
from vincula.kernels.evaluation import OK, Evaluation
from vincula.sweep.chunks import near_walk
from vincula.sweep.inputs import Inputs
from vincula.sweep.ledger import MOST_REASONS

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

    def evaluate(
        self, values: Matrix, extent: tuple[int, ...], start: Vector | None, threads: int | None = 1
    ) -> Block:
        """The numbers of a chunk.

        Args:
            values: Its points, one row a point in row-major order, one column a variable.
            extent: Points along every dimension.
            start: A configuration near the point that is visited first; None where nothing is closed.
            threads: Threads inside the chunk.
        """
        if not self.closes:
            found = self._evaluation(values, None, threads)
            return Block({name: found[name] for name in found.names}, _reasons(found, None))
        first = self.inputs.start.flat if start is None else start
        if not self.scattered:
            found = self._evaluation(values, first, threads, extent)
            rows = {name: found[name].reshape(len(values), *found[name].shape[len(extent) :])
                    for name in found.names}  # fmt: skip
            return Block(rows, _reasons(found, None))
        order = near_walk(values)
        found = self._evaluation(values[order], first, threads)
        arrays: dict[str, Array] = {}
        for name in found.names:
            arrays[name] = np.empty_like(found[name])
            arrays[name][order] = found[name]
        return Block(arrays, _reasons(found, order))

    def _evaluation(
        self, values: Matrix, start: Vector | None, threads: int | None, extent: tuple[int, ...] = (-1,)
    ) -> Evaluation:
        rows, flat = self.inputs.rows(values)
        parameters = {name: column.reshape(extent) for name, column in flat.items()}
        return self.compiled.evaluate(
            rows.reshape(*extent, rows.shape[1]),
            self.quantities,
            given=self.inputs.given,
            start=start,
            parameters=parameters,
            threads=threads,
        )


def _reasons(found: Evaluation, order: NDArray[np.int64] | None) -> tuple[tuple[int, int, str], ...]:
    """Stretches of points with one reason, in the order of the points.

    Not more than the ledger keeps, and none is asked for beyond them: where nearly all points are not ok,
    words would take longer than numbers.
    """
    status, visited = found.status.ravel(), None
    if order is not None:
        visited = np.empty_like(order)
        visited[order] = np.arange(len(order))
        status = status[visited]
    joined: list[tuple[int, int, str]] = []
    for point in np.flatnonzero(status != OK).tolist():
        place = np.unravel_index(point if visited is None else visited[point], found.status.shape)
        text = found.reason(tuple(int(k) for k in place))
        if joined and joined[-1][1] == point - 1 and joined[-1][2] == text:
            joined[-1] = (joined[-1][0], point, text)
        elif len(joined) < MOST_REASONS:
            joined.append((point, point, text))
        else:
            break
    return tuple(joined)
