"""`vincula compare`: the order of designs, the table, and what it refuses."""

from __future__ import annotations

import pytest

FIVE_BAR = "example:five-bar"
THREE = ["--active", "all", "--active", "o2,o4", "--active", "o1,o5"]


def motors(found) -> list[str]:
    return [",".join(design["active"]) for design in found["designs"]]


def test_the_three_designs_of_the_paper(run_json, paper) -> None:
    found = run_json("compare", FIVE_BAR, *THREE)
    assert found["schema"] == "vincula/comparison/1"
    assert found["rank_by"] == "kinematic"
    assert motors(found) == ["o1,o5", "o2,o4", "o1,o2,o3,o4,o5"]
    assert [design["rank"] for design in found["designs"]] == [1, 2, 3]
    for design, key in zip(found["designs"], ("motors_1_5", "motors_2_4", "motors_all"), strict=True):
        expected = paper["five_bar"][key]
        assert design["index"] == pytest.approx(expected["kinematic"][-1], abs=6e-5)
        assert design["efficiencies"]["kinematic"] == pytest.approx(expected["kinematic"], abs=6e-5)
        assert design["reason"] is None
        assert design["status"] == "certain"


def test_indeterminate_designs_come_last_with_the_reason(run, run_json) -> None:
    words = ["compare", FIVE_BAR, "--active", "o1", "--active", "all", "--active", "o1,o5"]
    found = run_json(*words)
    assert motors(found) == ["o1,o5", "o1,o2,o3,o4,o5", "o1"]
    assert "indeterminate" in found["designs"][-1]["reason"]
    text = run(*words).stdout
    assert "moves in 1 way with all motors locked" in text


def test_the_table_is_one_page(run) -> None:
    text = run("compare", FIVE_BAR, *THREE).stdout
    for part in ("3 choices of motors", "coupler", "o1, o5", "9.736, 0.5135", "0.11371", "8.794, 1.706"):
        assert part in text
    places = [text.index(part) for part in ("o1, o5", "o2, o4", "o1, o2")]
    assert places == sorted(places)


@pytest.mark.parametrize(
    "index",
    ["active-force", "passive-force", "internal-force", "dual-force", "yoshikawa", "inverse-condition",
     "isotropy", "smallest-singular-value"],
)  # fmt: skip
def test_rank_by_every_index(run_json, index: str) -> None:
    found = run_json("compare", FIVE_BAR, *THREE, "--rank-by", index)
    assert found["rank_by"] == index
    values = [design["index"] for design in found["designs"] if design["index"] is not None]
    assert values == sorted(values, reverse=True)
    assert values


def test_help_names_every_criterion_of_the_library() -> None:
    from vincula.analysis.ranking import CRITERIA
    from vincula.cli.compare import CRITERION_NAMES

    assert tuple(CRITERIA) == CRITERION_NAMES


def test_on_translations_only(run_json) -> None:
    both = [
        run_json("compare", FIVE_BAR, *THREE, "--rank-by", "yoshikawa", "--on", part)["designs"][0]["index"]
        for part in ("all", "translation")
    ]
    assert both[0] != both[1]


def test_doubt_under_strict(run) -> None:
    run("compare", FIVE_BAR, *THREE, "--tolerance", "0.2,5deg", "--strict", code=3)
    assert "doubtful" in run("compare", FIVE_BAR, *THREE, "--tolerance", "0.2,5deg").stdout


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ([FIVE_BAR], "--active"),
        ([FIVE_BAR, "--active", "o9"], "'o9'"),
        ([FIVE_BAR, "--active", "o1", "--rank-by", "speed"], "kinematic"),
        ([FIVE_BAR, "--active", "o1", "--on", "z"], "translation"),
        (["nosuch.yaml", "--active", "o1"], "no such file"),
    ],
)
def test_refusals(run, words: list[str], message: str) -> None:
    result = run("compare", *words, code=2)
    assert result.stdout == ""
    assert message in result.stderr


def test_an_open_loop_is_refused(run) -> None:
    run("compare", FIVE_BAR, *THREE, "--at", "o1=0.3", code=1)
