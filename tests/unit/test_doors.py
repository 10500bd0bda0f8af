"""What users hand over at the doors of the library: refused in one sentence when it cannot be meant."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import vincula as vc

EYE = np.eye(3)


def _matrices(J: Any = EYE, **options: Any) -> vc.LinearModel:
    return vc.LinearModel.from_matrices(J, EYE, **{"active": [0], **options})


def _arm() -> vc.Mechanism:
    joints = [vc.Revolute("a", "ground", "b", at=(0, 0)), vc.Revolute("c", "b", "d", at=(1, 0))]
    return vc.Mechanism.planar(joints, reference=vc.Reference("d", origin=(2, 1)), active=["a", "c"])


def _ellipsoid(**weights: Any) -> vc.Ellipsoid:
    return vc.kinematic_ellipsoid(_arm().linearize(), vc.Weights(**weights))


REFUSED: dict[str, tuple[Callable[[], object], type[Exception], str]] = {
    "complex numbers": (lambda: _matrices(EYE * 1j), vc.ShapeError, "J has shape"),
    "length zero": (lambda: _matrices(length=0), vc.ModelError, "characteristic length is 0"),
    "length below zero": (lambda: _matrices(length=-1.0), vc.ModelError, "characteristic length is -1.0"),
    "length NaN": (lambda: _matrices(length=float("nan")), vc.ModelError, "characteristic length is nan"),
    "length as text": (lambda: _matrices(length="1"), vc.ModelError, "characteristic length is '1'"),
    "active as a number": (lambda: _matrices(active=0), vc.ModelError, "active is 0: give a list"),
    "active by wrong text": (lambda: _matrices(active="q7"), vc.UnknownNameError, "'q7'"),
    "a mechanism": (lambda: vc.analyze(_arm()), vc.ModelError, "got Mechanism: mechanism.linearize()"),
    "weights as a list": (lambda: vc.analyze(_matrices(), [1, 1]), vc.WeightError, "give Weights"),
    "values as a list": (lambda: _arm().linearize([0.1, 0.2]), vc.ModelError, "give {joint: value}"),
    "tolerance below zero": (lambda: _arm().with_tolerance(-1e-4), vc.ModelError, "length is -0.0001"),
    "tolerance NaN": (lambda: _arm().with_tolerance(0.0, float("nan")), vc.ModelError, "angle is nan"),
    "no points": (lambda: _ellipsoid().points(0), vc.ModelError, "count is 0"),
    "half a point": (lambda: _ellipsoid().points(1.5), vc.ModelError, "count is 1.5"),
    "half a component": (lambda: _ellipsoid().project([0.5]), vc.UnknownNameError, "'0.5'"),
    "a component twice": (lambda: _ellipsoid().section(["vx", 0]), vc.DuplicateNameError, "'vx'"),
    "an ignored direction": (
        lambda: _ellipsoid(twist=[1, 1, 0]).along([0, 0, 1]), vc.ModelError, "the weights ignore",
    ),
}  # fmt: skip


@pytest.mark.parametrize("what", REFUSED)
def test_is_refused_in_one_sentence(what: str) -> None:
    door, kind, words = REFUSED[what]
    with pytest.raises(kind) as caught:
        door()
    assert words in str(caught.value)


def test_active_columns_as_all_or_as_one_name() -> None:
    assert [c.name for c in _matrices(active=vc.ALL).motors] == ["q1", "q2", "q3"]
    assert [c.name for c in _matrices(active="all").motors] == ["q1", "q2", "q3"]
    assert [c.name for c in _matrices(active="q2").motors] == ["q2"]
    assert [c.name for c in _matrices(active="all", columns=["a", "all", "b"]).motors] == ["all"]


def test_a_given_length_is_rounded_to_a_power_of_two() -> None:
    model = _matrices(np.array([[1 / 3, 0, 0], [0, 1, 0], [0, 0, 1]]), length=0.3)
    assert model.length == 0.25
    assert model.scaled.active[0, 0] == 4 / 3


def test_one_component_by_its_name() -> None:
    ellipsoid = _ellipsoid()
    assert ellipsoid.project("vx").components == ("vx",)
    assert ellipsoid.project("vx").support([1]) == pytest.approx(ellipsoid.support([1, 0, 0]), rel=1e-12)


def test_a_planar_joint_has_an_axis_as_in_native_files() -> None:
    slide = vc.PlanarJoint("p", "ground", "puck", at=(0, 0, 1), axis=(0, 1, 0))
    puck = vc.Mechanism.spatial([slide], reference=vc.Reference("puck"), active=["p"])
    structural = vc.analyze(puck.linearize(), vc.Weights()).forces.structural.wrench
    assert structural.shape == (6, 3)
    assert np.abs(structural[[0, 2, 4]]).max() < 1e-12  # fx, fz and my do work
