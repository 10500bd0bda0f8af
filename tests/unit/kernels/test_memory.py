"""Memory of large results: used again when nobody holds it, never before."""

from __future__ import annotations

import gc
from collections.abc import Iterator

import numpy as np
import pytest

from vincula.kernels import memory

LARGE = (memory.LARGE // 8, 3)


@pytest.fixture(autouse=True)
def nothing_kept() -> Iterator[None]:
    memory.release()
    yield
    memory.release()


def address(array: np.ndarray) -> int:
    return int(array.__array_interface__["data"][0])


def test_memory_is_used_again_when_the_last_view_is_gone() -> None:
    first = memory.doubles(LARGE)
    where, part = address(first), first[5:7, 1]
    part[...] = 4.0
    del first
    gc.collect()
    second = memory.doubles(LARGE)
    assert address(second) != where  # a view still shows the first
    second[...] = 0.0
    assert (part == 4.0).all()
    del part
    gc.collect()
    assert address(memory.doubles(LARGE)) == where


def test_much_smaller_results_do_not_take_a_large_block() -> None:
    large = memory.doubles((20 * LARGE[0], 3))
    where = address(large)
    del large
    gc.collect()
    assert address(memory.doubles(LARGE)) != where


def test_no_more_is_kept_than_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(memory, "MOST", 10 << 20)
    several = [memory.doubles(LARGE) for _ in range(8)]
    assert len({address(one) for one in several}) == 8
    several.clear()
    gc.collect()
    assert 0 < sum(map(len, memory._kept)) <= 10 << 20


def test_large_arrays_begin_at_a_line() -> None:
    assert address(memory.doubles(LARGE)) % 64 == 0
    for count in (1, 7, 1000):
        one = memory.aligned(count)
        assert one.shape == (count,)
        assert address(one) % 64 == 0


def test_small_arrays_are_plain() -> None:
    assert memory.doubles((3, 4)).shape == (3, 4)
    assert memory.doubles((0, 4)).shape == (0, 4)
    assert not memory._kept
