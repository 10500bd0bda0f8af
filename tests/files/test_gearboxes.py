"""Gearbox joints of SDF files couple two hinges of a third link: theta_2 = -ratio theta_1."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import vincula as vc
from vincula.files.load import load_with_report
from vincula.spatial.poses import Pose

TRAIN = """<sdf version="1.9"><model name="train">
  <link name="housing"/>
  <link name="rotor"><pose>0 0 0.1 0 0 0</pose></link>
  <link name="arm"><pose>0 0 0.2 0 0 1.2</pose></link>
  <joint name="input" type="revolute">{input}<axis><xyz>0 0 1</xyz></axis></joint>
  <joint name="output" type="revolute">{output}<axis><xyz>0 0 {sense}</xyz></axis></joint>
  <joint name="gear" type="gearbox"><parent>rotor</parent><child>arm</child>{parts}
    <axis><xyz>0 0 1</xyz></axis><axis2><xyz>0 0 1</xyz></axis2></joint>
</model></sdf>"""
ORIGIN = Pose.identity(3)
PARTS = "<gearbox_reference_body>housing</gearbox_reference_body><gearbox_ratio>0.04</gearbox_ratio>"


def ends(parent: str, child: str) -> str:
    return f"<parent>{parent}</parent><child>{child}</child>"


def train(folder: Path, *, swapped: bool = False, sense: int = 1, parts: str = PARTS) -> Path:
    path = folder / "train.sdf"
    first, second = (ends("rotor", "housing"), ends("arm", "housing")) if swapped else (
        ends("housing", "rotor"), ends("housing", "arm"))  # fmt: skip
    path.write_text(TRAIN.format(input=first, output=second, sense=sense, parts=parts), encoding="utf-8")
    return path


@pytest.mark.parametrize("sense", [1, -1])
@pytest.mark.parametrize("swapped", [False, True])
def test_angles_of_the_two_links_against_the_housing(swapped: bool, sense: int, tmp_path: Path) -> None:
    """Whichever way the hinges are written, the arm turns back by 0.04 of what the rotor turns."""
    robot, report = load_with_report(train(tmp_path, swapped=swapped, sense=sense))
    assert report.counts()["joint"]["used"] == 3
    closed = robot.close(motors={"input": -0.5 if swapped else 0.5})
    poses = robot.body_poses(closed)
    home = robot.body_poses(robot.home)

    def turned(link: str) -> float:
        """Angle of a link against the housing, from the drawn pose; the ground has no pose of its own."""
        (now, then) = (
            here["housing"].rotation.T @ here[link].rotation
            for here in ({"housing": ORIGIN, "rotor": ORIGIN, **where} for where in (poses, home))
        )
        step = now @ then.T
        return float(np.arctan2(step[1, 0], step[0, 0]))

    assert turned("rotor") == pytest.approx(0.5, abs=1e-12)
    assert turned("arm") == pytest.approx(-0.04 * 0.5, abs=1e-12)


def test_the_input_is_the_motor_and_moves_the_arm_slowly(tmp_path: Path) -> None:
    robot = vc.load(train(tmp_path)).with_reference("arm")
    assert robot.active == ("input",)
    ellipsoid = vc.kinematic_ellipsoid(robot.linearize(), vc.Weights())
    assert ellipsoid.efficiencies[0] == pytest.approx(0.04**2, rel=1e-12)


def test_a_missing_ratio_is_one(tmp_path: Path) -> None:
    only = "<gearbox_reference_body>housing</gearbox_reference_body>"
    robot = vc.load(train(tmp_path, parts=only))
    (coupling,) = robot.couplings
    assert coupling.rates == {"output": 1.0, "input": 1.0}


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        ("", "gearbox_reference_body ''"),
        ("<gearbox_reference_body>hosing</gearbox_reference_body>", "did you mean 'housing'"),
        ("<gearbox_reference_body>rotor</gearbox_reference_body>", "'rotor' has none to 'rotor'"),
        (PARTS.replace("0.04", "0"), "gearbox_ratio '0', expected a number, not 0"),
    ],
)
def test_what_cannot_be_a_gearbox_is_refused(parts: str, message: str, tmp_path: Path) -> None:
    with pytest.raises(vc.FileError) as refused:
        vc.load(train(tmp_path, parts=parts))
    assert message in str(refused.value)
