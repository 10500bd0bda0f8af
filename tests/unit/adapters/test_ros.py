"""Joint states as configurations: names in any order, axes of their own, refusals that name the joint."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import vincula as vc
from vincula.adapters.ros import configuration_of


def message(**positions: float) -> Any:
    """What a driver would send."""
    return SimpleNamespace(
        name=list(positions), position=list(positions.values()), velocity=[], effort=[], header=None
    )


def arm() -> vc.Mechanism:
    return vc.Mechanism.spatial(
        joints=[
            vc.Revolute("base", "ground", "post", at=(0, 0, 0)),
            vc.Prismatic("lift", "post", "beam", at=(0, 0, 1), axis=(0, 0, 1)),
            vc.Universal("wrist", "beam", "hand", at=(1, 0, 1), axes=((1, 0, 0), (0, 1, 0))),
            vc.Spherical("ball", "hand", "tool", at=(2, 0, 1)),
        ],
        reference=vc.Reference("tool", origin=(2, 0, 1)),
    ).with_configuration({"lift": 0.25})


def test_values_by_name_in_any_order() -> None:
    found = configuration_of(arm(), message(lift=0.5, base=-0.1))
    assert found["base"].tolist() == [-0.1]
    assert found["lift"].tolist() == [0.5]
    assert found["ball"].tolist() == [1.0, 0.0, 0.0, 0.0]


def test_what_is_missing_keeps_its_home_value() -> None:
    found = configuration_of(arm(), message(base=1.0))
    assert found["lift"].tolist() == [0.25]
    assert configuration_of(arm(), message()) == arm().home


def test_a_joint_with_several_axes_is_given_by_axis() -> None:
    assert configuration_of(arm(), message(**{"wrist.2": 0.3}))["wrist"].tolist() == [0.0, 0.3]
    both = configuration_of(arm(), message(**{"wrist.2": 0.3, "wrist.1": -1.0}))
    assert both["wrist"].tolist() == [-1.0, 0.3]


def test_arrays_and_tuples_are_read_like_lists() -> None:
    state = SimpleNamespace(name=("base", "lift"), position=np.array([0.1, 0.2], dtype=np.float32))
    assert configuration_of(arm(), state)["lift"] == pytest.approx([0.2], rel=1e-6)


def test_measured_values_of_a_loop_close_near_by() -> None:
    linkage = vc.load("example:five-bar")
    closed = linkage.close({"o1": 0.1})
    measured = {name: float(value[0]) + 1e-3 * (-1) ** k for k, (name, value) in enumerate(closed.items())}
    found = configuration_of(linkage, message(**measured))
    again = linkage.close(found)
    assert max(abs(again[name] - closed[name]).item() for name in closed) < 1e-2


@pytest.mark.parametrize(
    ("state", "error", "words"),
    [
        (message(lft=1.0), vc.UnknownNameError, "'lft'; did you mean 'lift'"),
        (message(ball=1.0), vc.ModelError, "'ball' is spherical and has 4 values"),
        (message(wrist=1.0), vc.ModelError, "has 2 values.*: name its axes wrist.1, wrist.2"),
        (message(lift=float("nan")), vc.NonFiniteError, "position.*nan"),
        (SimpleNamespace(name=["lift"], position=[]), vc.ShapeError, "one number a name"),
        (SimpleNamespace(name=["lift", "lift"], position=[1, 2]), vc.DuplicateNameError, "lift"),
    ],
)
def test_refusals(state: Any, error: type[Exception], words: str) -> None:
    with pytest.raises(error, match=words):
        configuration_of(arm(), state)
