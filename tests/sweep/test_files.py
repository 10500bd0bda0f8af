"""Sweep files: every bad input with its line and column; tables; commands with their exit codes."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner, Result
from tests.sweep.conftest import files_of

import vincula as vc
from vincula.cli.main import cli
from vincula.cli.sweep_subject import sweep_of
from vincula.files.sweep_file import read_sweep
from vincula.files.sweep_table import read_columns

GOOD = """\
sweep: 1
model: example:serial-2r
grid:
  shoulder: {from: 0, to: 40deg, points: 3}
  elbow: [10deg, 20deg, pi/6]
quantities: [kinematic.smallest]
"""


def refused(tmp_path: Path, text: str) -> str:
    file = tmp_path / "s.yaml"
    file.write_text(text)
    with pytest.raises(vc.FileError) as refusal:
        sweep_of(read_sweep(file))
    return str(refusal.value).replace(str(tmp_path) + "/", "")


def test_units_and_expressions(tmp_path: Path) -> None:
    (tmp_path / "s.yaml").write_text(GOOD)
    points = sweep_of(read_sweep(tmp_path / "s.yaml")).points
    assert points.variables == ("shoulder", "elbow")
    assert isinstance(points, vc.Grid)
    assert points.axes["shoulder"] == pytest.approx(np.radians([0, 20, 40]))
    assert points.axes["elbow"] == pytest.approx(np.radians([10, 20, 30]))


RANGE = "{from: 0, to: 40deg, points: 3}"
"""What most bad files change; below: what is replaced, by what, and words of the refusal."""
BAD = [
    (RANGE, "{from: 0, to: 1, step: 0}", "s.yaml:4:36: grid/shoulder/step: got 0"),
    (RANGE, "{from: 0, to: 1, step: -1}", "a step that leads from the first value"),
    (RANGE, "{from: 0, to: 1, step: 1e-12}", "s.yaml:4:36: grid/shoulder/step: got 1e+12 values"),
    (
        "elbow: [10deg, 20deg, pi/6]",
        "elbow: {from: 0, to: 1, points: 1e10}",
        "s.yaml:5:35: grid/elbow/points: got 1e+10 values",
    ),
    (
        "  elbow: [10deg, 20deg, pi/6]",
        "  elbow: {from: 0, to: 1, points: 9e6}\n  shoulder: [0]",
        "the key 'shoulder' is already in line 4",
    ),
    (RANGE, "{from: 0, to: 1, points: 3, step: 1}", "got both `points` and `step`"),
    (RANGE, "{from: 0, to: 1}", "got neither `points` nor `step`"),
    (
        RANGE,
        "{from: 0, to: 1, points: 2.5}",
        "s.yaml:4:38: grid/shoulder/points: got 2.5, expected a whole number",
    ),
    (RANGE, "{from: 0, to: 40mm, points: 3}", "s.yaml:4:27: grid/shoulder/to: got 40mm, expected an angle"),
    ("pi/6", "__import__('os')", "s.yaml:5:25: grid/elbow[2]: got \"__import__('os')\", expected a number"),
    ("pi/6", "$l/2", "no parameter is named 'l'"),
    ("pi/6", "'1,5'", "a decimal point"),
    ("pi/6", ".nan", "expected a finite number"),
    ("pi/6", "1e400", "a number of at most 1e+30"),
    ("elbow:", "elbo:", "'elbo'"),
    (
        "kinematic.smallest",
        "kinematic.smalest",
        "s.yaml:6:13: quantities: no quantity is named 'kinematic.smalest'; did you mean",
    ),
    ("grid:", "gird:", "unknown key 'gird'; did you mean 'grid'?"),
    ("sweep: 1", "sweep: 2", "s.yaml:1:8: sweep: got version 2, expected 1"),
    ("example:serial-2r", "example:serial-3r", "s.yaml:2:8: model: no example is named 'serial-3r'"),
    ("example:serial-2r", "missing.yaml", "missing.yaml: there is no such file"),
    ("quantities:", "table: a.csv\nquantities:", "got grid and table, expected one of the keys"),
    ("quantities:", "chunk: -1\nquantities:", "s.yaml:6:8: chunk: got -1, expected a whole number"),
    (
        "quantities:",
        "set: {l: 1}\nquantities:",
        "s.yaml:6:6: set: no parameter of example 'serial-2r' is named 'l'",
    ),
    ("quantities:", "at: wrist=1\nquantities:", "'wrist'"),
]


@pytest.mark.parametrize(("old", "new", "words"), BAD)
def test_bad_files(old: str, new: str, words: str, tmp_path: Path) -> None:
    assert words in refused(tmp_path, GOOD.replace(old, new, 1))


def test_a_grid_of_1e12_points_is_refused_before_it_is_made(tmp_path: Path) -> None:
    text = GOOD.replace("points: 3", "points: 1e6").replace(
        "[10deg, 20deg, pi/6]", "{from: 0, to: 1, points: 1e6}"
    )
    assert "s.yaml:4:3: grid: got 1e+12 points, expected at most 1e+10" in refused(tmp_path, text)


def test_the_other_kinds_of_points(tmp_path: Path) -> None:
    head, tail = "sweep: 1\nmodel: example:serial-2r\n", "quantities: [counts]\n"
    file = tmp_path / "s.yaml"
    ways = "[{shoulder: 0, elbow: 1}, {shoulder: 90deg, elbow: 0}]"
    file.write_text(f"{head}path: {{through: {ways}, points: 3}}\n{tail}")
    assert sweep_of(read_sweep(file)).points.at(np.arange(3)) == pytest.approx(
        np.array([[0, 1], [np.pi / 4, 0.5], [np.pi / 2, 0]])
    )
    for kind in ("random", "low-discrepancy"):
        file.write_text(f"{head}{kind}: {{ranges: {{elbow: [10deg, 1]}}, points: 9, seed: 4}}\n{tail}")
        points = sweep_of(read_sweep(file)).points
        made = vc.RandomPoints if kind == "random" else vc.LowDiscrepancyPoints
        assert np.array_equal(
            points.at(np.arange(9)), made({"elbow": (np.radians(10), 1)}, 9, 4).at(np.arange(9))
        )
    np.savez(tmp_path / "t.npz", elbow=[0.1, 0.2], shoulder=[1, 2])
    (tmp_path / "t.csv").write_text("elbow, shoulder\n0.1,1\n0.2,2\n")
    for table in ("t.npz", "t.csv"):
        file.write_text(f"{head}table: {table}\n{tail}")
        points = sweep_of(read_sweep(file)).points
        assert np.array_equal(points.at(np.arange(2)), [[0.1, 1], [0.2, 2]])


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("t.csv", b"a,b\n1,x\n", "t.csv:2:2: b: got 'x', expected a number"),
        ("t.csv", b"a,b\n1\n", "t.csv:2:1: got 1 values, expected 2"),
        ("t.csv", b"a,a\n1,2\n", "two columns are named 'a'"),
        ("t.csv", b"1,2\n3,4\n", "expected a row of names"),
        ("t.csv", b"a,b\n", "has no rows"),
        ("t.csv", b"a\n1e400\n", "expected a finite number"),
        ("t.csv", b"a\n\xff\n", "not UTF-8"),
        ("t.csv", b"", "empty"),
        ("t.npz", b"PK\x03\x04 nonsense", "not an npz file"),
        ("t.pkl", b"\x80\x04\x95", "ends in .csv, .npz or .parquet"),
    ],
)
def test_bad_tables(name: str, content: bytes, words: str, tmp_path: Path) -> None:
    (tmp_path / name).write_bytes(content)
    with pytest.raises(vc.FileError, match=words.replace("(", r"\(")):
        read_columns(tmp_path / name)


def test_arrays_of_objects_are_refused(tmp_path: Path) -> None:
    np.savez(tmp_path / "t.npz", a=np.array([{"x": 1}], dtype=object), allow_pickle=True)
    with pytest.raises(vc.FileError, match="pickles are never read"):
        read_columns(tmp_path / "t.npz")
    np.savez(tmp_path / "u.npz", a=np.zeros((2, 2)))
    with pytest.raises(vc.FileError, match="expected a row of numbers"):
        read_columns(tmp_path / "u.npz")


Run = Callable[..., Result]


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Run:
    """`run("sweep", "status", "a.zarr", code=0)` in the folder of a good sweep file `s.yaml`."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "s.yaml").write_text(GOOD)

    def invoke(*words: str, code: int = 0) -> Result:
        result = CliRunner().invoke(cli, words)
        assert result.exit_code == code, f"{words}: {result.output}\n{result.exception!r}"
        assert "Traceback" not in result.output
        return result

    return invoke


def test_commands(run: Run, tmp_path: Path) -> None:
    told: dict[str, Any] = json.loads(run("sweep", "run", "s.yaml", "--json", "--threads", "1").stdout)
    assert told["schema"] == "vincula/sweep-run/1"
    assert told["complete"]
    assert told["counts"]["ok"] == told["points"] == 9
    assert "9 of 9" in run("sweep", "status", "s.yaml").stdout
    assert "there is a sweep already" in run("sweep", "run", "s.yaml", code=2).stderr
    run("sweep", "run", "s.yaml", "--overwrite", "--quiet")
    assert "a second" in run("sweep", "run", "s.yaml", "--overwrite").stderr
    run("sweep", "resume", "s.zarr")
    run("sweep", "export", "s.yaml", "s.csv")
    assert len((tmp_path / "s.csv").read_text().splitlines()) == 10
    run("sweep", "run", "s.yaml", "-o", "m.zarr", "--shard", "1/2", code=2)  # one chunk only
    run("sweep", "status", "nothing.zarr", code=2)
    run("sweep", "resume", "nothing.zarr", code=2)


def test_shares_from_the_command_line(run: Run, tmp_path: Path) -> None:
    (tmp_path / "s.yaml").write_text(GOOD + "chunk: 3\n")
    run("sweep", "run", "s.yaml", "--quiet")
    for i in ("1/3", "2/3", "3/3"):
        run("sweep", "run", "s.yaml", "-o", "m.zarr", "--shard", i, "--quiet")
    shares = json.loads(run("sweep", "status", "m.zarr", "--json").stdout)
    assert len(shares["shares"]) == 3
    assert shares["points_done"] == 9
    assert json.loads(run("sweep", "merge", "m.zarr", "--json").stdout)["complete"]
    assert files_of(tmp_path / "m.zarr") == files_of(tmp_path / "s.zarr")
    for bad in ("0/3", "4/3", "1", "a/b"):
        run("sweep", "run", "s.yaml", "--shard", bad, code=2)


def test_a_changed_model_file_is_refused_with_both_hashes(run: Run, tmp_path: Path) -> None:
    run("convert", "example:serial-2r", "arm.yaml")
    (tmp_path / "s.yaml").write_text(GOOD.replace("example:serial-2r", "arm.yaml"))
    old = json.loads(run("sweep", "run", "s.yaml", "--json").stdout)["model_hash"]
    model = (tmp_path / "arm.yaml").read_text()
    (tmp_path / "arm.yaml").write_text(model + "\n# only a comment\n")
    run("sweep", "resume", "s.zarr")
    longer = model.replace("origin: [1, 1]", "origin: [1, 1.001]")
    assert longer != model
    (tmp_path / "arm.yaml").write_text(longer)
    refusal = run("sweep", "resume", "s.zarr", code=1).stderr
    assert "the model has changed" in refusal
    assert old in refusal


def test_parameters_of_the_model(run: Run, tmp_path: Path) -> None:
    (tmp_path / "s.yaml").write_text(
        "sweep: 1\nmodel: example:stewart\nset: {alpha: 10deg, beta: -110deg}\n"
        "grid: {upper_radius: [1.2m, 150cm], height: [1.9, 2]}\n"
        "quantities: ['kinematic.smallest_singular_value:translation']\n"
    )
    run("sweep", "run", "s.yaml", "--quiet")
    found = vc.open_sweep(tmp_path / "s.zarr").to_xarray()
    assert found["upper_radius"].values == pytest.approx([1.2, 1.5])
    for i, radius in enumerate([1.2, 1.5]):
        for j, height in enumerate([1.9, 2.0]):
            settings = {"alpha": "10deg", "beta": "-110deg", "upper_radius": radius, "height": height}
            model = vc.load("example:stewart", settings).linearize()
            value = found["kinematic.smallest_singular_value.translation"].values[i, j]
            assert value == pytest.approx(vc.smallest_singular_value(model, "translation"), rel=1e-9)
