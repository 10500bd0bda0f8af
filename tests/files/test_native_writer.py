"""Writing native files: what is read back behaves the same, and what cannot be held is listed."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.files.native_samples import ALL_JOINTS, FIVE_BAR, write

import vincula as vc
from vincula.files.native_writer import native_data
from vincula.files.yaml_writer import as_json, as_yaml
from vincula.mechanism.catalog.registry import MODULES

ROBOTS = {
    "robotiq_2f85_menagerie/2f85_nomesh.xml": "left_pad",
    "aloha_mink/aloha_nomesh.xml": "left/gripper_link",
    "leap_hand_mink/right_hand_nomesh.xml": "fingertip",
    "stewart_sdf/stewart_from_sdf.xml": None,
    "unitree_go1_mink/go1_nomesh.xml": "trunk",
}


def results(mechanism: vc.Mechanism) -> dict[str, Any]:
    return vc.analyze(mechanism.with_weights(vc.Weights()).linearize()).to_dict()


def same_results(one: vc.Mechanism, other: vc.Mechanism) -> None:
    a, b = results(one), results(other)
    for part in ("counts", "summary"):
        assert a["mobility"][part] == b["mobility"][part]
    assert a["rank"]["status"] == b["rank"]["status"]
    for part in ("kinematic", "active_force", "passive_force", "internal_force", "dual_force"):
        assert a[part]["classes"] == b[part]["classes"]
        np.testing.assert_allclose(
            np.array(a[part]["efficiencies"], dtype=float),
            np.array(b[part]["efficiencies"], dtype=float),
            rtol=1e-9,
            atol=1e-12,
        )


def written(mechanism: vc.Mechanism, folder: Path, *, as_text: Any = as_yaml) -> vc.Mechanism:
    return vc.load(write(folder, as_text(native_data(mechanism).content), "written.txt"))


@pytest.mark.parametrize("name", MODULES)
def test_examples_come_back(name: str, tmp_path: Path) -> None:
    mechanism = vc.load(f"example:{name}")
    data = native_data(mechanism)
    assert data.lost == []
    for as_text in (as_yaml, as_json):
        back = written(mechanism, tmp_path, as_text=as_text)
        same_results(mechanism, back)
        assert back.name == mechanism.name
        assert back.active == mechanism.active
        assert [body.name for body in back.bodies] == [body.name for body in mechanism.bodies]


@pytest.mark.parametrize("file", ROBOTS)
def test_robots_come_back(file: str, models: Path, tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    robot = vc.load(models / file)
    robot = robot.with_reference(ROBOTS[file] or robot.bodies[-1].name)
    data = native_data(robot)
    assert data.lost == []
    assert any("body axes are ground axes" in change for change in data.changed)
    back = written(robot, tmp_path)
    same_results(robot, back)
    assert back.precision.digits_length == pytest.approx(robot.precision.digits_length)
    once = [axis for axis in robot.active if list(robot.motors.values()).count(axis) == 1]
    assert set(back.motors) >= {m for m, axis in robot.motors.items() if m != axis and axis in once}
    assert native_data(back).content["joints"] == data.content["joints"]


def test_every_joint_moved_away_from_its_drawing(tmp_path: Path) -> None:
    """Drawn again where it has moved to, with limits, keyframes and couplings counted from there."""
    text = ALL_JOINTS.replace(
        "name: p, type: prismatic", "limits: {lower: -1, upper: 2}, name: p, type: prismatic"
    )
    text = text.replace("motors: [r, c.translation, u.2, k]", "motors: [r, c.translation, u.2]")
    text += """
couplings: [{name: g, rates: {p: 1}, driver: {r: 2}, polynomial: [0, 1, 0.5], references: {r: 0.1}}]
keyframes:
  away: {r: 0.5, p: 0.2, u: [0.1, -0.2], k: [0.9, 0.1, -0.3, 0.2], e: [0.1, 0.2, 0.3],
         fl: [1, 2, 3, 0.6, 0, 0.8, 0]}
"""
    mechanism = vc.load(write(tmp_path, text))
    there = {
        "r": 0.3, "p": 0.48, "s": 0.2, "c": [0.1, 0.7], "u": [0.4, -0.8], "k": [0.8, 0.6, 0, 0],
        "e": [0.2, -0.3, 0.9], "fl": [0.1, 0.2, 0.3, 0.6, 0, 0, 0.8], "v": 1.1,
    }  # fmt: skip
    moved = replace(mechanism, contacts=()).with_configuration(there)
    back = written(moved, tmp_path)
    for body in moved.bodies:
        # Frames differ; points of a body are compared through where a keyframe carries them.
        old = moved.body_poses(moved.configuration(moved.keyframes["away"]))[body.name] @ body.pose.inverse()
        new = back.body_poses(back.configuration(back.keyframes["away"]))[body.name] @ (
            back.body[body.name].pose.inverse()
        )
        np.testing.assert_allclose(new.rotation, old.rotation, atol=1e-12)
        np.testing.assert_allclose(new.position, old.position, atol=1e-12)
    same_results(moved.with_lock([]).with_active(["r"]), back.with_lock([]).with_active(["r"]))
    limits = next(joint for joint in back.joints if joint.name == "p").limits[0]
    assert (limits.lower, limits.upper) == pytest.approx((-1.48, 1.52))
    old, new = (m.residuals(m.keyframes["away"])[-1] for m in (moved, back))
    assert new.gap == pytest.approx(old.gap, rel=1e-12)


LOSSES = {
    "contact is open": lambda m: replace(
        m, contacts=(replace(m.contacts[0], frame_on_second=m.contacts[1].frame_on_first),)
    ),
    "name": lambda m: replace(m, name="<b>"),
    "used one by one": lambda m: m.with_configuration({"k": [0.8, 0.6, 0, 0]}).with_active(["k.x"]),
    "is not active": lambda m: replace(m, drives=(vc.Drive("d", {"r": 1.0, "p": 2.0}),)),
    "its rate is in m/s": lambda m: replace(
        m, drives=(vc.Drive("d", {"r": 1.0}, linear=True),), active=("d",)
    ),
    "twists are in its axes": lambda m: m.with_configuration({"fl": [0, 0, 0, 0.8, 0.6, 0, 0]}),
}


@pytest.mark.parametrize("kind", LOSSES)
def test_what_cannot_be_held_is_listed(kind: str, tmp_path: Path) -> None:
    mechanism = vc.load(write(tmp_path, ALL_JOINTS))
    assert native_data(mechanism).lost == []
    lossy = mechanism if kind.startswith("contact") else replace(mechanism, contacts=())
    change = LOSSES[kind]
    if kind == "contact is open":
        data = native_data(change(lossy))
        assert any("is open by" in text for text in data.lost)
    else:
        data = native_data(change(lossy))
        assert any(kind in text for text in data.lost)
    with pytest.raises(vc.UnsupportedFeatureError, match="cannot hold everything"):
        data.refuse_losses()


def test_an_open_loop_has_no_place_to_be_drawn_at(tmp_path: Path) -> None:
    mechanism = vc.load(write(tmp_path, FIVE_BAR + "configuration: {o1: 0.3}\n"))
    assert any("no one place" in text for text in native_data(mechanism).lost)


@pytest.mark.parametrize(
    "name", ["true", "null", "1", "a b", "a:", "# x", "-", "é", "a,b", "[x", "a'b", 'a"b', "yes", "key: v"]
)
def test_names_are_quoted_where_they_must_be(name: str, tmp_path: Path) -> None:
    mechanism = vc.Mechanism.planar(joints=[vc.Revolute(name, "ground", "arm", at=(0, 0))], active=[name])
    for as_text in (as_yaml, as_json):
        assert written(mechanism, tmp_path, as_text=as_text).active == (name,)


def test_numbers_come_back_to_the_last_bit(tmp_path: Path, rng: np.random.Generator) -> None:
    points = rng.normal(size=(20, 2)) * 10.0 ** rng.integers(-8, 8, size=(20, 1))
    joints = [
        vc.Revolute(f"j{k}", "ground" if k == 0 else f"b{k - 1}", f"b{k}", at=p) for k, p in enumerate(points)
    ]
    back = written(vc.Mechanism.planar(joints=joints), tmp_path)
    for point, joint in zip(points, back.joints, strict=True):
        assert np.array_equal(joint.frame_on_first.position, point)
