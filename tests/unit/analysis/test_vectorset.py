"""Ellipsoids as sets: along, support, projection and section are different things."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from tests.laws.planted import from_counts
from tests.paper.matrices import five_bar, stewart

from vincula.analysis.manipulability import (
    active_force_ellipsoid,
    dual_force_ellipsoid,
    kinematic_ellipsoid,
    passive_force_ellipsoid,
)
from vincula.analysis.vectorset import VectorSet
from vincula.errors import ModelError, ShapeError, UnknownNameError
from vincula.weights import Weights

NAMES, UNITS = ("x", "y", "z"), ("m", "m", "m")


def tilted(lengths: list[float], lines: int, rng: np.random.Generator) -> VectorSet:
    turn = np.linalg.qr(rng.standard_normal((3, 3)))[0]
    count = len(lengths)
    return VectorSet(NAMES, UNITS, turn[:, :count] * lengths, turn[:, count : count + lines])


def test_along_and_support_of_an_ellipsoid_against_its_matrix(rng: np.random.Generator) -> None:
    solid = tilted([3.0, 1.0, 0.2], 0, rng)
    matrix = solid.axes @ solid.axes.T
    for d in rng.standard_normal((20, 3)):
        assert solid.along(d) == pytest.approx(1.0 / np.sqrt(d @ np.linalg.solve(matrix, d)), rel=1e-12)
        assert solid.support(d) == pytest.approx(np.sqrt(d @ matrix @ d), rel=1e-12)
        assert solid.along(d) * np.linalg.norm(d) <= solid.support(d / np.linalg.norm(d)) * (1 + 1e-12)
        # Homogeneous: t d in the set, d . x over the set.
        assert solid.along(2.0 * d) == pytest.approx(solid.along(d) / 2.0)
        assert solid.support(2.0 * d) == pytest.approx(solid.support(d) * 2.0)


def test_flat_and_unbounded_sets(rng: np.random.Generator) -> None:
    set_ = tilted([2.0], 1, rng)
    axis, line = set_.axes[:, 0] / 2.0, set_.lines[:, 0]
    normal = np.cross(axis, line)
    assert set_.along(axis) == pytest.approx(2.0)
    assert set_.along(line) == float("inf")
    assert set_.along(normal) == 0.0
    assert set_.along(axis + line) == pytest.approx(2.0)
    assert set_.support(axis) == pytest.approx(2.0)
    assert set_.support(line) == float("inf")
    assert set_.support(normal) == pytest.approx(0.0, abs=1e-15)
    assert not set_.bounded


def test_projection_is_the_shadow_and_section_the_cut(rng: np.random.Generator) -> None:
    solid = tilted([3.0, 1.0, 0.2], 0, rng)
    shadow, cut = solid.project(["x", "z"]), solid.section(["x", "z"])
    assert shadow.components == cut.components == ("x", "z")
    for d in rng.standard_normal((20, 2)):
        full = np.array([d[0], 0.0, d[1]])
        assert shadow.support(d) == pytest.approx(solid.support(full), rel=1e-12)
        assert cut.along(d) == pytest.approx(solid.along(full), rel=1e-12)
        assert cut.along(d) <= shadow.along(d) * (1.0 + 1e-12)
    assert shadow.project([0, 1]).support([1.0, 0.0]) == pytest.approx(shadow.support([1.0, 0.0]))


def test_lines_project_and_cut(rng: np.random.Generator) -> None:
    cylinder = VectorSet(NAMES, UNITS, np.array([[2.0, 0], [0, 1.0], [0, 0]]), np.array([[0.0], [0], [1.0]]))
    assert cylinder.project(["x", "y"]).bounded
    assert np.abs(cylinder.section(["x", "z"]).lines) == pytest.approx(np.array([[0.0], [1.0]]))
    assert cylinder.section(["x", "z"]).along([1.0, 0.0]) == pytest.approx(2.0)
    slanted = VectorSet(NAMES, UNITS, np.array([[2.0], [0.0], [0.0]]), np.array([[0.6], [0.0], [0.8]]))
    assert slanted.project(["x", "y"]).lines.shape[1] == 1
    assert slanted.section(["x", "y"]).bounded
    assert slanted.section(["x", "y"]).along([1.0, 0.0]) == pytest.approx(2.0)


def test_sections_and_shadows_of_random_sets_against_points(rng: np.random.Generator) -> None:
    """Points of the boundary lie in the shadow; points of the cut lie in the set."""
    solid = tilted([1.0, 0.5, 0.3], 0, rng)
    shadow = solid.project(["y", "z"])
    for point in solid.points(40).T[:, 1:]:
        assert shadow.along(point) >= 1.0 - 1e-9
    for point in solid.section(["y", "z"]).points(40).T:
        assert solid.along(np.array([0.0, *point])) == pytest.approx(1.0, rel=1e-9)


def test_bad_directions() -> None:
    set_ = VectorSet(NAMES, UNITS, np.eye(3), np.empty((3, 0)))
    with pytest.raises(ShapeError, match="direction"):
        set_.along([1.0, 0.0])
    with pytest.raises(ModelError, match="zero vector"):
        set_.support([0.0, 0.0, 0.0])
    with pytest.raises(UnknownNameError, match="x, y, z"):
        set_.project(["w"])


def test_the_passive_set_is_a_cylinder_and_the_active_set_its_cut(paper: dict[str, Any]) -> None:
    model = five_bar(paper, [1, 5])
    weights = Weights()
    passive = passive_force_ellipsoid(model, weights)
    active = active_force_ellipsoid(model, weights)
    free = passive.task_directions[0]
    assert free is not None
    assert passive.along(free) == float("inf")
    assert active.along(free) == 0.0
    assert active.along([0.0, -0.89, 0.45]) == 0.0  # the printed digits are not the direction itself
    best = passive.task_directions[1]
    assert best is not None
    for forces in (passive, active, dual_force_ellipsoid(model, weights)):
        assert forces.along(best) == pytest.approx(np.sqrt(1.9473), abs=1e-4)
    assert passive.along(best + 5.0 * free) == pytest.approx(np.sqrt(1.9473), abs=1e-4)


def test_support_and_radius_of_the_stewart_platform_against_its_matrix(paper: dict[str, Any]) -> None:
    model = stewart(paper, 45.0, -45.0)
    weights = Weights(twist=[1.0, 1, 1, 5, 5, 5])
    found = kinematic_ellipsoid(model, weights)
    motions = model.ledger.subspaces.motions_and_equilibria[0]
    rate_of = (motions[:6] / 1.0) @ np.linalg.inv(motions[6:] * model.scaled.twist[:, None])
    rate_of = model.scaled.active_column[:, None] * rate_of
    for d in np.eye(6):
        assert found.along(d) == pytest.approx(1.0 / np.linalg.norm(rate_of @ d), rel=1e-11)
        assert found.support(d) == pytest.approx(np.linalg.norm(np.linalg.inv(rate_of).T @ d), rel=1e-11)


def test_semi_axes_and_readings() -> None:
    found = kinematic_ellipsoid(
        from_counts({**_ZERO, "ao": 3, "a": 1}, np.random.default_rng(2)).model, Weights()
    )
    assert found.semi_axes**2 == pytest.approx(found.efficiencies)
    accuracy = found.with_viewpoint("accuracy")
    assert (found.best, found.worst) == (0, 2)
    assert (accuracy.best, accuracy.worst) == (2, 0)
    assert accuracy.efficiencies is found.efficiencies
    with pytest.raises(ModelError, match="viewpoint is 'both'"):
        kinematic_ellipsoid(from_counts(_ZERO | {"ao": 1}, np.random.default_rng(2)).model, viewpoint="both")  # type: ignore[arg-type]


def test_ignored_components_are_no_direction(paper: dict[str, Any]) -> None:
    found = kinematic_ellipsoid(five_bar(paper, [1, 5]), Weights(twist=[1.0, 1.0, 0.0]))
    assert found.classes == ("finite", "finite")
    assert found.along([1.0, 0.0, 7.0]) == pytest.approx(found.along([1.0, 0.0, 0.0]))
    full = kinematic_ellipsoid(five_bar(paper, [1, 5]), Weights())
    assert found.set.project(["vx", "vy"]).support([1.0, 0.0]) == pytest.approx(full.support([1.0, 0.0, 0.0]))
    with pytest.raises(ModelError, match="the weights ignore this direction"):
        found.along([0.0, 0.0, 1.0])


_ZERO = dict.fromkeys(("ar", "pr", "oi", "t", "ap", "ao", "po", "g", "a", "p", "o", "none"), 0)
