"""Transmissions of URDF files: of types that nobody knows, and actuators that several of them name."""

from __future__ import annotations

from pathlib import Path

import pytest
from tests.files.conventions.test_conventions import urdf

import vincula as vc
from vincula.files.load import load_with_report
from vincula.files.report import LoadReport

ARM = "".join(
    f'<link name="l{k}"/><joint name="j{k}" type="continuous"><parent link="l{k - 1}"/><child link="l{k}"/>'
    '<origin xyz="1 0 0"/><axis xyz="0 0 1"/></joint>'
    for k in (1, 2, 3)
)


def loaded(folder: Path, *transmissions: str) -> tuple[vc.Mechanism, LoadReport]:
    path = folder / "robot.urdf"
    path.write_text(urdf('<link name="l0"/>' + ARM + "".join(transmissions)), encoding="utf-8")
    return load_with_report(path)


def simple(joint: str, actuator: str) -> str:
    return (
        f'<transmission name="t_{joint}"><type>transmission_interface/SimpleTransmission</type>'
        f'<joint name="{joint}"/><actuator name="{actuator}"/></transmission>'
    )


def test_an_actuator_that_two_transmissions_name_is_two_motors(tmp_path: Path) -> None:
    """Copied names are frequent; the first motor must not get lost under the second."""
    robot, report = loaded(tmp_path, simple("j1", "motor"), simple("j3", "motor"))
    assert robot.active == ("j1", "j3")
    assert dict(robot.motors) == {"motor": "j1", "j3": "j3"}
    assert report.notes == ["the actuator motor drives j1 and j3: each counts as a motor of its own"]
    assert report.counts()["transmission"] == {"total": 2, "used": 2, "ignored": 0, "repaired": 0}


def test_a_transmission_of_an_unknown_type_drives_the_joints_that_it_names(tmp_path: Path) -> None:
    own = (
        '<transmission name="wrist" type="WristTransmission"><rightActuator name="a"/>'
        '<leftActuator name="b"/><flexJoint name="j1"/><rollJoint name="j2"/><passive_joint name="j3"/>'
        "</transmission>"
    )
    robot, report = loaded(tmp_path, own)
    assert robot.active == ("j1", "j2")
    (note,) = report.notes
    assert note.startswith("transmissions of type WristTransmission are not understood")
    assert "--active" in note


def test_an_unknown_transmission_without_joints_drives_nothing(tmp_path: Path) -> None:
    robot, report = loaded(
        tmp_path, simple("j2", "m"), '<transmission name="t"><type>x/Belt</type></transmission>'
    )
    assert robot.active == ("j2",)
    assert report.counts()["transmission"] == {"total": 2, "used": 1, "ignored": 1, "repaired": 0}


@pytest.mark.parametrize("kind", ["SimpleTransmision", "simpleTransmission", "DiferentialTransmission"])
def test_a_slip_of_the_pen_in_a_known_type_is_refused(kind: str, tmp_path: Path) -> None:
    text = f'<transmission name="t"><type>{kind}</type><joint name="j1"/></transmission>'
    with pytest.raises(vc.UnsupportedFeatureError, match="did you mean"):
        loaded(tmp_path, text)


def test_a_known_type_with_the_wrong_joints_is_refused(tmp_path: Path) -> None:
    text = '<transmission name="t"><type>DifferentialTransmission</type><joint name="j1"/></transmission>'
    with pytest.raises(vc.UnsupportedFeatureError, match="with 1 joints and 0 actuators"):
        loaded(tmp_path, text)


def test_a_transmission_of_a_fixed_joint_is_ignored(tmp_path: Path) -> None:
    """Exporters of reduced models fix joints and leave their transmissions."""
    path = tmp_path / "robot.urdf"
    arm = ARM.replace('name="j2" type="continuous"', 'name="j2" type="fixed"')
    inside = '<link name="l0"/>' + arm + simple("j1", "m1") + simple("j2", "m2")
    path.write_text(urdf(inside), encoding="utf-8")
    robot, report = load_with_report(path)
    assert dict(robot.motors) == {"m1": "j1"}
    assert report.counts()["transmission"] == {"total": 2, "used": 1, "ignored": 1, "repaired": 0}
