"""`--exact`, `--snap`, `--assume-singular`, and both readings of rounded numbers, at the command line."""

from __future__ import annotations

from pathlib import Path

import pytest
from tests.files import rounded

ASKED = ("--reference", "coupler", "--active", "o1")
FILES = ("urdf-1.57", "urdf-1.57075", "sdf-1.57075", "euler-1.57075", "quat-4", "native-0.00005")


def words_of(path: Path, case: str) -> tuple[str, ...]:
    return ("analyze", str(path), *(() if case.startswith(("native", "cosine")) else ASKED))


@pytest.mark.parametrize("case", FILES)
def test_both_readings_and_what_decides(run, run_json, tmp_path: Path, case: str) -> None:
    path = rounded.write(tmp_path, case)
    if path.suffix == ".xml":
        pytest.importorskip("mujoco")
    words = words_of(path, case)
    told = run_json(*words)
    readings = told["rank"]["readings"]
    assert told["rank"]["status"] == "doubtful"
    assert (readings["typed"]["mobility"], readings["meant"]["mobility"]) == (0, 1)
    assert all(f"{path.name}:" in number for number in readings["numbers"])
    assert any("with the numbers as typed" in text for text in told["warnings"])
    run(*words, "--strict", code=3)


def test_snap_reads_the_numbers_so_and_lists_them(run, run_json, tmp_path: Path) -> None:
    path = rounded.write(tmp_path, "urdf-1.57075")
    told = run_json(*words_of(path, ""), "--snap")
    assert told["rank"]["status"] == "certain"
    assert told["mobility"]["summary"]["mobility"] == 1
    assert told["rank"]["snapped"][0] == f"1.57075 means pi/2 ({path}:8, joint 'o1', rpy)"
    assert any("1.57075 means pi/2" in note for note in told["notes"])
    run(*words_of(path, ""), "--snap", "--strict", code=0)


def test_exact_takes_the_numbers_as_typed(run, run_json, tmp_path: Path) -> None:
    pytest.importorskip("flint")
    path = rounded.write(tmp_path, "native-0.00005")
    told = run_json("analyze", str(path), "--exact")
    assert told["rank"]["status"] == "exact"
    assert told["mobility"]["summary"]["mobility"] == 0
    assert any("with the numbers as typed" in text for text in told["warnings"])
    meant = run_json("analyze", str(path), "--exact", "--snap")
    assert meant["rank"]["status"] == "exact"
    assert meant["mobility"]["summary"]["mobility"] == 1
    # Rotations typed in radians have no exact matrices: what is proved is proved from below.
    robot = rounded.write(tmp_path, "urdf-1.57075")
    below = run_json(*words_of(robot, ""), "--exact")
    assert below["rank"]["status"] == "certified_lower"
    assert below["mobility"]["summary"]["mobility"] == 0


def test_assume_singular(run, run_json, tmp_path: Path) -> None:
    path = rounded.write(tmp_path, "sdf-1.5708")
    told = run_json(*words_of(path, ""), "--assume-singular")
    assert told["rank"]["status"] == "assumed"
    assert told["mobility"]["summary"]["mobility"] == 1
    assert any("assumed to be zero" in text for text in told["warnings"])
    run(*words_of(path, ""), "--assume-singular", "--strict", code=0)


def test_a_loop_that_only_rounding_opens_names_the_numbers(run, tmp_path: Path) -> None:
    path = tmp_path / "open.urdf"
    path.write_text(rounded.urdf("1.57075").replace('rpy="-1.57075 0 0"', 'rpy="-1.5707 0 0"'))
    opened = path.read_text().replace("0.3 0 0", "0.3 0.01 0").replace("0.7 0 0.25", "0.7 0.01 0.25")
    path.write_text(opened.replace('<origin xyz="0.85 0 -0.2"/>', '<origin xyz="0.85 0 -0.21"/>'))
    other = tmp_path / "turned.urdf"
    turned = rounded.urdf("1.57075").replace('rpy="-1.57075 0 0"', 'rpy="-1.5707 0 0"')
    turned = turned.replace('<origin xyz="0.15 0 -0.45"/>', '<origin xyz="0.15 0 -0.45" rpy="1.5708 0 0"/>')
    before, _, after = turned.partition('<origin xyz="0.85 0 -0.2"/><axis xyz="0 -1 0"/>')
    other.write_text(f'{before}<origin xyz="0.85 0 -0.2" rpy="1.5708 0 0"/><axis xyz="0 0 1"/>{after}')
    for words in (("analyze", str(other), *ASKED), ("analyze", str(other), *ASKED, "--close")):
        refused = run(*words, code=1)
        assert "With the numbers as typed it is open" in refused.stderr
        assert "1.5708 means pi/2" in refused.stderr
        assert "--snap" in refused.stderr
    run("analyze", str(other), *ASKED, "--snap", "--strict", code=0)
    # A loop that is open by a centimetre is open in both readings.
    far = run("analyze", str(path), *ASKED, code=1)
    assert "as typed" not in far.stderr


def test_compare_and_inspect(run, run_json, tmp_path: Path) -> None:
    path = rounded.write(tmp_path, "urdf-1.5708")
    designs = ("--active", "o1", "--active", "o4", "--reference", "coupler")
    assert {one["status"] for one in run_json("compare", str(path), *designs)["designs"]} == {"doubtful"}
    assert {one["status"] for one in run_json("compare", str(path), *designs, "--snap")["designs"]} == {
        "certain"
    }
    run("compare", str(path), *designs, "--strict", code=3)
    load = run_json("inspect", str(path), "--snap")["load"]
    assert load["snapped"]
    assert run_json("inspect", str(path))["load"]["snapped"] == []


def test_an_exact_example(run_json) -> None:
    pytest.importorskip("flint")
    told = run_json("analyze", "example:five-bar", "--exact")
    assert told["rank"]["status"] == "exact"
    assert told["rank"]["basis"] == "the mechanism as drawn, every number as it is written"
