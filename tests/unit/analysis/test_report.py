"""The JSON object of the house page: keys, lists, nulls, infinities; and what it is the same as."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.paper.matrices import five_bar

from vincula.analysis.result import analyze
from vincula.labels import Uncertainty
from vincula.mechanism.catalog.registry import example
from vincula.weights import Weights

KEYS = {
    "schema", "mechanism", "reference", "frame", "active", "passive", "mobility", "kinematic",
    "active_force", "passive_force", "internal_force", "dual_force", "rank", "closure", "warnings",
    "components", "model", "statics", "maps",
}  # fmt: skip
SUMMARY = {
    "mobility", "passive_redundancy", "redundancy", "indeterminacy", "coordinated", "internal_torques",
    "structural_wrenches", "static_indeterminacy",
}  # fmt: skip


@pytest.fixture(scope="module")
def mixed() -> dict[str, Any]:
    return analyze(example("mixed").linearize()).to_dict()


def test_every_key_of_the_contract(mixed: dict[str, Any]) -> None:
    assert mixed.keys() >= KEYS
    assert mixed["schema"] == "vincula/analysis/1"
    assert mixed["mobility"]["summary"].keys() == SUMMARY
    assert set(mixed["mobility"]) >= {"counts", "nullity", "verdicts"}
    assert set(mixed["model"]) == {"rows", "columns", "cuts", "length"}
    assert set(mixed["components"]) == {
        "task", "task_units", "wrench", "wrench_units", "motors", "rate_units", "torque_units"
    }  # fmt: skip
    assert set(mixed["maps"]) >= {"twist_from_rates", "torque_from_wrench"}
    assert mixed["closure"]["residual"] <= 1e-12


def test_one_entry_an_efficiency_and_null_where_a_side_rests(mixed: dict[str, Any]) -> None:
    for name in ("kinematic", "active_force", "passive_force", "internal_force", "dual_force"):
        ellipsoid = mixed[name]
        lengths = {len(ellipsoid[key]) for key in ellipsoid if key not in ("weights", "clusters")}
        assert len(lengths) == 1
        for kind, value, task, motor in zip(
            ellipsoid["classes"], ellipsoid["efficiencies"], ellipsoid["task_directions"],
            ellipsoid["motor_directions"], strict=True,
        ):  # fmt: skip
            assert (value == "inf") == (kind == "infinite")
            assert (task is None) == (kind == "zero")
            assert (motor is None) == (kind == "infinite")
    assert mixed["kinematic"]["classes"] == ["infinite", "finite", "zero"]
    assert mixed["kinematic"]["weights"] == {"twist": [1.0] * 3, "rate": [1.0] * 3}
    assert mixed["maps"]["twist_from_rates"] is None
    assert "do not determine the twist" in mixed["maps"]["reasons"]["twist_from_rates"]
    assert mixed["statics"]["balances_every_wrench"] is False
    assert len(mixed["statics"]["structural_wrenches"]) == 1


def test_directions_have_length_one_and_a_positive_largest_component() -> None:
    weights = Weights(twist=[1.0, 4.0, 9.0], rate={"o1": 2.0})
    result = analyze(example("five-bar").linearize(), weights)
    for ellipsoid in result.ellipsoids[:1]:
        for task, motor in zip(ellipsoid.task_directions, ellipsoid.motor_directions, strict=True):
            assert task is not None
            assert motor is not None
            assert task @ ellipsoid.task_weight.matrix @ task == pytest.approx(1.0)
            assert motor @ ellipsoid.motor_weight.matrix @ motor == pytest.approx(1.0)
            assert task[np.argmax(np.abs(task))] > 0.0


def test_pairs_belong_together_signs_included(paper: dict[str, Any]) -> None:
    """The motor direction times the root of the efficiency gives the task direction, by the rate map."""
    result = analyze(five_bar(paper, [1, 5]), Weights())
    rates, torques = result.twist_from_rates.matrix, result.torque_from_wrench.matrix
    assert rates is not None
    assert torques is not None
    kinematic, passive = result.kinematic, result.passive_force
    for i, root in enumerate(kinematic.semi_axes):
        assert rates @ kinematic.motor_directions[i] == pytest.approx(root * kinematic.task_directions[i])
    for i in (1, 2):
        pushed = torques @ passive.task_directions[i]
        assert pushed * passive.semi_axes[i] == pytest.approx(passive.motor_directions[i])


def test_bounds_hold_and_clusters_are_found() -> None:
    result = analyze(example("stewart").linearize(), Weights())
    for value, (low, high) in zip(result.kinematic.efficiencies, result.kinematic.bounds, strict=True):
        assert low <= value <= high
        assert high / low - 1.0 < 1e-9
    assert result.kinematic.clusters == ((0, 1), (2,), (3,), (4, 5))
    loose = replace(result.model, uncertainty=Uncertainty(tolerance_length=1e-4, tolerance_angle=1e-4))
    wide = analyze(loose, Weights()).kinematic
    assert all(high / low - 1.0 > 1e-5 for low, high in wide.bounds)


def test_bounds_cover_what_typed_digits_leave_open(rng: np.random.Generator) -> None:
    """Matrices moved by up to half a digit keep their efficiencies inside the bounds."""
    model = replace(example("five-bar").linearize(), uncertainty=Uncertainty(digits_length=5e-5))
    bounds = analyze(model, Weights()).kinematic.bounds
    for _ in range(20):
        moved = replace(
            model,
            jacobian_active=model.jacobian_active + rng.uniform(-5e-5, 5e-5, model.jacobian_active.shape),
            jacobian_passive=model.jacobian_passive + rng.uniform(-5e-5, 5e-5, model.jacobian_passive.shape),
        )
        for value, (low, high) in zip(analyze(moved, Weights()).kinematic.efficiencies, bounds, strict=True):
            assert low <= value <= high


def test_numbers_survive_the_file(tmp_path: Path) -> None:
    result = analyze(example("stewart").linearize(), Weights())
    result.save(tmp_path / "stewart.json")
    read = json.loads((tmp_path / "stewart.json").read_text(encoding="utf-8"))
    assert read == result.to_dict()
    assert read["kinematic"]["efficiencies"] == result.kinematic.efficiencies.tolist()
    assert [row["unit"] for row in read["model"]["rows"][:4]] == ["m/s", "m/s", "m/s", "rad/s"]


def test_semidefinite_and_matrix_weights_are_reported() -> None:
    model = example("five-bar").linearize()
    positions = analyze(model, Weights(twist=[1.0, 1.0, 0.0], reciprocal=True)).to_dict()
    assert positions["kinematic"]["weights"]["twist"] == [1.0, 1.0, 0.0]
    assert positions["passive_force"]["weights"]["wrench"] == [1.0, 1.0, "inf"]
    coupled = analyze(model, Weights(twist=[[2.0, 1, 0], [1, 2, 0], [0, 0, 1]])).to_dict()
    assert coupled["kinematic"]["weights"]["twist"][0] == [2.0, 1.0, 0.0]


def test_the_text_names_everything() -> None:
    text = str(analyze(example("five-bar").linearize(), Weights()))
    for expected in ("motors:  o1, o5", "9.7365", "0.51353", "inf   fy 0.8944, mz -0.4472", "rank: certain"):
        assert expected in text
