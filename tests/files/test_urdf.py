"""URDF files: joints, mimic, motors, side files, and what is ignored, refused or noted."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from tests.files.conventions import four_bar
from tests.files.conventions.test_conventions import urdf

import vincula as vc
from vincula.cli.main import cli
from vincula.files.load import load_with_report
from vincula.files.report import LoadReport

TREE = four_bar.TREE


def loaded(folder: Path, inside: str, name: str = "robot.urdf") -> tuple[vc.Mechanism, LoadReport]:
    path = folder / name
    path.write_text(urdf(inside), encoding="utf-8")
    return load_with_report(path)


def two(kind: str, inside: str = "") -> str:
    return (
        f'<link name="a"/><link name="b"/><joint name="j" type="{kind}"><parent link="a"/><child link="b"/>'
        f"{inside}</joint>"
    )


def test_axis_origin_and_quaternion(tmp_path: Path) -> None:
    half = 0.5**0.5
    for turn in ('rpy="0 0 1.5707963267948966"', f'quat_xyzw="0 0 {half!r} {half!r}"'):
        robot, _ = loaded(tmp_path, two("prismatic", f'<origin xyz="1 0 0" {turn}/><axis xyz="2 0 0"/>'))
        pose = robot.body_poses(robot.configuration({"j": 0.5}))["b"]
        assert pose.position == pytest.approx([1.0, 0.5, 0.0], abs=1e-15)
        assert pose.rotation @ [1.0, 0.0, 0.0] == pytest.approx([0.0, 1.0, 0.0], abs=1e-15)


def test_mimic_is_a_coupling_and_the_follower_no_motor(tmp_path: Path) -> None:
    inside = TREE.replace(
        '<parent link="crank"/>', '<parent link="crank"/> <mimic joint="o1" multiplier="2" offset="0.5"/>'
    )
    robot, _ = loaded(tmp_path, inside)
    (coupling,) = robot.couplings
    values = {"o1": 0.3, "o2": 1.1}
    assert coupling.residual(values, {"o1": 0.0, "o2": 0.0}) == pytest.approx(0.0, abs=1e-15)
    assert coupling.coefficients(values, {"o1": 0.0, "o2": 0.0}) == {"o2": 1.0, "o1": -2.0}
    assert robot.active == ("o1", "o4")


def test_a_coupling_of_urdf_plus_runs_over_both_ways_down(tmp_path: Path) -> None:
    ends = (
        '<predecessor link="c"><origin xyz="1 0 0"/></predecessor>'
        '<successor link="base"><origin xyz="3 0 0"/></successor>'
    )
    point = f'<constraint name="tip" type="position">{ends}</constraint>'
    wheels = '<predecessor link="a"/><successor link="c"/><ratio value="2"/>'
    wheel = f'<constraint name="gear" type="rolling">{wheels}</constraint>'
    for extra, name in ((point, "tip"), (wheel, "gear")):
        path = tmp_path / f"{name}.urdf"
        path.write_text(SERIAL.format(extra), encoding="utf-8")
        robot = vc.load(path)
        if name == "tip":
            assert robot.joint["tip"].type == "spherical"
            assert robot.residuals()[0].gap < 1e-15
        else:
            # The way to a is a part of the way to c: what is left is the way from a to c.
            assert dict(robot.couplings[0].rates) == {"mot_b_left": -1.0, "to_c": -1.0}
    path.write_text(SERIAL.format(point.replace("position", "glue")), encoding="utf-8")
    with pytest.raises(vc.FileError, match="glue"):
        vc.load(path)
