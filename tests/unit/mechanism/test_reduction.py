"""The two-root rule on graphs whose answer is known by hand."""

from __future__ import annotations

import numpy as np
import pytest
from tests.unit.mechanism.five_bar import cuts_of, five_bar, summary

import vincula as vc
from vincula.errors import MissingReferenceError, TopologyError
from vincula.mechanism.mechanism import Mechanism
from vincula.mechanism.parts import Cut


def test_joints_at_the_member_are_cut_and_kept() -> None:
    linkage = five_bar()
    assert cuts_of(linkage) == {"o2": ("kept", "member cut"), "o3": ("kept", "member cut")}
    assert linkage.reduction.paths["crank"] == (("o1", 1),)
    assert linkage.reduction.paths["link"] == (("o5", -1), ("o4", -1))
    assert not any(linkage.reduction.carried[b] for b in ("crank", "link", "rocker", "ground"))
    model = linkage.linearize()
    assert [m.name for m in model.motors] == ["o1", "o5"]
    assert [p.name for p in model.passives] == ["o2", "o3", "o4"]


def test_the_five_bar_matrices_by_hand() -> None:
    """Velocity at the pins: limb o1, o2 at (-1, 0); limb o5, o4, o3 (drawn outwards) at (0, 0)."""
    model = five_bar().linearize()
    assert [row.name for row in model.rows] == ["o2.fx", "o2.fy", "o2.mz", "o3.fx", "o3.fy", "o3.mz"]
    o1, o5 = model.jacobian_active.T
    o2, o3, o4 = model.jacobian_passive.T
    assert o1 == pytest.approx([-2, 0, 1, 0, 0, 0])
    assert o2 == pytest.approx([0, 0, 1, 0, 0, 0])
    assert o5 == pytest.approx([0, 0, 0, 2, 1, -1])
    assert o4 == pytest.approx([0, 0, 0, 1, 1, -1])
    assert o3 == pytest.approx([0, 0, 0, 0, 0, -1])
    member = model.grasp.T
    assert member == pytest.approx(
        np.array([[1, 0, 0], [0, 1, -0.5], [0, 0, 1], [1, 0, 0], [0, 1, 0.5], [0, 0, 1]])
    )


def test_declared_cuts_say_how_and_where() -> None:
    linkage = five_bar(
        reference=vc.Reference("coupler", cuts={"o2": Cut("kept", (-2 / 3, 0)), "o3": Cut("contact")})
    )
    assert cuts_of(linkage) == {"o2": ("kept", "member cut"), "o3": ("contact", "member cut")}
    model = linkage.linearize()
    assert [c.at for c in model.cuts] == [(-2 / 3, 0.0), (0.0, 0.0)]
    assert [row.name for row in model.rows] == ["o2.fx", "o2.fy", "o2.mz", "o3.fx", "o3.fy"]
    assert {c.name for c in model.columns} == {"o1", "o2", "o4", "o5"}
    assert summary(linkage) == summary(five_bar())


def test_declared_cuts_move_the_tree_of_an_inner_loop() -> None:
    """By default the loop is cut where it was closed last; a declared cut comes first of all."""
    joints = [
        vc.Revolute("a1", "ground", "left", at=(0, 0)),
        vc.Revolute("a2", "ground", "right", at=(2, 0)),
        vc.Revolute("b1", "left", "bar", at=(0, 1)),
        vc.Revolute("b2", "right", "bar", at=(2, 1)),
        vc.Revolute("pin", "bar", "hand", at=(1, 1)),
    ]
    for name, path in (("b2", ["a1", "b1"]), ("a1", ["a2", "b2"]), ("b1", ["a2", "b2"])):
        cuts = {} if name == "b2" else {name: Cut("kept", (0.5, 0.5))}
        linkage = Mechanism.planar(joints=joints, reference=vc.Reference("hand", cuts=cuts), active=["a1"])
        assert cuts_of(linkage) == {name: ("kept", "loop cut"), "pin": ("kept", "member cut")}
        assert [joint for joint, _ in linkage.reduction.paths["bar"]] == path
        assert summary(linkage) == (2, 0, 0, 1, 1, 0, 1, 0)


def test_joints_away_from_the_member_are_not_cut() -> None:
    """The crank hangs from the ground, so the five-bar is never cut at o1."""
    cuts = {"o1": Cut("kept")}
    with pytest.raises(TopologyError, match="'o1' is not cut in this reduction"):
        five_bar(reference=vc.Reference("coupler", cuts=cuts)).linearize()


def test_counts_of_the_five_bar_in_both_kinds_of_cut() -> None:
    kept = five_bar().linearize().ledger.counts
    assert (kept.g, kept.p, kept.o, kept.ao) == (2, 1, 1, 0)
    contact = five_bar(
        reference=vc.Reference("coupler", cuts={"o2": Cut("contact"), "o3": Cut("contact")})
    ).linearize()
    counts = contact.ledger.counts
    assert (counts.ao, counts.g, counts.o, counts.p) == (1, 1, 1, 0)
    everything = five_bar(active=vc.ALL).linearize().ledger.counts
    assert (everything.ao, everything.a, everything.o) == (2, 3, 1)


def test_inner_loops_are_loop_cuts() -> None:
    """A parallelogram inside one limb: its closing joint is a loop cut, the member hangs on a pin."""
    linkage = Mechanism.planar(
        joints=[
            vc.Revolute("a1", "ground", "left", at=(0, 0)),
            vc.Revolute("a2", "ground", "right", at=(2, 0)),
            vc.Revolute("b1", "left", "bar", at=(0, 1)),
            vc.Revolute("b2", "right", "bar", at=(2, 1)),
            vc.Revolute("pin", "bar", "hand", at=(1, 1)),
        ],
        reference=vc.Reference("hand", origin=(1, 2)),
        active=["a1"],
    )
    assert cuts_of(linkage) == {"b2": ("kept", "loop cut"), "pin": ("kept", "member cut")}
    assert summary(linkage) == (2, 0, 0, 1, 1, 0, 1, 0)
    loop = linkage.linearize()
    assert [c.name for c in loop.columns] == ["a1", "a2", "b1", "b2", "pin"]
    assert not loop.grasp[:, :3].any()


def test_legs_hang_from_the_member_and_swing_in_the_air() -> None:
    """A trunk with two legs; one foot stands, the other leg is free to swing with its motors."""

    def trunk(standing: tuple[str, ...]) -> Mechanism:
        joints = [vc.Free("float", "ground", "trunk", at=(0, 1))]
        for side, x in (("l", -1.0), ("r", 1.0)):
            joints += [
                vc.Revolute(f"hip_{side}", "trunk", f"thigh_{side}", at=(x, 1)),
                vc.Revolute(f"knee_{side}", f"thigh_{side}", f"shank_{side}", at=(1.2 * x, 0.5)),
            ]
        feet = [
            vc.Contact(f"foot_{s}", f"shank_{s}", "ground", "hard-finger", at=(x, 0), normal=(0, -1))
            for s, x in (("l", -1.0), ("r", 1.0))
            if s in standing
        ]
        return Mechanism.planar(
            joints=joints, contacts=feet, reference=vc.Reference("trunk", origin=(0, 1)),
            active=["hip_l", "knee_l", "hip_r", "knee_r"],
        )  # fmt: skip

    both, one, none = trunk(("l", "r")), trunk(("l",)), trunk(())
    assert all(both.reduction.carried[b] for b in ("thigh_l", "shank_l", "thigh_r", "shank_r"))
    assert summary(both) == (3, 0, 0, 0, 3, 1, 0, 0)
    assert summary(one) == (5, 0, 2, 1, 2, 0, 0, 0)
    assert summary(none) == (7, 0, 4, 3, 0, 0, 0, 0)
    model = none.linearize()
    assert model.jacobian_active.shape == (0, 4)
    assert model.notes == (
        "free joint float between ground and reference member is unactuated: it constrains nothing",
    )
    standing = both.linearize()
    assert [row.name for row in standing.rows] == ["foot_l.ft", "foot_l.fn", "foot_r.ft", "foot_r.fn"]


def test_an_actuated_or_locked_free_joint_between_the_roots_counts() -> None:
    def floating(**changes):  # type: ignore[no-untyped-def]
        return Mechanism.planar(
            joints=[vc.Free("float", "ground", "body", at=(0, 0))], reference=vc.Reference("body"), **changes
        )

    free, driven, held = floating(), floating(active=["float.vx"]), floating(lock="float.wz")
    assert summary(free) == (3, 0, 0, 3, 0, 0, 0, 0)
    assert free.linearize().rows == ()
    assert summary(driven) == (3, 0, 0, 2, 1, 0, 0, 0)
    assert summary(held) == (2, 0, 0, 2, 0, 0, 1, 0)
    assert free.resolve_motors(vc.ALL) == ()


def test_a_second_object_gets_a_passive_free_joint_and_a_note() -> None:
    """A finger presses a block against the member: the block is held by its two contacts alone."""
    grasp = Mechanism.planar(
        joints=[vc.Prismatic("push", "ground", "finger", axis=(1, 0), at=(0, 0))],
        contacts=[
            vc.Contact("near", "finger", "block", "hard-finger", at=(1, 0), normal=(1, 0)),
            vc.Contact("far", "block", "member", "hard-finger", at=(2, 0), normal=(1, 0)),
        ],
        reference=vc.Reference("member", origin=(2, 0)),
        active=["push"],
    )
    model = grasp.linearize()
    assert [c.name for c in model.passives] == ["block.free.vx", "block.free.vy", "block.free.wz"]
    assert model.notes == (
        "block is held by contacts or closures only: it got a passive free joint to the ground",
    )
    assert grasp.resolve_motors("all") == ("push",)
    assert summary(grasp) == (3, 0, 0, 2, 1, 0, 0, 0)
    assert grasp.body_poses({"block.free": (0, 0, 0.5)})["block"].position == pytest.approx((0, 0))


def test_bodies_fixed_to_each_other_move_as_one() -> None:
    linkage = five_bar(
        bodies=[vc.Body("tool", fixed_to="coupler", at=(-0.5, 0.5)), vc.Body("base", fixed_to="ground")],
        reference=vc.Reference("tool", origin=(-0.5, 0)),
    )
    assert cuts_of(linkage) == {"o2": ("kept", "member cut"), "o3": ("kept", "member cut")}
    assert linkage.reduction.clusters["coupler"] == ("tool", "coupler")
    assert linkage.linearize().jacobian_active == pytest.approx(five_bar().linearize().jacobian_active)
    assert linkage.linearize().motions is not None
    with pytest.raises(TopologyError, match="'base' is fixed to the ground: it cannot move"):
        linkage.with_reference("base").linearize()


def test_a_joint_inside_a_rigid_group_is_a_loop_cut_that_cannot_move() -> None:
    linkage = Mechanism.planar(
        joints=[
            vc.Revolute("o", "ground", "plate", at=(0, 0)),
            vc.Fixed("weld", "plate", "rib", at=(1, 0)),
            vc.Revolute("jammed", "plate", "rib", at=(1, 1)),
        ],
        reference=vc.Reference("plate", origin=(0, 0)),
        active=["o"],
    )
    assert cuts_of(linkage) == {"o": ("kept", "member cut"), "jammed": ("kept", "loop cut")}
    assert summary(linkage) == (1, 0, 0, 0, 1, 0, 2, 2)


def test_every_joint_type_as_a_contact_blocks_its_complement() -> None:
    """Two links to the member, one through each joint type cut as a contact: same counts as kept."""
    for build, rows in (
        (lambda: vc.Revolute("j", "a", "m", (1, 2, 3), (0, 1, 1)), 5),
        (lambda: vc.Prismatic("j", "a", "m", (0, 1, 1), (1, 2, 3)), 5),
        (lambda: vc.Screw("j", "a", "m", (1, 2, 3), (0, 1, 1), 0.1), 5),
        (lambda: vc.Cylindrical("j", "a", "m", (1, 2, 3), (0, 1, 1)), 4),
        (lambda: vc.Universal("j", "a", "m", (1, 2, 3), ((0, 1, 1), (1, 1, 0))), 4),
        (lambda: vc.Spherical("j", "a", "m", (1, 2, 3)), 3),
        (lambda: vc.PlanarJoint("j", "a", "m", (1, 2, 3), (0, 1, 1)), 3),
        (lambda: vc.Fixed("j", "a", "m", (1, 2, 3)), 6),
        (lambda: vc.Free("j", "a", "m"), 0),
    ):
        both = []
        for kind in ("kept", "contact"):
            mechanism = Mechanism.spatial(
                joints=[
                    vc.Spherical("ball", "ground", "a", at=(0, 0, 0)),
                    build(),
                    vc.Revolute("hinge", "ground", "m", at=(3, 0, 0), axis=(1, 2, 0)),
                ],
                reference=vc.Reference("m", origin=(1, 0, 0), cuts={"j": Cut(kind)}),  # type: ignore[arg-type]
                active=["hinge"],
            )
            both.append(summary(mechanism))
            count = sum(1 for row in mechanism.linearize().rows if row.source == "j")
            assert count == (rows if kind == "contact" else 6)
        assert both[0] == both[1]


def test_a_joint_cut_as_a_contact_is_cut_at_its_centre() -> None:
    cuts = {"o2": Cut("contact", (0, 0))}
    with pytest.raises(TopologyError, match="a joint cut as a contact is cut at its centre; leave `at` out"):
        five_bar(reference=vc.Reference("coupler", cuts=cuts)).linearize()


def test_without_a_reference_member_candidates_are_listed() -> None:
    with pytest.raises(MissingReferenceError, match="one of crank, coupler, link, rocker") as refused:
        five_bar(reference=None).linearize()
    assert refused.value.candidates == ("crank", "coupler", "link", "rocker")
