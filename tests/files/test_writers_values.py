"""What a written file keeps of values, limits, names, couplings and configurations, and what it says."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest
from tests.files.same_mechanism import ROBOTS, numbers, read_back, same_numbers, same_poses

import vincula as vc
from vincula.files.save import save


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
