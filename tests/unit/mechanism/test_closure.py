"""Closing: from a start, from motor positions, from a pose; limits; what a refusal says."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.unit.mechanism.linkages import circles_meet, five_bar, five_bar_o3, four_bar, joint_point

import vincula as vc
from vincula.mechanism.parts import Joint, Precision
from vincula.spatial.poses import Pose


def test_motor_positions_put_the_five_bar_where_circles_meet() -> None:
    mechanism = five_bar()
    q = mechanism.close(motors={"o1": 0.2, "o5": -0.3})
    assert q["o1"][0] == 0.2
    assert q["o5"][0] == -0.3
    np.testing.assert_allclose(joint_point(mechanism, q, "o3"), five_bar_o3(0.2, -0.3), atol=1e-14)
    assert q.residual < 1e-14
    assert q.free_motions == 0
    assert q.held == ("o1", "o5")


def test_a_closed_configuration_is_a_configuration() -> None:
    mechanism = five_bar()
    q = mechanism.close({"o1": 0.1})
    assert isinstance(q, vc.Configuration)
    model = mechanism.linearize(q)
    assert model.uncertainty.residual == q.residual
    assert model.frame == "ground axes"


def test_a_closed_start_is_not_moved() -> None:
    q = five_bar().close()
    assert dict(q) == dict(five_bar().home)
    assert q.iterations == 1
    assert q.kantorovich == 0.0
    assert set(q.moved.values()) == {0.0}


def test_how_far_closing_moved_every_axis() -> None:
    q = five_bar().close({"o1": 0.3})
    assert q.moved["o1"] == pytest.approx(q["o1"][0] - 0.3, abs=1e-15)
    assert 0.0 < q.kantorovich < 1e-10


def test_held_values_far_away_are_carried_on_the_branch() -> None:
    """A whole turn of the crank: the closure stays on the drawn side and keeps count of turns."""
    mechanism = four_bar(ground=3.0, crank=0.5, coupler=3.0, rocker=2.0)
    for turns in (0.5, 1.0, 2.25):
        angle = 2 * math.pi * turns
        q = mechanism.close(motors={"a": angle})
        b = 0.5 * np.array([-math.sin(angle), math.cos(angle)])
        expected = circles_meet(b, 3.0, np.array([3.0, 0.0]), 2.0)[0]
        np.testing.assert_allclose(joint_point(mechanism, q, "c"), expected, atol=1e-13)
        assert abs(q["b"][0] + angle) < math.pi, "b unwinds as a winds up"


def test_position_of_the_reference_point() -> None:
    mechanism = five_bar()
    q = mechanism.close(pose=(-0.5, -0.1))
    pose = mechanism.body_poses(q)["coupler"]
    np.testing.assert_allclose(pose.apply(np.array([-0.5, 0.0])), (-0.5, -0.1), atol=1e-14)


def test_pose_of_the_reference_member() -> None:
    arm = vc.Mechanism.planar(
        joints=[
            vc.Revolute("j1", "ground", "a", at=(0, 0)),
            vc.Revolute("j2", "a", "b", at=(1, 0)),
            vc.Revolute("j3", "b", "tool", at=(2, 0)),
        ],
        reference=vc.Reference("tool", origin=(2.5, 0)),
    )
    wanted = Pose.from_angle(1.0, (0.8, 1.2))
    q = arm.close({"j2": 0.5}, pose=wanted)
    there = arm.body_poses(q)["tool"]
    np.testing.assert_allclose(there.apply(np.array([2.5, 0.0])), wanted.position, atol=1e-14)
    np.testing.assert_allclose(there.rotation, wanted.rotation, atol=1e-14)


def test_lengths_that_cannot_meet_are_named() -> None:
    with pytest.raises(vc.ClosureError, match="Lengths that cannot meet: o4 to o2") as refusal:
        five_bar().close(motors={"o1": 0.3, "o5": -0.2})
    error = refusal.value
    assert error.loop == "o3"
    (conflict,) = error.details["lengths"]
    o2 = np.array([-1 - 2 * math.sin(0.3), -2 + 2 * math.cos(0.3)])
    o4 = np.array([1 + math.sin(-0.2), -2 + math.cos(-0.2)])
    assert conflict.sides["o4 to o2"] == pytest.approx(np.linalg.norm(o2 - o4), abs=1e-14)
    short = float(np.linalg.norm(o2 - o4)) - 1.0 - math.sqrt(2.0)
    assert conflict.short == pytest.approx(short, abs=1e-12)
    assert error.gap == pytest.approx(short, abs=1e-6), "the best configuration stretches both links"
    assert set(error.details["best"]) == set(five_bar().home)
    assert "It closes when nothing is held" in str(error)


def test_a_point_out_of_reach() -> None:
    with pytest.raises(vc.ClosureError, match="the pose asked for") as refusal:
        five_bar().close(pose=(0.0, 3.0))
    assert refusal.value.gap > 0.5


def test_a_loop_frame_pair_too_far_apart_is_refused() -> None:
    """Two bars of 1 m to a closure frame 2.5 m away: as a file with a loop joint may say."""
    arm = vc.Mechanism.planar(
        joints=[vc.Revolute("a", "ground", "one", at=(0, 0)), vc.Revolute("b", "one", "two", at=(1, 0))]
    )
    end, far = Pose.at((2.0, 0.0)), Pose.at((0.0, 2.5))
    loop = Joint("end", "revolute", "two", "ground", end, far, closure=True)
    with pytest.raises(vc.ClosureError, match="Lengths that cannot meet") as refusal:
        _with_joint(arm, loop).close()
    assert refusal.value.loop == "end"
    assert refusal.value.gap == pytest.approx(0.5, abs=1e-6)
    near = Joint("end", "revolute", "two", "ground", end, Pose.at((0.0, 1.2)), closure=True)
    mechanism = _with_joint(arm, near)
    with pytest.raises(vc.ClosureError, match="is open by"):
        mechanism.with_reference("two").linearize()
    q = mechanism.close()
    assert max(r.gap for r in mechanism.residuals(q)) < 1e-14


def _with_joint(mechanism: vc.Mechanism, joint: Joint) -> vc.Mechanism:
    return replace(mechanism, joints=(*mechanism.joints, joint))


def test_limits_are_respected_on_request() -> None:
    mechanism = five_bar(limit=0.05)
    free = mechanism.close(motors={"o1": -0.1, "o5": 0.2})
    assert abs(free["o4"][0]) > 0.05
    with pytest.raises(vc.ClosureError, match="It closes beyond the limits, at o4 = "):
        mechanism.close(motors={"o1": -0.1, "o5": 0.2}, limits=True)
    q = mechanism.close(motors={"o1": -0.4}, limits=True)
    assert mechanism.close(motors={"o1": -0.4})["o4"][0] < -0.1
    assert q["o4"][0] == pytest.approx(-0.05, abs=1e-12)
    assert q.at_limits == ("o4",)
    assert q.residual < 1e-14


def test_locked_axes_stay_where_they_start() -> None:
    q = five_bar().with_lock("o3").close({"o1": 0.1, "o3": 0.05})
    assert q["o3"][0] == 0.05
    assert q["o1"][0] != 0.1


def test_a_chain_without_loops_is_closed_as_it_is() -> None:
    arm = vc.Mechanism.planar(joints=[vc.Revolute("j", "ground", "arm", at=(0, 0))])
    q = arm.close({"j": 0.7})
    assert q["j"][0] == 0.7
    assert q.residual == 0.0
    assert str(q.branch) == "assembly none, working none"


def test_couplings_are_closed_too() -> None:
    """Two gears 1:-2 and a polynomial: c = 0.1 + a^2."""
    joints = [vc.Revolute(n, "ground", n.upper(), at=(k, 0)) for k, n in enumerate("abc")]
    mechanism = vc.Mechanism.planar(
        joints=joints,
        couplings=[
            vc.Coupling("gear", {"a": 1.0, "b": 2.0}),
            vc.Coupling("cam", {"c": 1.0}, {"a": 1.0}, (0.1, 0.0, 1.0)),
        ],
    )
    q = mechanism.close(motors={"a": 0.6})
    assert q["b"][0] == pytest.approx(-0.3, abs=1e-15)
    assert q["c"][0] == pytest.approx(0.46, abs=1e-15)


def test_a_motor_over_several_axes_is_held() -> None:
    joints = [vc.Revolute(n, "ground", n.upper(), at=(k, 0)) for k, n in enumerate("ab")]
    mechanism = vc.Mechanism.planar(joints=joints, drives=[vc.Drive("split", {"a": 0.5, "b": 0.5})])
    q = mechanism.close(motors={"split": 0.4})
    assert q["a"][0] + q["b"][0] == pytest.approx(0.8, abs=1e-15)
    assert q["a"][0] == pytest.approx(q["b"][0], abs=1e-8), "nearest to the start: both turn alike"
    assert q.moved["split"] == pytest.approx(0.0, abs=1e-15)


def test_names_that_cannot_be_held() -> None:
    with pytest.raises(vc.UnknownNameError, match="did you mean 'o1'"):
        five_bar().close(motors={"o11": 0.1})
    ball = vc.Mechanism.spatial(joints=[vc.Spherical("s", "ground", "b", at=(0, 0, 0))])
    with pytest.raises(vc.ModelError, match="quaternion"):
        ball.close(motors={"s.x": 0.1})
    with pytest.raises(vc.MissingReferenceError):
        ball.close(pose=(0, 0, 0))
    with pytest.raises(vc.ModelError, match="not orthonormal"):
        five_bar().close(pose=Pose.at((0.0, 0.0), np.diag([1.0, 2.0])))


def test_one_axis_of_several_is_held() -> None:
    joint = vc.Cylindrical("c", "ground", "nut", at=(0, 0, 0), axis=(0, 0, 1))
    mechanism = vc.Mechanism.spatial(
        joints=[joint], couplings=[vc.Coupling("thread", {"c.translation": 1.0, "c.rotation": -0.01})]
    )
    q = mechanism.close(motors={"c.translation": 0.05})
    np.testing.assert_allclose(q["c"], (5.0, 0.05), atol=1e-14)


def test_rounded_right_angles_are_told_from_real_gaps() -> None:
    """A four-bar in space whose last axis is turned by 1.5708 instead of pi/2 closes at home only."""
    slip = 1.5708 - math.pi / 2
    at = {"a": (0, 0, 0), "b": (0, 1, 0), "c": (3, 2, 0), "d": (3, 0, 0)}
    bodies = ["ground", "crank", "coupler", "rocker", "ground"]
    axes = {"d": (0.0, -math.sin(slip), math.cos(slip))}
    mechanism = vc.Mechanism.spatial(
        joints=[
            vc.Revolute(n, bodies[k], bodies[k + 1], at=p, axis=axes.get(n, (0, 0, 1)))
            for k, (n, p) in enumerate(at.items())
        ]
    )
    typed = replace(mechanism, precision=Precision(digits_angle=5e-5))
    with pytest.raises(vc.ClosureError, match="give them with more digits") as refusal:
        typed.close(motors={"a": 0.5})
    assert 1e-8 < refusal.value.gap < 1e-4
    with pytest.raises(vc.ClosureError, match="No closed configuration was found"):
        mechanism.close(motors={"a": 0.5})
