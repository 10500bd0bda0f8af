"""Outlines of ellipsoids satisfy their equations, found here from plain null spaces and pseudoinverses."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from scipy.linalg import null_space

import vincula as vc
from vincula.analysis.ellipsoid import Ellipsoid
from vincula.analysis.manipulability import (
    active_force_ellipsoid,
    dual_force_ellipsoid,
    internal_force_ellipsoid,
    kinematic_ellipsoid,
    passive_force_ellipsoid,
)
from vincula.mechanism.catalog.registry import example
from vincula.spatial.space import PLANAR, SPATIAL
from vincula.view.drawables import ReferenceMark
from vincula.view.scene import scene
from vincula.view.shapes import EllipsoidShape, nice_scale, shape, silhouette, translations

SCALE = 0.3


def drawn(ellipsoid: Ellipsoid, mechanism: vc.Mechanism, reach: float = 5.0) -> EllipsoidShape:
    reference = scene(mechanism).reference
    assert reference is not None
    return shape(ellipsoid, mechanism.space, reference, SCALE, reach)


def twist_map(model: vc.LinearModel) -> np.ndarray:
    """u = T q_a of a mechanism whose motors determine its motion, from the kernel of eq. (1)."""
    n_a, n_p = len(model.motors), len(model.passives)
    kernel = null_space(np.hstack([model.jacobian_active, model.jacobian_passive, -model.grasp.T]))
    return kernel[n_a + n_p :] @ np.linalg.pinv(kernel[:n_a])


def local(points: np.ndarray, mechanism: vc.Mechanism) -> np.ndarray:
    """Drawn points as velocities or forces, one a column."""
    reference = scene(mechanism).reference
    assert reference is not None
    return (points - reference.at).T / SCALE


def five_bar(motors: str) -> vc.Mechanism:
    return example("five-bar").with_active(motors)


@pytest.mark.parametrize("motors", ["o1,o5", "o2,o4"])
def test_the_kinematic_outline_is_the_image_of_the_unit_circle_of_rates(motors: str) -> None:
    mechanism = five_bar(motors)
    model = mechanism.linearize()
    t = twist_map(model)[:2]
    (curve,) = drawn(kinematic_ellipsoid(model), mechanism).curves
    v = local(curve.points, mechanism)
    np.testing.assert_allclose(np.sum(v * np.linalg.solve(t @ t.T, v), axis=0), 1.0, rtol=1e-11)


@pytest.mark.parametrize("motors", ["o1,o5", "o2,o4"])
def test_the_passive_outline_holds_the_forces_without_moment_that_unit_torques_balance(motors: str) -> None:
    mechanism = five_bar(motors)
    model = mechanism.linearize()
    t = twist_map(model)[:2]
    (curve,) = drawn(passive_force_ellipsoid(model), mechanism).curves
    f = local(curve.points, mechanism)
    np.testing.assert_allclose(np.linalg.norm(t.T @ f, axis=0), 1.0, rtol=1e-11)


@pytest.mark.parametrize("motors", ["o1,o5", "o2,o4"])
@pytest.mark.parametrize("ellipsoid", [active_force_ellipsoid, dual_force_ellipsoid])
def test_active_and_dual_outlines_are_shadows_of_the_wrenches_off_the_structural_one(
    motors: str, ellipsoid: Callable[[vc.LinearModel], Ellipsoid]
) -> None:
    mechanism = five_bar(motors)
    model = mechanism.linearize()
    b = np.linalg.pinv(twist_map(model).T)[:2]
    (curve,) = drawn(ellipsoid(model), mechanism).curves
    f = local(curve.points, mechanism)
    np.testing.assert_allclose(np.sum(f * np.linalg.solve(b @ b.T, f), axis=0), 1.0, rtol=1e-11)


def test_the_unbounded_line_of_the_passive_set_is_the_structural_wrench_as_seen() -> None:
    mechanism = five_bar("o1,o5")
    model = mechanism.linearize()
    found = drawn(passive_force_ellipsoid(model), mechanism)
    structural = null_space(twist_map(model).T)[:, 0]
    assert found.infinite_direction is not None
    assert abs(found.infinite_direction @ structural) == pytest.approx(1.0, abs=1e-12)
    (line,) = found.unbounded
    seen = local(line.points, mechanism)
    assert np.linalg.matrix_rank(np.column_stack([seen, structural[:2]]), tol=1e-9) == 1
    np.testing.assert_allclose(seen.sum(axis=1), 0.0, atol=1e-12)


def test_an_ellipsoid_in_body_axes_is_drawn_where_it_is_in_ground_axes() -> None:
    joints = [
        vc.Revolute("a", "ground", "arm", at=(0, 0)),
        vc.Revolute("b", "arm", "hand", at=(1, 0)),
    ]
    arm = vc.Mechanism.planar(
        joints=joints, reference=vc.Reference("hand", origin=(1, 1)), active=["a", "b"], weights=vc.Weights()
    )
    q = {"a": 0.4, "b": 0.7}
    in_body = arm.with_reference("hand", arm.reference.origin, axes="body")
    outlines = []
    for mechanism in (arm, in_body):
        reference = scene(mechanism, q).reference
        assert reference is not None
        model = mechanism.linearize(q)
        outlines.append(shape(kinematic_ellipsoid(model), PLANAR, reference, SCALE, 1.0))
    axes = [one.axes @ one.axes.T for one in outlines]
    np.testing.assert_allclose(axes[0], axes[1], rtol=1e-10)


def test_a_cut_with_a_line_of_its_own_is_a_strip_between_parallels() -> None:
    mechanism = example("slider-crank")
    found = drawn(passive_force_ellipsoid(mechanism.linearize()), mechanism)
    edges = [curve.points for curve in found.curves]
    assert len(edges) == 2
    assert all(curve.open_ended for curve in found.curves)
    directions = [edge[1] - edge[0] for edge in edges]
    assert abs(directions[0] @ directions[1]) == pytest.approx(
        np.linalg.norm(directions[0]) * np.linalg.norm(directions[1]), rel=1e-12
    )
    (line,) = found.unbounded
    assert np.linalg.norm(line.points[1] - line.points[0]) == pytest.approx(10.0)


def test_a_flat_set_is_a_segment_and_an_empty_one_nothing() -> None:
    crank = example("slider-crank")
    (segment,) = drawn(kinematic_ellipsoid(crank.linearize()), crank).curves
    assert segment.points.shape == (2, 2)
    assert not segment.open_ended
    telescope = example("telescope")
    nothing = drawn(dual_force_ellipsoid(telescope.linearize()), telescope)
    assert nothing.curves == nothing.patches == nothing.unbounded == ()


def test_two_lines_leave_no_line_of_their_own() -> None:
    mechanism = example("four-bar-2a")
    found = drawn(passive_force_ellipsoid(mechanism.linearize()), mechanism)
    assert found.infinite_direction is None
    assert len(found.unbounded) == 1
    np.testing.assert_allclose(
        found.unbounded[0].points[1] - found.unbounded[0].points[0],
        10.0 * found.drawn.lines[:, 0],
        atol=1e-12,
    )


def test_everything_unbounded_at_the_singular_stewart_platform() -> None:
    mechanism = example("stewart", alpha="10deg", beta="10deg")
    model = mechanism.linearize()
    kinematic = drawn(kinematic_ellipsoid(model), mechanism)
    assert kinematic.drawn.lines.shape[1] == 3
    assert kinematic.drawn.axes.shape[1] == 0
    assert kinematic.patches == kinematic.curves == kinematic.unbounded == ()
    np.testing.assert_allclose(kinematic.points, scene(mechanism).reference.at[None, :])


def test_spatial_outlines_lie_on_the_ellipsoid() -> None:
    mechanism = example("stewart")
    model = mechanism.linearize()
    found = drawn(kinematic_ellipsoid(model), mechanism)
    t = twist_map(model)[:3]
    assert len(found.curves) == 3
    for curve in found.curves:
        v = local(curve.points, mechanism)
        np.testing.assert_allclose(np.sum(v * np.linalg.solve(t @ t.T, v), axis=0), 1.0, rtol=1e-10)


def test_the_silhouette_is_the_edge_of_what_the_eye_sees(rng: np.random.Generator) -> None:
    axes = rng.normal(size=(3, 3))
    right, up, _ = np.linalg.qr(rng.normal(size=(3, 3)))[0].T
    outline = silhouette(axes, right, up)
    seen = np.column_stack([outline @ right, outline @ up])
    for angle in np.linspace(0, 2 * np.pi, 13):
        towards = np.array([np.cos(angle), np.sin(angle)])
        support = np.linalg.norm(axes.T @ (towards[0] * right + towards[1] * up))
        assert (seen @ towards).max() == pytest.approx(support, rel=2e-3)
        assert (seen @ towards).max() <= support * (1 + 1e-12)


@pytest.mark.parametrize(
    ("radius", "longest", "expected"),
    [(1.0, 0.999, 0.8), (3.0, 1.0, 0.3), (250.0, 0.5, 0.002), (0.02, 1.0, 50.0)],
)
def test_scales_are_round_and_as_large_as_fits(radius: float, longest: float, expected: float) -> None:
    mark = ReferenceMark("hand", np.zeros(2), np.eye(2))
    arm = vc.Mechanism.planar(
        joints=[
            vc.Revolute("a", "ground", "arm", at=(0, 0)),
            vc.Prismatic("b", "arm", "hand", axis=(1, 0), at=(0, 0)),
        ],
        reference=vc.Reference("hand", origin=(radius, 0)),
        active=["a"],
        weights=vc.Weights(),
    )
    locked = arm.with_lock(["b"])
    ellipsoid = kinematic_ellipsoid(locked.linearize())
    assert nice_scale([translations(ellipsoid, PLANAR)], longest) == pytest.approx(expected)
    assert abs(shape(ellipsoid, PLANAR, mark, expected, 1.0).axes[1, 0]) == pytest.approx(expected * radius)


def test_contact_forces_cannot_be_drawn_at_the_member() -> None:
    model = five_bar("all").linearize()
    with pytest.raises(vc.ModelError, match="space of contact forces"):
        translations(internal_force_ellipsoid(model), PLANAR)


def test_every_example_has_a_picture_of_every_ellipsoid() -> None:
    from vincula.mechanism.catalog.registry import MODULES

    for name in MODULES:
        mechanism = example(name)
        model = mechanism.linearize()
        for function in (kinematic_ellipsoid, active_force_ellipsoid, passive_force_ellipsoid):
            found = drawn(function(model), mechanism)
            assert np.isfinite(found.points).all()
            assert found.points.shape[1] == (2 if mechanism.space is not SPATIAL else 3)
