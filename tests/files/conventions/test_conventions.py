"""One linkage in every convention: the same seven counts and the same efficiencies."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.files.conventions import five_bar, four_bar

import vincula as vc
from vincula.files.load import load_with_report

COUNTS = ("ar", "pr", "oi", "t", "ap", "ao", "po")
"""Parts of the space of motions; the static ones depend on how a closure is written."""


def urdf(inside: str) -> str:
    """A URDF document; the namespace is that of Drake's extensions."""
    return f'<robot name="linkage" xmlns:drake="http://drake.mit.edu">{inside}</robot>'


def written(folder: Path, name: str, text: str, beside: str = "") -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    if beside:
        (folder / "robot.yaml").write_text(beside, encoding="utf-8")
    return path


def numbers(mechanism: vc.Mechanism, body: str, point: list[float], motors: list[str]) -> dict[str, Any]:
    """Counts and efficiencies at the home configuration."""
    placed = mechanism.with_active(motors).with_reference(body, point)
    found = vc.analyze(placed.linearize(), vc.Weights()).to_dict()
    return {
        "counts": {key: found["mobility"]["counts"][key] for key in COUNTS},
        "kinematic": found["kinematic"]["efficiencies"],
        "dual": [e for e in found["dual_force"]["efficiencies"] if e != "inf"],
    }


def same(one: dict[str, Any], other: dict[str, Any]) -> None:
    assert one["counts"] == other["counts"]
    assert np.array(one["kinematic"], float) == pytest.approx(np.array(other["kinematic"], float), rel=1e-9)
    assert np.array(one["dual"], float) == pytest.approx(np.array(other["dual"], float), rel=1e-9)


@pytest.fixture
def four_bar_numbers(tmp_path: Path) -> dict[str, Any]:
    planar = vc.load(written(tmp_path, "planar.yaml", four_bar.NATIVE)).with_reference("coupler")
    # A drawn body's frame has the ground's axes and origin.
    return numbers(planar, "coupler", [1.0, 1.5], ["o1"])


@pytest.mark.parametrize("dialect", four_bar.URDF)
def test_four_bar_in_the_dialects_of_urdf(
    dialect: str, tmp_path: Path, four_bar_numbers: dict[str, Any]
) -> None:
    text = urdf(four_bar.TREE + four_bar.URDF[dialect])
    robot = vc.load(written(tmp_path, "robot.urdf", text))
    same(numbers(robot, "coupler", [1.0, 0.5, 0.0], ["o1"]), four_bar_numbers)
    assert robot.residuals()[0].gap < 1e-12


@pytest.mark.parametrize("kind", four_bar.GEPETTO)
def test_four_bar_with_a_gepetto_file(kind: str, tmp_path: Path, four_bar_numbers: dict[str, Any]) -> None:
    text = urdf(four_bar.TREE + four_bar.GEPETTO_TREE)
    if kind == "3d":  # a point that coincides needs no joint before it
        text = text.replace('name="o3" type="continuous"', 'name="o3" type="fixed"')
    robot = vc.load(written(tmp_path, "four.urdf", text, four_bar.GEPETTO[kind]))
    assert robot.active == ("o1",)
    same(numbers(robot, "coupler", [1.0, 0.5, 0.0], ["o1"]), four_bar_numbers)


@pytest.mark.parametrize("text", [four_bar.SDF_GRAPH, four_bar.SDF_BALL])
def test_four_bar_in_sdf(text: str, tmp_path: Path, four_bar_numbers: dict[str, Any]) -> None:
    robot = vc.load(written(tmp_path, "model.sdf", text.replace("<sdf", '<sdf xmlns:drake="d"')))
    same(numbers(robot, "coupler", [1.0, 0.5, 0.0], ["o1"]), four_bar_numbers)


def test_four_bar_in_mjcf_and_in_space(tmp_path: Path, four_bar_numbers: dict[str, Any]) -> None:
    spatial = vc.load(written(tmp_path, "spatial.yaml", four_bar.NATIVE_SPATIAL))
    same(numbers(spatial, "coupler", [1.0, 1.5, 0.0], ["o1"]), four_bar_numbers)
    pytest.importorskip("mujoco")
    for text in (four_bar.MJCF, four_bar.MJCF_WELD):
        robot = vc.load(written(tmp_path, "robot.xml", text))
        same(numbers(robot, "coupler", [1.0, 0.5, 0.0], ["o1"]), four_bar_numbers)
        assert robot.residuals()[0].gap < 1e-12


def test_a_distance_is_a_rod_that_cannot_spin(tmp_path: Path, four_bar_numbers: dict[str, Any]) -> None:
    robot = vc.load(written(tmp_path, "robot.urdf", urdf(four_bar.CONSTRUCTED["Drake distance"])))
    assert robot.active == ("o1", "o4")
    middle = [0.5 * 5**0.5, 0.0, 0.0]
    same(numbers(robot, "coupler", middle, ["o1"]), four_bar_numbers)


@pytest.fixture
def five_bar_numbers(tmp_path: Path) -> dict[str, Any]:
    planar = vc.load(written(tmp_path, "planar.yaml", five_bar.NATIVE)).with_reference("coupler")
    return numbers(planar, "coupler", [-0.5, 0.0], ["o1", "o4"])


@pytest.mark.parametrize("dialect", five_bar.URDF)
def test_five_bar_in_the_dialects_of_urdf(
    dialect: str, tmp_path: Path, five_bar_numbers: dict[str, Any]
) -> None:
    text = urdf(five_bar.TREE + five_bar.URDF[dialect])
    robot, report = load_with_report(written(tmp_path, "robot.urdf", text))
    assert robot.active == ("o1", "o4")
    same(numbers(robot, "coupler", [0.5, 0.0, 0.0], ["m1", "m4"]), five_bar_numbers)
    assert sum(count["ignored"] for count in report.counts().values()) == 0


def test_five_bar_with_a_gepetto_file(tmp_path: Path, five_bar_numbers: dict[str, Any]) -> None:
    tree = five_bar.TREE[: five_bar.TREE.index("  <transmission")]
    robot = vc.load(written(tmp_path, "five.urdf", urdf(tree + five_bar.GEPETTO_TREE), five_bar.GEPETTO))
    assert robot.active == ("o1", "o4")
    same(numbers(robot, "coupler", [0.5, 0.0, 0.0], ["o1", "o4"]), five_bar_numbers)


def test_five_bar_in_space(tmp_path: Path, five_bar_numbers: dict[str, Any]) -> None:
    spatial = vc.load(written(tmp_path, "spatial.yaml", five_bar.NATIVE_SPATIAL))
    same(numbers(spatial, "coupler", [-0.5, 0.0, 0.0], ["o1", "o4"]), five_bar_numbers)


@pytest.mark.parametrize("text", [five_bar.SDF, five_bar.SDF_BALL])
def test_five_bar_in_sdf(text: str, tmp_path: Path, five_bar_numbers: dict[str, Any]) -> None:
    robot = vc.load(written(tmp_path, "model.sdf", text))
    assert robot.active == ("o1", "o4")
    same(numbers(robot, "coupler", [0.5, 0.0, 0.0], ["o1", "o4"]), five_bar_numbers)


@pytest.mark.parametrize("text", [five_bar.MJCF, five_bar.MJCF_WELD])
def test_five_bar_in_mjcf(text: str, tmp_path: Path, five_bar_numbers: dict[str, Any]) -> None:
    pytest.importorskip("mujoco")
    robot = vc.load(written(tmp_path, "robot.xml", text))
    assert robot.residuals()[0].gap < 1e-12
    same(numbers(robot, "coupler", [0.5, 0.0, 0.0], ["o1", "o4"]), five_bar_numbers)
