"""The nearest singular configuration, where it is known."""

from __future__ import annotations

from math import cos, hypot, pi, sin, sqrt

import numpy as np
import pytest

import vincula as vc
from vincula.mechanism.catalog.registry import example
from vincula.mechanism.holding import Holding, problem_for
from vincula.mechanism.nearest import FARTHEST, _deflation, nearest_singular


def parallelogram(angle: float) -> vc.Mechanism:
    """Change point at angle 0; all four joints turn by the angle on the way there."""
    x, y = cos(angle), sin(angle)
    return vc.Mechanism.planar(
        joints=[
            vc.Revolute("o1", "ground", "crank", at=(0, 0)),
            vc.Revolute("o2", "crank", "coupler", at=(x, y)),
            vc.Revolute("o3", "coupler", "rocker", at=(x + 2, y)),
            vc.Revolute("o4", "rocker", "ground", at=(2, 0)),
        ],
        reference=vc.Reference("coupler"),
        active=["o1"],
    )


def slider_crank(angle: float) -> vc.Mechanism:
    """Dead centre at angle 0: crank 1, rod 2 in one line; the slider is the motor."""
    x, y = cos(angle), sin(angle)
    end = x + sqrt(4 - y * y)
    return vc.Mechanism.planar(
        joints=[
            vc.Revolute("o1", "ground", "crank", at=(0, 0)),
            vc.Revolute("o2", "crank", "rod", at=(x, y)),
            vc.Revolute("o3", "rod", "block", at=(end, 0)),
            vc.Prismatic("slide", "ground", "block", axis=(1, 0)),
        ],
        reference=vc.Reference("crank", origin=(0.5, 0.5)),
        active=["slide"],
    )


@pytest.mark.parametrize("angle", [1e-6, 1e-3, 0.03])
def test_change_point(angle: float) -> None:
    mechanism = parallelogram(angle)
    found = nearest_singular(mechanism, mechanism.home, ("all",))
    assert found is not None
    # Two branches cross here: loops tell positions apart only to the root of rounding.
    assert found.distance == pytest.approx(2 * angle, rel=1e-3, abs=1e-11)
    assert found.residual < 1e-10
    assert found.kantorovich < 1e-6
    assert found.configuration["o1"][0] == pytest.approx(-angle, rel=1e-3, abs=1e-11)
    # There it is singular, by the ledger's own rule.
    there = mechanism.linearize(found.configuration).ledger
    assert there.summary.mobility == 2
    assert set(found.joints) <= {"o1", "o2", "o3", "o4"}


@pytest.mark.parametrize("angle", [1e-7, 1e-4, 0.02])
def test_dead_centre_of_a_slider_crank(angle: float) -> None:
    mechanism = slider_crank(angle)
    found = nearest_singular(mechanism, mechanism.home, ("passive+member",))
    assert found is not None
    # Crank by angle, rod by asin(sin(angle) / 2) against the ground: three turning joints.
    rod = sin(angle) / 2
    assert found.configuration["o1"][0] == pytest.approx(-angle, rel=1e-3, abs=1e-12)
    assert found.distance >= hypot(angle, angle + rod, rod) * (1 - 1e-3)
    assert mechanism.linearize(found.configuration).ledger.summary.indeterminacy == 1


def test_far_from_any_singularity_there_is_none() -> None:
    mechanism = parallelogram(pi / 3)
    assert nearest_singular(mechanism, mechanism.home, ("all",)) is None
    assert pi / 3 > FARTHEST


def test_an_analysis_in_doubt_tells_it() -> None:
    with pytest.warns(vc.RankAmbiguityWarning):
        found = vc.analyze(parallelogram(1e-13).linearize(), vc.Weights())
    assert found.ledger.status == "doubtful"
    assert found.nearest_singular is not None
    told = found.to_dict()["rank"]["nearest_singular"]
    assert told["distance"] == pytest.approx(2e-13, rel=0.1)
    assert told["kantorovich"] < 0.5
    assert "Nearest singular configuration" in str(found)


def test_a_certain_analysis_does_not_look_for_it() -> None:
    found = vc.analyze(parallelogram(0.5).linearize(), vc.Weights())
    assert found.nearest_singular is None
    assert found.to_dict()["rank"]["nearest_singular"] is None


@pytest.mark.parametrize("name", ["stewart", "delta"])
def test_derivatives_along_one_direction_are_those_of_every_column(name: str) -> None:
    """With balls, whose rates are no coordinates; closed and beside a closed configuration."""
    mechanism = example(name)
    problem = problem_for(mechanism, Holding({}, {}, {}), tuple(mechanism.active), member=True)
    start = problem.start(mechanism.home)
    found = _deflation(problem, start, tuple(mechanism.active), False, False)
    assert found is not None
    assert problem.variables.balls
    chance = np.random.default_rng(5)
    for away in (0.0, 1e-2):
        state = problem.variables.moved(start, away * chance.standard_normal(problem.columns) * found.free)
        v = chance.standard_normal(int(found.block.sum()))
        turned = found._turned(state, v, problem.equations(state).jacobian)
        for column in np.flatnonzero(found.free):
            step = np.zeros(problem.columns)
            step[column] = 1e-5
            ahead, behind = (
                problem.equations(problem.variables.moved(state, sign * step)).jacobian
                for sign in (1.0, -1.0)
            )
            expected = (ahead - behind)[:, found.block] @ v / 2e-5
            assert turned[:, column] == pytest.approx(expected, abs=1e-8)
