"""Locks, couplings and drives: what they do to rows and columns."""

from __future__ import annotations

import pytest
from tests.unit.mechanism.five_bar import cuts_of, five_bar, rows_of, summary

import vincula as vc
from vincula.errors import TopologyError
from vincula.mechanism.mechanism import Mechanism
from vincula.mechanism.parts import Coupling, Cut, Drive


def test_locked_joints_lose_their_columns_only() -> None:
    locked = five_bar(active=["o1"], lock=["o5"])
    assert [c.name for c in locked.linearize().columns] == ["o1", "o2", "o3", "o4"]
    assert summary(locked) == (1, 0, 0, 0, 1, 0, 2, 0)
    at_member = five_bar(active=["o1", "o5"], lock=["o2"])
    assert cuts_of(at_member)["o2"] == ("kept", "member cut")
    assert summary(at_member) == (1, 0, 0, 0, 1, 1, 2, 0)
    fully = five_bar(active=[], lock=["o1", "o2", "o3", "o4", "o5"])
    assert summary(fully) == (0, 0, 0, 0, 0, 0, 3, 3)
    with pytest.raises(
        TopologyError, match="'o2' cannot be cut as a contact: an axis of it is active, locked or"
    ):
        five_bar(lock=["o2"], reference=vc.Reference("coupler", cuts={"o2": Cut("contact")})).linearize()


def test_locking_drops_the_motor_of_the_joint() -> None:
    assert five_bar().with_lock("o1").active == ("o5",)
    assert five_bar().with_lock("").active == ("o1", "o5")


def test_couplings_are_rows() -> None:
    """o5 geared to o1 takes one of the two freedoms."""
    geared = five_bar(active=["o1"], couplings=[Coupling("gear", {"o1": 1.0, "o5": -2.0})])
    model = geared.linearize()
    assert rows_of(geared)[-1] == ("gear.rate", "coupling")
    assert model.jacobian_active[-1] == pytest.approx([1.0])
    assert model.jacobian_passive[-1] == pytest.approx([0.0, 0.0, 0.0, -2.0])
    assert not model.grasp[:, -1].any()
    assert summary(geared) == (1, 0, 0, 0, 1, 0, 2, 0)
    locked = geared.with_active(()).with_lock("o5").linearize()
    assert locked.jacobian_passive[-1] == pytest.approx([1.0, 0.0, 0.0, 0.0])


def test_a_polynomial_coupling_gives_its_slope() -> None:
    """q2 = 0.5 q1^2 about home: slope q1."""
    arm = Mechanism.planar(
        joints=[vc.Revolute("q1", "ground", "a", at=(0, 0)), vc.Revolute("q2", "a", "b", at=(1, 0))],
        couplings=[Coupling("cam", {"q2": 1.0}, driver={"q1": 1.0}, polynomial=(0.0, 0.0, 0.5))],
        reference=vc.Reference("b", origin=(2, 0)),
        active=["q1"],
    )
    for q1 in (0.0, 0.3, -1.2):
        model = arm.linearize({"q1": q1, "q2": 0.5 * q1**2})
        assert model.jacobian_active[-1] == pytest.approx([-q1])
        assert model.jacobian_passive[-1] == pytest.approx([1.0])
    moved = arm.with_configuration({"q1": 0.3, "q2": 0.045})
    assert moved.linearize().jacobian_active[-1] == pytest.approx([-0.3])
    assert max(r.gap for r in moved.residuals({"q1": 0.5, "q2": 0.125})) < 1e-15
    assert max(r.gap for r in moved.residuals({"q1": 0.5})) == pytest.approx(0.08 * moved.length)


def test_drives_are_motors_on_several_axes() -> None:
    """One motor turns the mean of o1 and o5: a column and a row, the axes become passive."""
    driven = five_bar(drives=[Drive("mean", {"o1": 0.5, "o5": 0.5})], active=["mean"])
    model = driven.linearize()
    assert [m.name for m in model.motors] == ["mean"]
    assert rows_of(driven)[-1] == ("mean.rate", "drive")
    assert model.jacobian_active[:, 0] == pytest.approx([0, 0, 0, 0, 0, 0, -1])
    assert dict(zip([p.name for p in model.passives], model.jacobian_passive[-1], strict=True)) == {
        "o1": 0.5, "o2": 0.0, "o3": 0.0, "o4": 0.0, "o5": 0.5,
    }  # fmt: skip
    assert summary(driven) == (2, 0, 0, 1, 1, 0, 1, 0)
    idle = driven.with_active(["o1", "o5"])
    assert summary(idle) == summary(five_bar())
    assert "mean.rate" not in [name for name, _ in rows_of(idle)]


def test_names_shared_across_name_spaces_give_different_rows() -> None:
    """A contact and a joint may have one name; their rows are told apart."""
    linkage = Mechanism.planar(
        joints=[
            vc.Revolute("o", "ground", "link", at=(0, 0)),
            vc.Revolute("grip", "link", "tool", at=(1, 0)),
        ],
        contacts=[vc.Contact("grip", "ground", "tool", "point", at=(2, 0), normal=(0, 1))],
        reference=vc.Reference("tool", origin=(2, 0)),
        active=["o"],
    )
    names = [row.name for row in linkage.linearize().rows]
    assert names == ["grip.fn", "grip.fx", "grip.fy", "grip.mz"]
    twice = Mechanism.planar(
        joints=[vc.Revolute("o", "ground", "link", at=(0, 0)), vc.Revolute("o2", "link", "tool", at=(1, 0))],
        contacts=[vc.Contact("gear", "ground", "tool", "complete", at=(2, 0), normal=(0, 1))],
        couplings=[Coupling("gear", {"o": 1.0, "o2": 1.0}), Coupling("o2", {"o": 1.0, "o2": 1.0})],
        reference=vc.Reference("tool", origin=(2, 0)),
    )
    rows = [row.name for row in twice.linearize().rows]
    assert len(set(rows)) == len(rows)
