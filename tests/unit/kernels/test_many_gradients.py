"""Gradients of batches are those of one configuration at a time, and do not depend on the batch."""

from __future__ import annotations

import numpy as np
import pytest
from tests.laws.random_closed import displaced, holdable_motors, random_closed
from tests.unit.kernels.test_gradients_of_dimensions import varied

import vincula as vc
from vincula.kernels import many_gradients
from vincula.kernels.compiled import CompiledMechanism
from vincula.kernels.gradients import Gradient
from vincula.mechanism.catalog.registry import example, examples
from vincula.mechanism.mechanism import Mechanism

QUANTITIES = [
    "kinematic.efficiencies",
    "passive_force.efficiencies",
    "internal_force.efficiencies",
    "kinematic.largest",
    "active_force.smallest",
    "kinematic.yoshikawa_volume:translation",
    "kinematic.condition:translation",
    "kinematic.isotropy:rotation",
    "dual_force.isotropy:translation",
    "singularity.distance",
]


def one_by_one(monkeypatch: pytest.MonkeyPatch, ask: object) -> Gradient:
    """The same question when nothing may be computed together."""
    with monkeypatch.context() as only:
        only.setattr(many_gradients.ManyDerivatives, "of", lambda *_: None)
        return ask()


def same(together: Gradient, alone: Gradient) -> None:
    assert np.array_equal(together.smooth, alone.smooth)
    assert dict(together.reasons) == dict(alone.reasons)
    known = together.smooth
    size = np.abs(alone.gradient[known]).max(initial=1e-300)
    size = max(size, 1e-3 * np.abs(alone.values[known]).max(initial=0.0))
    assert np.abs(together.gradient - alone.gradient)[known].max(initial=0.0) <= 1e-11 * size
    assert np.allclose(together.values[known], alone.values[known], rtol=1e-11, atol=0.0)
    assert np.isnan(together.gradient[~known & np.isnan(alone.gradient).all(axis=-1)]).all()


def configurations(mechanism: Mechanism, count: int) -> np.ndarray:
    rng = np.random.default_rng(6)
    found = [mechanism.close(near=displaced(rng, mechanism, 0.1)).flat for _ in range(count)]
    return np.array([mechanism.home.flat, *found])


def check(
    monkeypatch: pytest.MonkeyPatch, compiled: CompiledMechanism, flats: np.ndarray, wrt: object
) -> None:
    for quantity in QUANTITIES:
        together = compiled.gradient(flats, quantity, wrt=wrt)
        same(together, one_by_one(monkeypatch, lambda q=quantity: compiled.gradient(flats, q, wrt=wrt)))


@pytest.mark.parametrize("weighted", [False, True])
@pytest.mark.parametrize("name", [entry.name for entry in examples()])
def test_examples(name: str, weighted: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    mechanism = example(name)
    d = mechanism.space.dimension
    weights = vc.Weights(twist=np.linspace(0.5, 2.0, d), wrench=np.ones(d)) if weighted else vc.Weights()
    compiled = vc.compile(varied(mechanism, 3), weights=weights)
    flats = configurations(mechanism, 2)
    for wrt in ("motors", "joints", ["p"]):
        check(monkeypatch, compiled, flats, wrt)


@pytest.mark.parametrize("seed", [0, 2, 4, 8, 11, 23, 38])
def test_random_mechanisms(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    mechanism = random_closed(np.random.default_rng(seed), planar=seed % 3 == 0, loops=1 + seed % 3)
    mechanism = mechanism.with_active(list(holdable_motors(np.random.default_rng(seed), mechanism)))
    weights = vc.Weights(twist=[1.0] * mechanism.space.dimension, wrench=[2.0] * mechanism.space.dimension)
    compiled = vc.compile(varied(mechanism, 3), weights=weights)
    flats = configurations(mechanism, 2)
    for wrt in ("motors", "joints", ["p"]):
        check(monkeypatch, compiled, flats, wrt)


def test_a_configuration_does_not_depend_on_the_batch(monkeypatch: pytest.MonkeyPatch) -> None:
    mechanism = example("stewart")
    compiled = vc.compile(varied(mechanism, 3), weights=vc.Weights())
    flats = configurations(mechanism, 6)
    flats[3, 0] += 0.3  # open
    for quantity in ("kinematic.efficiencies", "kinematic.isotropy:rotation"):
        for wrt in ("motors", "joints", ["p"]):
            whole = compiled.gradient(flats, quantity, wrt=wrt)
            with monkeypatch.context() as small:
                small.setattr(many_gradients, "SLAB", 1)
                parts = compiled.gradient(flats, quantity, wrt=wrt)
            assert np.array_equal(whole.gradient, parts.gradient, equal_nan=True)
            assert dict(whole.reasons) == dict(parts.reasons)
            assert not whole.smooth[3].any()


def test_different_dimensions_in_one_batch() -> None:
    mechanism = example("five-bar")
    build = varied(mechanism, 3)
    compiled = vc.compile(build)
    values = np.array([0.0, 0.01, 0.0, 0.02])
    flats = np.array([build(p=p).close(motors={"o1": 0.1, "o5": -0.1}).flat for p in values])
    found = compiled.gradient(flats, "kinematic.largest", wrt=["p"], parameters={"p": values})
    assert found.smooth.all()
    for k, p in enumerate(values):
        single = compiled.gradient(flats[k], "kinematic.largest", wrt=["p"], parameters={"p": p})
        assert np.array_equal(found.gradient[k], single.gradient)
