"""Members of a front over many configurations are computed again where it matters."""

from __future__ import annotations

import numpy as np
import pytest

import vincula as vc
from vincula.design import rechecked as module
from vincula.design.linkages import uneven_five_bar
from vincula.design.measures import Index
from vincula.design.problem import DesignProblem
from vincula.design.rechecked import rechecked
from vincula.design.variables import DesignVariable


def test_objectives_are_those_of_the_search_where_they_are_decided(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "WHOLE", 0)
    monkeypatch.setattr(module, "SPREAD", 3)
    turns = np.linspace(-0.25, 0.25, 4)
    places = np.stack([mesh.ravel() for mesh in np.meshgrid(turns, turns)], axis=1)
    problem = DesignProblem(
        uneven_five_bar,
        [DesignVariable("near_left", 0.2, 0.3), DesignVariable("far_right", 0.3, 0.4)],
        [
            Index(quantity="kinematic.condition:translation"),
            Index(quantity="kinematic.smallest_singular_value:translation", over="mean"),
        ],
        configurations=places,
        given="motors",
        weights=vc.Weights(),
    )
    judged = problem.judge([[0.22, 0.33], [0.27, 0.38]])
    assert judged.feasible.all()
    again = rechecked(problem, judged)
    np.testing.assert_allclose(again, judged.objectives, rtol=1e-9)
