"""Legal extremes: no motors, all motors, no loop, nothing that moves, nothing at all."""

from __future__ import annotations

import json

import numpy as np
import pytest

from vincula.analysis.result import Analysis, analyze
from vincula.model import LinearModel
from vincula.weights import Weights


def of(jacobian: object, grasp: object, active: list[int]) -> Analysis:
    result = analyze(LinearModel.from_matrices(jacobian, grasp, active=active, length=1.0), Weights())
    json.dumps(result.to_dict(), allow_nan=False)
    assert str(result)
    return result


PIN_AT_ONE = [[0.0, 0.0], [1.0, 2.0], [1.0, 1.0]]
"""Two revolutes at (-1, 0) and (-2, 0) drive the member, held completely at the origin."""


def test_a_serial_arm_gives_yoshikawas_matrix() -> None:
    result = of(PIN_AT_ONE, np.eye(3), [0, 1])
    jacobian = np.array(PIN_AT_ONE)
    expected = np.sort(np.linalg.eigvalsh(jacobian.T @ jacobian))[::-1]
    assert result.kinematic.efficiencies == pytest.approx(expected, rel=1e-13)
    assert result.twist_from_rates.matrix == pytest.approx(jacobian, abs=1e-14)
    assert result.torque_from_wrench.matrix == pytest.approx(-jacobian.T, abs=1e-14)
    assert "Every joint axis carries a motor." in " ".join(result.verdicts)


def test_no_motors() -> None:
    result = of(PIN_AT_ONE, np.eye(3), [])
    assert result.ledger.summary.indeterminacy == 2
    assert result.kinematic.classes == ("infinite", "infinite")
    assert result.kinematic.motor_directions == (None, None)
    assert any(verdict.startswith("No motors") for verdict in result.verdicts)
    assert result.twist_from_rates.matrix is None
    assert "do not determine the twist" in result.twist_from_rates.reason
    assert result.torque_from_wrench.matrix is None
    assert "2 direction(s)" in result.torque_from_wrench.reason


def test_no_loop_and_no_rows() -> None:
    result = of(np.zeros((0, 2)), np.zeros((3, 0)), [0])
    assert result.ledger.summary.mobility == 5
    assert result.ledger.counts.as_dict() | {"ar": 1, "pr": 1, "oi": 3} == result.ledger.counts.as_dict()
    assert result.verdicts[0].startswith("No constraint rows")


def test_a_structure() -> None:
    result = of(np.zeros((3, 0)), np.eye(3), [])
    assert result.ledger.summary.mobility == 0
    assert result.verdicts[0].startswith("Nothing can move")
    assert result.passive_force.classes == ("infinite",) * 3
    assert result.kinematic.classes == ()
    assert "Every wrench" in " ".join(result.verdicts)


def test_a_member_that_nothing_holds() -> None:
    result = of(np.zeros((1, 1)), np.zeros((3, 1)), [0])
    counts = result.ledger.counts
    assert (counts.ar, counts.oi, counts.none) == (1, 3, 1)
    assert result.kinematic.classes == ("infinite",) * 3 + ("zero",)
    assert result.internal_force.classes == ("infinite",)


def test_one_of_everything(rng: np.random.Generator) -> None:
    """All vectors of a kernel are paired with None on the side that rests."""
    from tests.laws.planted import NAMES, from_counts

    result = analyze(from_counts(dict.fromkeys(NAMES, 1), rng).model, Weights())
    for ellipsoid in result.ellipsoids:
        for kind, task, motor in zip(
            ellipsoid.classes, ellipsoid.task_directions, ellipsoid.motor_directions, strict=True
        ):
            assert (task is None) == (kind == "zero")
            assert (motor is None) == (kind == "infinite")
    text = json.dumps(result.to_dict(), allow_nan=False)
    assert json.loads(text)["kinematic"]["efficiencies"].count("inf") == 3
