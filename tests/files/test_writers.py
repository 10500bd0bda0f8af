"""Writers: what is written reads back to the same mechanism, in ours and in other programs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from tests.files.same_mechanism import ROBOTS, numbers, read_back, same_numbers, same_poses

import vincula as vc
from vincula.files.save import save, written
from vincula.mechanism.catalog.registry import MODULES, example
from vincula.mechanism.spatial_twin import spatial_twin

MODELS = (
    "aloha_mink/aloha_nomesh.xml",
    "drake_four_bar/four_bar.sdf",
    "drake_four_bar/four_bar_loop.sdf",
    "drake_four_bar/four_bar_weld.sdf",
    "gepetto_5bar_linkage/robot_nomesh.urdf",
    "gepetto_5bar_linkage_iso3d/robot_nomesh.urdf",
    "gepetto_5bar_linkage_iso6d/robot_nomesh.urdf",
    "gepetto_cassie_like/robot_nomesh.urdf",
    "gepetto_robot_delta/robot_nomesh.urdf",
    "leap_hand_mink/right_hand_nomesh.xml",
    "robotiq_2f85_menagerie/2f85_nomesh.xml",
    "stewart_sdf/model.sdf",
    "stewart_sdf/stewart_from_sdf.xml",
    "unitree_go1_mink/go1_nomesh.xml",
)
CANNOT = {
    ("aloha_mink/aloha_nomesh.xml", "sdf"): "one space of names",
    ("robotiq_2f85_menagerie/2f85_nomesh.xml", "sdf"): "combines axes",
    ("robotiq_2f85_menagerie/2f85_nomesh.xml", "urdf-plus"): "combines axes",
    ("robotiq_2f85_menagerie/2f85_nomesh.xml", "urdf-gepetto"): "combines axes",
    ("unitree_go1_mink/go1_nomesh.xml", "sdf"): "no joint of type free",
}
"""What of the real robots a format cannot hold."""


@pytest.mark.parametrize("to", ROBOTS)
@pytest.mark.parametrize("name", MODULES)
def test_every_example_is_read_back_or_its_losses_are_said(name: str, to: str, tmp_path: Path) -> None:
    if to == "mjcf":
        pytest.importorskip("mujoco")
    mechanism, path = example(name), tmp_path / f"robot{ROBOTS[to]}"
    # A free body has no joint in SDF, and only contacts would hold it.
    lost = [text for text in written(mechanism, path, to).lost if not ("SDF" in text and "joint" in text)]
    expected = len(mechanism.contacts) + (mechanism.space.name == "planar")
    assert len(lost) == expected, lost
    if lost:
        with pytest.raises(vc.UnsupportedFeatureError, match="cannot hold everything"):
            save(mechanism, path, to)
        assert not path.exists()
    if not mechanism.contacts:
        again, _ = read_back(mechanism, path, to, lossy=True)
        twin = spatial_twin(mechanism)
        assert again.active == mechanism.active
        same_numbers(twin, again)
        same_poses(twin, again, origins=not to.startswith("urdf"))


def test_the_twin_in_space_moves_in_the_plane_as_the_drawing() -> None:
    planar = example("five-bar")
    twin = spatial_twin(planar)
    one, other = numbers(planar), numbers(twin)
    assert other[0] == one[0]
    assert other[2]["kinematic"] == pytest.approx(one[2]["kinematic"], rel=1e-9)
    assert np.array_equal(twin.body["coupler"].pose.position[:2], planar.body["coupler"].pose.position)


@pytest.mark.parametrize("to", ROBOTS)
@pytest.mark.parametrize("model", MODELS)
def test_every_real_robot_is_read_back(model: str, to: str, models: Path, tmp_path: Path) -> None:
    if to == "mjcf" or model.endswith(".xml"):
        pytest.importorskip("mujoco")
    robot, path = vc.load(models / model), tmp_path / f"robot{ROBOTS[to]}"
    robot = robot.with_reference(robot.bodies[-1].name)
    if max((r.gap for r in robot.residuals()), default=0.0) > 1e-8 * robot.length:
        robot = robot.with_configuration(robot.close())
    if (model, to) in CANNOT:
        assert any(CANNOT[model, to] in text for text in written(robot, path, to).lost)
        return
    again, saved = read_back(robot, path, to)
    assert saved.lost == ()
    assert again.active == robot.active
    same_numbers(robot, again)
    moved = any("moved" in text for text in saved.changed)
    same_poses(robot, again, origins=not moved)


def test_parts_of_one_name_get_names_of_their_own_in_sdf(tmp_path: Path) -> None:
    def hinge(name: str, first: str, second: str, x: float, y: float) -> vc.Revolute:
        return vc.Revolute(name, first, second, at=(x, y, 0.0), axis=(0.0, 0.0, 1.0))

    joints = [hinge("crank", "ground", "crank", 0, 0), hinge("rod", "crank", "rod", 0, 1),
              hinge("o3", "rod", "crank_joint", 2, 2), hinge("o4", "ground", "crank_joint", 3, 0)]
    mechanism = vc.Mechanism.spatial(joints=joints, active=["crank"], reference=vc.Reference("rod"))
    path = tmp_path / "robot.sdf"
    told = " ".join(written(mechanism, path, "sdf").lost)
    assert "the joint becomes 'crank_joint_'" in told
    assert "the joint becomes 'rod_joint'" in told
    again, _ = read_back(mechanism, path, "sdf", lossy=True)
    assert [joint.name for joint in again.joints] == ["crank_joint_", "rod_joint", "o3", "o4"]
    assert again.active == ("crank_joint_",)
    same_numbers(mechanism, again)
    same_poses(mechanism, again, origins=True)


@pytest.mark.parametrize("to", ["mjcf", "urdf-plus", "urdf-gepetto"])
def test_a_loop_that_is_open_stays_open_by_the_same_gap(to: str, models: Path, tmp_path: Path) -> None:
    if to == "mjcf":
        pytest.importorskip("mujoco")
    robot = vc.load(models / "gepetto_cassie_like" / "robot_nomesh.urdf").with_reference("hip_pitch")
    again, _ = read_back(robot, tmp_path / f"robot{ROBOTS[to]}", to)
    before, after = ([(r.linear, r.angular) for r in m.residuals()] for m in (robot, again))
    assert np.array(after) == pytest.approx(np.array(before), abs=1e-13)


# In other programs --------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["stewart-spherical", "delta", "mixed", "serial-7r", "telescope"])
def test_mujoco_holds_the_written_loops(name: str, tmp_path: Path) -> None:
    mujoco = pytest.importorskip("mujoco")
    mechanism, path = spatial_twin(example(name)), tmp_path / "robot.xml"
    save(mechanism, path)
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    if data.ne:
        assert np.abs(data.efc_pos[: data.ne]).max() < 1e-12
    for body in mechanism.bodies:
        assert data.body(body.name).xpos == pytest.approx(body.pose.position, abs=1e-12)
        assert data.body(body.name).xmat.reshape(3, 3) == pytest.approx(body.pose.rotation, abs=1e-12)
    assert model.nu == len(mechanism.active)


@pytest.mark.parametrize("to", ["urdf-plus", "urdf-gepetto"])
@pytest.mark.parametrize("name", ["stewart-spherical", "delta", "mixed", "serial-7r"])
def test_pinocchio_puts_the_written_links_where_they_were(name: str, to: str, tmp_path: Path) -> None:
    pin = pytest.importorskip("pinocchio")
    mechanism, path = spatial_twin(example(name)), tmp_path / "robot.urdf"
    save(mechanism, path, to)
    model = pin.buildModelFromUrdf(str(path))
    data = model.createData()
    pin.framesForwardKinematics(model, data, pin.neutral(model))
    again = vc.load(path)
    for body in again.bodies:
        placed = data.oMf[model.getFrameId(body.name)]
        assert placed.translation == pytest.approx(body.pose.position, abs=1e-12)
        assert placed.rotation == pytest.approx(body.pose.rotation, abs=1e-12)


@pytest.mark.parametrize("model", ["stewart_sdf/model.sdf", "gepetto_cassie_like/robot_nomesh.urdf"])
def test_from_each_format_to_the_next(model: str, models: Path, tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    robot = vc.load(models / model)
    robot = robot.with_reference(robot.bodies[-1].name)
    robot = robot.with_configuration(robot.close())
    now = robot
    for step, to in enumerate(("mjcf", "urdf-gepetto", "sdf", "urdf-plus", "native", "mjcf", "urdf-plus")):
        now, _ = read_back(now, tmp_path / f"robot{step}{ROBOTS.get(to, '.yaml')}", to)
        assert now.active == robot.active
        same_numbers(robot, now, counts=False)
