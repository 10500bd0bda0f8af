"""Weights from limits, and weights by name when other joints carry the motors."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import vincula as vc
from vincula.errors import UnknownNameError, WeightError
from vincula.mechanism.catalog.registry import example
from vincula.mechanism.mechanism import Mechanism
from vincula.mechanism.motor_weights import weights_from_limits
from vincula.mechanism.parts import Limits


def limited(**limits: Limits) -> Mechanism:
    """The five-bar with limits on some joints."""
    linkage = example("five-bar")
    joints = tuple(replace(j, limits=(limits[j.name],)) if j.name in limits else j for j in linkage.joints)
    return replace(linkage, joints=joints)


def test_limits_become_inverse_squares() -> None:
    linkage = limited(o1=Limits(rate=2.0, effort=10.0), o5=Limits(rate=4.0, effort=5.0))
    model = linkage.with_weights(weights_from_limits(linkage)).linearize()
    assert model.weights is not None
    np.testing.assert_allclose(model.weights.metric("rate", model).diagonal, [1 / 4, 1 / 16])
    np.testing.assert_allclose(model.weights.metric("torque", model).diagonal, [1 / 100, 1 / 25])


def test_a_motor_at_its_limit_counts_as_one() -> None:
    """With W_q = 1/limit^2 the set of reachable twists is that of rates within the limits' ellipsoid."""
    from vincula.analysis.manipulability import kinematic_ellipsoid

    linkage = limited(o1=Limits(rate=2.0), o5=Limits(rate=4.0))
    weighted = kinematic_ellipsoid(linkage.with_weights(weights_from_limits(linkage)).linearize())
    direction = np.array([-2.0, -1.0, -2.0])  # twist of one unit of o1 alone
    assert weighted.along(direction) == pytest.approx(2.0)


def test_a_kind_of_limit_that_no_motor_has_weighs_one() -> None:
    linkage = limited(o1=Limits(effort=10.0), o5=Limits(effort=5.0))
    weights = weights_from_limits(linkage)
    assert weights.rate is None
    assert weights.torque == {"o1": 0.01, "o5": 0.04}


def test_limits_that_some_motors_lack_are_refused_by_name() -> None:
    with pytest.raises(WeightError, match="no rate limit for o5"):
        weights_from_limits(limited(o1=Limits(rate=2.0)))


def test_no_limits_at_all_are_refused() -> None:
    with pytest.raises(WeightError, match="no rate and no effort limit for o1, o5"):
        weights_from_limits(example("five-bar"))


def test_a_limit_of_zero_is_refused() -> None:
    with pytest.raises(WeightError, match="rate limit of o1 is zero"):
        weights_from_limits(limited(o1=Limits(rate=0.0), o5=Limits(rate=1.0)))


def test_limits_stay_right_for_other_motors() -> None:
    every = {
        name: Limits(rate=rate) for name, rate in zip(("o1", "o2", "o4", "o5"), (1, 2, 4, 8), strict=True)
    }
    linkage = limited(**every)
    other = linkage.with_weights(weights_from_limits(linkage)).with_active("o2,o4")
    model = other.linearize()
    assert model.weights is not None
    np.testing.assert_allclose(model.weights.metric("rate", model).diagonal, [1 / 4, 1 / 16])


def test_weights_of_joints_that_carry_no_motor_have_no_effect() -> None:
    linkage = example("five-bar").with_weights(vc.Weights(rate={"o1": 4.0, "o2": 9.0}))
    for motors, expected in (("o1,o5", [4, 1]), ("o2,o4", [9, 1]), ("all", [4, 9, 1, 1, 1])):
        model = linkage.with_active(motors).linearize()
        assert model.weights is not None
        np.testing.assert_array_equal(model.weights.metric("rate", model).diagonal, expected)


def test_weights_of_names_that_do_not_exist_are_refused() -> None:
    model = example("five-bar").with_weights(vc.Weights(rate={"o9": 4.0})).linearize()
    assert model.weights is not None
    with pytest.raises(UnknownNameError, match="o9"):
        model.weights.metric("rate", model)


def test_a_motor_on_several_axes_has_the_limits_of_its_axes() -> None:
    """Its rate is reached with every axis at its limit; its torque takes the first of them to its own."""
    linkage = limited(o1=Limits(rate=2.0, effort=10.0), o5=Limits(rate=4.0, effort=5.0))
    both = replace(linkage, drives=(vc.Drive("both", {"o1": 0.5, "o5": -2.0}),)).with_active(["both"])
    weights = weights_from_limits(both)
    assert isinstance(weights.rate, dict)
    assert isinstance(weights.torque, dict)
    rate, torque = weights.rate["both"] ** -0.5, weights.torque["both"] ** -0.5
    corners = [0.5 * a - 2.0 * b for a in (-2.0, 2.0) for b in (-4.0, 4.0)]
    assert rate == pytest.approx(max(corners))
    assert np.abs(torque * np.array([0.5, -2.0])) / [10.0, 5.0] == pytest.approx([0.125, 1.0])


def test_a_motor_on_several_axes_needs_limits_of_all_of_them() -> None:
    linkage = limited(o1=Limits(rate=2.0), o5=Limits(effort=5.0))
    both = replace(linkage, drives=(vc.Drive("both", {"o1": 0.5, "o5": -2.0}),)).with_active(["both", "o1"])
    with pytest.raises(WeightError, match=r"no rate limit for both.*when all of them have one"):
        weights_from_limits(both)
