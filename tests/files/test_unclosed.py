"""Frames that look like the ends of loops which nothing closes are told; closed ones, and others, are not."""

from __future__ import annotations

from pathlib import Path

import pytest
from tests.files.conventions.test_conventions import urdf

from vincula.files.load import load_with_report

LINKS = '<link name="base"/><link name="left"/><link name="right"/>'
HINGES = "".join(
    f'<joint name="j_{side}" type="continuous"><parent link="base"/><child link="{side}"/>'
    '<axis xyz="0 0 1"/></joint>'
    for side in ("left", "right")
)


def robot(folder: Path, first: str, second: str, *, on: str = "right", side_file: str = "") -> list[str]:
    """The notes of a robot with two frames, on the left and another link."""
    ends = "".join(
        f'<link name="{name}"/><joint name="{name}_frame" type="fixed"><parent link="{link}"/>'
        f'<child link="{name}"/><origin xyz="1 0 0"/></joint>'
        for name, link in ((first, "left"), (second, on))
    )
    (folder / "robot.urdf").write_text(urdf(LINKS + HINGES + ends), encoding="utf-8")
    if side_file:
        (folder / "robot.yaml").write_text(side_file, encoding="utf-8")
    notes = load_with_report(folder / "robot.urdf")[1].notes
    return [note for note in notes if note.startswith("these frames look like")]


@pytest.mark.parametrize(
    ("first", "second"),
    [
        ("closing_tip_1", "closing_tip_2"),
        ("closedloop3_B", "closedloop3_A"),
        ("fermeture_A", "fermeture_B"),
        ("closedloop_ankle_left_2A", "closedloop_ankle_left_2B"),
        ("Loop1", "Loop2"),
    ],
)
def test_ends_that_nothing_joins_are_named_with_what_to_write(
    first: str, second: str, tmp_path: Path
) -> None:
    (note,) = robot(tmp_path, first, second)
    assert first in note
    assert second in note
    assert "closed_loop: [[" in note


@pytest.mark.parametrize(
    ("first", "second"), [("tip_1", "tip_2"), ("closet_1", "closet_2"), ("closing_a_1", "closing_b_2")]
)
def test_other_names_are_not(first: str, second: str, tmp_path: Path) -> None:
    assert robot(tmp_path, first, second) == []


def test_a_loop_that_a_side_file_closes_is_not(tmp_path: Path) -> None:
    side_file = "closed_loop: [[closing_tip_1, closing_tip_2]]\ntype: [3d]\n"
    assert robot(tmp_path, "closing_tip_1", "closing_tip_2", side_file=side_file) == []


def test_the_note_of_an_sdf_file_names_the_overlay(tmp_path: Path) -> None:
    frames = "".join(
        f'<frame name="closing_tip_{k}" attached_to="{link}"/>' for k, link in ((1, "a"), (2, "b"))
    )
    hinges = "".join(
        f'<link name="{link}"/><joint name="j{link}" type="revolute"><parent>world</parent>'
        f"<child>{link}</child><axis><xyz>0 0 1</xyz></axis></joint>"
        for link in "ab"
    )
    path = tmp_path / "robot.sdf"
    path.write_text(f'<sdf version="1.9"><model name="m">{hinges}{frames}</model></sdf>', encoding="utf-8")
    _, report = load_with_report(path)
    assert any("frames: [closing_tip_1, closing_tip_2]" in note for note in report.notes)
    (tmp_path / "closed.yaml").write_text(
        "vincula: 1\nbase: robot.sdf\nclosures: [{name: tip, type: spherical, frames: "
        "[closing_tip_1, closing_tip_2]}]\n",
        encoding="utf-8",
    )
    closed, _ = load_with_report(tmp_path / "closed.yaml")
    assert [joint.name for joint in closed.joints if joint.closure] == ["tip"]
