"""From the names people give to axes, motors and points."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tests.unit.mechanism.five_bar import five_bar

import vincula as vc
from vincula.errors import DuplicateNameError, TopologyError, UnknownNameError
from vincula.mechanism.mechanism import Mechanism
from vincula.mechanism.names import split_names
from vincula.mechanism.parts import ALL, Drive, Frame
from vincula.spatial.poses import Pose


def arm(**changes) -> Mechanism:  # type: ignore[no-untyped-def]
    parts = {
        "joints": [
            vc.Universal("wrist", "ground", "a", at=(0, 0, 0), axes=((0, 0, 1), (1, 0, 0))),
            vc.Revolute("left.arm", "a", "b", at=(1, 0, 0)),
            vc.Spherical("left/ball", "b", "c", at=(2, 0, 0)),
            vc.Revolute("a,b", "c", "d", at=(3, 0, 0)),
        ],
        "reference": vc.Reference("d", origin=(4, 0, 0)),
    }
    return Mechanism.spatial(**{**parts, **changes})


def test_a_joint_means_all_its_axes() -> None:
    assert arm().resolve_axes("wrist") == ("wrist.1", "wrist.2")
    assert arm().resolve_axes(["wrist.2", "wrist"]) == ("wrist.2", "wrist.1")
    assert arm().resolve_axes("left/ball") == ("left/ball.x", "left/ball.y", "left/ball.z")
    assert arm().resolve_axes("left.arm, left/ball.y") == ("left.arm", "left/ball.y")


def test_names_with_commas_are_quoted() -> None:
    assert split_names('left.arm,"a,b", wrist.1') == ["left.arm", "a,b", "wrist.1"]
    assert split_names("  ") == []
    assert arm().with_active('"a,b"').active == ("a,b",)


def test_motors_keep_the_order_given_and_may_not_repeat() -> None:
    assert arm().with_active(["left.arm", "wrist"]).active == ("left.arm", "wrist.1", "wrist.2")
    with pytest.raises(DuplicateNameError, match=r"two active axes are named 'wrist.1'"):
        arm().with_active(["wrist", "wrist.1"])


def test_all_is_every_unlocked_axis_but_free_ones() -> None:
    everything = ("wrist.1", "wrist.2", "left.arm", "left/ball.x", "left/ball.y", "left/ball.z", "a,b")
    assert arm().with_active(ALL).active == everything
    assert arm().with_active("all").active == everything
    assert arm().with_lock("wrist").with_active("ALL").active == everything[2:]
    floating = Mechanism.planar(
        joints=[vc.Free("float", "ground", "a"), vc.Revolute("j", "a", "b", at=(0, 0))],
        reference=vc.Reference("b"),
    )
    assert floating.with_active(ALL).active == ("j",)
    assert floating.with_active(["float.vx"]).active == ("float.vx",)


def test_motors_of_files_and_drives_come_before_joints() -> None:
    """A motor called like a joint but on another one means the motor."""
    bar = replace(
        five_bar(drives=[Drive("tendon", {"o2": 0.5, "o3": 0.5})]),
        motors={"grip": "tendon", "o2": "o4", "ball motor": "o3"},
    )
    assert bar.with_active(["grip"]).active == ("tendon",)
    assert bar.with_active(["tendon"]).active == ("tendon",)
    assert bar.with_active(["o2", "ball motor"]).active == ("o4", "o3")
    ball = replace(arm(), motors={"m": "wrist"})
    assert ball.with_active("m").active == ("wrist.1", "wrist.2")


def test_unknown_motors_list_motors_and_joints() -> None:
    bar = five_bar(drives=[Drive("tendon", {"o2": 0.5, "o3": 0.5})])
    with pytest.raises(
        UnknownNameError, match="no motor, joint or axis is named 'tendn'; did you mean 'tendon'"
    ) as e:
        bar.with_active("tendn")
    assert e.value.choices == ("tendon", "o1", "o2", "o3", "o4", "o5")
    with pytest.raises(UnknownNameError, match="no joint or axis is named 'tendon'"):
        bar.with_lock("tendon")


def test_the_reference_by_body_frame_or_coordinates() -> None:
    bar = replace(
        five_bar(),
        frames=(Frame("tip", "link", Pose.at((0.5, 0.25))), Frame("far", "crank", Pose.at((9, 9)))),
    )
    by_frame = bar.with_reference("link", frame="tip").reference
    assert by_frame is not None
    assert by_frame.origin == pytest.approx([0.5, 0.25])
    assert by_frame.label == "link@tip"
    by_place = bar.with_reference("link", (1, 2)).reference
    assert by_place is not None
    assert by_place.label == "link@1,2"
    with pytest.raises(UnknownNameError, match=r"no frame on body 'link' is named 'far'. Known: tip"):
        bar.with_reference("link", frame="far")
    with pytest.raises(UnknownNameError, match="no body is named 'lnk'; did you mean 'link'"):
        bar.with_reference("lnk")
    for ground in ("ground", "world"):
        with pytest.raises(
            TopologyError, match="the ground cannot be the reference member: it does not move"
        ):
            bar.with_reference(ground)


def test_cuts_stay_with_the_body_they_were_declared_for() -> None:
    cuts = {"o2": vc.Cut("contact")}
    bar = five_bar(reference=vc.Reference("coupler", cuts=cuts))
    same = bar.with_reference("coupler", (0, 0)).reference
    other = bar.with_reference("link").reference
    assert same is not None
    assert other is not None
    assert same.cuts == cuts
    assert other.cuts == {}


def test_body_axes_turn_twists_and_wrenches() -> None:
    """At a quarter turn the body's x is the ground's y."""
    bar = Mechanism.planar(
        joints=[vc.Revolute("j", "ground", "b", at=(0, 0))],
        reference=vc.Reference("b", origin=(1, 0)),
        active=["j"],
    )
    q = {"j": np.pi / 2}
    in_ground = bar.linearize(q)
    in_body = bar.with_reference("b", (1, 0), axes="body").linearize(q)
    twists = [np.linalg.solve(m.grasp.T, m.jacobian_active[:, 0]) for m in (in_ground, in_body)]
    assert twists[0] == pytest.approx([-1, 0, 1], abs=1e-15)
    assert twists[1] == pytest.approx([0, 1, 1], abs=1e-15)
    assert (in_ground.frame, in_body.frame) == ("ground axes", "axes of b")
    assert in_body.motions is not None
    assert in_body.motions.origin == pytest.approx([0, 1])


def test_characteristic_length_is_a_power_of_two_near_the_rms_distance(rng: np.random.Generator) -> None:
    for scale in (1e-6, 1e-3, 1.0, 37.0, 1e6):
        points = scale * rng.normal(size=(5, 2))
        bar = Mechanism.planar(
            joints=[vc.Revolute(f"j{k}", "ground", f"b{k}", at=p) for k, p in enumerate(points)],
            reference=vc.Reference("b0", origin=(0, 0)),
        )
        rms = np.sqrt(np.mean(np.sum(points**2, axis=1)))
        assert np.frexp(bar.length)[0] == 0.5
        assert 2**-0.5 <= bar.length / rms <= 2**0.5
        assert bar.linearize().length == bar.length


def test_characteristic_length_when_all_points_coincide() -> None:
    here = Mechanism.planar(
        joints=[vc.Revolute("j", "ground", "b", at=(0.1, 0.7))],
        bodies=[vc.Body("b", at=(0.3, -0.2))],
        reference=vc.Reference("b", origin=(0.1, 0.7)),
    )
    assert here.length == 1.0
