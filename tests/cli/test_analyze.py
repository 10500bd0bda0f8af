"""`vincula analyze`: the paper's numbers, every option, every exit code."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

FIVE_BAR = "example:five-bar"
DESIGNS = {"motors_1_5": "o1,o5", "motors_2_4": "o2,o4", "motors_all": "all"}
COUNTS = {
    "motors_1_5": {"g": 2, "p": 1, "o": 1},
    "motors_2_4": {"g": 2, "p": 1, "o": 1},
    "motors_all": {"ao": 2, "a": 3, "o": 1},
}


def numbers(values) -> list[float]:
    return [float(value) for value in values]


@pytest.mark.parametrize("design", DESIGNS)
def test_every_invariant_value_of_the_paper(run_json, paper, design: str) -> None:
    found = run_json("analyze", FIVE_BAR, "--active", DESIGNS[design])
    expected = paper["five_bar"][design]
    for kind in ("kinematic", "active_force", "passive_force", "internal_force", "dual_force"):
        if kind in expected:
            assert numbers(found[kind]["efficiencies"]) == pytest.approx(numbers(expected[kind]), abs=6e-5)
    counts = {name: value for name, value in found["mobility"]["counts"].items() if value}
    assert counts == COUNTS[design]
    assert len(found["mobility"]["counts"]) == 12
    assert found["rank"]["status"] == "certain"


@pytest.mark.parametrize("design", DESIGNS)
def test_the_printed_convention(run_json, paper, design: str) -> None:
    found = run_json("analyze", FIVE_BAR, "--active", DESIGNS[design], "--convention", "printed")
    expected = paper["five_bar"][design]
    assert found["convention"] == "printed"
    for kind in ("active_force", "passive_force"):
        printed = expected.get(f"{kind}_printed_convention")
        if printed:
            values = [value for value in numbers(found[kind]["efficiencies"]) if value > 0.0]
            assert values == pytest.approx(numbers(printed), abs=6e-5)
    assert numbers(found["kinematic"]["efficiencies"]) == pytest.approx(expected["kinematic"], abs=6e-5)


def test_the_wrench_that_needs_no_torque(run_json, paper) -> None:
    found = run_json("analyze", FIVE_BAR)
    (wrench,) = found["statics"]["structural_wrenches"]
    printed = np.array(paper["five_bar"]["zero_torque_wrench_printed"])
    assert abs(np.dot(wrench, printed) / np.linalg.norm(printed)) == pytest.approx(1.0, abs=1e-4)
    assert found["passive_force"]["classes"][0] == "infinite"
    assert found["passive_force"]["efficiencies"][0] == "inf"
    assert found["passive_force"]["motor_directions"][0] is None


def test_the_default_motors_are_those_of_the_example(run_json) -> None:
    assert run_json("analyze", FIVE_BAR)["active"] == ["o1", "o5"]


def test_stewart_platform_of_the_paper(run_json, paper) -> None:
    for check in paper["stewart"]["check"]:
        alpha, beta = check["alpha_beta_deg"]
        words = ["--set", f"alpha={alpha}deg", "--set", f"beta={beta}deg"]
        weights = ["--weights", "twist=" + ",".join(map(str, check["task_metric"]))]
        found = run_json("analyze", "example:stewart", *words, *weights)
        values = numbers(found["kinematic"]["efficiencies"])
        if "efficiencies" in check:
            assert values == pytest.approx(check["efficiencies"], abs=6e-4)
        cost = (max(values) - 1.0) ** 2 + (min(values) - 1.0) ** 2
        assert 1.0 / cost == pytest.approx(check["inverse_cost"], abs=6e-5)


def test_legs_that_coincide_leave_three_infinite_efficiencies(run_json) -> None:
    found = run_json("analyze", "example:stewart", "--set", "alpha=10deg", "--set", "beta=10deg")
    assert found["kinematic"]["classes"].count("infinite") == 3
    assert found["maps"]["twist_from_rates"] is None
    assert "all motors locked" in found["maps"]["reasons"]["twist_from_rates"]


def test_spherical_joints_leave_six_free_leg_spins(run_json) -> None:
    found = run_json("analyze", "example:stewart-spherical")
    assert found["mobility"]["summary"]["passive_redundancy"] == 6
    assert sum("can turn freely" in verdict for verdict in found["mobility"]["verdicts"]) == 6


def test_json_keys_of_the_contract(run_json) -> None:
    found = run_json("analyze", FIVE_BAR, "--active", "all")
    assert {
        "schema", "mechanism", "reference", "frame", "active", "passive", "mobility", "rank", "closure",
        "warnings", "components", "model", "statics", "maps",
    } <= set(found)  # fmt: skip
    assert found["schema"] == "vincula/analysis/1"
    assert set(found["mobility"]["summary"]) == {
        "mobility", "passive_redundancy", "redundancy", "indeterminacy", "coordinated", "internal_torques",
        "structural_wrenches", "static_indeterminacy",
    }  # fmt: skip
    for kind in ("kinematic", "active_force", "passive_force", "internal_force", "dual_force"):
        one = found[kind]
        lengths = {
            len(one[key]) for key in ("efficiencies", "classes", "task_directions", "motor_directions")
        }
        assert len(lengths) == 1
        finite = [float(value) for value in one["efficiencies"] if value is not None]
        assert finite == sorted(finite, reverse=True)
        for direction in (d for d in one["task_directions"] if d is not None):
            assert math.hypot(*direction) == pytest.approx(1.0)
            assert max(direction) >= (1 - 1e-9) * max(map(abs, direction))


# The page -----------------------------------------------------------------------------------------


def test_the_page_says_everything_in_words_and_numbers(run) -> None:
    text = run("analyze", FIVE_BAR, "--active", "all").stdout
    for part in (
        "five-bar", "reference member", "coupler", "motors", "passive axes",
        "In words", "Mobility and statics", "structural wrenches", "twelve counts: ar 0", "ao 2",
        "Kinematic ellipsoid", "0.58629", "0.11371", "0.7657",
        "Active force ellipsoid", "8.7944", "zero", "Passive force ellipsoid", "inf", "infinite",
        "Internal force ellipsoid", "1.2433", "o2.fx", "Dual force ellipsoid",
        "Motor rates to twist", "Load to motor torques", "rad/s", "N m",
        "Rank", "certain", "closure residual",
    ):  # fmt: skip
        assert part in text, part
    assert max(map(len, text.splitlines())) <= 120


def test_a_narrow_terminal_is_respected(run, monkeypatch) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    text = run("analyze", "example:stewart").stdout
    assert max(map(len, text.splitlines())) <= 80


def test_viewpoint_names_worst_and_best_the_other_way_round(run, run_json) -> None:
    fast, exact = (run_json("analyze", FIVE_BAR, "--viewpoint", view) for view in ("efficiency", "accuracy"))
    assert fast["kinematic"] == exact["kinematic"]
    assert (fast["viewpoint"], exact["viewpoint"]) == ("efficiency", "accuracy")
    assert "large is fast" in run("analyze", FIVE_BAR).stdout
    assert "large is inaccurate" in run("analyze", FIVE_BAR, "--viewpoint", "accuracy").stdout


# Options ------------------------------------------------------------------------------------------


def test_reference_point_and_axes(run_json) -> None:
    centre = run_json("analyze", FIVE_BAR)
    moved = run_json("analyze", FIVE_BAR, "--reference", "coupler@-1,0")
    assert centre["mobility"]["counts"] == moved["mobility"]["counts"]
    # The twist of one unit of o1 at o2 = (-1, 0): o1 is straight below it, 2 m away.
    np.testing.assert_allclose(np.array(moved["maps"]["twist_from_rates"])[:, 0], [-2, 0, -2], atol=1e-12)
    body = run_json("analyze", FIVE_BAR, "--axes", "body")
    assert body["frame"] == "axes of coupler"
    assert body["kinematic"]["efficiencies"] == pytest.approx(centre["kinematic"]["efficiencies"])


def test_another_reference_member(run_json) -> None:
    found = run_json("analyze", FIVE_BAR, "--reference", "rocker")
    assert found["reference"].startswith("rocker")
    assert found["mobility"]["summary"]["mobility"] == 2


def test_locked_joints(run_json) -> None:
    found = run_json("analyze", FIVE_BAR, "--lock", "o2")
    assert found["mobility"]["summary"]["mobility"] == 1
    assert "o2" not in found["active"] + found["passive"]
    assert run_json("analyze", FIVE_BAR, "--lock", "o1")["active"] == ["o5"]


def test_a_configuration_that_stays_closed(run_json) -> None:
    home, turned = (
        run_json("analyze", "example:serial-2r", *words)
        for words in ([], ["--at", "shoulder=0.5,elbow=0.25"])
    )
    assert home["kinematic"]["efficiencies"] != turned["kinematic"]["efficiencies"]


def test_weights_as_text_and_file(run_json, tmp_path) -> None:
    file = tmp_path / "weights.yaml"
    file.write_text("twist: [1, 1, 4]\nrate: {o1: 4}\n", encoding="utf-8")
    from_text = run_json("analyze", FIVE_BAR, "--weights", "twist=1,1,4")
    assert from_text["kinematic"]["weights"]["twist"] == [1, 1, 4]
    from_file = run_json("analyze", FIVE_BAR, "--weights", str(file))
    assert from_file["kinematic"]["weights"] == {"twist": [1, 1, 4], "rate": [4, 1]}
    # Scaling every motor by 2 divides every efficiency by 4: here o1 alone is weighed.
    assert from_file["kinematic"]["efficiencies"][0] < from_text["kinematic"]["efficiencies"][0]


def test_weights_limits_without_limits_is_bad_usage(run) -> None:
    assert "no rate and no effort limit" in run("analyze", FIVE_BAR, "--weights", "limits", code=2).stderr


def test_tolerance_makes_ranks_doubtful_and_strict_says_so(run, run_json) -> None:
    loose = ["analyze", FIVE_BAR, "--tolerance", "0.2,5deg"]
    found = run_json(*loose)
    assert found["rank"]["status"] == "doubtful"
    assert found["warnings"]
    assert run_json(*loose, "--strict", code=3)["rank"]["status"] == "doubtful"
    assert "not decided" in run(*loose).stdout
    run("analyze", FIVE_BAR, "--strict")
    run_json("analyze", FIVE_BAR, "--tolerance", "0.1mm,0.01deg", "--strict")


def test_warnings_are_on_stderr_beside_the_json(run, tmp_path) -> None:
    result = run("analyze", FIVE_BAR, "--tolerance", "0.2,5deg", "--json")
    json.loads(result.stdout)
    lines = result.stderr.splitlines()
    assert lines
    assert all(line.startswith("warning: ") for line in lines)
    assert run("analyze", FIVE_BAR, "--json").stderr == ""


# Refusals -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("words", "code", "message"),
    [
        (["analyze"], 2, "Missing argument 'FILE'"),
        (["analyze", "nosuch.yaml"], 2, "no such file"),
        (["analyze", "example:five-baa"], 2, "did you mean 'five-bar'?"),
        (["analyze", FIVE_BAR, "--active", "o9"], 2, "'o9'"),
        (["analyze", FIVE_BAR, "--active", "o1,o1"], 2, "o1"),
        (["analyze", FIVE_BAR, "--active", "o1", "--active", "o5"], 2, "given more than once"),
        (["analyze", FIVE_BAR, "--lock", "o9"], 2, "'o9'"),
        (["analyze", FIVE_BAR, "--reference", "couplr"], 2, "did you mean 'coupler'?"),
        (["analyze", FIVE_BAR, "--reference", "ground"], 2, "ground cannot be the reference member"),
        (["analyze", FIVE_BAR, "--reference", "coupler@1,2,3"], 2, "reference point"),
        (["analyze", FIVE_BAR, "--reference", "coupler@tip"], 2, "'tip'"),
        (["analyze", FIVE_BAR, "--axes", "world"], 2, "ground"),
        (["analyze", FIVE_BAR, "--at", "o9=1"], 2, "'o9'"),
        (["analyze", FIVE_BAR, "--at", "o1=abc"], 2, "abc"),
        (["analyze", FIVE_BAR, "--at", "key:home"], 2, "home"),
        (["analyze", FIVE_BAR, "--weights", "twist=1,1"], 2, "twist"),
        (["analyze", FIVE_BAR, "--weights", "twist=1,1,-1"], 2, "twist"),
        (["analyze", FIVE_BAR, "--tolerance", "abc"], 2, "tolerance"),
        (["analyze", FIVE_BAR, "--tolerance", "-1mm"], 2, "not negative"),
        (["analyze", FIVE_BAR, "--tolerance", "1mm,2mm"], 2, "one length and one angle"),
        (["analyze", FIVE_BAR, "--set", "alpha=1"], 2, "alpha"),
        (["analyze", FIVE_BAR, "--set", "alpha"], 2, "name=value"),
        (["analyze", "example:stewart", "--set", "height=2deg"], 2, "deg"),
        (["analyze", "example:stewart", "--set", "height=1", "--set", "height=2"], 2, "set twice"),
        (["analyze", FIVE_BAR, "--convention", "other"], 2, "invariant"),
        (["analyze", FIVE_BAR, "--frobnicate"], 2, "--frobnicate"),
        (["analyze", FIVE_BAR, "--at", "o1=0.3"], 1, "open by"),
    ],
)
@pytest.mark.parametrize("as_json", [False, True])
def test_refusals(run, words: list[str], code: int, message: str, as_json: bool) -> None:
    result = run(*words, *(["--json"] if as_json else []), code=code)
    assert result.stdout == ""
    assert message in result.stderr


def test_no_reference_member_lists_the_bodies_and_the_option(run, tmp_path) -> None:
    file = tmp_path / "bare.yaml"
    file.write_text(
        "vincula: 1\nspace: planar\njoints:\n"
        "  - {name: j1, type: revolute, bodies: [ground, arm], at: [0, 0]}\nmotors: [j1]\n",
        encoding="utf-8",
    )
    result = run("analyze", str(file), code=2)
    assert "arm" in result.stderr
    assert "--reference" in result.stderr
