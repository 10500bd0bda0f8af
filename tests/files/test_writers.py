"""Writers: what is written reads back to the same mechanism, in ours and in other programs."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.files.same_mechanism import numbers, read_back, same_numbers, same_poses

import vincula as vc
from vincula.files.save import save, written
from vincula.files.written import roll_pitch_yaw
from vincula.mechanism.catalog.registry import MODULES, example
from vincula.mechanism.spatial_twin import spatial_twin
from vincula.spatial.poses import Pose, rotation_about

ROBOTS = {"mjcf": ".xml", "sdf": ".sdf", "urdf-plus": ".urdf", "urdf-gepetto": ".urdf"}
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


@pytest.mark.parametrize("to", ["mjcf", "urdf-plus", "urdf-gepetto"])
def test_a_loop_that_is_open_stays_open_by_the_same_gap(to: str, models: Path, tmp_path: Path) -> None:
    if to == "mjcf":
        pytest.importorskip("mujoco")
    robot = vc.load(models / "gepetto_cassie_like" / "robot_nomesh.urdf").with_reference("hip_pitch")
    again, _ = read_back(robot, tmp_path / f"robot{ROBOTS[to]}", to)
    before, after = ([(r.linear, r.angular) for r in m.residuals()] for m in (robot, again))
    assert np.array(after) == pytest.approx(np.array(before), abs=1e-13)


# Random mechanisms -------------------------------------------------------------------------------

KINDS = (vc.Revolute, vc.Prismatic, vc.Cylindrical, vc.Spherical, vc.Universal, vc.Screw, vc.PlanarJoint)


def random_mechanism(seed: int) -> vc.Mechanism:
    """Chains of joints of all kinds between the ground and a platform, drawn where they are closed."""
    rng = np.random.default_rng(seed)

    def unit() -> list[float]:
        vector = rng.normal(size=3)
        return list(vector / np.linalg.norm(vector))

    joints = []
    for chain in range(int(rng.integers(2, 4))):
        links = ["ground", *(f"c{chain}_{k}" for k in range(int(rng.integers(1, 3)))), "platform"]
        for k, pair in enumerate(pairwise(links)):
            kind = KINDS[int(rng.integers(len(KINDS)))]
            place, words = list(rng.uniform(-1, 1, size=3)), {}
            one, two = reversed(pair) if rng.random() < 0.3 else pair
            if kind is vc.Universal:
                first = unit()
                across = np.cross(first, unit())
                words["axes"] = [first, list(across / np.linalg.norm(across))]
            elif kind is not vc.Spherical:
                words["axis"] = unit()
            if kind is vc.Screw:
                words["lead"] = float(rng.uniform(0.1, 2.0))
            joints.append(kind(f"j{chain}_{k}", one, two, at=place, **words))
    base = vc.Mechanism.spatial(
        joints=joints, reference=vc.Reference("platform", origin=list(rng.normal(size=3)))
    )
    axes = list(base.axis_names)
    couplings = []
    scalar = [
        a
        for j in base.joints
        if j.type in ("revolute", "prismatic")
        for a in base.type_of(j).axis_names(j.name)
    ]
    if len(scalar) >= 2 and rng.random() < 0.6:
        one, two = rng.choice(scalar, size=2, replace=False)
        couplings.append(vc.Coupling("gear", {str(one): 1.0, str(two): float(rng.uniform(-3, 3))}))
    active = [str(a) for a in rng.choice(axes, size=min(len(axes), 4), replace=False)]
    return vc.Mechanism.spatial(
        joints=joints, couplings=couplings, active=active, name="random",
        reference=vc.Reference("platform", origin=list(rng.normal(size=3))),
    )  # fmt: skip


@settings(max_examples=15)
@given(seed=st.integers(0, 10**6), to=st.sampled_from(["native", "mjcf", "urdf-plus", "urdf-gepetto"]))
def test_random_mechanisms_are_read_back(
    seed: int, to: str, tmp_path_factory: pytest.TempPathFactory
) -> None:
    if to == "mjcf":
        pytest.importorskip("mujoco")
    mechanism = random_mechanism(seed)
    path = tmp_path_factory.mktemp("random") / f"robot{ROBOTS.get(to, '.yaml')}"
    again, _ = read_back(mechanism, path, to)
    assert sorted(again.active) == sorted(mechanism.active)
    same_numbers(mechanism, again, counts=to == "native")
    same_poses(mechanism, again, origins=not to.startswith("urdf"))


@settings(max_examples=200)
@given(
    st.sampled_from([0.0, np.pi / 2, -np.pi / 2, np.pi / 2 - 1e-9, np.pi, 0.3]),
    st.floats(-4, 4),
    st.floats(-4, 4),
)
def test_angles_are_exact_where_pitch_is_a_right_angle(pitch: float, roll: float, yaw: float) -> None:
    x, y, z = np.eye(3)
    rotation = rotation_about(z, yaw) @ rotation_about(y, pitch) @ rotation_about(x, roll)
    r, p, w = roll_pitch_yaw(Pose.at(np.zeros(3), rotation))
    again = rotation_about(z, w) @ rotation_about(y, p) @ rotation_about(x, r)
    assert np.abs(again - rotation).max() < 4e-16 * 4


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


# What stays and what is said -----------------------------------------------------------------------


def crank_rocker() -> vc.Mechanism:
    """A four-bar linkage in space with a joint value, limits and motor names."""
    linkage = vc.Mechanism.spatial(
        joints=[
            vc.Revolute(
                "o1", "ground", "crank", at=(0, 0, 0), axis=(0, 0, 1), limits=vc.Limits(-1.0, 2.0, 3.0, 4.0)
            ),
            vc.Revolute("o2", "crank", "coupler", at=(0, 1, 0), axis=(0, 0, 1)),
            vc.Revolute("o3", "rocker", "coupler", at=(2, 2, 0), axis=(0, 0, 1)),
            vc.Revolute("o4", "ground", "rocker", at=(3, 0, 0), axis=(0, 0, 1)),
        ],
        reference=vc.Reference("coupler"),
        active=["o1"],
        name='crank & "rocker"',
    )
    return linkage.with_configuration(linkage.close(motors={"o1": 0.25}))


def test_mjcf_keeps_joint_values_limits_and_body_frames(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    linkage = crank_rocker()
    again, saved = read_back(linkage, tmp_path / "linkage.xml")
    assert again.name == linkage.name
    for joint in ("o1", "o2", "o4"):
        assert float(again.home[joint][0]) == float(linkage.home[joint][0])
    limits = again.joint["o1"].limits[0]
    assert (limits.lower, limits.upper, limits.effort) == (-1.0, 2.0, 4.0)
    assert any("speed" in text for text in saved.changed)
    same_poses(linkage, again)
    same_numbers(linkage, again)


@pytest.mark.parametrize("to", ["urdf-plus", "urdf-gepetto", "sdf"])
def test_urdf_and_sdf_count_values_and_limits_from_home(to: str, tmp_path: Path) -> None:
    linkage = crank_rocker()
    again, saved = read_back(linkage, tmp_path / f"linkage{ROBOTS[to]}", to)
    limits = again.joint["o1"].limits[0]
    home = float(linkage.home["o1"][0])
    assert (limits.lower, limits.upper) == (-1.0 - home, 2.0 - home)
    assert (limits.rate, limits.effort) == (3.0, 4.0)
    assert any("displacements" in text for text in saved.changed)
    same_numbers(linkage, again)


def test_numbers_are_written_so_that_they_read_back_to_the_same_doubles(tmp_path: Path) -> None:
    linkage, path = crank_rocker(), tmp_path / "linkage.urdf"
    save(linkage, path)
    root = ET.parse(path).getroot()
    assert root.attrib["name"] == linkage.name
    origins = {j.attrib["name"]: j.find("origin") for j in root.findall("joint")}
    first = origins["o1"]
    assert first is not None
    text = first.attrib.get("rpy", "0 0 0").split()
    assert float(text[2]) == np.arctan2(*linkage.body["crank"].pose.rotation[[1, 0], 0])


def test_mjcf_holds_gears_differentials_and_tendons(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    rail = [vc.Prismatic(f"p{k}", "ground", f"b{k}", at=(k, 0, 0), axis=(0, 0, 1)) for k in range(4)]
    base = vc.Mechanism.spatial(
        joints=rail,
        couplings=[
            vc.Coupling("square", {"p0": 2.0}, {"p1": 0.5}, (0.0, 3.0, 1.0)),
            vc.Coupling("sum", {"p1": 1.0, "p2": 1.0, "p3": -2.0}),
        ],
        drives=[vc.Drive("both", {"p1": 0.5, "p2": 1.5})],
        active=["both"],
        lock=["p3"],
        reference=vc.Reference("b0"),
    )
    moved = base.with_configuration({"p1": 0.1, "p0": 0.5 * (3 * 0.05 + 0.05**2), "p2": -0.1})
    for mechanism in (base, moved):
        again, saved = read_back(mechanism, tmp_path / "rails.xml", force=True)
        assert saved.lost == ()
        assert again.active == ("both",)
        assert dict(again.drives[0].drives) == {"p1": 0.5, "p2": 1.5}
        assert max(abs(r.gap) for r in again.residuals()) < 1e-15
        one, other = numbers(mechanism), numbers(again)
        assert other[0] == one[0]
        assert other[2]["kinematic"] == pytest.approx(one[2]["kinematic"], rel=1e-12)
    assert any("locks are equalities" in text for text in saved.changed)


def test_a_coupling_of_urdf_plus_says_what_a_mimic_would(tmp_path: Path) -> None:
    arm = [
        vc.Revolute("a", "ground", "one", at=(0, 0, 0), axis=(0, 0, 1)),
        vc.Revolute("b", "one", "two", at=(1, 0, 0), axis=(0, 0, 1)),
        vc.Revolute("c", "ground", "three", at=(0, 1, 0), axis=(0, 0, 1)),
    ]
    for rates, tag in (({"a": 2.0, "b": 2.0, "c": -1.0}, "coupling"), ({"a": 1.0, "b": 3.0}, "mimic")):
        mechanism = vc.Mechanism.spatial(
            joints=arm, couplings=[vc.Coupling("gear", rates)], active=["a"], reference=vc.Reference("two")
        )
        path = tmp_path / f"{tag}.urdf"
        again, saved = read_back(mechanism, path)
        assert f"<{tag}" in path.read_text(encoding="utf-8")
        same_numbers(mechanism, again)
        assert saved.lost == ()


def test_keyframes_of_mjcf_are_the_same_configurations(tmp_path: Path, models: Path) -> None:
    pytest.importorskip("mujoco")
    dog = vc.load(models / "unitree_go1_mink" / "go1_nomesh.xml").with_reference("trunk")
    again, _ = read_back(dog, tmp_path / "dog.xml")
    assert set(again.keyframes) == set(dog.keyframes)
    for name, values in dog.keyframes.items():
        before, after = dog.body_poses(dict(values)), again.body_poses(dict(again.keyframes[name]))
        for body, pose in before.items():
            assert after[body].position == pytest.approx(pose.position, abs=1e-12)
            assert after[body].rotation == pytest.approx(pose.rotation, abs=1e-12)


def test_balls_and_reversed_joints_are_displaced_alike_in_keyframes(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    from dataclasses import replace

    arm = vc.Mechanism.spatial(
        joints=[
            vc.Spherical("s", "ground", "one", at=(0, 0, 0)),
            vc.Universal("u", "two", "one", at=(1, 0, 0), axes=[(1, 0, 0), (0, 1, 0)]),
            vc.Spherical("t", "three", "two", at=(2, 0, 0)),
            vc.Screw("h", "three", "four", at=(3, 0, 0), axis=(0, 0, 1), lead=0.5),
        ],
        reference=vc.Reference("four"),
    )
    s = np.array([0.9, 0.1, -0.3, 0.2])
    t = np.array([0.7, -0.5, 0.1, 0.4])
    pose = {
        "s": tuple(s / np.linalg.norm(s)),
        "u": (0.3, -0.4),
        "t": tuple(t / np.linalg.norm(t)),
        "h": (0.7,),
    }
    away = {"s": (1.0, 0.0, 0.0, 0.0), "u": (-0.2, 0.5), "t": pose["s"], "h": (-0.1,)}
    for active in ((), ("s.x", "t.z")):
        posed = replace(arm.with_active(active).with_configuration(pose), keyframes={"away": away})
        again, _ = read_back(posed, tmp_path / "arm.xml", force=True)
        before, after = posed.body_poses(dict(away)), again.body_poses(dict(again.keyframes["away"]))
        for body in ("one", "two", "three", "four"):
            assert after[body].position == pytest.approx(before[body].position, abs=1e-13)
            assert after[body].rotation == pytest.approx(before[body].rotation, abs=1e-13)


def test_a_file_that_is_there_is_kept_and_a_format_that_is_not_is_refused(tmp_path: Path) -> None:
    linkage, path = crank_rocker(), tmp_path / "linkage.urdf"
    (tmp_path / "linkage.yaml").write_text("mine\n", encoding="utf-8")
    with pytest.raises(vc.FileError, match="such a file"):
        save(linkage, path, "urdf-gepetto")
    assert not path.exists()
    assert save(linkage, path, "urdf-gepetto", force=True).files == (
        str(path),
        str(tmp_path / "linkage.yaml"),
    )
    with pytest.raises(vc.UnknownNameError, match="usd"):
        save(linkage, path, "usd")
    with pytest.raises(vc.FileError, match="must end in"):
        save(linkage, tmp_path / "linkage.stl")
