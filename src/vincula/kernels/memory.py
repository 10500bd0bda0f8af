"""Memory of large results, used again: a batch that follows another finds its pages already there.

The first touch of fresh memory costs about as much as a kernel: the system has to find and clear every page.
So the memory of a result that nobody holds any more is kept for the next one, up to `MOST` bytes in all, and
is marked as free to take: the system takes it back when anybody needs it.
"""

from __future__ import annotations

import mmap
import weakref
from collections import deque
from typing import Final

import numpy as np
from numpy.typing import NDArray

LARGE: Final = 1 << 20
"""Bytes from which an array is worth it."""
MOST: Final = 1 << 29
"""Bytes that are kept at most."""
LINE: Final = 8
"""Doubles in a line of the cache."""
_PAGE: Final = 1 << 21

_kept: deque[mmap.mmap] = deque()


def doubles(shape: tuple[int, ...]) -> NDArray[np.float64]:
    """An array of doubles with anything in it; a large one begins at a page.

    Args:
        shape: Its dimensions.
    """
    count = 1
    for length in shape:
        count *= length
    if 8 * count < LARGE:
        return np.empty(shape)
    block = _taken(8 * count)
    # The array keeps the block alive, and every view of it keeps this very array.
    whole: NDArray[np.float64] = np.frombuffer(memoryview(block), dtype=np.float64, count=count)
    weakref.finalize(whole, _give_back, block).atexit = False
    return whole.reshape(shape)


def aligned(count: int) -> NDArray[np.float64]:
    """So many doubles with anything in them, from the beginning of a line of the cache on."""
    room = np.empty(count + LINE)
    start: int = -(room.__array_interface__["data"][0] // 8) % LINE
    return room[start : start + count]


def release() -> None:
    """Give all memory that is kept back to the system."""
    _kept.clear()


def _taken(size: int) -> mmap.mmap:
    """A kept block that is large enough and not much too large, or a new one."""
    for _ in range(len(_kept)):
        try:
            block = _kept.popleft()
        except IndexError:  # another thread was quicker
            break
        if size <= len(block) <= size + size // 4 + _PAGE:
            return block
        _kept.append(block)
    return _new(-(-size // _PAGE) * _PAGE)


def _new(size: int) -> mmap.mmap:
    if not hasattr(mmap, "MAP_PRIVATE"):
        return mmap.mmap(-1, size)
    block = mmap.mmap(-1, size, flags=mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS)
    if hasattr(mmap, "MADV_HUGEPAGE"):
        block.madvise(mmap.MADV_HUGEPAGE)
    return block


def _give_back(block: mmap.mmap) -> None:
    """Keep a block whose array is gone; the oldest ones go where they are too many."""
    if hasattr(mmap, "MADV_FREE"):
        block.madvise(mmap.MADV_FREE)
    _kept.append(block)
    while sum(map(len, tuple(_kept))) > MOST:
        try:
            _kept.popleft()
        except IndexError:
            break
