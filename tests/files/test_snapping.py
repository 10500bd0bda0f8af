"""Files whose axes are parallel only if a typed number means another: never certain of a wrong answer."""

from __future__ import annotations

from dataclasses import replace
from math import pi
from pathlib import Path

import pytest
from tests.files import rounded
from tests.files.leaning import TEXTS, Leaning

import vincula as vc
from vincula.files.load import load, load_with_report
from vincula.mechanism.mechanism import Mechanism


def _subject(mechanism: Mechanism) -> Mechanism:
    member = mechanism if mechanism.reference is not None else mechanism.with_reference("coupler")
    return member.with_active("o1")


@pytest.mark.parametrize("case", rounded.CASES)
def test_as_typed_it_is_doubtful_and_as_meant_certain(tmp_path: Path, case: str) -> None:
    path = rounded.write(tmp_path, case)
    typed = _subject(load(path)).linearize().ledger
    assert {one.mobility for one in typed.scenarios} == {0, 1}
    assert typed.status == "doubtful"
    mechanism, report = load_with_report(path, snap=True)
    snapped = _subject(mechanism).linearize().ledger
    assert snapped.summary.mobility == 1
    assert snapped.status == "certain"
    assert report.snapped
    assert all(f"{path.name}:" in told for told in report.snapped)
    assert report.snapped[0] in mechanism.notes[-1]


@pytest.mark.parametrize("angle", rounded.ANGLES)
def test_as_typed_the_axes_are_not_parallel(tmp_path: Path, angle: str) -> None:
    """Without doubt about digits, what is typed is what is computed: sigma is the tilt times lengths."""
    for case in (f"urdf-{angle}", f"sdf-{angle}", f"euler-{angle}", f"cosine-{angle}"):
        mechanism = _subject(load(rounded.write(tmp_path, case)))
        exact = replace(
            mechanism, precision=replace(mechanism.precision, digits_angle=0.0, digits_length=0.0)
        )
        ledger = exact.linearize().ledger
        assert ledger.status == "certain"
        assert ledger.summary.mobility == 0
        smallest = ledger.decision("all").kept
        tilt = rounded.tilt(float(angle))
        assert 0.1 * tilt < smallest < 3.0 * tilt
        assert mechanism.precision.digits_angle >= abs(float(angle) - pi / 2) * (1 - 1e-6)


def test_a_file_without_such_numbers_is_left_alone(tmp_path: Path) -> None:
    path = tmp_path / "exact.yaml"
    path.write_text(rounded.native("[0, -1, 0]"))
    mechanism, report = load_with_report(path, snap=True)
    assert report.snapped == []
    assert mechanism.notes == load(path).notes
    assert _subject(mechanism).linearize().ledger.status == "certain"


def test_lengths_and_their_places(tmp_path: Path) -> None:
    path = tmp_path / "lengths.yaml"
    text = rounded.native("[0, -1, 0]").replace("[0.85, 0, -0.2]", "[0.8333, 0, -0.2]")
    path.write_text(text.replace("[0.3, 0, 0]", "[0.83333, 0, 0]"))
    mechanism, report = load_with_report(path, snap=True)
    assert report.snapped == [f"0.8333 means 0.83333 ({path}:8, joints[o4], at)"]
    assert mechanism.joint["o4"].frame_on_first.position[0] == 0.83333


def test_parameters_used_as_angles(tmp_path: Path) -> None:
    path = tmp_path / "parameter.yaml"
    text = rounded.native("[0, -sin($turn), cos($turn)]")
    path.write_text(text.replace("space: spatial", "space: spatial\nparameters: {turn: 1.57, far: 3.14}"))
    _, report = load_with_report(path, snap=True)
    assert [told.split(" (")[0] for told in report.snapped] == ["1.57 means pi/2"]
    assert {one.mobility for one in _subject(load(path)).linearize().ledger.scenarios} == {0, 1}


@pytest.mark.parametrize("name", TEXTS)
@pytest.mark.parametrize("spherical", [False, True])
@pytest.mark.parametrize("digits", [4, 6, 8])
def test_axes_that_are_parallel_or_meet_but_for_rounding(
    tmp_path: Path, name: str, spherical: bool, digits: int
) -> None:
    """As typed such a loop cannot be closed (URDF) or may be stuck (SDF); as meant it is a four-bar."""
    path = tmp_path / name
    path.write_text(TEXTS[name](Leaning(digits, seed=digits, spherical=spherical)))
    typed = _subject(load(path))
    if path.suffix == ".sdf":
        assert {one.mobility for one in typed.linearize().ledger.scenarios} == {0, 1}
        assert typed.linearize().ledger.decision("all").status == "doubtful"
    elif digits < 8:
        with pytest.raises(vc.ClosureError, match="cannot close"):
            typed.close()
    mechanism, report = load_with_report(path, snap=True)
    meant = _subject(mechanism)
    ledger = meant.linearize(meant.close()).ledger
    assert ledger.summary.mobility == 1
    assert ledger.decision("all").status == "certain"
    assert 3 <= len(report.snapped) <= 9
    word = "meeting" if spherical else "parallel"
    assert any(f"means {word} ({path}" in told for told in report.snapped)


def test_bodies_hardly_move_when_axes_are_put_right(tmp_path: Path) -> None:
    for name, write in TEXTS.items():
        for spherical in (False, True):
            path = tmp_path / name
            path.write_text(write(Leaning(6, seed=1, spherical=spherical)))
            typed, meant = load(path).body_poses(), load(path, snap=True).body_poses()
            for body, pose in typed.items():
                assert abs(pose.position - meant[body].position).max() < 3e-5
                assert abs(pose.rotation - meant[body].rotation).max() < 2e-5


def test_axes_that_lean_on_purpose_are_left_alone(tmp_path: Path) -> None:
    """A tilt of twenty units of the last digit is no rounding."""
    path = tmp_path / "robot.urdf"
    text = rounded.urdf("1.570796326794897").replace('<axis xyz="0 0 1"/>', '<axis xyz="0 0.0020 1.0000"/>')
    path.write_text(text)
    mechanism, report = load_with_report(path, snap=True)
    assert not [told for told in report.snapped if "axes" in told]
    assert _subject(mechanism).linearize().ledger.summary.mobility == 0


def test_numbers_of_dialects_are_snapped_too(tmp_path: Path) -> None:
    links = "".join(f'<link name="{name}"/>' for name in "abc")
    joints = "".join(
        f'<joint name="{child}" type="continuous"><parent link="a"/><child link="{child}"/></joint>'
        for child in "bc"
    )
    ball = (
        '<drake:ball_constraint><drake:ball_constraint_body_A name="b"/>'
        '<drake:ball_constraint_p_AP value="0 0.2598 0"/><drake:ball_constraint_body_B name="c"/>'
        '<drake:ball_constraint_p_BQ value="0 0.25981 0"/></drake:ball_constraint>'
    )
    gazebo = (
        '<gazebo><joint name="g" type="revolute"><parent>b</parent><child>c</child>'
        "<pose>0 0 0 1.5708 0 0</pose><axis><xyz>0 0.8660 0.5</xyz></axis></joint></gazebo>"
    )
    path = tmp_path / "robot.urdf"
    path.write_text(f'<robot name="r" xmlns:drake="d">{links}{joints}{ball}{gazebo}</robot>')
    told = [one.split(" (")[0] for one in load_with_report(path, snap=True)[1].snapped]
    assert "0.2598 means 0.25981" in told
    assert "1.5708 means pi/2" in told
    assert "0.8660 means sqrt(3/4)" in told
