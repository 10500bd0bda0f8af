"""`vincula convert`: what was read is written, and reads back to the same."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from vincula.mechanism.catalog.registry import MODULES


def same_analysis(one, two) -> None:
    assert one["mobility"]["summary"] == two["mobility"]["summary"]
    assert one["active"] == two["active"]
    for kind in ("kinematic", "passive_force", "dual_force"):
        first, second = ([float(e) for e in found[kind]["efficiencies"]] for found in (one, two))
        assert second == pytest.approx(first, rel=1e-9)


@pytest.mark.parametrize("name", MODULES)
@pytest.mark.parametrize("ending", [".yaml", ".json"])
def test_every_example_survives(run, run_json, tmp_path: Path, name: str, ending: str) -> None:
    target = tmp_path / f"mechanism{ending}"
    result = run("convert", f"example:{name}", str(target))
    assert result.stdout == ""
    assert f"wrote {target}" in result.stderr
    if ending == ".json":
        assert json.loads(target.read_text(encoding="utf-8"))["vincula"] == 1
    same_analysis(run_json("analyze", f"example:{name}"), run_json("analyze", str(target)))


@pytest.mark.parametrize(
    ("path", "words"),
    [
        ("robotiq_2f85_menagerie/2f85_nomesh.xml", ["--reference", "right_pad"]),
        ("aloha_mink/aloha_nomesh.xml", ["--reference", "left/gripper_link@left/gripper"]),
        (
            "stewart_sdf/stewart_from_sdf.xml",
            ["--reference", "platform", "--active", "piston1_prismatic_joint"],
        ),
    ],
)
def test_real_robots_survive(
    run, run_json, models: Path, tmp_path: Path, path: str, words: list[str]
) -> None:
    pytest.importorskip("mujoco")
    source, target = str(models / path), str(tmp_path / "robot.yaml")
    found = run_json("convert", source, target, *words)
    assert found["schema"] == "vincula/conversion/1"
    assert found["load"]["format"] == "MJCF"
    same_analysis(run_json("analyze", source, *words), run_json("analyze", target))


def test_parameters_and_choices_are_written(run, run_json, tmp_path: Path) -> None:
    target = str(tmp_path / "low.yaml")
    run("convert", "example:stewart", target, "--set", "height=1", "--active", "p1,p2", "--lock", "p6")
    found = run_json("inspect", target)
    assert found["active"] == ["p1", "p2"]
    assert found["locked"] == ["p6"]


def test_an_old_file_is_kept_unless_forced(run, tmp_path: Path) -> None:
    target = tmp_path / "old.yaml"
    target.write_text("mine\n", encoding="utf-8")
    assert "--force" in run("convert", "example:five-bar", str(target), code=2).stderr
    assert target.read_text(encoding="utf-8") == "mine\n"
    run("convert", "example:five-bar", str(target), "--force")
    assert target.read_text(encoding="utf-8").startswith("vincula: 1\n")


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["example:five-bar"], "OUT"),
        (["example:five-bar", "out.usd"], ".yaml, .yml, .json"),
        (["example:five-bar", "no/such/folder/out.yaml"], "cannot be written"),
        (["nosuch.xml", "out.yaml"], "no such file"),
        (["example:five-bar", "out.yaml", "--reference", "ground"], "ground"),
    ],
)
def test_refusals(run, tmp_path: Path, monkeypatch, words: list[str], message: str) -> None:
    monkeypatch.chdir(tmp_path)
    result = run("convert", *words, code=2)
    assert result.stdout == ""
    assert message in result.stderr
    assert not list(tmp_path.iterdir())


ROBOTS = [("mjcf", ".xml"), ("sdf", ".sdf"), ("urdf-plus", ".urdf"), ("urdf-gepetto", ".urdf")]


@pytest.mark.parametrize(("to", "ending"), ROBOTS)
def test_one_robot_in_every_format(run, run_json, tmp_path: Path, to: str, ending: str) -> None:
    pytest.importorskip("mujoco")
    before = run_json("analyze", "example:delta")
    target = str(tmp_path / f"delta{ending}")
    found = run_json("convert", "example:delta", target, "--to", to)
    assert found["format"] == to
    assert found["files"] == [target] + [str(tmp_path / "delta.yaml")] * (to == "urdf-gepetto")
    member = next(text for text in found["changed"] if "--reference" in text).partition("--reference ")[2]
    after = run_json("analyze", target, "--reference", member)
    for one in (before, after):
        one["mobility"]["summary"].pop("static_indeterminacy")
    same_analysis(before, after)


def test_a_planar_drawing_needs_lossy_in_a_robot_file(run, tmp_path: Path) -> None:
    target = tmp_path / "five-bar.xml"
    assert "the plane" in run("convert", "example:five-bar", str(target), code=2).stderr
    assert not target.exists()
    assert "lost: the plane" in run("convert", "example:five-bar", str(target), "--lossy").stderr
    assert "loop" in run("inspect", str(target)).stdout
