"""A batch says what one configuration after the other says, singular ones included."""

from __future__ import annotations

import numpy as np
import pytest
from tests.laws.batch_and_loop import COMPARED, compared
from tests.laws.random_configurations import random_configurations

import vincula as vc
from vincula.mechanism.catalog import examples

NAMES = [entry.name for entry in examples()]
HEAVY = ("stewart-spherical", "two-arms", "quadruped")


@pytest.mark.parametrize("name", NAMES)
def test_every_example(name: str) -> None:
    compiled = vc.compile(vc.load(f"example:{name}"))
    lanes = random_configurations(compiled.mechanism, 6 if "stewart" in name else 24)
    found = compared(compiled, lanes)
    assert found.same, found


@pytest.mark.parametrize("name", [name for name in NAMES if name not in HEAVY])
def test_bits_do_not_depend_on_the_batch(name: str) -> None:
    """Any size, order, chunks and number of threads: every lane gives the same bits."""
    compiled = vc.compile(vc.load(f"example:{name}"))
    some = random_configurations(compiled.mechanism, 5, seed=1)
    lanes = some[np.random.default_rng(0).integers(0, len(some), 37)]
    names = (*COMPARED, "kinematic.condition", "reference.pose")
    whole = compiled.evaluate(lanes, names)
    for threads, chunk in ((1, 1), (1, 5), (2, 16), (3, 37)):
        for start in range(0, len(lanes), chunk):
            part = compiled.evaluate(lanes[start : start + chunk], names, threads=threads)
            for quantity in part:
                np.testing.assert_array_equal(part[quantity], whole[quantity][start : start + chunk])
