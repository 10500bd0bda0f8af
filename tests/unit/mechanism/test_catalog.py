"""The examples: every one with an answer worked out by hand, parameters, and the paper's numbers."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from vincula.analysis.manipulability import (
    active_force_ellipsoid,
    internal_force_ellipsoid,
    kinematic_ellipsoid,
    passive_force_ellipsoid,
)
from vincula.errors import ModelError, NonFiniteError, UnknownNameError
from vincula.mechanism.catalog.registry import entry, example, examples
from vincula.mechanism.mechanism import Mechanism
from vincula.spatial.space import PLANAR

ANSWERS = {
    # mobility, passive redundancy, redundancy, indeterminacy, coordinated, internal torques,
    # structural wrenches, static indeterminacy
    "five-bar": (2, 0, 0, 0, 2, 0, 1, 0),
    "stewart": (6, 0, 0, 0, 6, 0, 0, 0),
    "stewart-spherical": (12, 6, 0, 0, 6, 0, 0, 0),
    "four-bar-2a": (1, 0, 0, 0, 1, 0, 2, 0),
    "four-bar-2c": (1, 0, 0, 0, 1, 0, 2, 0),
    "slider-crank": (1, 0, 0, 0, 1, 0, 2, 0),
    "3rrr": (3, 0, 0, 0, 3, 0, 0, 0),
    "delta": (3, 0, 0, 0, 3, 0, 3, 0),
    "serial-2r": (2, 0, 0, 0, 2, 0, 1, 0),
    "serial-7r": (7, 0, 1, 0, 6, 0, 0, 0),
    "two-arms": (6, 0, 0, 0, 6, 6, 0, 0),
    "two-finger-grasp": (3, 0, 0, 0, 3, 1, 0, 0),
    "three-finger-grasp": (6, 0, 0, 0, 6, 3, 0, 0),
    "quadruped": (6, 0, 0, 0, 6, 6, 0, 0),
    "mixed": (3, 0, 1, 1, 1, 1, 1, 1),
    "telescope": (2, 0, 1, 1, 0, 0, 2, 0),
}


def summary(mechanism: Mechanism) -> tuple[int, ...]:
    s = mechanism.linearize().ledger.summary
    return (
        s.mobility, s.passive_redundancy, s.redundancy, s.indeterminacy, s.coordinated,
        s.internal_torques, s.structural_wrenches, s.static_indeterminacy,
    )  # fmt: skip


def test_the_list_is_complete() -> None:
    assert {e.name for e in examples()} == set(ANSWERS)
    for found in examples():
        assert found.title
        assert len(found.description) > 80
        assert found.reference
        assert example(found.name).name == found.name


@pytest.mark.parametrize("name", ANSWERS)
def test_known_answers(name: str) -> None:
    mechanism = example(name)
    assert summary(mechanism) == ANSWERS[name]
    model = mechanism.linearize()
    assert model.ledger.status == "certain"
    assert model.uncertainty.residual == 0.0
    assert model.weights is not None
    assert model.weights.explicit
    planar = name in (
        "five-bar", "four-bar-2a", "four-bar-2c", "slider-crank", "3rrr", "serial-2r", "two-finger-grasp",
        "mixed", "telescope",
    )  # fmt: skip
    assert (mechanism.space is PLANAR) == planar


def test_the_five_bar_of_the_paper(paper: dict[str, Any]) -> None:
    for design in ("motors_1_5", "motors_2_4", "motors_all"):
        numbers = paper["five_bar"][design]
        model = example("five-bar").with_active([f"o{k}" for k in numbers["active"]]).linearize()
        assert kinematic_ellipsoid(model).efficiencies[:2] == pytest.approx(numbers["kinematic"], abs=5e-5)
        assert active_force_ellipsoid(model).efficiencies == pytest.approx(numbers["active_force"], abs=5e-5)
        passive = [float(value) for value in numbers["passive_force"]]
        assert passive_force_ellipsoid(model).efficiencies == pytest.approx(passive, abs=5e-5)
        internal = internal_force_ellipsoid(model).efficiencies
        assert internal[np.isfinite(internal)] == pytest.approx(numbers["internal_force"], abs=5e-5)
    assert [cut.at for cut in example("five-bar").linearize().cuts] == [(-2 / 3, 0.0), (-1 / 3, 0.0)]


def test_the_stewart_platform_of_the_paper(paper: dict[str, Any]) -> None:
    for check in paper["stewart"]["check"]:
        alpha, beta = check["alpha_beta_deg"]
        model = example("stewart", alpha=f"{alpha}deg", beta=f"{beta}deg").linearize()
        from vincula.weights import Weights

        found = kinematic_ellipsoid(model, Weights(twist=check["task_metric"])).efficiencies
        if "efficiencies" in check:
            assert found == pytest.approx(check["efficiencies"], abs=6e-4)
        cost = (found.max() - 1) ** 2 + (found.min() - 1) ** 2
        assert 1 / cost == pytest.approx(check["inverse_cost"], abs=6e-5)


def test_stewart_legs_that_coincide_free_three_motions() -> None:
    for turn in (0.0, 0.7):
        model = example("stewart", alpha=turn, beta=turn).linearize()
        efficiencies = kinematic_ellipsoid(model).efficiencies
        assert list(np.isinf(efficiencies)) == [True] * 3 + [False] * 3
        assert model.ledger.summary.indeterminacy == 3


def test_ball_and_soft_finger_platforms_move_alike() -> None:
    one, two = (example(name).linearize() for name in ("stewart", "stewart-spherical"))
    assert kinematic_ellipsoid(one).efficiencies == pytest.approx(kinematic_ellipsoid(two).efficiencies)
    spins = two.ledger.subspaces.kernel("passive")
    assert spins.shape[1] == 6


def test_both_four_bars_are_one_linkage() -> None:
    one, two = (example(name).linearize() for name in ("four-bar-2a", "four-bar-2c"))
    assert kinematic_ellipsoid(one).efficiencies == pytest.approx(kinematic_ellipsoid(two).efficiencies)
    assert passive_force_ellipsoid(one).efficiencies == pytest.approx(
        passive_force_ellipsoid(two).efficiencies
    )
    assert len(one.rows) == 4
    assert len(two.rows) == 6


def test_the_delta_only_translates() -> None:
    model = example("delta").linearize()
    found = kinematic_ellipsoid(model)
    directions = np.array([d for d in found.task_directions if d is not None])
    assert directions[:, 3:] == pytest.approx(np.zeros((3, 3)), abs=1e-12)


def test_the_serial_arm_is_the_textbook() -> None:
    """J of the 2R arm at the elbow angle q2 with links l1, l2."""
    l1, l2, q2 = 0.7, 0.4, 1.1
    model = example("serial-2r", upper=l1, fore=l2, angle=q2).linearize()
    jacobian = np.array([[-l2 * np.sin(q2)] * 2, [l1 + l2 * np.cos(q2), l2 * np.cos(q2)], [1, 1]])
    expected = np.linalg.svd(jacobian, compute_uv=False) ** 2
    assert kinematic_ellipsoid(model).efficiencies == pytest.approx(expected)


def test_mixed_is_all_three_at_once_and_telescope_has_t() -> None:
    counts = example("mixed").linearize().ledger.counts
    assert (counts.ap, counts.po, counts.none, counts.g, counts.a) == (1, 1, 1, 1, 1)
    counts = example("telescope").linearize().ledger.counts
    assert (counts.t, counts.o) == (1, 2)
    assert counts.ap == counts.ao == counts.po == counts.g == 0


def test_slider_crank_at_its_dead_centre() -> None:
    """The motor turns and the slider stands; driven at the slide, the crank is loose and the motor stuck."""
    assert summary(example("slider-crank", angle=0.0)) == (1, 0, 1, 0, 0, 0, 3, 0)
    assert summary(example("slider-crank", angle=0.0).with_active("slide")) == (1, 1, 0, 0, 0, 1, 3, 0)


def test_motors_of_the_3rrr() -> None:
    assert summary(example("3rrr").with_active("a1,a2")) == (3, 0, 0, 1, 2, 0, 0, 0)
    assert summary(example("3rrr").with_active("all")) == (3, 0, 0, 0, 3, 6, 0, 0)


def test_parameters_are_numbers_in_metres_and_radians_or_texts_with_units() -> None:
    by_number = example("stewart", alpha=np.deg2rad(30), height=1.5).linearize()
    by_text = example("stewart", alpha="30deg", height="150 cm").linearize()
    assert by_text.jacobian_active == pytest.approx(by_number.jacobian_active)
    default = example("stewart").linearize()
    told = example("stewart", **{p.name: p.default for p in entry("stewart").parameters}).linearize()
    assert np.array_equal(told.grasp, default.grasp)
    alpha = entry("stewart").parameters[0]
    assert (alpha.name, alpha.default, alpha.unit) == ("alpha", "1deg", "rad")
    assert alpha.value == pytest.approx(np.pi / 180)


@pytest.mark.parametrize(
    ("name", "values", "error", "message"),
    [
        ("stewrt", {}, UnknownNameError, "no example is named 'stewrt'; did you mean 'stewart'"),
        (
            "stewart",
            {"alfa": 1},
            UnknownNameError,
            "no parameter of example 'stewart' is named 'alfa'; did you mean 'al",
        ),
        (
            "five-bar",
            {"l": 1},
            UnknownNameError,
            r"no parameter of example 'five-bar' is named 'l'. Known: \(none\)",
        ),
        (
            "stewart",
            {"alpha": "1mm"},
            ModelError,
            "parameter 'alpha' is '1mm': the unit 'mm' is not one of rad, deg",
        ),
        (
            "stewart",
            {"height": "high"},
            ModelError,
            "parameter 'height' is 'high': give a number, with a unit",
        ),
        ("stewart", {"height": "1_000"}, ModelError, "give a number, with a unit"),
        (
            "stewart",
            {"height": True},
            ModelError,
            "parameter 'height' is True: give a number, or a text like '20mm'",
        ),
        ("stewart", {"height": float("inf")}, NonFiniteError, "parameter 'height' is inf"),
        ("stewart", {"height": "1e999m"}, NonFiniteError, "parameter 'height' is inf"),
        (
            "3rrr",
            {"near": 0.1},
            ModelError,
            "links of 0.1 m and 1 m do not meet over a distance of 1.5 m: it must be",
        ),
        ("slider-crank", {"rod": "1mm"}, ModelError, "does not reach the slide"),
        ("delta", {"rod": "10mm"}, ModelError, "do not bridge"),
    ],
)
def test_bad_requests(name: str, values: dict[str, Any], error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        example(name, **values)
