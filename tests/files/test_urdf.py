"""URDF files: joints, mimic, motors, side files, and what is ignored, refused or noted."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from tests.files.conventions import four_bar
from tests.files.conventions.test_conventions import urdf

import vincula as vc
from vincula.cli.main import cli
from vincula.files.load import load_with_report
from vincula.files.report import LoadReport

TREE = four_bar.TREE


def loaded(folder: Path, inside: str, name: str = "robot.urdf") -> tuple[vc.Mechanism, LoadReport]:
    path = folder / name
    path.write_text(urdf(inside), encoding="utf-8")
    return load_with_report(path)


def two(kind: str, inside: str = "") -> str:
    return (
        f'<link name="a"/><link name="b"/><joint name="j" type="{kind}"><parent link="a"/><child link="b"/>'
        f"{inside}</joint>"
    )


def test_axis_origin_and_quaternion(tmp_path: Path) -> None:
    half = 0.5**0.5
    for turn in ('rpy="0 0 1.5707963267948966"', f'quat_xyzw="0 0 {half!r} {half!r}"'):
        robot, _ = loaded(tmp_path, two("prismatic", f'<origin xyz="1 0 0" {turn}/><axis xyz="2 0 0"/>'))
        pose = robot.body_poses(robot.configuration({"j": 0.5}))["b"]
        assert pose.position == pytest.approx([1.0, 0.5, 0.0], abs=1e-15)
        assert pose.rotation @ [1.0, 0.0, 0.0] == pytest.approx([0.0, 1.0, 0.0], abs=1e-15)


def test_mimic_is_a_coupling_and_the_follower_no_motor(tmp_path: Path) -> None:
    inside = TREE.replace(
        '<parent link="crank"/>', '<parent link="crank"/> <mimic joint="o1" multiplier="2" offset="0.5"/>'
    )
    robot, _ = loaded(tmp_path, inside)
    (coupling,) = robot.couplings
    values = {"o1": 0.3, "o2": 1.1}
    assert coupling.residual(values, {"o1": 0.0, "o2": 0.0}) == pytest.approx(0.0, abs=1e-15)
    assert coupling.coefficients(values, {"o1": 0.0, "o2": 0.0}) == {"o2": 1.0, "o1": -2.0}
    assert robot.active == ("o1", "o4")


def test_a_coupling_of_urdf_plus_runs_over_both_ways_down(tmp_path: Path) -> None:
    ends = '<predecessor link="coupler"/><successor link="rocker"/>'
    inside = f'{TREE}<coupling name="c">{ends}<ratio value="3"/></coupling>'
    robot, _ = loaded(tmp_path, inside)
    (coupling,) = robot.couplings
    assert coupling.rates == {"o1": 3.0, "o2": 3.0, "o4": -1.0}


def test_joints_with_a_command_interface_are_motors(tmp_path: Path) -> None:
    inside = TREE + (
        '<ros2_control name="c" type="system"><hardware/>'
        '<joint name="o1"><command_interface name="position"/></joint>'
        '<joint name="o2"><state_interface name="position"/></joint></ros2_control>'
    )
    robot, report = loaded(tmp_path, inside)
    assert robot.active == ("o1",)
    assert report.counts()["ros2_control joint"]["used"] == 2


def test_passive_joints_of_an_srdf_file(tmp_path: Path) -> None:
    srdf = '<robot name="linkage"><passive_joint name="o2"/><group name="g"/></robot>'
    (tmp_path / "robot.srdf").write_text(srdf, encoding="utf-8")
    robot, report = loaded(tmp_path, TREE)
    assert robot.active == ("o1", "o4")
    assert report.counts()["passive_joint"]["used"] == 1
    assert report.counts()["SRDF group"]["ignored"] == 1


def test_side_files_by_name(tmp_path: Path) -> None:
    path = tmp_path / "other.urdf"
    path.write_text(urdf(TREE + four_bar.GEPETTO_TREE), encoding="utf-8")
    side = tmp_path / "my-loops.yaml"
    side.write_text(four_bar.GEPETTO["6d"], encoding="utf-8")
    assert len(vc.load(path, beside=[side]).residuals()) == 1
    assert len(vc.load(path).residuals()) == 0
    words = ["inspect", str(path), "--loops", str(side), "--json"]
    assert '"o1"' in CliRunner().invoke(cli, words).stdout
    with pytest.raises(vc.FileError, match="this is none"):
        vc.load("example:five-bar", beside=[side])
    refused = CliRunner().invoke(cli, ["inspect", "example:five-bar", "--loops", str(side)])
    assert refused.exit_code == 2


def test_harmless_strangers_are_ignored_and_possible_loops_refused(tmp_path: Path) -> None:
    _, report = loaded(
        tmp_path, TREE + '<mood colour="blue"/><gazebo reference="crank"><mu1>1</mu1></gazebo>'
    )
    assert report.counts()["mood"] == {"total": 1, "used": 0, "ignored": 1, "repaired": 0}
    assert report.counts()["gazebo mu1"]["ignored"] == 1
    for stranger in ('<rope from="crank" to="rocker"/>', "<loop_closure/>", "<x><mimicJoint/></x>"):
        with pytest.raises(vc.FileError, match="may be a loop"):
            loaded(tmp_path, TREE + stranger)


def test_plugins_that_couple_joints_are_said(tmp_path: Path) -> None:
    plugin = '<gazebo><plugin name="p"><joint>o1</joint><mimicJoint>o2</mimicJoint></plugin></gazebo>'
    _, report = loaded(tmp_path, TREE + plugin)
    assert any("plugins that couple joints are not read" in note for note in report.notes)


def test_a_link_with_two_parents_is_noted(tmp_path: Path) -> None:
    robot, report = loaded(tmp_path, TREE + four_bar.URDF["several parents"])
    assert any("pin is the child of 2 joints" in note for note in report.notes)
    assert "o3" in robot.active


def test_springs_of_drake_leave_the_loop_open_and_say_so(tmp_path: Path) -> None:
    _, report = loaded(tmp_path, TREE + "<drake:linear_bushing_rpy/>")
    assert any("spring" in note for note in report.notes)


def test_joints_of_drake(tmp_path: Path) -> None:
    links = '<link name="a"/><link name="b"/>'
    ends = '<parent link="a"/><child link="b"/>'
    for kind, inside, expected in (
        ("ball", "", "spherical"),
        ("universal", "", "universal"),
        ("planar", "", "planar"),
        ("screw", '<axis xyz="0 0 1"/><drake:screw_thread_pitch value="0.02"/>', "screw"),
    ):
        text = f'{links}<drake:joint name="j" type="{kind}">{ends}{inside}</drake:joint>'
        robot, _ = loaded(tmp_path, text)
        assert robot.joints[0].type == expected
    pose = robot.body_poses(robot.configuration({"j": np.pi}))["b"]
    assert pose.position == pytest.approx([0.0, 0.0, 0.01], abs=1e-15)
    universal, _ = loaded(tmp_path, f'{links}<drake:joint name="j" type="universal">{ends}</drake:joint>')
    turned = universal.body_poses(universal.configuration({"j": [0.3, 0.4]}))["b"].rotation
    c, s = np.cos([0.3, 0.4]), np.sin([0.3, 0.4])
    first = np.array([[1, 0, 0], [0, c[0], -s[0]], [0, s[0], c[0]]])
    second = np.array([[c[1], 0, s[1]], [0, 1, 0], [-s[1], 0, c[1]]])
    assert turned == pytest.approx(first @ second, abs=1e-15)


@pytest.mark.parametrize(
    ("folder", "loops"),
    [
        ("gepetto_5bar_linkage", 1),
        ("gepetto_5bar_linkage_iso3d", 1),
        ("gepetto_5bar_linkage_iso6d", 1),
        ("gepetto_cassie_like", 2),
        ("gepetto_robot_delta", 3),
    ],
)
def test_real_robots_are_read_without_an_unexplained_element(models: Path, folder: str, loops: int) -> None:
    robot, report = load_with_report(models / folder / "robot_nomesh.urdf")
    assert len(robot.residuals()) == loops
    assert report.counts()["closed_loop"]["used"] == loops
    assert all(entry.detail for entry in report.entries if entry.fate != "used")
    assert "not known" not in str(report)


# Spellings of older and larger files --------------------------------------------------------------

SERIAL = """<robot name="arm"><link name="base"/><link name="a"/><link name="b"/><link name="c"/>
  <joint name="mot_a_left" type="continuous"><parent link="base"/><child link="a"/><axis xyz="0 0 1"/></joint>
  <joint name="mot_b_left" type="continuous"><parent link="a"/><child link="b"/><origin xyz="1 0 0"/>
    <axis xyz="0 0 1"/></joint>
  <joint name="to_c" type="revolute"><parent link="b"/><child link="c"/><origin xyz="1 0 0"/>
    <axis xyz="0 1 0"/><limit lower="-1" upper="1"/></joint>{}</robot>"""


def side_file_read(tmp_path: Path, yaml: str) -> vc.Mechanism:
    (tmp_path / "arm.urdf").write_text(SERIAL.format(""), encoding="utf-8")
    (tmp_path / "arm.yaml").write_text(yaml, encoding="utf-8")
    return vc.load(tmp_path / "arm.urdf")


def test_gepetto_cardan_turns_about_x_then_y(tmp_path: Path) -> None:
    text = "closed_loop: []\ntype: []\nname_mot: [mot_a_left]\njoint_name: [to_c]\njoint_type: [CARDAN]\n"
    robot = side_file_read(tmp_path, text)
    assert robot.joint["to_c"].type == "universal"
    assert robot.active == ("mot_a_left",)
    turned = robot.body_poses(robot.configuration({"to_c": (0.3, 0.4)}))["c"].rotation
    c, s = np.cos, np.sin
    about_x = np.array([[1, 0, 0], [0, c(0.3), -s(0.3)], [0, s(0.3), c(0.3)]])
    about_y = np.array([[c(0.4), 0, s(0.4)], [0, 1, 0], [-s(0.4), 0, c(0.4)]])
    assert turned == pytest.approx(about_x @ about_y, abs=1e-15)


def test_gepetto_words_in_capitals_fixed_joints_and_parts_of_names(tmp_path: Path) -> None:
    for kind, closure in (("3D", "spherical"), ("6D", "fixed"), ("6d", "fixed")):
        loops = f"closed_loop: [[a, c]]\ntype: [{kind}]\nname_mot: [mot]\n"
        robot = side_file_read(tmp_path, loops + "joint_name: [to_c]\njoint_type: [FIXED]\n")
        assert robot.joint["loop:a-c"].type == closure
        assert robot.joint["to_c"].type == "fixed"
        assert robot.active == ("mot_a_left", "mot_b_left")


def test_gepetto_universal_joints_about_named_axes(tmp_path: Path) -> None:
    text = "name_mot: [mot_a_left]\njoint_name: [to_c]\njoint_type: [UJOINT_ZY]\n"
    robot = side_file_read(tmp_path, text)
    turned = robot.body_poses(robot.configuration({"to_c": (0.3, 0.4)}))["c"].rotation
    c, s = np.cos, np.sin
    about_z = np.array([[c(0.3), -s(0.3), 0], [s(0.3), c(0.3), 0], [0, 0, 1]])
    about_y = np.array([[c(0.4), 0, s(0.4)], [0, 1, 0], [-s(0.4), 0, c(0.4)]])
    assert turned == pytest.approx(about_z @ about_y, abs=1e-15)


def test_older_gepetto_files_name_parts_of_names(tmp_path: Path) -> None:
    (tmp_path / "arm.urdf").write_text(
        SERIAL.format('<fixed_frame/>').replace('<fixed_frame/>', "".join(
            f'<link name="{name}"/><joint name="{name}_fixed" type="fixed"><parent link="{link}"/>'
            f'<child link="{name}"/></joint>'
            for name, link in (("fermeture1_A", "a"), ("fermeture1_B", "c"))
        )),
        encoding="utf-8",
    )  # fmt: skip
    text = "name_mot: mot\nrotule_name: to_\nname_closedloop: fermeture\nclosed_loop_number: {}\ntype: {}\n"
    for kind, closure in (("6D", "fixed"), ("3D", "spherical")):
        (tmp_path / "arm.yaml").write_text(text.format(1, kind) + "Lidmot: [0, 1]\n", encoding="utf-8")
        robot, report = load_with_report(tmp_path / "arm.urdf")
        assert robot.joint["loop:fermeture1_A-fermeture1_B"].type == closure
        assert robot.joint["to_c"].type == "spherical"
        assert robot.active == ("mot_a_left", "mot_b_left")
        assert {e.kind: e.fate for e in report.entries if e.name in ("", "to_c")} == {
            "joint": "repaired", "Lidmot": "ignored"
        }  # fmt: skip
    (tmp_path / "arm.yaml").write_text(text.format(2, "6D"), encoding="utf-8")
    with pytest.raises(vc.FileError, match=r"arm.yaml:3:.*got 1 pairs"):
        vc.load(tmp_path / "arm.urdf")


def test_older_files_of_urdf_plus_say_constraint(tmp_path: Path) -> None:
    ends = (
        '<predecessor link="c"><origin xyz="1 0 0"/></predecessor>'
        '<successor link="base"><origin xyz="3 0 0"/></successor>'
    )
    point = f'<constraint name="tip" type="position">{ends}</constraint>'
    wheels = '<predecessor link="a"/><successor link="c"/><ratio value="2"/>'
    wheel = f'<constraint name="gear" type="rolling">{wheels}</constraint>'
    for extra, name in ((point, "tip"), (wheel, "gear")):
        path = tmp_path / f"{name}.urdf"
        path.write_text(SERIAL.format(extra), encoding="utf-8")
        robot = vc.load(path)
        if name == "tip":
            assert robot.joint["tip"].type == "spherical"
            assert robot.residuals()[0].gap < 1e-15
        else:
            # The way to a is a part of the way to c: what is left is the way from a to c.
            assert dict(robot.couplings[0].rates) == {"mot_b_left": -1.0, "to_c": -1.0}
    path.write_text(SERIAL.format(point.replace("position", "glue")), encoding="utf-8")
    with pytest.raises(vc.FileError, match="glue"):
        vc.load(path)
