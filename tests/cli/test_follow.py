"""`vincula follow`: table, CSV, pictures, and what it says where it stops."""

from __future__ import annotations

import csv
import itertools
from pathlib import Path

import numpy as np
import pytest

import vincula as vc

FIVE_BAR = "example:five-bar"


def test_to_the_end(run, run_json) -> None:
    words = ("follow", FIVE_BAR, "--to", "o1=-0.4,o5=0.1", "--to", "o1=0,o5=0", "--steps", "8")
    found = run_json(*words)
    assert found["schema"] == "vincula/path/1"
    assert found["complete"] is True
    assert found["stopped"] is None
    assert len(found["points"]) == len(found["frames"]) == 9
    path = vc.load(FIVE_BAR).follow([{"o1": -0.4, "o5": 0.1}, {"o1": 0.0, "o5": 0.0}], samples=8)
    for point, q in zip(found["points"], path, strict=True):
        assert point["configuration"] == {name: float(value[0]) for name, value in q.items()}
    text = run(*words).stdout
    assert "followed to the end" in text
    assert "o1, o5" in text


def test_stops_at_a_singularity_and_names_it(run, run_json) -> None:
    found = run_json("follow", FIVE_BAR, "--to", "o1=0.4", code=1)
    stop = found["stopped"]
    assert stop["kind"] == "singularity"
    assert [s["kind"] for s in stop["singularities"]] == ["platform free"]
    assert stop["joints"] == ["o3", "o2", "o4"]
    assert stop["configuration"]["o1"] == pytest.approx(0.10116926080649125, abs=1e-12)
    assert stop["passable"] is False
    text = run("follow", FIVE_BAR, "--to", "o1=0.4", code=1).stdout
    assert "'coupler' becomes free" in text
    assert "It cannot be passed" in text


def test_passing_a_singularity(run, run_json) -> None:
    words = ("follow", FIVE_BAR, "--point", "-0.5,-0.3", "--point", "0.3,-0.3")
    assert "--through platform passes it" in run(*words, code=1).stdout
    found = run_json(*words, "--through", "platform")
    assert found["complete"] is True
    assert len(found["passed"]) == 2
    assert found["held"] == ["(position of the reference point)"]


def test_a_path_from_a_file_and_a_table_of_it(run, run_json, tmp_path: Path) -> None:
    values = tmp_path / "path.csv"
    values.write_text("o1,o5\n-0.1,0.1\n-0.2,0.1\n")
    table = tmp_path / "table.csv"
    run("follow", FIVE_BAR, "--path", str(values), "--csv", str(table))
    with table.open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert [float(row["o1"]) for row in rows] == [0.0, -0.1, -0.2]
    assert list(rows[0]) == [
        "parameter",
        "o1",
        "o2",
        "o3",
        "o4",
        "o5",
        "residual",
        "margin",
        "efficiency1",
        "efficiency2",
    ]
    assert all(float(row["residual"]) < 1e-12 for row in rows)
    found = run_json("follow", FIVE_BAR, "--path", str(values))
    assert float(rows[2]["o3"]) == found["points"][2]["configuration"]["o3"]


def test_balls_have_a_column_a_value(run, tmp_path: Path) -> None:
    table = tmp_path / "table.csv"
    run("follow", "example:stewart", "--pose", "0,0,2.05,1,0,0,0", "--csv", str(table))
    header = table.read_text().splitlines()[0].split(",")
    assert header[1:6] == ["b1[0]", "b1[1]", "b1[2]", "b1[3]", "p1"]


def test_pictures(run, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    run("follow", FIVE_BAR, "--to", "o1=-0.2", "--steps", "2", "--frames", str(tmp_path / "frames"),
        "--frame-format", "svg")  # fmt: skip
    assert [p.name for p in sorted((tmp_path / "frames").iterdir())] == [
        "frame-1.svg", "frame-2.svg", "frame-3.svg"
    ]  # fmt: skip


def test_limits_stop_unless_they_are_ignored(run_json, tmp_path: Path) -> None:
    file = tmp_path / "arm.urdf"
    file.write_text(
        """<robot name="arm"><link name="base"/><link name="tip"/>
  <joint name="j" type="revolute"><parent link="base"/><child link="tip"/><axis xyz="0 0 1"/>
    <limit lower="-0.5" upper="0.5" effort="1" velocity="1"/></joint></robot>"""
    )
    found = run_json("follow", str(file), "--to", "j=0.9", code=1)
    assert found["stopped"]["kind"] == "limit"
    assert found["stopped"]["axis"] == "j"
    assert found["points"][-1]["configuration"]["j"] == pytest.approx(0.5, abs=1e-12)
    assert run_json("follow", str(file), "--to", "j=0.9", "--no-limits")["complete"] is True


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ((), "one of --to, --path, --point and --pose"),
        (("--to", "o1=0.1", "--point", "0,0"), "one of --to, --path, --point and --pose"),
        (("--path", "nowhere.csv"), "there is no such file"),
        (("--to", "o9=1"), "--to: no joint"),
    ],
)
def test_bad_usage(run, words: tuple[str, ...], message: str) -> None:
    assert message in run("follow", FIVE_BAR, *words, code=2).stderr


def test_bad_tables(run, tmp_path: Path) -> None:
    table = tmp_path / "bad.csv"
    for text, message in (
        ("o1\n", "a row of names"),
        ("o1,o5\n0.1\n", "bad.csv:2: 1 values for 2 names"),
        ("o1\nfast\n", "bad.csv:2"),
        ("o9\n0.1\n", "bad.csv:2: no joint"),
    ):
        table.write_text(text)
        assert message in run("follow", FIVE_BAR, "--path", str(table), code=2).stderr


def test_efficiencies_keep_their_place_along_the_path(run_json, tmp_path: Path) -> None:
    file = tmp_path / "path.csv"
    words = ("follow", "example:five-bar", "--to", "o1=-0.4,o5=0.3", "--steps", "60", "--csv", str(file))
    found = [point["efficiencies"] for point in run_json(*words)["points"]]
    # At home they are those of the analysis, and along the path nothing jumps.
    assert found[0] == pytest.approx([9.7365, 0.5135], abs=5e-4)
    for before, after in itertools.pairwise(found):
        for one, other in zip(before, after, strict=True):
            assert abs(other - one) < 0.25 * abs(one)
    header, first = file.read_text().splitlines()[:2]
    assert header.endswith("margin,efficiency1,efficiency2")
    assert [float(x) for x in first.split(",")[-2:]] == pytest.approx(found[0])


@pytest.mark.parametrize(("name", "to"), [("five-bar", "o1=-0.4,o5=0.3"), ("delta", "a1=0.3,a2=-0.1,a3=0.2")])
def test_directions_are_carried_along_and_belong_together(
    run_json, tmp_path: Path, name: str, to: str
) -> None:
    """At every point the mechanism makes of a motor direction its task direction times a root."""
    file = tmp_path / "path.csv"
    words = ("follow", f"example:{name}", "--to", to, "--steps", "20", "--csv", str(file), "--directions")
    points = run_json(*words)["points"]
    robot = vc.load(f"example:{name}")
    for point in points:
        model = robot.linearize(robot.configuration(point["configuration"]))
        twist_from_rates = np.array(vc.analyze(model).to_dict()["maps"]["twist_from_rates"])
        for value, motors, task in zip(
            point["efficiencies"], point["motor_directions"], point["task_directions"], strict=True
        ):
            assert twist_from_rates @ motors == pytest.approx(np.sqrt(value) * np.array(task), abs=1e-9)
    for before, after in itertools.pairwise(points):
        for one, other in zip(before["motor_directions"], after["motor_directions"], strict=True):
            assert np.dot(one, other) > 0.9
    rows = list(csv.DictReader(file.read_text().splitlines()))
    active = robot.active
    for row, point in zip(rows, points, strict=True):
        assert [float(row[f"motors1[{axis}]"]) for axis in active] == point["motor_directions"][0]
        told = [float(row[f"task2[{c}]"]) for c in robot.space.twist_components]
        assert told == point["task_directions"][1]
