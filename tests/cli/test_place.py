"""`vincula place`: the table, the JSON object, sweeps and figures, and what it refuses."""

from __future__ import annotations

from pathlib import Path

import pytest

FIVE_BAR = "example:five-bar"


def test_all_ten_pairs(run_json, paper) -> None:
    found = run_json("place", FIVE_BAR, "--motors", "2")
    assert found["schema"] == "vincula/placement/1"
    assert found["exhaustive"] is True
    assert found["admissible"] == len(found["choices"]) == found["controlling"] == 10
    by_motors = {",".join(choice["motors"]): choice for choice in found["choices"]}
    for motors, key in (("o1,o5", "motors_1_5"), ("o2,o4", "motors_2_4")):
        assert by_motors[motors]["index"] == pytest.approx(paper["five_bar"][key]["kinematic"][-1], abs=6e-5)
    ranks = found["front"]["ranks"]
    assert ranks[0] == 1
    assert [choice["rank"] for choice in found["choices"]] == list(range(1, 11))


def test_all_subsets_and_why_single_motors_fail(run, run_json) -> None:
    found = run_json("place", FIVE_BAR, "--motors", "1..5")
    assert len(found["choices"]) == 31
    failing = [choice for choice in found["choices"] if not choice["controls"]]
    assert sorted(choice["motors"] for choice in failing) == [["o1"], ["o2"], ["o3"], ["o4"], ["o5"]]
    assert all("moves with all motors locked" in choice["why"][0] for choice in failing)
    assert [choice["rank"] for choice in failing] == [27, 28, 29, 30, 31]
    text = run("place", FIVE_BAR, "--motors", "1..5", "--show", "3").stdout
    assert "28 more behind these" in text
    assert "5 choices that cannot control the member" in text
    assert "it can turn about the point" in text


def test_forbid_require_cost(run_json) -> None:
    words = [
        "--motors",
        "2,3",
        "--forbid",
        "o3",
        "--require",
        "o5",
        "--cost",
        "o1=2.5,o5=0",
        "--cost",
        "o2=4",
    ]
    found = run_json("place", FIVE_BAR, *words)
    costs = {",".join(choice["motors"]): choice["cost"] for choice in found["choices"]}
    assert costs == {"o1,o5": 2.5, "o2,o5": 4, "o4,o5": 1, "o1,o2,o5": 6.5, "o1,o4,o5": 3.5, "o2,o4,o5": 5}
    assert found["required"] == ["o5"]


def test_a_figure(run, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    target = tmp_path / "motors.svg"
    result = run("place", FIVE_BAR, "--motors", "2..3", "-o", str(target))
    assert "wrote" in result.stderr
    assert target.read_text(encoding="utf-8").count("<path") > 20


def test_over_the_points_of_a_sweep(run_json, tmp_path: Path) -> None:
    pytest.importorskip("ruamel.yaml")
    sweep = tmp_path / "sweep.yaml"
    sweep.write_text(
        "sweep: 1\nmodel: example:five-bar\nactive: [o1, o5]\n"
        "path: {points: 3, through: [{o1: 0, o5: 0}, {o1: -0.1, o5: -0.1}]}\n"
        "quantities: [kinematic.efficiencies]\n",
        encoding="utf-8",
    )
    found = run_json("place", FIVE_BAR, "--motors", "2", "--over", str(sweep))
    assert found["configurations"] == {"count": 3, "left_out": []}
    home = {tuple(c["motors"]): c["index"] for c in run_json("place", FIVE_BAR, "--motors", "2")["choices"]}
    for choice in found["choices"]:
        assert choice["index"] <= choice["mean"]
        assert choice["index"] <= home[tuple(choice["motors"])] * (1 + 1e-9)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ([FIVE_BAR], "--motors"),
        ([FIVE_BAR, "--motors", "0"], "1 or more"),
        ([FIVE_BAR, "--motors", "6"], "only 5 joint axes"),
        ([FIVE_BAR, "--motors", "many"], "not of the form"),
        ([FIVE_BAR, "--motors", "3..2"], "empty"),
        ([FIVE_BAR, "--motors", "2", "--forbid", "o9"], "'o9'"),
        ([FIVE_BAR, "--motors", "2", "--forbid", "o1", "--require", "o1"], "forbidden and required at once"),
        ([FIVE_BAR, "--motors", "2", "--cost", "o1"], "not of the form"),
        ([FIVE_BAR, "--motors", "2", "--cost", "o1=-2"], "0 or more"),
        ([FIVE_BAR, "--motors", "2", "--cost", "o1=1,o1=2"], "given twice"),
        ([FIVE_BAR, "--motors", "2", "--front", "beauty"], "'beauty'"),
        ([FIVE_BAR, "--motors", "2", "--at", "o1=0", "--over", "x.yaml"], "exclude"),
        ([FIVE_BAR, "--motors", "2", "--over", "nosuch.yaml"], "no such file"),
        ([FIVE_BAR, "--motors", "2", "-o", "x.docx"], "must end in"),
        (["nosuch.yaml", "--motors", "2"], "no such file"),
    ],
)
def test_refusals(run, words: list[str], message: str) -> None:
    result = run("place", *words, code=2)
    assert result.stdout == ""
    assert message in result.stderr


def test_an_open_loop_is_refused(run) -> None:
    result = run("place", FIVE_BAR, "--motors", "2", "--at", "o1=0.3", code=1)
    assert "--close" in result.stderr


def test_doubt_under_strict(run) -> None:
    run("place", FIVE_BAR, "--motors", "2", "--tolerance", "0.2,5deg", "--strict", code=3)
