"""`vincula inspect`: what a newcomer sees of a file, and what it refuses to hide."""

from __future__ import annotations

from pathlib import Path

import pytest

from vincula.cli.inspection_page import SCREEN
from vincula.mechanism.catalog.registry import MODULES, example

FIVE_BAR = "example:five-bar"


def test_the_page_of_the_five_bar(run) -> None:
    text = run("inspect", FIVE_BAR).stdout
    for part in (
        "five-bar", "planar", "crank, coupler, link, rocker", "5 revolute", "o1, o5", "o2, o3, o4",
        "1, closed", "2 independent motions", "coupler", "ground axes",
        "ground -o1- crank -o2- coupler -o3- link -o4- rocker -o5- ground", "motor", "passive",
    ):  # fmt: skip
        assert part in text, part


@pytest.mark.parametrize("name", MODULES)
def test_every_example_fits_a_screen(run, monkeypatch, name: str) -> None:
    monkeypatch.setenv("COLUMNS", "100")
    text = run("inspect", f"example:{name}").stdout
    assert len(text.splitlines()) <= 42
    assert max(map(len, text.splitlines())) <= 100


def test_json(run_json) -> None:
    found = run_json("inspect", FIVE_BAR)
    assert found["schema"] == "vincula/inspection/1"
    assert [body["name"] for body in found["bodies"]] == ["crank", "coupler", "link", "rocker"]
    assert found["joints"][0] == {
        "name": "o1", "type": "revolute", "between": ["ground", "crank"], "closes_loop": False,
        "axes": [{"name": "o1", "state": "motor", "unit": "rad"}], "values": [0.0], "limits": [],
    }  # fmt: skip
    assert found["loops"] == [
        {
            "closed_by": "o3",
            "bodies": ["ground", "crank", "coupler", "link", "rocker"],
            "parts": ["o1", "o2", "o3", "o4", "o5"],
        }
    ]
    assert found["mobility"] == {"motions": 2, "status": "certain", "reason": None}
    assert found["reference"] == {"body": "coupler", "point": [-0.5, 0.0], "axes": "ground"}
    assert found["closure"]["open"] == []


@pytest.mark.parametrize("name", MODULES)
def test_mobility_is_that_of_the_analysis(run_json, name: str) -> None:
    found = run_json("inspect", f"example:{name}")
    assert found["mobility"]["motions"] == example(name).linearize().ledger.summary.mobility


def test_motors_and_locks_of_the_command_line(run_json) -> None:
    found = run_json("inspect", FIVE_BAR, "--active", "o2", "--lock", "o4")
    states = {axis["name"]: axis["state"] for joint in found["joints"] for axis in joint["axes"]}
    assert states == {"o1": "passive", "o2": "motor", "o3": "passive", "o4": "locked", "o5": "passive"}


def test_an_open_loop_is_shown_not_refused(run, run_json) -> None:
    text = run("inspect", FIVE_BAR, "--at", "o1=0.3").stdout
    assert "not closed at this configuration" in text
    assert "open: o3 by" in text
    assert "--close" in text
    assert "not known: loops are open" in text
    found = run_json("inspect", FIVE_BAR, "--at", "o1=0.3")
    (gap,) = found["closure"]["open"]
    assert gap["gap"] > found["closure"]["allowed"]
    assert found["mobility"]["motions"] is None


@pytest.fixture
def bare(tmp_path: Path) -> str:
    """A native four-bar without a reference member."""
    file = tmp_path / "four-bar.yaml"
    file.write_text(
        "vincula: 1\nspace: planar\njoints:\n"
        "  - {name: a, type: revolute, bodies: [ground, crank], at: [0, 0]}\n"
        "  - {name: b, type: revolute, bodies: [crank, coupler], at: [0, 1]}\n"
        "  - {name: c, type: revolute, bodies: [coupler, rocker], at: [2, 2]}\n"
        "  - {name: d, type: revolute, bodies: [rocker, ground], at: [2, 0]}\n"
        "motors: [a]\n",
        encoding="utf-8",
    )
    return str(file)


def test_without_a_reference_member_the_next_step_is_told(run, run_json, bare: str) -> None:
    text = run("inspect", bare).stdout
    assert "none yet" in text
    assert f"vincula analyze {bare} --reference BODY" in " ".join(text.split())
    assert "crank, coupler, rocker" in text
    assert run_json("inspect", bare)["mobility"]["motions"] == 1


def test_the_load_report_adds_up(run_json, bare: str) -> None:
    load = run_json("inspect", bare)["load"]
    for count in load["counts"].values():
        assert count["total"] == count["used"] + count["ignored"] + count["repaired"]
    assert sum(count["total"] for count in load["counts"].values()) >= 4


def test_long_tables_are_cut_and_all_shows_them(run) -> None:
    short = run("inspect", "example:stewart").stdout
    assert "--all shows them" in short
    long = run("inspect", "example:stewart", "--all").stdout
    assert "--all" not in long
    assert long.count("soft-finger") > short.count("soft-finger")


@pytest.mark.parametrize("columns", [80, 120])
@pytest.mark.parametrize(
    "path",
    [
        "robotiq_2f85_menagerie/2f85_nomesh.xml",
        "aloha_mink/aloha_nomesh.xml",
        "leap_hand_mink/right_hand_nomesh.xml",
        "unitree_go1_mink/go1_nomesh.xml",
        "stewart_sdf/stewart_from_sdf.xml",
        "stewart_sdf/model.sdf",
        "gepetto_cassie_like/robot_nomesh.urdf",
        "gepetto_robot_delta/robot_nomesh.urdf",
        "gepetto_5bar_linkage_iso6d/robot_nomesh.urdf",
        "drake_four_bar/four_bar_weld.sdf",
    ],
)
def test_real_robots_fit_a_screen(
    run, run_json, models: Path, monkeypatch, tmp_path: Path, path: str, columns: int
) -> None:
    file = models / path
    if not file.exists():
        pytest.skip(f"{path} is not there")
    if file.suffix == ".xml":
        pytest.importorskip("mujoco")
    monkeypatch.chdir(file.parent)
    monkeypatch.setenv("COLUMNS", str(columns))
    lines = run("inspect", file.name).stdout.splitlines()
    assert len(lines) <= SCREEN
    assert max(map(len, lines)) <= columns
    assert run_json("inspect", file.name)["load"]["counts"]


def test_the_ground_under_the_name_that_the_file_gives_it(run, run_json, leg: str) -> None:
    """The root link of a URDF is the ground: to ask for it changes nothing, to move it is refused."""
    as_drawn = run_json("inspect", leg)
    again = run_json("inspect", leg, "--ground", "trunk")
    assert again["joints"] == as_drawn["joints"]
    result = run("analyze", leg, "--reference", "trunk", code=2)
    assert "'trunk' is part of the ground here and cannot move" in result.stderr
    assert "--ground BODY --reference world@trunk" in result.stderr
    turned = run_json("analyze", leg, "--ground", "foot", "--reference", "world@trunk")
    assert turned["mobility"]["nullity"] == 1


@pytest.fixture
def leg(tmp_path: Path) -> str:
    """A trunk and a foot."""
    file = tmp_path / "leg.urdf"
    file.write_text(
        '<robot name="leg"><link name="trunk"/><link name="foot"/><joint name="hip" type="revolute">'
        '<parent link="trunk"/><child link="foot"/><axis xyz="0 1 0"/><origin xyz="0 0 -1"/>'
        '<limit effort="1" velocity="1" lower="-1" upper="1"/></joint></robot>',
        encoding="utf-8",
    )
    return str(file)


def test_a_side_file_given_alone_is_recognised(run, tmp_path: Path) -> None:
    file = tmp_path / "robot.yaml"
    file.write_text("closed_loop: [[a, b]]\ntype: [3d]\nname_mot: [m]\n", encoding="utf-8")
    assert "name the URDF file beside it" in run("inspect", str(file), code=2).stderr
