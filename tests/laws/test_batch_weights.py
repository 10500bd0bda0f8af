"""A batch says what one configuration after the other says under weights of every kind."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from tests.laws.batch_and_loop import COMPARED, compared
from tests.laws.random_configurations import random_configurations
from tests.laws.random_mechanisms import random_mechanism

import vincula as vc

pytest.importorskip("numba")


def _positions(mechanism: vc.Mechanism) -> list[float]:
    s = mechanism.space.translations
    return [1.0] * s + [0.0] * (mechanism.space.dimension - s)


def _mixing(mechanism: vc.Mechanism) -> np.ndarray:
    d = mechanism.space.dimension
    some = np.random.default_rng(0).normal(size=(d, d))
    return some @ some.T + d * np.eye(d)


def _counted(mechanism: vc.Mechanism) -> list[float]:
    return [float(k + 1) for k in range(mechanism.space.dimension)]


WEIGHTS: dict[str, Callable[[vc.Mechanism], vc.Weights]] = {
    "not reciprocal": lambda m: vc.Weights(twist=_counted(m), wrench=[2.0] * m.space.dimension),
    "positions": lambda m: vc.Weights(twist=_positions(m)),
    "positions, reciprocal": lambda m: vc.Weights(twist=_positions(m), reciprocal=True),
    "a matrix": lambda m: vc.Weights(twist=_mixing(m), reciprocal=True),
    "a motor for nothing": lambda m: vc.Weights(rate=[0.0] + [1.0] * (len(m.active) - 1)),
    "all rows": lambda m: vc.Weights(contact_force="all rows"),
}


def compared_quantities(compiled: vc.CompiledMechanism) -> tuple[str, ...]:
    """What is compared; indices of components that weights ignore do not exist."""
    found, refused = [], []
    for name in COMPARED:
        try:
            compiled.evaluate(None, [name], path="lanes")
        except vc.ModelError as problem:
            refused.append(str(problem))
        else:
            found.append(name)
    assert all("ignore" in reason or "has no" in reason for reason in refused)
    assert "internal_force.efficiencies" in found
    assert len(found) > len(COMPARED) - 5
    return tuple(found)


@pytest.mark.parametrize("weights", WEIGHTS)
@pytest.mark.parametrize("name", ["five-bar", "3rrr", "stewart", "two-finger-grasp", "two-arms"])
def test_examples(name: str, weights: str) -> None:
    mechanism = vc.load(f"example:{name}")
    compiled = vc.compile(mechanism, weights=WEIGHTS[weights](mechanism))
    found = compared(compiled, random_configurations(mechanism, 12), compared_quantities(compiled))
    assert found.same, found


@pytest.mark.parametrize("seed", range(12))
def test_random_mechanisms(seed: int) -> None:
    mechanism = random_mechanism(seed)
    weights = list(WEIGHTS.values())[seed % len(WEIGHTS)](mechanism)
    compiled = vc.compile(mechanism, weights=weights)
    found = compared(compiled, random_configurations(mechanism, 5), compared_quantities(compiled))
    assert found.same, found


@pytest.mark.parametrize("weights", WEIGHTS)
def test_bits_do_not_depend_on_the_batch(weights: str) -> None:
    mechanism = vc.load("example:five-bar").with_active(vc.ALL)
    compiled = vc.compile(mechanism, weights=WEIGHTS[weights](mechanism))
    some = random_configurations(mechanism, 6, seed=1)
    lanes = some[np.random.default_rng(0).integers(0, len(some), 37)]
    names = compared_quantities(compiled)
    whole = compiled.evaluate(lanes, names)
    for threads, chunk in ((1, 1), (1, 5), (2, 16)):
        for start in range(0, len(lanes), chunk):
            part = compiled.evaluate(lanes[start : start + chunk], names, threads=threads)
            for quantity in part:
                np.testing.assert_array_equal(part[quantity], whole[quantity][start : start + chunk])


def test_many_lanes_are_those_of_few() -> None:
    """Blocks and threads: thousands of lanes give the bits of each alone."""
    mechanism = vc.load("example:two-finger-grasp")
    compiled = vc.compile(mechanism, weights=vc.Weights(twist=[1.0, 1.0, 0.0]))
    some = random_configurations(mechanism, 7, seed=2)
    names = ("internal_force.efficiencies", "internal_force.task_directions", "kinematic.efficiencies",
             "passive_force.task_directions", "singularity.distance")  # fmt: skip
    many = compiled.evaluate(np.tile(some, (700, 1)), names, threads=2)
    for k, row in enumerate(some):
        one = compiled.at(row, names)
        for name in one:
            np.testing.assert_array_equal(
                many[name][k::7], np.broadcast_to(one[name], many[name][k::7].shape)
            )


def test_other_dimensions_in_every_lane() -> None:
    """Lanes of another characteristic length are computed as well, where weights have zeros one by one."""
    for weights in (None, vc.Weights(twist=[1.0, 1.0, 1.0, 0.0, 0.0, 0.0])):
        compiled = vc.compile(vc.builder("example:stewart"), weights=weights)
        names = ("internal_force.efficiencies", "passive_force.efficiencies", "kinematic.efficiencies",
                 "singularity.distance", "summary")  # fmt: skip
        heights = {"height": np.linspace(0.3, 15.0, 6)}
        fast, slow = (
            compiled.evaluate(None, names, parameters=heights, path=path) for path in ("lanes", "reference")
        )
        for name in fast:
            np.testing.assert_allclose(fast[name], slow[name], rtol=1e-10, atol=1e-13)


def test_home_that_is_special_does_not_stand_for_all() -> None:
    """Passive joints that are dependent at home only: lanes are prepared for what is so in general."""
    compiled = vc.compile(random_mechanism(16), weights=vc.Weights())
    lanes = random_configurations(compiled.mechanism, 6)
    names = ("kinematic.efficiencies",)
    plan = compiled._plan(names)
    writers = compiled._runner.writers(plan, False)
    assert not isinstance(writers, str)
    arrays = {quantity.name: quantity.empty(len(lanes)) for quantity in plan.quantities}
    alone, _ = writers.evaluate(lanes, None, arrays, 1)
    assert alone.tolist() == [0]
