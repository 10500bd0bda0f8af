"""`vincula close`, `--close` and `--ground`: what is moved is said, what cannot close is explained."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest

import vincula as vc

FIVE_BAR = "example:five-bar"


def test_the_page(run) -> None:
    text = run("close", FIVE_BAR, "--motors", "o1=-0.2,o5=-0.1").stdout
    for part in (
        "five-bar  closed",
        "residual",
        "assembly +, working ++",
        "singular",
        "motor, held",
        "--at 'o1=-0.2",
    ):
        assert part in text, part


def test_json_is_what_the_library_says(run_json) -> None:
    found = run_json("close", FIVE_BAR, "--motors", "o1=-0.2,o5=-0.1")
    q = vc.load(FIVE_BAR).close(motors={"o1": -0.2, "o5": -0.1})
    assert found["schema"] == "vincula/closure/1"
    assert found["configuration"] == {name: float(value[0]) for name, value in q.items()}
    assert found["residual"] == q.residual < 1e-14
    assert found["branch"] == {"assembly": "+", "working": "++"}
    assert found["held"] == ["o1", "o5"]
    assert found["singular"] is False
    assert found["free_motions"] == 0
    assert found["moved"] == {name: q.moved[name] for name in q.moved}


def test_a_start_is_moved_as_little_as_possible(run_json) -> None:
    found = run_json("close", FIVE_BAR, "--at", "o1=0.3")
    assert 0.0 < found["configuration"]["o1"] < 0.3
    assert found["free_motions"] == 2


def test_holding_the_start(run_json) -> None:
    found = run_json("close", FIVE_BAR, "--at", "o1=-0.3,o3=0.1", "--hold", "o1")
    assert found["configuration"]["o1"] == -0.3
    assert found["configuration"]["o3"] != 0.1
    motors = run_json("close", FIVE_BAR, "--at", "o1=-0.3", "--hold", "motors")
    assert motors["held"] == ["o1", "o5"]
    assert motors["configuration"]["o5"] == 0.0


def test_the_written_configuration_is_read_back(run, run_json, tmp_path: Path) -> None:
    file = tmp_path / "closed.json"
    run("close", "example:stewart", "--pose", "0,0,2.1,1,0,0,0.05", "-o", str(file))
    again = run_json("close", "example:stewart", "--at", str(file))
    assert again["iterations"] == 1
    assert again["configuration"] == json.loads(file.read_text())
    analysis = run_json("analyze", "example:stewart", "--at", str(file))
    assert analysis["closure"]["residual"] < 1e-13


def test_values_are_in_the_units_of_the_file(run_json, tmp_path: Path) -> None:
    file = tmp_path / "slider.yaml"
    file.write_text(
        """vincula: 1
space: planar
units: {length: mm, angle: deg}
joints:
  - {name: crank, type: revolute, bodies: [ground, arm], at: [0, 0]}
  - {name: pin, type: revolute, bodies: [arm, rod], at: [100, 0]}
  - {name: end, type: revolute, bodies: [rod, slider], at: [400, 0]}
  - {name: rail, type: prismatic, bodies: [ground, slider], at: [400, 0], axis: [1, 0]}
motors: [crank]
reference: {body: slider}
"""
    )
    found = run_json("close", str(file), "--motors", "crank=90")
    assert found["units"] == {"length": "mm", "angle": "deg"}
    assert found["configuration"]["crank"] == 90.0
    assert found["configuration"]["rail"] == pytest.approx(math.sqrt(300**2 - 100**2) - 400, abs=1e-9)
    assert found["configuration"]["pin"] == pytest.approx(-90 - math.degrees(math.asin(1 / 3)), abs=1e-9)


def test_assembly_modes(run, run_json) -> None:
    found = run_json("close", FIVE_BAR, "--modes", "--motors", "o1=-0.2,o5=-0.1", "--starts", "20")
    assert found["schema"] == "vincula/modes/1"
    assert sorted(mode["branch"]["assembly"] for mode in found["modes"]) == ["+", "-"]
    text = run("close", FIVE_BAR, "--modes", "--starts", "20").stdout
    assert "2 assembly modes from 20 starts" in text


def test_what_cannot_close_is_refused_with_its_lengths(run) -> None:
    for words in (("--modes", "--starts", "5"), ()):
        result = run("close", FIVE_BAR, "--motors", "o1=0.4,o5=0", *words, code=1)
        assert result.stdout == ""
        assert "cannot close: loop 'o3' is open by" in result.stderr
        assert "Lengths that cannot meet: o4 to o2" in result.stderr


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--motors", "o7=1"), "--motors: no joint"),
        (("--motors", "o1"), "--motors: cannot read"),
        (("--hold", "o7"), "--hold: no motor, joint or axis"),
        (("--point", "1,2,3"), "expected x,y"),
        (("--pose", "0,0,zero"), "expected x,y,angle"),
        (("--point", "0,0", "--pose", "0,0,0"), "not both"),
        (("--ground", "nobody"), "--ground: no body"),
    ],
)
def test_bad_usage(run, words: tuple[str, ...], message: str) -> None:
    assert message in run("close", FIVE_BAR, *words, code=2).stderr


def test_analyze_refuses_open_loops_unless_asked_to_close(run, run_json) -> None:
    refusal = run("analyze", FIVE_BAR, "--at", "o1=-0.1", code=1).stderr
    assert "nothing was moved. The closest closed configuration found moves o1 by" in refusal
    assert "--close closes it" in refusal
    hopeless = run("analyze", FIVE_BAR, "--at", "o1=0.1", "--lock", "o1,o2,o3", code=1).stderr
    assert "It cannot be closed from here" in hopeless
    assert "Lengths that cannot meet: o5 to o4" in hopeless
    result = run("analyze", FIVE_BAR, "--at", "o1=-0.1", "--close", "--json")
    assert "closing moved" in result.stderr
    found = json.loads(result.stdout)
    mechanism = vc.load(FIVE_BAR)
    q = mechanism.close({"o1": -0.1}, motors={"o1": -0.1})
    expected = vc.analyze(mechanism.linearize(q)).to_dict()
    assert found["kinematic"]["efficiencies"] == expected["kinematic"]["efficiencies"]


def test_named_joints_are_let_go_only_where_they_must_be(run) -> None:
    result = run("analyze", FIVE_BAR, "--at", "o1=0.4,o5=0.4", "--close")
    assert "o1, o5 could not stay at the values of --at" in result.stderr
    assert "closing moved" in result.stderr


def test_a_leg_seen_from_the_trunk(run_json) -> None:
    found = run_json(
        "analyze", "example:quadruped", "--ground", "trunk", "--reference", "fl_shank",
        "--active", "fl_roll,fl_pitch,fl_knee",
    )  # fmt: skip
    assert found["frame"] == "ground axes"
    assert any(
        "trunk is the ground" in note
        for note in run_json("inspect", "example:quadruped", "--ground", "trunk")["notes"]
    )
