"""Files whose axes are parallel only if a typed number means another: never certain of a wrong answer."""

from __future__ import annotations

from dataclasses import replace
from math import pi
from pathlib import Path

import pytest
from tests.files import rounded

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
