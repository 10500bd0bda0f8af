"""Frames and rows in lanes give the matrices that the ordinary functions give, anywhere, closed or not."""

from __future__ import annotations

import math

import numpy as np
import pytest
from tests.laws.random_mechanisms import random_mechanism

from vincula.arrays import Matrix, Vector
from vincula.errors import MissingReferenceError
from vincula.mechanism import jacobians
from vincula.mechanism.catalog.registry import MODULES, example
from vincula.mechanism.mechanism import Mechanism

pytest.importorskip("numba")

from vincula.kernels.lanes import tables as t
from vincula.kernels.lanes.program import LaneProgram


@pytest.fixture(autouse=True)
def open_loops_allowed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Matrices are compared at open configurations too."""
    monkeypatch.setattr(jacobians, "CLOSED", math.inf)


def anywhere(mechanism: Mechanism, rng: np.random.Generator, count: int) -> Matrix:
    """Home, and random values far from it."""
    rows: list[Vector] = [np.concatenate([np.zeros(0), *mechanism.home.values()])]
    for _ in range(count):
        values = []
        for value in mechanism.home.values():
            moved = value + rng.normal(size=len(value))
            if len(value) in (4, 7):
                moved[-4:] /= np.linalg.norm(moved[-4:])
            values.append(moved)
        rows.append(np.concatenate([np.zeros(0), *values]))
    return np.array(rows)


def ordinary(mechanism: Mechanism, row: Vector) -> Matrix:
    """[J_a J_p -G^T] in scaled units by the ordinary functions."""
    values, at = {}, 0
    for name, home in mechanism.home.items():
        values[name] = row[at : at + len(home)]
        at += len(home)
    return np.asarray(mechanism.linearize(values).ledger.matrix("all"))


def held(mechanism: Mechanism, rng: np.random.Generator) -> float:
    """Largest difference, relative to the largest entry, with the same and with their own dimensions."""
    values = anywhere(mechanism, rng, 4)
    expected = np.array([ordinary(mechanism, row) for row in values])
    scale = max(1.0, np.abs(expected).max(initial=0.0))
    plain = LaneProgram.prepare(mechanism)
    general = LaneProgram.prepare(mechanism, general=True)
    many = np.tile(general.constants, (len(values), 1))
    gaps = [plain.matrices(values) - expected, general.matrices(values, many) - expected]
    return max(float(np.abs(gap).max(initial=0.0)) for gap in gaps) / scale


@pytest.mark.parametrize("name", MODULES)
def test_catalog(name: str, rng: np.random.Generator) -> None:
    assert held(example(name), rng) < 1e-14


def test_random_mechanisms(rng: np.random.Generator) -> None:
    """Every joint and contact type, member cuts and loop cuts, couplings and drives."""
    seen = 0
    for seed in range(120):
        try:
            mechanism = random_mechanism(seed)
            mechanism.layout  # noqa: B018
        except MissingReferenceError:
            continue
        assert held(mechanism, rng) < 2e-14, seed
        seen += 1
    assert seen > 100


def test_axes_of_the_member(rng: np.random.Generator) -> None:
    mechanism = example("stewart").with_reference("platform", (0.1, 0.2, 0.3), axes="body")
    assert held(mechanism, rng) < 1e-14


def test_one_lane_has_the_bits_of_many(rng: np.random.Generator) -> None:
    mechanism = example("mixed")
    program = LaneProgram.prepare(mechanism)
    values = anywhere(mechanism, rng, 20)
    together = program.matrices(values)
    for row, found in zip(values, together, strict=True):
        np.testing.assert_array_equal(program.matrices(row[None])[0], found)


def test_large_angles_lose_nothing(rng: np.random.Generator) -> None:
    """Sine and cosine of many turns are those of the number given."""
    mechanism = example("serial-2r")
    program = LaneProgram.prepare(mechanism)
    values = rng.uniform(-1, 1, (400, 2)) * 10.0 ** rng.uniform(-9, 8.9, (400, 1))
    values[:, 1] = 0.0
    found = program.matrices(values)
    expected = np.array([ordinary(mechanism, row) for row in values])
    np.testing.assert_allclose(found, expected, rtol=0, atol=5e-16 * np.abs(expected).max())


def test_angles_beyond_reason_are_not_a_number() -> None:
    mechanism = example("serial-2r")
    program = LaneProgram.prepare(mechanism)
    values = np.array([[0.3, 0.4], [1e12, 0.4]])
    found = program.matrices(values)
    assert np.isfinite(found[0]).all()
    assert np.isnan(found[1]).any()
    assert program.code[t.ROWS] == found.shape[1]
