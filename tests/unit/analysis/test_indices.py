"""Indices against their textbook formulas, and the refusal to mix metres with radians."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from tests.paper.matrices import stewart

from vincula.analysis import indices
from vincula.analysis.manipulability import kinematic_ellipsoid
from vincula.errors import MixedUnitsError, ModelError
from vincula.model import LinearModel
from vincula.weights import Weights, characteristic_length_weights


def arm(bend: float) -> LinearModel:
    """A planar arm of two unit links, the second turned by `bend`."""
    c, s = np.cos(bend), np.sin(bend)
    jacobian = np.array([[-s, -s], [1.0 + c, c], [1.0, 1.0]])
    return LinearModel.from_matrices(jacobian, np.eye(3), active=[0, 1], length=1.0)


@pytest.mark.parametrize("bend", [0.3, 1.0, 2.5])
def test_translation_indices_of_a_two_link_arm(bend: float) -> None:
    jacobian = arm(bend).jacobian_active[:2]
    values = np.linalg.svd(jacobian, compute_uv=False)
    model = arm(bend)
    assert indices.yoshikawa_volume(model, "translation") == pytest.approx(abs(np.sin(bend)), rel=1e-12)
    assert indices.smallest_singular_value(model, "translation") == pytest.approx(values[1], rel=1e-12)
    assert indices.condition_number(model, "translation") == pytest.approx(values[0] / values[1], rel=1e-12)
    assert indices.inverse_condition_number(model, "translation") == pytest.approx(values[1] / values[0])
    squares = values**2
    expected = np.sqrt(np.prod(squares)) / squares.mean()
    assert indices.isotropy(model, "translation") == pytest.approx(expected, rel=1e-12)
    assert indices.yoshikawa_volume(model, "rotation") == pytest.approx(np.sqrt(2.0))


def test_the_straight_arm_is_flat() -> None:
    assert indices.yoshikawa_volume(arm(0.0), "translation") == 0.0
    assert indices.condition_number(arm(0.0), "translation") == float("inf")
    assert indices.inverse_condition_number(arm(0.0), "translation") == 0.0
    assert indices.isotropy(arm(0.0), "translation") == 0.0


def test_mixed_units_are_refused_unless_weighed() -> None:
    with pytest.raises(MixedUnitsError, match="on='translation'"):
        indices.yoshikawa_volume(arm(1.0))
    chosen = indices.yoshikawa_volume(arm(1.0), weights=characteristic_length_weights(1.0, arm(1.0)))
    assert chosen == 0.0  # two motors do not fill three dimensions


def test_all_components_in_a_metric(paper: dict[str, Any]) -> None:
    model = stewart(paper, 45.0, -45.0)
    found = kinematic_ellipsoid(model, Weights(twist=[1.0, 1, 1, 5, 5, 5]))
    axes = found.semi_axes
    assert indices.yoshikawa_volume(found) == pytest.approx(np.prod(axes), rel=1e-12)
    assert indices.condition_number(found) == pytest.approx(axes[0] / axes[-1], rel=1e-12)
    rotation = indices.smallest_singular_value(found, "rotation")
    shadow = found.project(["wx", "wy", "wz"])
    lengths = np.sqrt(5.0) * np.linalg.norm(shadow.axes, axis=0)
    assert rotation == pytest.approx(lengths.min(), rel=1e-12)


def test_unbounded_sets(paper: dict[str, Any]) -> None:
    model = stewart(paper, 10.0, 10.0)
    everything = Weights()
    assert indices.yoshikawa_volume(model, "all", everything) == float("inf")
    assert np.isnan(indices.isotropy(model, "all", everything))
    assert indices.condition_number(model, "all", everything) == float("inf")


def test_bad_questions() -> None:
    with pytest.raises(ModelError, match="on is 'position'"):
        indices.isotropy(arm(1.0), "position")  # type: ignore[arg-type]
    with pytest.raises(ModelError, match="ignore every chosen component"):
        indices.isotropy(arm(1.0), "rotation", Weights(twist=[1.0, 1.0, 0.0]))
