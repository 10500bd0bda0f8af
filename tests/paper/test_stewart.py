"""The Stewart platform of the paper, from bare matrices: the checks of reference/paper.toml."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from tests.paper.matrices import stewart

from vincula.analysis.manipulability import kinematic_ellipsoid
from vincula.weights import Weights


@pytest.mark.parametrize("index", range(5))
def test_efficiencies_and_cost(paper: dict[str, Any], index: int) -> None:
    check = paper["stewart"]["check"][index]
    model = stewart(paper, *check["alpha_beta_deg"])
    found = kinematic_ellipsoid(model, Weights(twist=check["task_metric"])).efficiencies
    if "efficiencies" in check:
        assert found == pytest.approx(check["efficiencies"], abs=5.001e-4)
    cost = (found[0] - 1.0) ** 2 + (found[-1] - 1.0) ** 2
    assert 1.0 / cost == pytest.approx(check["inverse_cost"], abs=5.001e-5)
    assert model.ledger.status == "certain"


def test_the_printed_optimum_is_met_only_roughly(paper: dict[str, Any]) -> None:
    model = stewart(paper, *paper["stewart"]["printed_optimum_deg"])
    found = kinematic_ellipsoid(model, Weights()).efficiencies
    assert found == pytest.approx(paper["stewart"]["printed_efficiencies"], abs=0.06)
    assert not np.allclose(found, paper["stewart"]["printed_efficiencies"], atol=0.005)


@pytest.mark.parametrize("angle", [0.0, 30.0, -75.0])
def test_three_infinite_efficiencies_where_odd_and_even_legs_coincide(
    paper: dict[str, Any], angle: float
) -> None:
    model = stewart(paper, angle, angle)
    found = kinematic_ellipsoid(model, Weights())
    assert found.classes.count("infinite") == 3
    assert found.classes.count("finite") == 3
    assert model.ledger.summary.internal_torques == 3
    assert model.ledger.summary.indeterminacy == 3
    assert model.ledger.status == "certain"


def test_efficiencies_grow_as_the_square_on_the_way_into_the_singularity(paper: dict[str, Any]) -> None:
    steps = 10.0 ** -np.arange(3.0, 7.0)
    largest = [
        kinematic_ellipsoid(stewart(paper, 10.0, 10.0 + step), Weights()).efficiencies[0] for step in steps
    ]
    assert np.diff(np.log(largest)) / np.diff(np.log(steps)) == pytest.approx(-2.0, abs=1e-3)
