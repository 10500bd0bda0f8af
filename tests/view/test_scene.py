"""Drawables: every link, symbol, support and reference point where the mechanism has it."""

from __future__ import annotations

import numpy as np
import pytest

import vincula as vc
from vincula.view.drawables import Scene
from vincula.view.scene import scene


def five_bar(**options: object) -> vc.Mechanism:
    return vc.Mechanism.planar(
        joints=[
            vc.Revolute("o1", "ground", "crank", at=(-1, -2)),
            vc.Revolute("o2", "crank", "coupler", at=(-1, 0)),
            vc.Revolute("o3", "coupler", "link", at=(0, 0)),
            vc.Revolute("o4", "link", "rocker", at=(1, -1)),
            vc.Revolute("o5", "rocker", "ground", at=(1, -2)),
        ],
        reference=vc.Reference("coupler", origin=(-0.5, 0)),
        **{"active": ["o1", "o5"], **options},
    )


def link(drawn: Scene, body: str) -> np.ndarray:
    (found,) = [one.points for one in drawn.links if one.body == body]
    return found


def test_links_run_between_their_joints() -> None:
    drawn = scene(five_bar())
    np.testing.assert_array_equal(link(drawn, "crank"), [[-1, -2], [-1, 0]])
    np.testing.assert_array_equal(link(drawn, "coupler"), [[-1, 0], [0, 0]])
    assert [one.body for one in drawn.links if one.member] == ["coupler"]
    assert "ground" not in {one.body for one in drawn.links}


def test_motors_and_passive_joints_are_told_apart() -> None:
    roles = {mark.name: mark.role for mark in scene(five_bar(lock=["o3"])).joints}
    assert roles == {"o1": "motor", "o2": "passive", "o3": "locked", "o4": "passive", "o5": "motor"}


def test_joints_behind_a_transmission_are_driven() -> None:
    drive = vc.Drive("belt", {"o2": 1.0, "o4": -2.0})
    roles = {mark.name: mark.role for mark in scene(five_bar(drives=[drive], active=["belt"])).joints}
    assert roles == {"o1": "passive", "o2": "driven", "o3": "passive", "o4": "driven", "o5": "passive"}


def test_supports_stand_at_the_ground_joints_only() -> None:
    drawn = scene(five_bar())
    assert {tuple(ground.at) for ground in drawn.grounds} == {(-1, -2), (1, -2)}
    assert all(tuple(ground.towards) == (0, -1) and not ground.rail for ground in drawn.grounds)


def test_the_reference_point_moves_with_its_member() -> None:
    mechanism = five_bar()
    at_home = scene(mechanism).reference
    assert at_home is not None
    np.testing.assert_array_equal(at_home.at, [-0.5, 0])
    turned = scene(mechanism, {"o1": np.pi / 2}).reference
    assert turned is not None
    np.testing.assert_allclose(turned.at, [-3, -1.5], atol=1e-12)


def test_an_open_loop_is_drawn_open() -> None:
    drawn = scene(five_bar(), {"o1": 0.3})
    ends = {tuple(np.round(p, 9)) for body in ("coupler", "link") for p in link(drawn, body)}
    assert len(ends) == 4
    crank_tip = np.array([-1, -2]) + 2 * np.array([-np.sin(0.3), np.cos(0.3)])
    np.testing.assert_allclose(link(drawn, "crank")[1], crank_tip, atol=1e-12)


def test_axes_of_the_body_are_turned_with_it() -> None:
    mechanism = five_bar().with_reference("coupler", axes="body")
    turned = scene(mechanism, {"o1": np.pi / 2}).reference
    assert turned is not None
    np.testing.assert_allclose(turned.rotation, [[0, -1], [1, 0]], atol=1e-12)


def slider_crank(axis: tuple[float, float], at: tuple[float, float] | None) -> vc.Mechanism:
    return vc.Mechanism.planar(
        joints=[
            vc.Revolute("o1", "ground", "crank", at=(1, 1)),
            vc.Revolute("o2", "crank", "rod", at=(2, 2)),
            vc.Revolute("o3", "rod", "slider", at=(4, 1)),
            vc.Prismatic("slide", "slider", "ground", axis=axis, at=at),
        ],
        reference=vc.Reference("slider"),
        active=["o1"],
    )


@pytest.mark.parametrize("at", [None, (7, 1), (4, 1)])
def test_a_slider_on_a_guide_is_drawn_at_its_pin(at: tuple[float, float] | None) -> None:
    (mark,) = [one for one in scene(slider_crank((1, 0), at)).joints if one.name == "slide"]
    np.testing.assert_allclose(mark.at, [4, 1])
    np.testing.assert_allclose(mark.axis, [1, 0])
    assert mark.slides
    assert mark.grounded


@pytest.mark.parametrize(("axis", "towards"), [((1, 0), (0, -1)), ((-1, 0), (0, -1)), ((0, 1), (1, 0))])
def test_a_guide_lies_beside_its_slider(axis: tuple[float, float], towards: tuple[float, float]) -> None:
    (guide,) = [one for one in scene(slider_crank(axis, (4, 1))).grounds if one.rail]
    np.testing.assert_allclose(guide.towards, towards, atol=1e-15)
    assert abs(guide.towards @ np.array(axis)) < 1e-15


def leg() -> vc.Mechanism:
    return vc.Mechanism.spatial(
        joints=[
            vc.Spherical("ball", "ground", "cylinder", at=(0, 0, 0)),
            vc.Prismatic("push", "cylinder", "rod", axis=(0, 0, 1), at=(0, 0, 0.1)),
            vc.Universal("top", "rod", "plate", at=(0, 0, 2), axes=((1, 0, 0), (0, 1, 0))),
            vc.Revolute("b", "ground", "arm", at=(2, 0, 0), axis=(0, 1, 0)),
            vc.Spherical("c", "arm", "plate", at=(2, 0, 2)),
            vc.Spherical("d", "ground", "third", at=(0, 2, 0)),
            vc.Spherical("e", "third", "plate", at=(0, 2, 2)),
        ],
        contacts=[
            vc.Contact("foot", "plate", "ground", type="point", at=(0, 0, 3), normal=(0, 0, 2)),
        ],
        reference=vc.Reference("plate", origin=(0.5, 0.5, 2)),
        active=["push", "top.1"],
    )


def test_a_slider_between_bodies_is_drawn_between_them() -> None:
    drawn = scene(leg())
    (push,) = [one for one in drawn.joints if one.name == "push"]
    np.testing.assert_allclose(push.at, [0, 0, 1])
    np.testing.assert_allclose(link(drawn, "rod"), [[0, 0, 1], [0, 0, 2]])
    np.testing.assert_allclose(link(drawn, "cylinder"), [[0, 0, 0], [0, 0, 1]])


def test_axes_and_roles_in_space() -> None:
    marks = {mark.name: mark for mark in scene(leg()).joints}
    assert marks["ball"].axis is None
    np.testing.assert_allclose(marks["b"].axis, [0, 1, 0])
    np.testing.assert_allclose(marks["top"].axis, [1, 0, 0])
    assert {name for name, mark in marks.items() if mark.role == "motor"} == {"push", "top"}


def test_contacts_carry_their_normal_and_the_side_of_the_ground() -> None:
    drawn = scene(leg())
    (foot,) = drawn.contacts
    np.testing.assert_allclose(foot.normal, [0, 0, 1])
    assert foot.ground_side == 1
    (ground,) = [one for one in drawn.grounds if tuple(one.at) == (0, 0, 3)]
    np.testing.assert_allclose(ground.towards, [0, 0, 1])


def test_a_plate_goes_round_its_points_once() -> None:
    corners = {"a": (0, 0), "b": (2, 3), "c": (2, 0), "d": (0, 3)}
    plate = vc.Mechanism.planar(
        joints=[vc.Revolute(name, "ground", "plate", at=at) for name, at in corners.items()]
    )
    outline = link(scene(plate), "plate")
    around = np.vstack([outline, outline[:1]])
    x, y = around.T
    assert abs(0.5 * np.sum(x[:-1] * y[1:] - x[1:] * y[:-1])) == pytest.approx(6.0)
    assert {tuple(p) for p in outline} == set(corners.values())


def test_free_joints_hold_nothing_and_are_not_drawn() -> None:
    floating = vc.Mechanism.spatial(
        joints=[
            vc.Free("float", "ground", "trunk"),
            vc.Revolute("hip", "trunk", "thigh", at=(0, 1, 1), axis=(0, 1, 0)),
        ],
        contacts=[vc.Contact("foot", "thigh", "ground", type="hard-finger", at=(0, 1, 0), normal=(0, 0, -1))],
        reference=vc.Reference("trunk", origin=(0, 0, 1)),
        active=["hip"],
    )
    drawn = scene(floating)
    assert [mark.name for mark in drawn.joints] == ["hip"]
    np.testing.assert_allclose(link(drawn, "trunk"), [[0, 1, 1], [0, 0, 1]])


def test_no_reference_member_is_legal() -> None:
    drawn = scene(vc.Mechanism.planar(joints=[vc.Revolute("a", "ground", "bar", at=(0, 0))]))
    assert drawn.reference is None
    assert drawn.size == 1.0


def test_an_unknown_joint_in_the_configuration_is_refused() -> None:
    with pytest.raises(vc.UnknownNameError, match="o9"):
        scene(five_bar(), {"o9": 1.0})
