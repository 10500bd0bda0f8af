"""Closing random mechanisms: exact derivatives, the same freedoms as the linear model, nothing silent."""

from __future__ import annotations

import numpy as np
import pytest
from tests.laws.random_closed import displaced, holdable_motors, random_closed
from tests.laws.random_mechanisms import random_mechanism

from vincula.errors import ClosureError
from vincula.mechanism.closure_problem import ClosureProblem
from vincula.mechanism.holding import Holding, problem_for
from vincula.mechanism.watching import locked
from vincula.numerics.rank import decide_rank

NOTHING = Holding({}, {}, {})
CLOSED = 1e-12


@pytest.mark.parametrize("seed", range(60))
def test_jacobian_is_the_derivative_of_the_gaps_far_from_closure(seed: int) -> None:
    """All joint and contact types, couplings, drives, own and dependent loop joints, central differences."""
    rng = np.random.default_rng(seed)
    mechanism = random_mechanism(seed) if seed % 2 else random_closed(rng, planar=False, loops=2)
    kept = [joint.name for joint in mechanism.joints if rng.random() < 0.5]
    drives = [drive.name for drive in mechanism.drives]
    problem = ClosureProblem(mechanism, kept, drives, member=True)
    where = problem.variables
    state = where.moved(problem.start(mechanism.home), 0.5 * rng.uniform(-1, 1, problem.columns))
    h = 1e-6
    for column, unit in enumerate(np.eye(problem.columns)):
        ahead = problem.gaps(where.moved(state, h * unit))
        behind = problem.gaps(where.moved(state, -h * unit))
        np.testing.assert_allclose(
            problem.equations(state).jacobian[:, column], (ahead - behind) / (2 * h), atol=2e-8
        )


@pytest.mark.parametrize("seed", range(60))
def test_freedoms_are_those_of_the_linear_model(seed: int) -> None:
    """The closure equations and [J_a J_p -G^T] are written apart and have kernels of one dimension."""
    mechanism = random_mechanism(seed)
    problem = problem_for(mechanism, NOTHING, mechanism.active, member=True)
    jacobian = problem.equations(problem.start(mechanism.home)).jacobian[:, ~locked(problem)]
    scaled = mechanism.linearize().scaled
    model = np.hstack([scaled.active, scaled.passive, -scaled.member])
    assert jacobian.shape[1] - decide_rank(jacobian).rank == model.shape[1] - decide_rank(model).rank


def test_steps_are_inverted_by_step_between(rng: np.random.Generator) -> None:
    for seed in range(10):
        problem = ClosureProblem(random_closed(rng, planar=seed % 2 == 0, loops=2), member=True)
        state = problem.start(problem.mechanism.home)
        step = rng.uniform(-1, 1, problem.columns)
        there = problem.variables.moved(state, step)
        np.testing.assert_allclose(problem.variables.step_between(state, there), step, atol=1e-14)


def test_random_mechanisms_close_from_half_a_radian_away() -> None:
    """The benchmark's ten thousand in small: planar and spatial, one to four loops, free and with motors."""
    refused: list[ClosureError] = []
    for number in range(160):
        rng = np.random.default_rng(number)
        mechanism = random_closed(rng, planar=number % 2 == 0, loops=1 + (number // 2) % 4)
        motors = holdable_motors(rng, mechanism) if (number // 8) % 2 else {}
        try:
            q = mechanism.close(displaced(rng, mechanism, 0.5), motors=motors)
        except ClosureError as error:
            refused.append(error)
            continue
        worst = max(r.gap for r in mechanism.residuals(dict(q)))
        assert worst < CLOSED * mechanism.length
        assert q.residual == worst
        assert all(q[name][0] == value for name, value in motors.items())
    assert len(refused) <= 0.01 * 160
    assert all(error.gap > CLOSED for error in refused)


@pytest.mark.parametrize("seed", range(0, 200, 5))
def test_mechanisms_of_every_shape_close_and_can_be_analysed(seed: int) -> None:
    """Contacts, couplings, drives, locked axes, second objects, floating members."""
    mechanism = random_mechanism(seed)
    rng = np.random.default_rng(seed)
    problem = problem_for(mechanism, NOTHING)
    still = locked(problem)
    step = np.where(still, 0.0, 0.3 * rng.uniform(-1, 1, problem.columns))
    state = problem.variables.moved(problem.start(mechanism.home), step)
    start = problem.configuration(state, mechanism.home)
    q = mechanism.close(start)
    model = mechanism.linearize(q)
    assert model.uncertainty.residual < CLOSED * mechanism.length
    moved = q.moved
    assert all(moved[axis] == 0.0 for axis in mechanism.lock if axis in moved)


@pytest.mark.parametrize("number", range(0, 64, 3))
def test_what_is_free_stays_nearest_to_the_start(number: int) -> None:
    """The way back to the start is at right angles to every free motion (a necessary condition)."""
    rng = np.random.default_rng(number)
    mechanism = random_closed(rng, planar=number % 2 == 0, loops=1 + (number // 2) % 3)
    start = mechanism.configuration(displaced(rng, mechanism, 0.2))
    q = mechanism.close(start)
    problem = ClosureProblem(mechanism)
    state, goal = problem.start(q), problem.start(start)
    jacobian = problem.equations(state).jacobian
    kernel = np.linalg.svd(jacobian)[2][decide_rank(jacobian).rank :]
    back = problem.variables.step_between(state, goal)
    assert np.abs(kernel @ back).max(initial=0.0) < 1e-5
