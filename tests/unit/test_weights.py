"""Weights: numbers, lists, names, matrices, reciprocals; and everything that cannot be a weight."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import pytest

from vincula.analysis.manipulability import kinematic_ellipsoid, passive_force_ellipsoid
from vincula.errors import MixedUnitsWarning, UnknownNameError, WeightError
from vincula.model import LinearModel
from vincula.spatial.space import PLANAR, SPATIAL
from vincula.weights import UNIT, Weights, characteristic_length_weights


def model() -> LinearModel:
    """A planar arm of one slider and two revolutes that holds its member completely."""
    jacobian = [[1.0, -1.0, 0.0], [0.0, 2.0, 1.0], [0.0, 1.0, 1.0]]
    return LinearModel.from_matrices(
        jacobian, np.eye(3), active=[0, 1, 2], columns=["slide", "arm.1", "arm.2"],
        linear_columns=[True, False, False], linear_rows=[True, True, False], length=1.0,
    )  # fmt: skip


SAME = [
    Weights(twist=[1.0, 4.0, 1.0]),
    Weights(twist={"vy": 4.0}),
    Weights(twist=np.diag([1.0, 4.0, 1.0])),
    Weights.from_mapping({"twist": {"vy": 4}}),
]


@pytest.mark.parametrize("weights", SAME)
def test_one_weight_in_many_forms(weights: Weights) -> None:
    assert weights.metric("twist", model()).matrix == pytest.approx(np.diag([1.0, 4.0, 1.0]))


def test_numbers_scale_the_identity_and_what_is_not_given_is_the_identity() -> None:
    weights = Weights(rate=9.0)
    assert weights.metric("rate", model()).matrix == pytest.approx(9.0 * np.eye(3))
    assert weights.metric("torque", model()).unit


def test_reciprocal_weights() -> None:
    weights = Weights(
        rate={"slide": 4.0}, twist=np.array([[2.0, 1, 0], [1, 2, 0], [0, 0, 5]]), reciprocal=True
    )
    for given, derived in (("rate", "torque"), ("twist", "wrench")):
        product = weights.metric(given, model()).matrix @ weights.metric(derived, model()).matrix  # type: ignore[arg-type]
        assert product == pytest.approx(np.eye(3), abs=1e-15)


def test_reciprocal_of_ignored_is_required_zero_and_back() -> None:
    metric = Weights(twist=[1.0, 4.0, 0.0], reciprocal=True).metric("wrench", model())
    assert metric.diagonal == pytest.approx([1.0, 0.25, np.inf])
    assert np.abs(metric.required_zero) == pytest.approx(np.array([[0.0], [0.0], [1.0]]))
    assert metric.reciprocal().matrix == pytest.approx(np.diag([1.0, 4.0, 0.0]))


def test_semidefinite_matrices_have_a_rectangular_factor() -> None:
    v = np.array([1.0, 2.0, -1.0])
    metric = Weights(twist=np.outer(v, v)).metric("twist", model())
    assert metric.factor.shape == (1, 3)
    assert not metric.definite
    assert metric.factor.T @ metric.factor == pytest.approx(np.outer(v, v))
    assert metric.factor @ metric.inverse == pytest.approx(np.eye(1))
    assert metric.without_ignored(np.array([2.0, -1.0, 0.0])) == pytest.approx(np.zeros(3), abs=1e-15)


def test_badly_scaled_but_definite_matrices_stay_definite() -> None:
    scale = np.diag([1e-8, 1.0, 1e8])
    weight = scale @ np.array([[2.0, 1, 0.5], [1, 3, 1], [0.5, 1, 4]]) @ scale
    assert Weights(twist=weight).metric("twist", model()).definite


def test_names_of_joints_and_axes() -> None:
    assert Weights(rate={"arm.2": 2.0}).metric("rate", model()).diagonal == pytest.approx([1, 1, 2])
    with pytest.raises(UnknownNameError, match=r"did you mean 'slide'"):
        Weights(rate={"slde": 2.0}).metric("rate", model())
    with pytest.raises(UnknownNameError, match="fx, fy, mz"):
        Weights(wrench={"vx": 2.0}).metric("wrench", model())


BAD: list[tuple[dict[str, Any], str]] = [
    ({"twist": [1.0, -2.0, 1.0]}, r"twist\[1\] is -2"),
    ({"twist": {"vx": -1.0}}, r"twist\['vx'\] is -1"),
    ({"twist": {"vx": "heavy"}}, r"twist\['vx'\] is heavy"),
    ({"rate": -1.0}, "rate is -1"),
    ({"rate": "limits"}, "rate is 'limits'"),
    ({"twist": [1.0, 2.0]}, r"shape \(2,\), expected 3 numbers or a 3 x 3 matrix"),
    ({"twist": np.ones((2, 3))}, "must be square"),
    ({"twist": np.ones((2, 2, 2))}, "3 dimensions"),
    ({"twist": [[1.0, 2.0, 0], [0, 1, 0], [0, 0, 1]]}, r"not symmetric: \[0, 1\] is 2, \[1, 0\] is 0"),
    ({"twist": [[1.0, 2.0, 0], [2, 1, 0], [0, 0, 1]]}, "not positive"),
    ({"twist": [[1.0, 0, 0], [0, -1, 0], [0, 0, 1]]}, r"twist\[1\] is -1"),
    ({"torque": 1.0, "reciprocal": True}, "reciprocal=True sets torque and wrench"),
]


@pytest.mark.parametrize(("given", "message"), BAD)
def test_bad_weights_say_where_and_what(given: dict[str, Any], message: str) -> None:
    with pytest.raises(WeightError, match=message):
        kinematic_ellipsoid(model(), Weights(**given))


def test_numbers_must_be_finite() -> None:
    with pytest.raises(WeightError, match=r"weight twist\[1\] is nan"):
        Weights(twist=[1.0, np.nan, 1.0])
    with pytest.raises(WeightError, match="finite"):
        Weights(twist={"vx": np.inf})
    with pytest.raises(WeightError, match="numbers"):
        Weights(twist=["one", 2.0, 3.0])
    with pytest.raises(WeightError, match="numbers"):
        Weights(twist=[[1.0, 2.0], [3.0]])


def test_unknown_weights_in_a_mapping() -> None:
    with pytest.raises(UnknownNameError, match="did you mean 'twist'"):
        Weights.from_mapping({"twits": 1.0})


def test_only_weights_that_nobody_chose_warn_of_mixed_units() -> None:
    with pytest.warns(MixedUnitsWarning, match=r"the twist and motors.*characteristic_length_weights\(1"):
        kinematic_ellipsoid(model())
    with pytest.warns(MixedUnitsWarning, match="the wrench and motors"):
        passive_force_ellipsoid(model(), UNIT)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        kinematic_ellipsoid(model(), Weights())
        kinematic_ellipsoid(model().with_weights(Weights(rate=1.0)))


def test_a_characteristic_length_makes_results_independent_of_the_unit() -> None:
    metres = model()
    unit = np.array([1000.0, 1000.0, 1.0])
    millimetres = LinearModel.from_matrices(
        unit[:, None] * metres.jacobian_active / np.array([1000.0, 1.0, 1.0]),
        np.eye(3),
        active=[0, 1, 2],
        linear_columns=[True, False, False],
        linear_rows=[True, True, False],
    )
    # Twists of the second are in mm/s: rows in mm/s, member side the identity.
    first = kinematic_ellipsoid(metres, characteristic_length_weights(0.5, metres))
    second = kinematic_ellipsoid(millimetres, characteristic_length_weights(500.0, millimetres))
    rates = Weights(rate=[1.0, 1.0, 1.0], twist=[1.0, 1.0, 1.0])
    assert kinematic_ellipsoid(metres, rates).finite != pytest.approx(
        kinematic_ellipsoid(millimetres, rates).finite, rel=0.1
    )
    assert first.finite == pytest.approx(second.finite, rel=1e-12)


@pytest.mark.parametrize("space", [PLANAR, SPATIAL])
def test_characteristic_length_by_space(space: Any) -> None:
    weights = characteristic_length_weights(2.0, space)
    assert weights.twist == pytest.approx([1.0] * space.translations + [4.0] * space.rotations)
    assert weights.reciprocal
    with pytest.raises(WeightError, match="positive length"):
        characteristic_length_weights(0.0, space)


def test_contact_forces_weigh_contacts_and_member_cuts_only() -> None:
    from vincula.mechanism.catalog.registry import example

    linear = example("mixed").linearize()
    kinds = [row.kind in ("contact", "member cut") for row in linear.rows]
    assert not all(kinds)
    assert Weights().metric("contact_force", linear).diagonal == pytest.approx(np.array(kinds, dtype=float))
    assert Weights(contact_force="all rows").metric("contact_force", linear).unit
    source = linear.rows[0].source
    by_source = Weights(contact_force={source: 3.0}).metric("contact_force", linear).diagonal
    assert by_source is not None
    assert {r.source for r, w in zip(linear.rows, by_source, strict=True) if w == 3.0} == {source}


def test_a_matrix_of_condition_1e16_is_graded_or_semidefinite_and_never_inverted() -> None:
    """Graded by units it keeps its full rank; two components that weigh as one are found to be one."""
    from vincula.weights import metric_of

    names = [("vx",), ("vy",), ("wz",)]
    graded = metric_of([[1.0, 0.5, 0.0], [0.5, 1.0, 0.0], [0.0, 0.0, 1e-16]], "twist", names)
    assert graded.definite
    np.testing.assert_allclose(graded.factor @ graded.inverse, np.eye(3), atol=1e-14)
    same = 1.0 - 3e-16
    alike = metric_of([[1.0, same, 0.0], [same, 1.0, 0.0], [0.0, 0.0, 1.0]], "twist", names)
    assert alike.factor.shape == (2, 3)
    np.testing.assert_allclose(np.abs(alike.factor @ [1.0, -1.0, 0.0]).max(), 0.0, atol=1e-15)
