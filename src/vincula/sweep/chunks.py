"""How the points of a sweep are cut into chunks: blocks of points, one work unit and one file each."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from vincula.errors import ModelError

LARGEST_CHUNK: Final = 65_536
"""Points of a chunk, by default at most."""
SMALLEST_CHUNK: Final = 1024
"""Points of a chunk, by default at least: each costs about ten syncs of the disk, which take tens of ms."""
MOST_CHUNKS: Final = 1_000_000
"""Most chunks of a sweep: each is a row of the ledger and a file for every array."""


@dataclass(frozen=True, slots=True)
class Chunking:
    """A grid of points cut into equal blocks; those at the far ends may be smaller.

    Attributes:
        shape: Points along every dimension.
        block: Points of a chunk along every dimension.
    """

    shape: tuple[int, ...]
    block: tuple[int, ...]

    @staticmethod
    def of(shape: tuple[int, ...], asked: int | Sequence[int] | None = None) -> Chunking:
        """Chunks of so many points, whole rows first; or of a given shape.

        Args:
            shape: Points along every dimension.
            asked: Points of a chunk, or its shape; by default a 64th of all, within limits.  It depends
                on the number of points alone, never on the machine, because it is part of the data set.

        Raises:
            ModelError: A size that cannot be used, or more than a million chunks.
        """
        total = math.prod(shape)
        if asked is None:
            size = min(max(total // 64, SMALLEST_CHUNK), LARGEST_CHUNK)
            block = _filled(shape, max(size, math.ceil(total / MOST_CHUNKS) * 2))
        elif isinstance(asked, (int, np.integer)):
            if asked < 1 or isinstance(asked, bool):
                raise ModelError(f"chunk is {asked}: give the number of points of a chunk, 1 or more")
            block = _filled(shape, int(asked))
        else:
            block = _given(shape, asked)
        chunking = Chunking(shape, block)
        if chunking.count > MOST_CHUNKS:
            raise ModelError(
                f"{total} points in chunks of {math.prod(block)} make {chunking.count} chunks, at most "
                f"{MOST_CHUNKS} are kept track of: give larger chunks"
            )
        return chunking

    @property
    def numbers(self) -> tuple[int, ...]:
        """Chunks along every dimension."""
        return tuple(-(-n // b) for n, b in zip(self.shape, self.block, strict=True))

    @property
    def count(self) -> int:
        """Number of chunks."""
        return math.prod(self.numbers)

    def place(self, chunk: int) -> tuple[int, ...]:
        """Place of a chunk among the chunks, by dimension."""
        return tuple(int(k) for k in np.unravel_index(chunk, self.numbers))

    def slices(self, chunk: int) -> tuple[slice, ...]:
        """The points of a chunk, by dimension."""
        return tuple(
            slice(k * b, min((k + 1) * b, n))
            for k, b, n in zip(self.place(chunk), self.block, self.shape, strict=True)
        )

    def extent(self, chunk: int) -> tuple[int, ...]:
        """Points of a chunk along every dimension; smaller than the block at the far ends."""
        return tuple(s.stop - s.start for s in self.slices(chunk))

    def indices(self, chunk: int) -> NDArray[np.int64]:
        """Row-major places of the points of a chunk among all points, in the chunk's own row-major order."""
        flat = np.zeros((1,) * len(self.shape), dtype=np.int64)
        stride = 1
        for axis in reversed(range(len(self.shape))):
            part = self.slices(chunk)[axis]
            along = np.arange(part.start, part.stop, dtype=np.int64) * stride
            flat = flat + along.reshape([-1 if k == axis else 1 for k in range(len(self.shape))])
            stride *= self.shape[axis]
        return flat.ravel()


def near_walk(values: NDArray[np.float64]) -> NDArray[np.int64]:
    """An order in which to visit scattered points with short steps: along a Z-shaped curve.

    Args:
        values: One row a point.
    """
    low, high = values.min(axis=0), values.max(axis=0)
    span = np.where(high > low, high - low, 1.0)
    bits = min(16, 62 // values.shape[1])
    if bits < 1:
        return np.arange(len(values), dtype=np.int64)
    cells = np.minimum((values - low) / span * 2.0**bits, 2.0**bits - 1.0).astype(np.uint64)
    code = np.zeros(len(values), dtype=np.uint64)
    for bit in range(bits):
        for column in range(values.shape[1]):
            at = np.uint64(bit * values.shape[1] + column)
            code |= ((cells[:, column] >> np.uint64(bit)) & np.uint64(1)) << at
    return np.argsort(code, kind="stable").astype(np.int64)


def _filled(shape: tuple[int, ...], size: int) -> tuple[int, ...]:
    block: list[int] = []
    for n in reversed(shape):
        block.append(max(1, min(n, size)))
        size //= block[-1]
    return tuple(reversed(block))


def _given(shape: tuple[int, ...], asked: Sequence[int]) -> tuple[int, ...]:
    block = tuple(asked)
    if len(block) != len(shape) or any(
        isinstance(b, bool) or not isinstance(b, (int, np.integer)) or b < 1 for b in block
    ):
        raise ModelError(
            f"chunk is {asked!r}: give a number of points, or one number for each of {len(shape)} dimensions"
        )
    return tuple(min(int(b), n) for b, n in zip(block, shape, strict=True))
