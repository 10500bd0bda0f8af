"""Efficiencies against 200-digit arithmetic: weights over 1e+-16, efficiencies up to 1e14."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from tests.paper.matrices import five_bar, stewart
from tests.unit.analysis.exact_spectrum import exact_efficiencies

from vincula.analysis.manipulability import (
    dual_force_ellipsoid,
    kinematic_ellipsoid,
    passive_force_ellipsoid,
)
from vincula.model import LinearModel
from vincula.weights import Weights

ONE_SIDE, BOTH_SIDES, NEAR_SINGULAR = 1e-12, 1e-8, 1e-6
DRAWS = {"five-bar 1 5": 30, "five-bar 2 4": 30, "five-bar all": 30, "stewart 1 -120": 4, "stewart 45 -45": 4}


def mechanism(paper: dict[str, Any], name: str) -> LinearModel:
    kind, *rest = name.split()
    if kind == "stewart":
        return stewart(paper, float(rest[0]), float(rest[1]))
    return five_bar(paper, [1, 2, 3, 4, 5] if rest == ["all"] else [int(r) for r in rest])


def graded(size: int, step: int, rng: np.random.Generator) -> np.ndarray:
    """Log-uniform, or from a few values so that rows of one size meet: both have their dangers."""
    if step % 2:
        return 10.0 ** rng.uniform(-16.0, 16.0, size)
    return 10.0 ** rng.choice([-16.0, -8.0, 0.0, 8.0, 16.0], size)


@pytest.mark.parametrize("side", ["twist", "rate", "both"])
@pytest.mark.parametrize("name", DRAWS)
def test_weights_over_thirty_two_orders(
    paper: dict[str, Any], name: str, side: str, rng: np.random.Generator
) -> None:
    model = mechanism(paper, name)
    bound = BOTH_SIDES if side == "both" else ONE_SIDE
    for step in range(DRAWS[name]):
        twist = np.ones(model.dimension) if side == "rate" else graded(model.dimension, step, rng)
        rate = np.ones(len(model.motors)) if side == "twist" else graded(len(model.motors), step, rng)
        weights = Weights(twist=twist, rate=rate, reciprocal=True)
        exact = exact_efficiencies(model, twist, rate)
        assert kinematic_ellipsoid(model, weights).finite == pytest.approx(exact, rel=bound)
        assert 1.0 / dual_force_ellipsoid(model, weights).finite[::-1] == pytest.approx(exact, rel=bound)


@pytest.mark.parametrize("name", DRAWS)
def test_forces_with_weights_of_their_own(paper: dict[str, Any], name: str, rng: np.random.Generator) -> None:
    """Structural wrenches and internal torques besides; the peer is the dual problem of motions."""
    model = mechanism(paper, name)
    for step in range(DRAWS[name]):
        wrench, torque = graded(model.dimension, step, rng), graded(len(model.motors), step, rng)
        found = passive_force_ellipsoid(model, Weights(wrench=wrench, torque=torque))
        exact = exact_efficiencies(model, 1.0 / wrench, 1.0 / torque)
        assert 1.0 / found.finite[::-1] == pytest.approx(exact, rel=BOTH_SIDES)


@pytest.mark.parametrize("step", 10.0 ** -np.arange(2.0, 8.0))
def test_near_a_singularity(paper: dict[str, Any], step: float) -> None:
    model = stewart(paper, 10.0, 10.0 + np.degrees(step))
    found = kinematic_ellipsoid(model, Weights()).efficiencies
    assert found == pytest.approx(exact_efficiencies(model, np.ones(6), np.ones(6)), rel=NEAR_SINGULAR)
    assert model.ledger.status == "certain"


def test_weights_of_every_size_give_orthonormal_directions(paper: dict[str, Any]) -> None:
    weights = 10.0 ** np.linspace(-16.0, 16.0, 6)
    model = stewart(paper, 1.0, -120.0)
    found = kinematic_ellipsoid(model, Weights(twist=weights, rate=weights[::-1]))
    for directions, weight in ((found.task_directions, weights), (found.motor_directions, weights[::-1])):
        columns = np.array([np.sqrt(weight) * d for d in directions if d is not None])
        assert np.abs(columns @ columns.T - np.eye(6)).max() < 1e-14
