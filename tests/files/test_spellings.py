"""What other programs write differently is read as they mean it."""

from __future__ import annotations

from pathlib import Path

import pytest
from tests.files.conventions import four_bar
from tests.files.conventions.test_conventions import urdf

import vincula as vc
from vincula.files.load import load_with_report

LOOP = """<loop name="o3" type="revolute">
  <predecessor {key}="coupler"><origin xyz="2 1 0" rpy="0 0 0"/></predecessor>
  <{second} {key}="rocker"><origin xyz="-1 2 0" rpy="0 0 0"/></{second}>
  <axis xyz="0 0 1"/></loop>"""


def loaded(folder: Path, inside: str, name: str = "robot.urdf") -> vc.Mechanism:
    path = folder / name
    path.write_text(inside if name.endswith(".sdf") else urdf(inside), encoding="utf-8")
    return load_with_report(path)[0]


def test_loops_as_acdc4robot_spells_them(tmp_path: Path) -> None:
    """`name` for `link`, and an end called `sucessor`."""
    as_meant = loaded(tmp_path, four_bar.TREE + LOOP.format(key="link", second="successor"))
    as_spelt = loaded(tmp_path, four_bar.TREE + LOOP.format(key="name", second="sucessor"))
    for robot in (as_meant, as_spelt):
        (loop,) = [joint for joint in robot.joints if joint.closure]
        assert (loop.name, loop.first, loop.second) == ("o3", "coupler", "rocker")
        assert robot.close(near=robot.home).residual < 1e-12
    speeds = [
        vc.kinematic_ellipsoid(
            robot.with_reference("coupler").with_active(["o1"]).linearize(), vc.Weights()
        ).efficiencies
        for robot in (as_meant, as_spelt)
    ]
    assert speeds[0] == pytest.approx(speeds[1], rel=1e-14)


@pytest.mark.parametrize("second", ["succesor", "successors"])
def test_other_spellings_are_refused(second: str, tmp_path: Path) -> None:
    with pytest.raises(vc.FileError, match="did you mean 'successor'"):
        loaded(tmp_path, four_bar.TREE + LOOP.format(key="link", second=second))


def test_a_spherical_joint_of_urdf_is_a_ball(tmp_path: Path) -> None:
    ball = (
        '<link name="a"/><link name="b"/><joint name="s" type="spherical"><parent link="a"/>'
        '<child link="b"/><origin xyz="0 0 1"/></joint>'
    )
    robot = loaded(tmp_path, ball)
    assert robot.joint["s"].type == "spherical"
    assert robot.active == ()


def test_a_link_called_ground_that_is_not_the_root_has_another_name(tmp_path: Path) -> None:
    inside = (
        '<link name="world"/><link name="ground"/><link name="ground_link"/>'
        '<joint name="f" type="fixed"><parent link="world"/><child link="ground"/>'
        '<origin xyz="0 0 2"/></joint>'
        '<joint name="j" type="continuous"><parent link="ground"/><child link="ground_link"/></joint>'
    )
    robot = loaded(tmp_path, inside)
    assert [body.name for body in robot.bodies] == ["ground_link'", "ground_link"]
    assert (robot.joint["j"].first, robot.joint["j"].second) == ("ground_link'", "ground_link")
    assert robot.body_poses(robot.home)["ground_link"].position == pytest.approx([0.0, 0.0, 2.0])
    _, report = load_with_report(tmp_path / "robot.urdf")
    assert any("the link ground is called ground_link' here" in note for note in report.notes)


def test_friction_of_rolling_is_no_rolling_contact(tmp_path: Path) -> None:
    text = four_bar.SDF_GRAPH.replace(
        '<link name="coupler">',
        '<link name="coupler"><contact><rolling_friction>0.1</rolling_friction></contact>',
    )
    assert "rolling_friction" in text
    assert len(loaded(tmp_path, text, "robot.sdf").joints) == len(
        loaded(tmp_path, four_bar.SDF_GRAPH, "robot.sdf").joints
    )


def test_the_oldest_spelling_of_urdf_plus_is_the_point_and_the_coupling(tmp_path: Path) -> None:
    point = (
        '<{tag} name="o3"{kind}><{a} link="coupler">{first}</{a}>{second}<{b} link="rocker">{third}</{b}>'
        "{fourth}</{tag}>"
    )
    one, two = 'xyz="2 1 0"', 'xyz="-1 2 0"'
    old = point.format(
        tag="constraint", kind=' type="position"', a="predecessor", b="successor",
        first=f"<origin {one}/>", second="", third=f"<origin {two}/>", fourth="",
    )  # fmt: skip
    oldest = point.format(
        tag="loop_constraint", kind="", a="parent", b="child", first="", second=f"<parent_origin {one}/>",
        third="", fourth=f"<child_origin {two}/>",
    )  # fmt: skip
    gear = '<{0} name="g"><{1} link="coupler"/><{2} link="rocker"/><{3} value="3"/></{0}>'
    for loop, words in (
        (old, ("coupling", "predecessor", "successor", "ratio")),
        (oldest, ("joint_constraint", "parent", "child", "gear_ratio")),
    ):
        robot = loaded(tmp_path, four_bar.TREE + loop)
        (closure,) = [joint for joint in robot.joints if joint.closure]
        assert closure.frame_on_first.position == pytest.approx([2.0, 1.0, 0.0])
        assert closure.frame_on_second.position == pytest.approx([-1.0, 2.0, 0.0])
        assert closure.type == "spherical"
        (coupling,) = loaded(tmp_path, four_bar.TREE + gear.format(*words)).couplings
        assert coupling.rates == {"o1": 3.0, "o2": 3.0, "o4": -1.0}


FLOATING = (
    '<robot xmlns:drake="http://drake.mit.edu" name="walker"><link name="floor"/><link name="trunk"/>'
    '<link name="leg"/><joint name="weld" type="fixed"><parent link="world"/><child link="floor"/></joint>'
    '<joint name="hip" type="continuous"><parent link="trunk"/><child link="leg"/></joint></robot>'
)


def test_drake_takes_the_world_and_floating_trees_for_granted(tmp_path: Path) -> None:
    path = tmp_path / "walker.urdf"
    path.write_text(FLOATING, encoding="utf-8")
    robot, report = load_with_report(path)
    assert {joint.name: (joint.type, joint.first, joint.second) for joint in robot.joints} == {
        "weld": ("fixed", "ground", "floor"),
        "hip": ("revolute", "trunk", "leg"),
        "trunk.floating": ("free", "ground", "trunk"),
    }
    assert robot.active == ("hip",)
    assert sum("as Drake takes it" in note for note in report.notes) == 2
    path.write_text(FLOATING.replace(' xmlns:drake="http://drake.mit.edu"', ""), encoding="utf-8")
    with pytest.raises(vc.FileError, match="'world', which does not exist"):
        vc.load(path)


def test_an_srdf_file_belongs_beside_a_urdf_file(tmp_path: Path) -> None:
    path = tmp_path / "robot.srdf"
    path.write_text('<robot name="r"><group name="g"><joint name="j"/></group></robot>', encoding="utf-8")
    with pytest.raises(vc.FileError, match=r"robot.srdf:1:1: .*an SRDF file, .*--loops"):
        vc.load(path)


MIMIC = '<mimic joint="{}" multiplier="2" offset="0.5"/>'


def chain(first: str, second: str, inside: str) -> str:
    """Two joints in a row; the second one mimics the first."""
    return (
        '<link name="a"/><link name="b"/><link name="c"/>'
        f'<joint name="j" type="{first}"><parent link="a"/><child link="b"/></joint>'
        f'<joint name="k" type="{second}"><parent link="b"/><child link="c"/>{inside}</joint>'
    )


def test_joints_that_exporters_have_fixed_keep_their_mimic(tmp_path: Path) -> None:
    """A fixed follower follows nothing; a fixed leader holds its follower at the offset."""
    assert loaded(tmp_path, chain("revolute", "fixed", MIMIC.format("j"))).couplings == ()
    assert load_with_report(tmp_path / "robot.urdf")[1].counts()["mimic"]["ignored"] == 1
    held = loaded(tmp_path, chain("fixed", "revolute", MIMIC.format("j")))
    (coupling,) = held.couplings
    assert coupling.rates == {"k": 1.0}
    assert held.active == ()
    assert held.close(near=held.home)["k"] == pytest.approx([0.5], abs=1e-12)


@pytest.mark.parametrize(("first", "second"), [("floating", "revolute"), ("revolute", "spherical")])
def test_a_joint_without_a_single_value_cannot_mimic(first: str, second: str, tmp_path: Path) -> None:
    with pytest.raises(vc.FileError, match=r"robot.urdf:\d+:\d+: .*has no single value"):
        loaded(tmp_path, chain(first, second, MIMIC.format("j")))
