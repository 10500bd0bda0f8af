"""Overlays: a native file on top of another file adds parts, and replaces scalars and lists."""

from __future__ import annotations

import json
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.files.native_samples import FIVE_BAR, write
from tests.parity.mjcf_cases import CONTACTS, GRASPS

import vincula as vc
from vincula.files.load import load_with_report


def overlay_of(case: dict[str, Any], model: Path, *, in_body: bool) -> dict[str, Any]:
    """The grasp of a reference case as an overlay: contacts given in ground axes or on the fingers."""
    contacts = []
    for index, contact in enumerate(case["contacts"]):
        at: Any = contact["point_world"]
        if in_body:
            at = {"in": contact["body"], "xyz": contact["offset_in_body"]}
        contacts.append({
            "name": f"c{index}",
            "type": CONTACTS[contact["type"]],
            "bodies": [contact["body"], "object"],
            "at": at,
            "normal": contact["normal_world"],
        })  # fmt: skip
    values = {name: v[0] if len(v) == 1 else v for name, v in case["configuration"]["by_joint"].items()}
    return {
        "vincula": 1,
        "base": str(model),
        "configuration": values,
        "contacts": contacts,
        "motors": case["actuated"],
        "lock": case["locked"],
        "reference": {"body": "object", "origin": case["object_frame_point_world"]},
        "weights": {},
    }


@pytest.mark.parametrize("in_body", [False, True])
@pytest.mark.parametrize("name", GRASPS)
def test_grasps_of_the_reference_cases(name: str, in_body: bool, shared: Path, tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    case = json.loads((shared / "cases" / name / "expected.json").read_text(encoding="utf-8"))
    content = overlay_of(case, shared / case["model_file"], in_body=in_body)
    mechanism = vc.load(write(tmp_path, json.dumps(content), "grasp.json"))
    summary = vc.analyze(mechanism.linearize()).to_dict()
    expected = case["results"]
    counts = summary["mobility"]["summary"]
    assert counts["indeterminacy"] == expected["dim_member_indeterminacy"]
    assert counts["redundancy"] == expected["dim_actuated_redundancy"]
    assert counts["coordinated"] == expected["dim_coordinated"]
    assert counts["structural_wrenches"] == expected["dim_structural_wrenches"]
    assert counts["internal_torques"] == expected["dim_internal_torques"]
    kinematic = summary["kinematic"]
    pairs = zip(kinematic["efficiencies"], kinematic["classes"], strict=True)
    finite = [float(value) for value, kind in pairs if kind == "finite"]
    np.testing.assert_allclose(finite, expected["eig_velocity_eq13"], rtol=1e-6)


def grasp(tmp_path: Path, extra: str = "") -> vc.Mechanism:
    """A planar gripper file and an overlay that gives it a box to hold."""
    write(
        tmp_path,
        """
vincula: 1
space: planar
parameters: {w: 1.0}
joints:
  - {name: left, type: revolute, bodies: [ground, left_finger], at: [-$w, 0]}
  - {name: right, type: revolute, bodies: [ground, right_finger], at: [$w, 0]}
couplings: [{name: gear, rates: {left: 1, right: 1}}]
motors: [left]
lock: []
reference: {body: left_finger}
""",
        "gripper.yaml",
    )
    return vc.load(
        write(
            tmp_path,
            """
vincula: 1
base: gripper.yaml
units: {length: cm, angle: deg}
configuration: {left: -30, right: 30}
contacts:
  - {name: cl, type: hard-finger, bodies: [left_finger, box], normal: [1, 0],
     at: {in: left_finger, xyz: [-100, 200]}}
  - {name: cr, type: hard-finger, bodies: [right_finger, box], normal: [-1, 0],
     at: {in: right_finger, xyz: [100, 200]}}
reference: {body: box, origin: [0, 180]}
"""
            + extra,
            "held.yaml",
        )
    )


def test_positions_hold_at_the_configuration_of_the_overlay(tmp_path: Path) -> None:
    mechanism = grasp(tmp_path)
    assert [c.name for c in mechanism.contacts] == ["cl", "cr"]
    assert all(residual.gap < 1e-15 for residual in mechanism.residuals())
    points = [mechanism.body_poses()[c.first].apply(c.frame_on_first.position) for c in mechanism.contacts]
    sine, cosine = 0.5, np.sqrt(0.75)
    np.testing.assert_allclose(points[0], [-1 + 2 * sine, 2 * cosine], atol=1e-15)
    np.testing.assert_allclose(mechanism.body["box"].pose.position, [0, 1.8], atol=1e-15)
    reference = mechanism.reference
    assert reference is not None
    np.testing.assert_allclose(reference.origin, [0, 0], atol=1e-15)
    assert mechanism.residuals({"left": 0.1})[0].gap > 0.01  # the gear keeps the zero of the base


def test_what_the_overlay_does_not_name_stays(tmp_path: Path) -> None:
    assert grasp(tmp_path).active == ("left",)
    assert grasp(tmp_path).couplings[0].name == "gear"
    changed = grasp(tmp_path, "motors: [right]\nlock: [left]\n")
    assert changed.active == ("right",)
    assert changed.lock == ("left",)


def test_parameters_of_the_base_can_be_set(tmp_path: Path) -> None:
    grasp(tmp_path)
    wide = vc.load(tmp_path / "held.yaml", {"w": 1.5})
    np.testing.assert_allclose(wide.joints[0].frame_on_first.position, [-1.5, 0])
    with pytest.raises(vc.UnknownNameError, match="no parameter is named 'v'"):
        vc.load(tmp_path / "held.yaml", {"v": 1.0})


def test_overlays_on_overlays_and_on_examples(tmp_path: Path) -> None:
    grasp(tmp_path)
    text = "vincula: 1\nbase: held.yaml\n"
    text += "contacts:\n  - {name: wall, type: point, bodies: [ground, box], at: [0, 2], "
    three = vc.load(write(tmp_path, text + "normal: [0, -1]}\n", "wall.yaml"))
    assert len(three.contacts) == 3
    text = "vincula: 1\nbase: example:five-bar\nmotors: [o2, o4]\n"
    five = vc.load(write(tmp_path, text, "five.yaml"))
    assert five.active == ("o2", "o4")
    assert five.reference is not None


def test_new_joints_on_a_moved_base(tmp_path: Path) -> None:
    """A joint drawn where the base has moved to is the same as in a file drawn there."""
    write(tmp_path, FIVE_BAR, "five.yaml")
    overlay = """
vincula: 1
base: five.yaml
joints: [{name: tool, type: revolute, bodies: [coupler, gripper], at: [-0.5, 0.5]}]
configuration: {tool: 0.25}
reference: {body: gripper, origin: [0, 1]}
"""
    found = vc.load(write(tmp_path, overlay, "tool.yaml"))
    drawn = FIVE_BAR.replace(
        "motors:", "  - {name: tool, type: revolute, bodies: [coupler, gripper], at: [-0.5, 0.5]}\nmotors:"
    )
    drawn = (
        drawn[: drawn.index("reference:")]
        + "configuration: {tool: 0.25}\nreference: {body: gripper, origin: [0, 1]}\n"
    )
    whole = vc.load(write(tmp_path, drawn, "whole.yaml"))
    np.testing.assert_allclose(
        found.linearize().jacobian_passive, whole.linearize().jacobian_passive, atol=1e-15
    )
    assert found.home["tool"][0] == 0.25


def test_the_report_of_the_base_is_part_of_the_report(tmp_path: Path) -> None:
    grasp(tmp_path)
    _, report = load_with_report(tmp_path / "held.yaml")
    assert report.counts()["joint"]["used"] == 2
    assert report.counts()["contact"]["used"] == 2
    assert report.units.angle == "deg"


def test_a_circle_of_bases_is_refused(tmp_path: Path) -> None:
    write(tmp_path, "vincula: 1\nbase: b.yaml\n", "a.yaml")
    write(tmp_path, "vincula: 1\nbase: a.yaml\n", "b.yaml")
    with pytest.raises(vc.FileError, match="the file is its own base"):
        vc.load(tmp_path / "a.yaml")


def test_reference_to_a_site_and_a_frame_of_the_base(models: Path, tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    base = models / "robotiq_2f85_menagerie" / "2f85_nomesh.xml"
    text = f"vincula: 1\nbase: {base}\nreference: {{body: base, origin: {{in: pinch, xyz: [0, 0, 0]}}}}\n"
    mechanism = vc.load(write(tmp_path, text))
    site = next(frame for frame in mechanism.frames if frame.name == "pinch")
    reference = mechanism.reference
    assert reference is not None
    np.testing.assert_allclose(reference.origin, site.pose.position, atol=1e-15)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert mechanism.active


def test_motors_of_the_overlay_replace_those_of_the_base_in_the_report_too(tmp_path: Path) -> None:
    base = write(tmp_path, FIVE_BAR, "base.yaml")
    for motors, used, ignored in (("", ["o1", "o5"], []), ("motors: [o2]\n", ["o2"], ["o1", "o5"])):
        path = write(tmp_path, f"vincula: 1\nbase: {base.name}\n{motors}", "over.yaml")
        mechanism, report = load_with_report(path)
        fates = {fate: [e.name for e in report.entries if (e.kind, e.fate) == ("motor", fate)]
                 for fate in ("used", "ignored")}  # fmt: skip
        assert fates == {"used": used, "ignored": ignored}
        assert list(mechanism.active) == used
