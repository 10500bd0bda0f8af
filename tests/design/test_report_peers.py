"""The numbers of a design report against an evaluation that is written down here, without the library."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.linalg import null_space

import vincula as vc
from vincula.design.asking import Asking
from vincula.design.constraints import Relation
from vincula.design.measures import Index
from vincula.design.neighbourhood import MOVES, neighbourhood
from vincula.design.optimum import APART
from vincula.design.polish import polished

LOW, HIGH = np.array([-1.3, -1.4]), np.array([-0.6, -0.7])
TOLERANCE = np.array([5e-3, 0.0])


def build(x: float = -1.0, y: float = -1.0) -> vc.Mechanism:
    """The paper's five-bar with one ground pin at (x, -2) and the pin of the rocker at (1, y)."""
    return vc.Mechanism.planar(
        joints=[
            vc.Revolute("o1", "ground", "crank", at=(x, -2)),
            vc.Revolute("o2", "crank", "coupler", at=(-1, 0)),
            vc.Revolute("o3", "coupler", "link", at=(0, 0)),
            vc.Revolute("o4", "link", "rocker", at=(1, y)),
            vc.Revolute("o5", "rocker", "ground", at=(1, -2)),
        ],
        reference=vc.Reference("coupler", origin=(-0.5, 0)),
        active=["o1", "o5"],
        weights=vc.Weights(),
    )


def condition(x: float, y: float) -> float:
    """Longest over shortest semi-axis of the velocities of (-0.5, 0), by the null space of the loop."""
    pins = np.array([[x, -2], [-1, 0], [0, 0], [1, y], [1, -2]])
    loop = np.vstack([pins[:, 1], -pins[:, 0], np.ones(5)])
    motions = null_space(loop)
    member = np.zeros((2, 5))
    for k in range(2):
        member[:, k] = -(0.0 - pins[k, 1]), -0.5 - pins[k, 0]
    values = np.linalg.svd(member @ motions @ np.linalg.inv(motions[[0, 4]]), compute_uv=False)
    return float(values[0] / values[1])


@pytest.fixture(scope="module")
def found() -> Any:
    """A search that ends in a corner, made short."""
    problem = vc.DesignProblem(
        build,
        [
            vc.DesignVariable("x", LOW[0], HIGH[0], tolerance=TOLERANCE[0]),
            vc.DesignVariable("y", LOW[1], HIGH[1]),
        ],
        Index(quantity="kinematic.condition:translation"),
        path="reference",
    )
    return problem.optimize(seed=3, population=8, generations=3, samples=40)


def test_every_design_has_its_own_value(found: Any) -> None:
    designs, values = found.everything.designs, found.everything.objectives[:, 0]
    assert len(values) == found.evaluated > 30
    np.testing.assert_allclose(values, [condition(*design) for design in designs], rtol=1e-8)


def test_the_best_is_the_best_of_a_grid_too(found: Any) -> None:
    """No point of a fine grid over all allowed designs is better."""
    grid = [
        condition(x, y) for x in np.linspace(LOW[0], HIGH[0], 71) for y in np.linspace(LOW[1], HIGH[1], 71)
    ]
    assert found.value <= min(grid) * (1 + 1e-6)
    assert found.value == pytest.approx(condition(*found.design), rel=1e-9)
    assert found.start_value == pytest.approx(condition(-1.0, -1.0), rel=1e-9)


def test_bounds_that_bind_are_told(found: Any) -> None:
    """On a bound means: nearer than 1e-6 of the range, and it is so where the objective falls outwards."""
    span = HIGH - LOW
    for k, name in enumerate(("x", "y")):
        near = {
            "low": (found.design - LOW)[k] <= 1e-6 * span[k],
            "high": (HIGH - found.design)[k] <= 1e-6 * span[k],
        }
        assert found.bounds.get(name) == next((end for end, is_near in near.items() if is_near), None)
        if name in found.bounds:
            step = 1e-4 * span[k] * (1 if found.bounds[name] == "high" else -1)
            outside = np.where(np.arange(2) == k, found.design + step, found.design)
            assert condition(*outside) < found.value
    assert found.bounds


def test_flatness_is_what_moving_a_variable_does(found: Any) -> None:
    for k in range(2):
        for move, value in zip(MOVES, found.around.moved[k], strict=True):
            moved = found.design + move * (HIGH - LOW) * (np.arange(2) == k)
            if ((moved < LOW) | (moved > HIGH)).any():
                assert np.isnan(value)
            else:
                assert value == pytest.approx(condition(*moved), rel=1e-8)
    facts = found.to_dict()["sensitivity"]
    assert facts["moves"] == list(MOVES)
    assert set(facts["values"]) == {"x", "y"}


def test_manufacturing_errors_are_uniform_and_judged(found: Any) -> None:
    asking = Asking(found.problem, "again")
    around = neighbourhood(asking, found.design, 3, 40)
    assert np.array_equal(around.sampled, found.around.sampled)
    sampled = asking.everything.designs[-40:]
    errors = sampled - found.design
    assert (np.abs(errors) <= TOLERANCE + 1e-15).all()
    assert np.abs(errors[:, 0]).max() > 0.8 * TOLERANCE[0]
    values = np.array([condition(*design) for design in sampled])
    report = found.to_dict()["tolerance"]
    assert report["samples"] == 40
    assert report["feasible_share"] == 1.0
    assert report["mean"] == pytest.approx(values.mean(), rel=1e-8)
    assert report["worst"] == pytest.approx(values.max(), rel=1e-8)


def test_runners_up_lie_apart_and_are_the_best_that_do(found: Any) -> None:
    kept = found.runners_up.designs
    values = np.array([condition(*design) for design in kept])
    assert np.array_equal(kept[0], found.design)
    assert (np.diff(values) >= -1e-12).all()
    span = HIGH - LOW
    for k, design in enumerate(kept):
        assert all(np.abs((design - other) / span).max() > APART for other in kept[:k])
    # Whatever is better than the last one lies beside one that is kept, and that one is not worse.
    everything = found.everything.designs
    for design, value in zip(everything, found.everything.objectives[:, 0], strict=True):
        if value < values[-1]:
            beside = [v for other, v in zip(kept, values, strict=True)
                      if np.abs((design - other) / span).max() <= APART]  # fmt: skip
            assert min(beside) <= value * (1 + 1e-9)


@pytest.mark.slow
def test_an_optimum_on_the_edge_of_a_constraint_is_followed_along_it() -> None:
    """The slope points across the edge y - x = 0.5; the best design on it is that of a grid along it."""
    problem = vc.DesignProblem(
        build,
        [vc.DesignVariable("x", LOW[0], HIGH[0]), vc.DesignVariable("y", LOW[1], HIGH[1])],
        Index(quantity="kinematic.condition:translation"),
        constraints=[Relation(value=lambda v: v["y"] - v["x"], most=0.1)],
        path="reference",
    )
    best, how = polished(Asking(problem, "edge"), np.array([-1.0, -0.95]))
    along = [condition(x, x + 0.1) for x in np.linspace(-1.3, -0.8, 2001)]
    assert how == "simplex"
    assert condition(*best) == pytest.approx(min(along), rel=1e-4)
