"""SDF files: real models against independent results, joint types, mimic, and writing against reading."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import vincula as vc
from vincula.files.load import load_with_report
from vincula.files.sdf_writer import sdf_data
from vincula.mechanism.catalog.registry import example


def model(inside: str, links: str = '<link name="a"/><link name="b"/>', version: str = "1.11") -> str:
    return f'<sdf version="{version}" xmlns:drake="d"><model name="m">{links}{inside}</model></sdf>'


def joint(kind: str, inside: str, name: str = "j", ends: tuple[str, str] = ("a", "b")) -> str:
    parent, child = ends
    return (
        f'<joint name="{name}" type="{kind}"><parent>{parent}</parent><child>{child}</child>{inside}</joint>'
    )


def loaded(folder: Path, text: str) -> vc.Mechanism:
    path = folder / "model.sdf"
    path.write_text(text, encoding="utf-8")
    return vc.load(path)


def finite(mechanism: vc.Mechanism) -> tuple[dict[str, int], list[float]]:
    found = vc.analyze(mechanism.linearize(), vc.Weights()).to_dict()
    kinematic: dict[str, Any] = found["kinematic"]
    pairs = zip(kinematic["efficiencies"], kinematic["classes"], strict=True)
    return found["mobility"]["counts"], [e for e, kind in pairs if kind == "finite"]


def test_the_stewart_platform_agrees_with_the_independent_case(models: Path, cases: Path) -> None:
    """Here as a true graph; the case was computed from the same joints written as a tree with welds."""
    case = json.loads((cases / "stewart_sdf_home" / "expected.json").read_text(encoding="utf-8"))
    robot = vc.load(models / "stewart_sdf" / "model.sdf")
    assert len(robot.active) == 36
    robot = robot.with_active(case["actuated"]).with_reference("platform_link")
    counts, efficiencies = finite(robot)
    assert efficiencies == pytest.approx(case["results"]["eig_velocity_eq13"], rel=1e-6)
    assert counts["po"] + counts["oi"] + counts["t"] == case["results"]["dim_member_indeterminacy"]


def test_four_bars_of_drake(models: Path, cases: Path) -> None:
    """Comments with two hyphens are repaired; the loops are drawn open and said to be so."""
    for name, kind in (("four_bar_loop", "revolute"), ("four_bar_weld", "fixed")):
        robot, report = load_with_report(models / "drake_four_bar" / f"{name}.sdf")
        assert report.counts()["comment"] == {"total": 1, "used": 0, "ignored": 0, "repaired": 1}
        gap = robot.residuals()[0]
        assert gap.linear == pytest.approx(math.hypot(4.0 - 4.8, 2.0 - 1.0), rel=1e-12)
        assert kind in {j.type for j in robot.joints}
        with pytest.raises(vc.ClosureError):
            robot.with_reference("coupler").linearize()


def test_the_bushing_of_drake_is_a_loop_by_an_overlay(models: Path, cases: Path, tmp_path: Path) -> None:
    """The two frames are 0.1 m apart along the axis, so the pin is a cylindrical one."""
    case = json.loads((cases / "drake_four_bar" / "generic.json").read_text(encoding="utf-8"))
    content = {
        "vincula": 1,
        "base": str(models / "drake_four_bar" / "four_bar.sdf"),
        "closures": [{"name": "tip", "type": "cylindrical", "frames": ["Bc_bushing", "Cb_bushing"]}],
        "configuration": case["configuration"],
        "reference": {"body": "B"},
    }
    path = tmp_path / "overlay.json"
    path.write_text(json.dumps(content), encoding="utf-8")
    robot = vc.load(path)
    assert robot.active == ("joint_WA",)
    with pytest.warns(vc.RankAmbiguityWarning, match="loop closure"):
        # The file turns its frames by 1.57079632679: the axes are parallel to 5e-12 only.
        counts, efficiencies = finite(robot)
    assert counts["po"] + counts["oi"] + counts["t"] == case["results"]["dim_member_indeterminacy"]
    assert efficiencies == pytest.approx(case["results"]["eig_velocity_eq13"], rel=1e-6)
    assert max(residual.gap for residual in robot.residuals()) < 1e-8


def test_a_screw_advances_by_its_pitch(tmp_path: Path) -> None:
    for inside, lead in (
        ("<screw_thread_pitch>0.01</screw_thread_pitch>", 0.01),
        (f"<thread_pitch>{-2 * math.pi / 0.01!r}</thread_pitch>", 0.01),
    ):
        text = model(joint("screw", f"<axis><xyz>0 0 2</xyz></axis>{inside}"))
        robot = loaded(tmp_path, text)
        pose = robot.body_poses(robot.configuration({"j": math.pi}))["b"]
        assert pose.position == pytest.approx([0.0, 0.0, lead / 2], abs=1e-15)
        assert pose.rotation @ [1.0, 0.0, 0.0] == pytest.approx([-1.0, 0.0, 0.0], abs=1e-15)


def test_mimic_with_reference_and_second_axis(tmp_path: Path) -> None:
    mimic = (
        '<mimic joint="u" axis="axis2"><multiplier>2</multiplier><offset>0.5</offset>'
        "<reference>0.1</reference></mimic>"
    )
    text = model(
        joint("universal", "<axis><xyz>1 0 0</xyz></axis><axis2><xyz>0 1 0</xyz></axis2>", "u")
        + joint("revolute", f"<axis><xyz>0 0 1</xyz>{mimic}</axis>", "k", ("b", "c")),
        '<link name="a"/><link name="b"/><link name="c"/>',
    )
    robot = loaded(tmp_path, text)
    (coupling,) = robot.couplings
    follower = 2.0 * (0.7 - 0.1) + 0.5
    zero = {"k": 0.0, "u.2": 0.0}
    assert coupling.residual({"k": follower, "u.2": 0.7}, zero) == pytest.approx(0.0, abs=1e-15)
    assert coupling.coefficients({"k": follower, "u.2": 0.7}, zero) == {"k": 1.0, "u.2": -2.0}
    assert robot.active == ("u.1", "u.2") or "k" not in robot.active


def test_axes_are_expressed_in_frames(tmp_path: Path) -> None:
    links = '<link name="a"/><link name="b"><pose degrees="true">1 0 0 0 0 90</pose></link>'
    frame = '<frame name="f" attached_to="b"><pose degrees="true">0 0 0 90 0 0</pose></frame>'
    for expressed, axis in (("", [0, 1, 0]), ("__model__", [1, 0, 0]), ("f", [0, 1, 0])):
        where = f' expressed_in="{expressed}"' if expressed else ""
        text = model(frame + joint("prismatic", f"<axis><xyz{where}>1 0 0</xyz></axis>"), links)
        robot = loaded(tmp_path, text)
        moved = robot.body_poses(robot.configuration({"j": 0.25}))["b"].position - [1.0, 0.0, 0.0]
        assert moved == pytest.approx(0.25 * np.array(axis), abs=1e-15)


SPATIAL = ("stewart-spherical", "delta", "serial-7r")


@pytest.mark.parametrize("name", SPATIAL)
def test_examples_survive_writing_and_reading(name: str, tmp_path: Path) -> None:
    mechanism = example(name)
    data = sdf_data(mechanism)
    assert data.lost == []
    again = loaded(tmp_path, data.text)
    assert again.active == mechanism.active
    member = mechanism.reference
    assert member is not None
    same = again.with_reference(member.body, member.origin)
    one, other = finite(mechanism), finite(same)
    assert one[0] == other[0]
    assert other[1] == pytest.approx(one[1], rel=1e-9)


def test_the_stewart_platform_survives_writing_and_reading(models: Path, tmp_path: Path) -> None:
    robot = vc.load(models / "stewart_sdf" / "model.sdf")
    pistons = [f"piston{k}_prismatic_joint" for k in range(1, 7)]
    robot = robot.with_active(pistons).with_reference("platform_link")
    again = loaded(tmp_path, sdf_data(robot).text).with_reference("platform_link")
    assert again.active == robot.active
    one, other = finite(robot), finite(again)
    assert one[0] == other[0]
    assert other[1] == pytest.approx(one[1], rel=1e-9)


@pytest.mark.parametrize("name", ["two-finger-grasp", "stewart"])
def test_what_the_format_cannot_hold_is_said(name: str) -> None:
    mechanism = example(name)
    data = sdf_data(mechanism)
    assert any("the plane" in text for text in data.lost) == (mechanism.space.name == "planar")
    assert any("contact" in text for text in data.lost)
    with pytest.raises(vc.UnsupportedFeatureError, match="cannot hold everything"):
        data.refuse_losses()
