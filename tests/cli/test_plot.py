"""`vincula plot`: figures in three formats, for one and for several choices of motors."""

from __future__ import annotations

from pathlib import Path

import pytest

pytest.importorskip("matplotlib")

FIVE_BAR = "example:five-bar"
MAGIC = {".svg": b"<?xml", ".png": b"\x89PNG", ".pdf": b"%PDF"}


@pytest.mark.parametrize("ending", MAGIC)
def test_formats(run, tmp_path: Path, ending: str) -> None:
    target = tmp_path / f"five-bar{ending}"
    result = run("plot", FIVE_BAR, "-o", str(target))
    assert target.read_bytes().startswith(MAGIC[ending])
    assert result.stdout == ""
    assert f"wrote {target}" in result.stderr


def test_an_old_figure_is_replaced_and_the_same_command_gives_the_same_bytes(run, tmp_path: Path) -> None:
    target = tmp_path / "figure.svg"
    target.write_text("old", encoding="utf-8")
    run("plot", FIVE_BAR, "--output", str(target))
    first = target.read_bytes()
    run("plot", FIVE_BAR, "--output", str(target))
    assert target.read_bytes() == first


def test_several_choices_of_motors_in_one_figure(run_json, tmp_path: Path) -> None:
    one, three = tmp_path / "one.svg", tmp_path / "three.svg"
    run_json("plot", FIVE_BAR, "-o", str(one), "--ellipsoid", "kinematic")
    designs = ["--active", "o1,o5", "--active", "o2,o4", "--active", "all"]
    found = run_json("plot", FIVE_BAR, "-o", str(three), "--ellipsoid", "kinematic", *designs)
    assert found == {
        "schema": "vincula/figure/1",
        "mechanism": "five-bar",
        "reference": "coupler",
        "ellipsoids": ["kinematic"],
        "figure": str(three),
    }
    assert len(three.read_bytes()) > 2 * len(one.read_bytes())


def test_the_mechanism_alone_needs_no_closed_loop_and_no_reference(run, run_json, tmp_path: Path) -> None:
    target = tmp_path / "alone.svg"
    found = run_json("plot", FIVE_BAR, "-o", str(target), "--ellipsoid", "none")
    assert found["ellipsoids"] == []
    run("plot", FIVE_BAR, "-o", str(target), "--ellipsoid", "none", "--at", "o1=0.3")
    run("plot", FIVE_BAR, "-o", str(target), "--at", "o1=0.3", code=1)


def test_names_width_and_space(run, tmp_path: Path) -> None:
    words = ["--ellipsoid", "kinematic", "--no-names", "--width", "3"]
    run("plot", "example:serial-7r", "-o", str(tmp_path / "arm.png"), *words)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ([], "--output"),
        (["-o", "figure.gif"], ".svg, .png, .pdf"),
        (["-o", "no/such/folder/figure.svg"], "cannot be written"),
        (["-o", "x.svg", "--ellipsoid", "round"], "kinematic"),
        (["-o", "x.svg", "--ellipsoid", "none", "--ellipsoid", "kinematic"], "cannot be combined"),
        (["-o", "x.svg", "--width", "0"], "--width"),
        (["-o", "x.svg", "--active", "o9"], "'o9'"),
    ],
)
def test_refusals(run, tmp_path: Path, monkeypatch, words: list[str], message: str) -> None:
    monkeypatch.chdir(tmp_path)
    result = run("plot", FIVE_BAR, *words, code=2)
    assert result.stdout == ""
    assert message in result.stderr
    assert not list(tmp_path.iterdir())


def test_without_matplotlib_the_install_command_is_told(run, tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "matplotlib", None)
    result = run("plot", FIVE_BAR, "-o", str(tmp_path / "x.svg"), code=2)
    assert "pip install 'vincula[plot]'" in result.stderr
