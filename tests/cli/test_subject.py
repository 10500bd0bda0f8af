"""What the options mean: bodies, points, frames, tolerances, units, quoted names."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import vincula as vc
from vincula.cli.exits import BadOptionError
from vincula.cli.subject import split_reference, tolerances, with_reference
from vincula.errors import UnknownNameError
from vincula.mechanism.mechanism import Mechanism


@pytest.fixture
def arm() -> Mechanism:
    """A two-joint arm whose names hold an @ and whose frames look like numbers."""
    from dataclasses import replace

    from vincula.mechanism.parts import Frame
    from vincula.spatial.poses import Pose

    mechanism = vc.Mechanism.planar(
        joints=[
            vc.Revolute("j1", "ground", "upper@left", at=(0, 0)),
            vc.Revolute("j2", "upper@left", "hand", at=(1, 0)),
        ]
    )
    tip = Pose(np.eye(2), np.array([2.0, 0.0]))
    frames = (Frame("tip", "hand", tip), Frame("1,2", "hand", tip))
    return replace(mechanism, frames=frames)


@pytest.mark.parametrize(
    ("text", "parts"),
    [
        ("hand", ("hand", None, None)),
        ("hand@tip", ("hand", None, "tip")),
        ("hand@0.5,-1e-3", ("hand", [0.5, -1e-3], None)),
        ("hand@1,2", ("hand", None, "1,2")),
        ("upper@left", ("upper@left", None, None)),
        ("upper@left@0,1", ("upper@left", [0.0, 1.0], None)),
        ("hand@nosuch", ("hand", None, "nosuch")),
    ],
)
def test_reference_texts(arm: Mechanism, text: str, parts: tuple[object, ...]) -> None:
    assert split_reference(arm, text) == parts


def test_a_frame_instead_of_a_body_gets_the_right_words(arm: Mechanism) -> None:
    with pytest.raises(BadOptionError, match="say --reference hand@tip"):
        split_reference(arm, "tip")
    with pytest.raises(UnknownNameError, match="did you mean 'hand'"):
        split_reference(arm, "hnad")


def test_axes_alone_keep_member_and_point(arm: Mechanism) -> None:
    chosen = with_reference(arm, "hand@tip", None)
    assert chosen.reference is not None
    turned = with_reference(chosen, None, "body")
    assert turned.reference is not None
    assert (turned.reference.body, turned.reference.axes) == ("hand", "body")
    np.testing.assert_array_equal(turned.reference.origin, chosen.reference.origin)
    again = with_reference(turned, "hand", None)
    assert again.reference is not None
    assert again.reference.axes == "body"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("0.1mm", (1e-4, 0.0)),
        ("0.001", (1e-3, 0.0)),
        ("0.5rad", (0.0, 0.5)),
        ("0.1mm, 180deg", (1e-4, np.pi)),
        ("180deg,1cm", (1e-2, np.pi)),
    ],
)
def test_tolerances(text: str, expected: tuple[float, float]) -> None:
    assert tolerances(text) == pytest.approx(expected)


@pytest.mark.parametrize("text", ["", "x", "1mm,2mm", "-1mm", "nan", "1kg"])
def test_bad_tolerances(text: str) -> None:
    with pytest.raises(BadOptionError, match="tolerance"):
        tolerances(text)


NATIVE = """\
vincula: 1
space: planar
units: {length: mm, angle: deg}
parameters: {l: 1000}
joints:
  - {name: "turn, fast", type: revolute, bodies: [ground, arm], at: [0, 0]}
  - {name: slide.r, type: prismatic, bodies: [arm, hand], at: ["$l", 0], axis: [1, 0]}
motors: ["turn, fast", slide.r]
reference: {body: hand, origin: ["$l", 0]}
"""


@pytest.fixture
def native(tmp_path: Path) -> str:
    file = tmp_path / "arm.yaml"
    file.write_text(NATIVE, encoding="utf-8")
    return str(file)


def test_configurations_are_in_the_units_of_the_file(run_json, native: str) -> None:
    found = run_json("inspect", native, "--at", '"turn, fast"=90,slide.r=500')
    values = {joint["name"]: joint["values"][0] for joint in found["joints"]}
    assert values == pytest.approx({"turn, fast": np.pi / 2, "slide.r": 0.5})
    position = {body["name"]: body["position"] for body in found["bodies"]}
    assert np.isfinite(position["hand"]).all()
    # At 90 degrees and 0.5 m out, the hand's point is 1.5 m above the pivot: a turn moves it sideways.
    turned = run_json("analyze", native, "--at", '"turn, fast"=90,slide.r=500')
    np.testing.assert_allclose(np.array(turned["maps"]["twist_from_rates"])[:, 0], [-1.5, 0, 1], atol=1e-12)


def test_names_with_commas_and_dots(run_json, native: str) -> None:
    assert run_json("analyze", native, "--active", '"turn, fast",slide.r')["active"] == [
        "turn, fast",
        "slide.r",
    ]
    assert run_json("analyze", native, "--lock", '"turn, fast"')["active"] == ["slide.r"]


def test_parameters_of_a_native_file(run_json, native: str) -> None:
    for value in ("2000", "2m", "200cm"):
        found = run_json("analyze", native, "--set", f"l={value}")
        np.testing.assert_allclose(np.array(found["maps"]["twist_from_rates"])[:, 0], [0, 2, 1], atol=1e-12)


def test_a_configuration_file(run_json, native: str, tmp_path: Path) -> None:
    at = tmp_path / "at.json"
    at.write_text('{"slide.r": 250}', encoding="utf-8")
    found = run_json("inspect", native, "--at", str(at))
    assert found["joints"][1]["values"] == pytest.approx([0.25])


def test_keyframes_of_a_robot_file(run_json, models: Path) -> None:
    pytest.importorskip("mujoco")
    robot = str(models / "unitree_go1_mink" / "go1_nomesh.xml")
    found = run_json("inspect", robot, "--at", "key:home")
    values = {joint["name"]: joint["values"] for joint in found["joints"]}
    assert values["FR_thigh_joint"] == pytest.approx([0.9])


def test_at_of_the_whole_file_goes_with_another_ground(run, run_json, tmp_path: Path) -> None:
    """`close -o` writes the pose of a floating base too; seen from the base, the floor moves instead."""
    file = str(tmp_path / "closed.json")
    lifted = "float=[0.1,0,0.05,0.9921977,0,0.1246747,0]"  # by a quarter of a radian
    run("close", "example:quadruped", "--at", lifted, "-o", file)
    whole = json.loads(Path(file).read_text(encoding="utf-8"))
    assert abs(whole["float"][0]) > 0.01
    assert any(abs(value) > 0.01 for name, value in whole.items() if name != "float")
    words = ["analyze", "example:quadruped", "--ground", "trunk", "--reference", "fl_shank"]
    joints = ",".join(f"{name}={value!r}" for name, value in whole.items() if name != "float")
    alone = run_json(*words, "--at", joints, "--close")
    there = run_json(*words, "--at", file)
    assert there["closure"]["residual"] < 1e-9
    assert there["kinematic"]["efficiencies"] == pytest.approx(alone["kinematic"]["efficiencies"], rel=1e-6)
