"""Holding a law on all random geometric mechanisms, in blocks so that they run side by side."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache

import numpy as np
import pytest
from tests.laws.random_mechanisms import COUNT, random_mechanism

from vincula.model import LinearModel

BLOCKS = [range(start, COUNT, 10) for start in range(10)]
IN_BLOCKS = pytest.mark.parametrize("block", BLOCKS, ids=[f"{b.start}::10" for b in BLOCKS])
Law = Callable[[int, np.random.Generator], None]


def hold(block: range, law: Law) -> None:
    """A law on every mechanism of a block."""
    for seed in block:
        with about(seed):
            law(seed, np.random.default_rng([seed, 77]))


@cache
def model_of(seed: int) -> LinearModel:
    """The linear model of a random mechanism."""
    return random_mechanism(seed).linearize()


@contextmanager
def about(seed: int) -> Iterator[None]:
    """Names the random mechanism in a failure."""
    try:
        yield
    except Exception as error:
        error.add_note(f"random mechanism {seed}")
        raise
