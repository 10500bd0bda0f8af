"""`vincula map` from the command line: text, JSON, data files, figures, and what it refuses."""

from __future__ import annotations

import csv
import json

import numpy as np
import pytest
from click.testing import CliRunner

from vincula.cli.main import CommandLine

OVER = ["--over", "x=-0.7:-0.3:5", "--over", "y=-0.4m:0.05m:5"]


@pytest.fixture
def run():
    def invoke(*words: str):
        return CliRunner().invoke(CommandLine(), ["map", "example:five-bar", *words])

    return invoke


def test_text_data_and_figure(run, tmp_path) -> None:
    pytest.importorskip("matplotlib")
    figure, table = tmp_path / "map.svg", tmp_path / "map.csv"
    index = "kinematic.inverse_condition_number:translation"
    result = run(*OVER, "--index", index, "-o", str(figure), "--data", str(table))
    assert result.exit_code == 0, result.output
    assert "map of 'coupler', motors o1, o5" in result.output
    assert "platform free crosses it" in result.output
    assert figure.read_text().startswith("<?xml")
    rows = list(csv.reader(table.read_text().splitlines()))
    assert rows[0] == ["branch", "x [m]", "y [m]", "status", index, "distance [m]", "nearest"]
    assert all(row[3] == "ok" and 0.0 <= float(row[4]) <= 1.0 for row in rows[1:])


def test_distance_in_colour_and_zarr(run, tmp_path) -> None:
    """The data set holds what the map holds: distances, the kinds they are to, and the curves."""
    pytest.importorskip("matplotlib")
    pytest.importorskip("zarr")
    xarray = pytest.importorskip("xarray")
    data, figure = tmp_path / "map.zarr", tmp_path / "map.png"
    result = run(*OVER, "--index", "distance", "-o", str(figure), "--data", str(data))
    assert result.exit_code == 0, result.output
    kept = xarray.open_zarr(data, consolidated=False)
    reached = kept.reached.values
    assert kept.distance.attrs["units"] == "m"
    assert np.isfinite(kept.distance.values[reached]).all()
    assert (kept.distance.values[reached] >= 0.0).all()
    kinds = kept.nearest.attrs["meanings"]
    assert {kinds[code] for code in np.unique(kept.nearest.values[reached])} <= {
        "platform free", "motors without authority",
    }  # fmt: skip
    curve = int(kept.curve_of_point.values[0])
    place = np.array([kept.curve_x.values[0], kept.curve_y.values[0]])
    assert kinds[kept.curve_kind.values[curve]] in ("platform free", "motors without authority")
    here = np.stack(np.meshgrid(kept.x, kept.y, indexing="ij"), axis=-1)[reached[0]]
    away = np.hypot(*(here - place).T)
    assert (kept.distance.values[0][reached[0]] <= away + 1e-12).all()


def test_json_is_one_object(run) -> None:
    result = run(*OVER, "--json")
    assert result.exit_code == 0, result.output
    told = json.loads(result.stdout)
    assert told["schema"] == "vincula/map/1"
    assert [v["unit"] for v in told["variables"]] == ["m", "m"]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--over", "x=-1:1"], "two variables"),
        (["--over", "x", "--over", "y=0:1"], "NAME=FROM:TO"),
        (["--over", "x=1:0", "--over", "y=0:1"], "is no range"),
        (["--over", "x=0:1:1000000000000", "--over", "y=0:1"], "2 to 2000"),
        (["--over", "x=0:one", "--over", "y=0:1"], "one"),
        (["--over", "elbow=0:1", "--over", "y=0:1"], "variable of a map"),
        ([*OVER, "-o", "map.gif"], ".svg"),
        ([*OVER, "--data", "map.pkl"], ".json, .csv or .zarr"),
        ([*OVER, "--index", "kinematic.efficiencies"], "one number a point"),
        ([*OVER, "--index", "kinematic.smalest"], "kinematic.smallest"),
    ],
)
def test_what_it_refuses(run, words: list[str], message: str) -> None:
    result = run(*words)
    text = result.output + (str(result.exception) if result.exception else "")
    assert message in text
    assert result.exit_code != 0
