"""DESIGN.yaml and `vincula design`: what is read, what is refused where, what is written."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import vincula as vc
from vincula.cli.main import cli, finished

GOOD = """\
design: 1
model: linkage.yaml
variables:
  left: {from: -1.5, to: -0.7, tolerance: 5mm}
  right: {from: 80cm, to: 150cm, start: 100cm}
ties:
  "joints[o1]/at[0]": $left
  "joints[o5]/at[0]": $right
objectives: {quantity: "kinematic.condition:translation", over: mean}
constraints:
- {value: $right - $left, most: 2.9, label: room}
search: {seed: 1, population: 6, generations: 1, samples: 4}
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    vc.save(vc.load("example:five-bar"), tmp_path / "linkage.yaml")
    (tmp_path / "design.yaml").write_text(GOOD)
    return tmp_path


def test_any_number_of_the_file_by_its_path(folder: Path) -> None:
    problem = vc.read_design(folder / "design.yaml").problem
    problem.path = "reference"
    assert problem.space.start == pytest.approx([-1.1, 1.0])
    assert problem.space.variables[1].unit == "cm"
    same = vc.load("example:five-bar")
    assert problem.mechanism([-1.0, 1.0]).linearize().jacobian_active == pytest.approx(
        same.linearize().jacobian_active
    )
    judged = problem.judge([[-1.0, 1.0], [-1.5, 1.45]])
    expected = vc.condition_number(vc.kinematic_ellipsoid(same.linearize()), "translation")
    assert judged.objectives[0, 0] == pytest.approx(expected)
    assert judged.counted(problem.names_of_constraints) == {"room": 1}


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("joints[o5]", "joints[o6]", r"8:23: .*did you mean 'joints\[o5\]/at\[0\]'"),
        ("-1.5, to: -0.7", "-0.5, to: -0.7", "4:9: variables/left: .*crossed"),
        ("$right - $left", "$right % $left", "constraints.*not in the grammar"),
        ("$right - $left", "$rigth - $left", "did you mean 'right'"),
        ("over: mean", "ovr: mean", "9:.*unknown key 'ovr'.*did you mean 'over'"),
        ("design: 1", "desing: 1", "expected the key `design: 1`"),
        ("linkage.yaml", "example:fivebar", "2:8: model: .*did you mean 'five-bar'"),
        ("condition:translation", "condtion:translation", "objectives.*no quantity is named"),
        ("to: 150cm", "to: 1.5", "5:2.*got 1.5 beside a bound in cm: give it a unit too"),
        ("to: 150cm", "to: 150deg", "5:2.*a length is no angle"),
        ("5mm}", "5deg, start: 1m}", "4:6.*got 1m beside values in deg|got 5deg beside values in m"),
        ("ties:", "active: []\nties:", "6:9: active: no motors"),
        ("ties:", "active: o1,o9\nties:", "6:9: active: no motor, joint or axis is named 'o9'"),
        ("ties:", "reference: couple\nties:", "6:12: reference: .*did you mean 'coupler'"),
    ],
)
def test_what_is_refused_has_a_place(folder: Path, old: str, new: str, words: str) -> None:
    (folder / "bad.yaml").write_text(GOOD.replace(old, new))
    with pytest.raises(vc.FileError, match=words):
        vc.read_design(folder / "bad.yaml")


def test_an_angle_is_no_length(folder: Path) -> None:
    text = GOOD.replace("left: {from: -1.5, to: -0.7, tolerance: 5mm}",
                        'left: {from: -90deg, to: 0, sets: "joints[o1]/at[0]"}')  # fmt: skip
    (folder / "bad.yaml").write_text(text.replace('  "joints[o1]/at[0]": $left\n', ""))
    with pytest.raises(vc.FileError, match="is a length, and the bounds are in deg"):
        vc.read_design(folder / "bad.yaml")


def test_a_cost_that_is_infinite_everywhere_says_why(folder: Path) -> None:
    """One motor for two motions: the coupler is loose in every design."""
    (folder / "loose.yaml").write_text(GOOD.replace("ties:", "active: [o1]\nties:"))
    problem = vc.read_design(folder / "loose.yaml").problem.by_reference()
    words = "'no finite cost' killed 13.*moves in 1 way with all motors locked: give .* more motors"
    with pytest.raises(vc.DesignError, match=words):
        problem.optimize(population=6, generations=1, polish=False)


def test_the_command_writes_what_analyze_reads(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(folder)
    command = ["design", "design.yaml", "--path", "reference", "--json", "--log", "log.db", "-o", "best.yaml",
               "--data", "all.csv", "--figure", "best.svg"]  # fmt: skip
    first = CliRunner().invoke(cli, command, catch_exceptions=False)
    assert first.exit_code == 0, first.output
    report = json.loads(first.stdout)
    assert report["schema"] == "vincula/design/1"
    best = vc.load("best.yaml")
    again = vc.condition_number(vc.kinematic_ellipsoid(best.linearize()), "translation")
    assert report["best"]["value"] == pytest.approx(again, rel=1e-6)
    assert report["best"]["value"] < report["start"]["value"]
    again_run = CliRunner().invoke(cli, command, catch_exceptions=False)
    assert json.loads(again_run.stdout) == report
    rows = np.genfromtxt("all.csv", delimiter=",", names=True)
    assert len(rows) == report["search"]["evaluated"]


def test_the_best_file_has_the_weights_it_was_judged_by(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The cost of the report is that of the efficiencies which `analyze` prints for the file."""
    monkeypatch.chdir(folder)
    text = GOOD.replace("ties:", 'weights: "twist=1,1,4"\nties:', 1)
    text = text.replace('{quantity: "kinematic.condition:translation", over: mean}', "{measure: sphere}")
    Path("sphere.yaml").write_text(text)
    command = ["design", "sphere.yaml", "--path", "reference", "--json", "--quiet", "-o", "best.yaml"]
    report = json.loads(CliRunner().invoke(cli, command, catch_exceptions=False).stdout)
    told = CliRunner().invoke(cli, ["analyze", "best.yaml", "--json"], catch_exceptions=False)
    values = json.loads(told.stdout)["kinematic"]["efficiencies"]
    cost = (values[0] - 1.0) ** 2 + (values[-1] - 1.0) ** 2
    assert report["best"]["value"] == pytest.approx(cost, rel=1e-9)


def test_a_member_that_is_not_there_loses_no_report(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("pymoo")
    monkeypatch.chdir(folder)
    one = '{quantity: "kinematic.condition:translation", over: mean}'
    both = f'[{one}, {{quantity: "kinematic.smallest"}}]'
    text = GOOD.replace(one, both).replace(", samples: 4", "")
    Path("two.yaml").write_text(text)
    command = [
        "design",
        "two.yaml",
        "--path",
        "reference",
        "--json",
        "--quiet",
        "-o",
        "b.yaml",
        "--member",
        "99",
    ]
    found = CliRunner().invoke(cli, command)
    assert found.exit_code == 2
    members = json.loads(found.stdout)["members"]
    assert f"there are {len(members)} compromises" in found.stderr


def test_exit_codes(folder: Path) -> None:
    (folder / "none.yaml").write_text(GOOD.replace("most: 2.9", "most: 0.1"))

    def run(*words: str) -> int:
        return finished(lambda: cli.main(list(words), standalone_mode=False), debug=False)

    assert run("design", str(folder / "none.yaml"), "--path", "reference", "--quiet") == 1
    assert run("design", "example:stuart") == 2
