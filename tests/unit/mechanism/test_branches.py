"""Assembly modes, the names of branches, singularities by type, and another body as the ground."""

from __future__ import annotations

import itertools
import math
from typing import Any

import numpy as np
import pytest
from tests.laws.random_mechanisms import random_mechanism
from tests.unit.mechanism.linkages import circles_meet, five_bar, five_bar_o3, four_bar, joint_point

import vincula as vc
from vincula.mechanism.branch_groups import branch_groups
from vincula.mechanism.branches import branch_measures
from vincula.mechanism.catalog import example, examples
from vincula.mechanism.samples import sample_configurations
from vincula.mechanism.singularities import singularities_at


def test_five_bar_has_two_assembly_modes_at_given_motors() -> None:
    mechanism = five_bar()
    modes = mechanism.assembly_modes({"o1": 0.2, "o5": -0.3}, starts=30)
    assert len(modes) == 2
    o2, o4 = joint_point(mechanism, modes[0], "o2"), joint_point(mechanism, modes[0], "o4")
    expected = circles_meet(o2, 1.0, o4, math.sqrt(2.0))
    found = [joint_point(mechanism, q, "o3") for q in modes]
    for point in expected:
        assert min(float(np.linalg.norm(point - other)) for other in found) < 1e-13
    assert {q.branch.assembly for q in modes} == {"+", "-"}
    np.testing.assert_allclose(found[0], five_bar_o3(0.2, -0.3), atol=1e-13)
    assert modes[0].branch == vc.Branch("+", "++"), "the first mode is the one of home"


def test_the_name_of_a_branch_tells_all_postures_apart() -> None:
    """Both legs bent either way, the coupler fixed: four working modes for one pose of the coupler."""
    mechanism = example("3rrr")
    home = mechanism.home
    member = mechanism.reference
    assert member is not None
    pose = mechanism.body_poses(home)[member.body]
    there = vc.Pose(pose.rotation, pose.apply(member.origin))
    rng = np.random.default_rng(0)
    names = set()
    for _ in range(60):
        start = {name: rng.uniform(-3, 3) for name in home}
        names.add(str(mechanism.close(start, pose=there).branch.working))
    assert names == {"".join(signs) for signs in itertools.product("+-", repeat=3)}


def test_measures_are_those_of_the_legs() -> None:
    """Legs of a 3-RRR whose platform is held: arms of two bars, whose determinant is the area they span."""
    mechanism = example("3rrr")
    start = mechanism.close({"b1": 0.6, "b2": -0.9, "b3": 1.1})
    model = mechanism.linearize(start)
    scale = np.linalg.svd(np.hstack([model.scaled.active, model.scaled.passive, model.scaled.member]))[1][0]
    for k, group in enumerate(branch_groups(mechanism)["working"]):
        block = np.hstack([model.scaled.active, model.scaled.passive])[np.ix_(group.rows, group.columns)]
        value = branch_measures(mechanism, model, "working")[k]
        assert abs(value) == pytest.approx(np.linalg.svd(block)[1][-1] / scale, abs=1e-12)
        points = [joint_point(mechanism, start, f"{letter}{k + 1}") for letter in "abc"]
        home = [joint_point(mechanism, mechanism.home, f"{letter}{k + 1}") for letter in "abc"]
        assert np.sign(value) == np.sign(_turn(*points) * _turn(*home))
        assert abs(np.linalg.det(block)) * mechanism.length**2 == pytest.approx(
            abs(_turn(*points)), abs=1e-12
        )


def _turn(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> float:
    """Twice the signed area of a triangle."""
    (x, y), (u, v) = (b - a)[:2], (c - b)[:2]
    return float(x * v - y * u)


@pytest.mark.parametrize("entry", examples(), ids=lambda entry: entry.name)
def test_groups_of_the_structure_take_in_every_entry(entry: Any) -> None:
    """No entry of the matrices, at any configuration, joins a group with anything outside."""
    mechanism = example(entry.name)
    for q in sample_configurations(mechanism):
        _hold_every_entry(mechanism, q)


@pytest.mark.parametrize("seed", range(25))
def test_groups_of_random_mechanisms(seed: int) -> None:
    """Limbs that branch, inner loops, couplings, contacts: home is on its own branch in every group."""
    mechanism = random_mechanism(seed)
    _hold_every_entry(mechanism, mechanism.home)
    for side, groups in branch_groups(mechanism).items():
        assert len({group.label for group in groups}) == len(groups)
        assert (branch_measures(mechanism, mechanism.linearize(), side) > 0.0).all()


def _hold_every_entry(mechanism: vc.Mechanism, q: vc.Configuration) -> None:
    motors, joints = len(mechanism.layout.active), len(mechanism.layout.columns)
    columns = {"assembly": range(motors, joints + mechanism.space.dimension), "working": range(joints)}
    matrix = mechanism.linearize(q).ledger.matrix("all")
    for side, groups in branch_groups(mechanism).items():
        inside = np.zeros(matrix.shape, dtype=bool)
        for group in groups:
            assert not inside[np.ix_(group.rows, group.columns)].any(), "groups do not overlap"
            inside[np.ix_(group.rows, group.columns)] = True
        assert not matrix[:, columns[side]][~inside[:, columns[side]]].any()


def test_a_branch_of_a_mechanism_that_is_singular_at_home() -> None:
    """Two sides meet there: it has neither sign, and those beside it have opposite ones."""
    mechanism = _stretched(0.0)
    assert mechanism.close().branch.assembly == "0"
    assert branch_measures(mechanism, mechanism.linearize(), "assembly")[0] == 0.0
    sides = [mechanism.close({"o2": -turn, "o3": 2.0 * turn}).branch.assembly for turn in (0.3, -0.3)]
    assert sorted(sides) == ["+", "-"]


def test_too_few_motors_leave_no_separate_modes() -> None:
    with pytest.raises(vc.ModelError, match="hold as many motors"):
        five_bar().assembly_modes({"o1": 0.2}, starts=5)


def test_spinning_legs_do_not_multiply_the_modes() -> None:
    """Four-bar in space closed by two balls: the coupler spins about its own line."""
    a, b, c, d = (0, 0, 0), (0, 1, 0), (3.0, 2.0, 0), (3, 0, 0)
    mechanism = vc.Mechanism.spatial(
        joints=[
            vc.Revolute("a", "ground", "crank", at=a),
            vc.Spherical("b", "crank", "rod", at=b),
            vc.Spherical("c", "rod", "rocker", at=c),
            vc.Revolute("d", "rocker", "ground", at=d),
        ],
        reference=vc.Reference("rocker"),
        active=["a"],
    )
    modes = mechanism.assembly_modes(starts=25)
    assert len(modes) == 2
    assert all(q.free_motions == 1 for q in modes)
    tips = circles_meet(np.array([0.0, 1.0]), math.sqrt(10.0), np.array([3.0, 0.0]), 2.0)
    found = sorted(tuple(np.round(joint_point(mechanism, q, "c")[:2], 9)) for q in modes)
    assert found == sorted(tuple(np.round(tip, 9)) for tip in tips)


def _stretched(shift: float) -> vc.Mechanism:
    """A five-bar whose passive links o2-o3-o4 are in line but for `shift`."""
    return vc.Mechanism.planar(
        joints=[
            vc.Revolute("o1", "ground", "crank", at=(-1, 0)),
            vc.Revolute("o2", "crank", "coupler", at=(-1, 1)),
            vc.Revolute("o3", "coupler", "link", at=(0, 1 + shift)),
            vc.Revolute("o4", "link", "rocker", at=(1, 1)),
            vc.Revolute("o5", "rocker", "ground", at=(1, 0)),
        ],
        reference=vc.Reference("coupler", origin=(-0.5, 1)),
        active=["o1", "o5"],
    )


def test_platform_becomes_free_when_the_passive_links_are_in_line() -> None:
    (singular,) = singularities_at(_stretched(0.0), _stretched(0.0).home)
    assert singular.kind == "platform free"
    assert "becomes free: it can move with o1, o5 locked" in str(singular)
    assert set(singular.joints) == {"o2", "o4"} or set(singular.joints) == {"o2", "o3", "o4"}
    q = _stretched(0.0).close()
    assert q.singular
    assert not _stretched(0.01).close().singular
    assert singularities_at(_stretched(1e-4), _stretched(1e-4).home) == ()


def test_motors_lose_authority_when_a_leg_is_stretched() -> None:
    mechanism = vc.Mechanism.planar(
        joints=[
            vc.Revolute("o1", "ground", "crank", at=(-1, -1)),
            vc.Revolute("o2", "crank", "coupler", at=(-1, 0)),
            vc.Revolute("o3", "coupler", "link", at=(-1, 1)),
            vc.Revolute("o4", "link", "rocker", at=(1, 0)),
            vc.Revolute("o5", "rocker", "ground", at=(2, -1)),
        ],
        reference=vc.Reference("link", origin=(-1, 1)),
        active=["o1", "o5"],
    )
    (singular,) = singularities_at(mechanism, mechanism.home)
    assert singular.kind == "motors without authority"
    # the leg o1-o2 of lengths 1 and 1 folds: rates 1 at o1, -2 at o2
    assert singular.joints["o2"] / singular.joints["o1"] == pytest.approx(2.0, abs=1e-9)


def test_a_flat_four_bar_degenerates_in_itself() -> None:
    flat = vc.Mechanism.planar(
        joints=[
            vc.Revolute("a", "ground", "crank", at=(0, 0)),
            vc.Revolute("b", "crank", "coupler", at=(1, 0)),
            vc.Revolute("c", "coupler", "rocker", at=(3, 0)),
            vc.Revolute("d", "rocker", "ground", at=(2, 0)),
        ],
        reference=vc.Reference("coupler"),
        active=["a"],
    )
    kinds = {singular.kind for singular in singularities_at(flat, flat.home)}
    assert kinds == {"internal", "platform free"}


def test_a_shaky_truss_is_singular_although_it_cannot_move() -> None:
    """Two bars in line between two fixed points: movable to first order only."""
    truss = vc.Mechanism.planar(
        joints=[
            vc.Revolute("a", "ground", "left", at=(-1, 0)),
            vc.Revolute("b", "left", "right", at=(0, 0)),
            vc.Revolute("c", "right", "ground", at=(1, 0)),
        ],
        reference=vc.Reference("left"),
    )
    assert {s.kind for s in singularities_at(truss, truss.home)} == {"internal"}


def test_a_planar_loop_in_space_is_not_singular() -> None:
    """Three of its six rows are redundant everywhere: that is no singularity."""
    at = {"a": (0, 0, 0), "b": (0, 1, 0), "c": (3, 2, 0), "d": (3, 0, 0)}
    bodies = ["ground", "crank", "coupler", "rocker", "ground"]
    mechanism = vc.Mechanism.spatial(
        joints=[vc.Revolute(n, bodies[k], bodies[k + 1], at=p) for k, (n, p) in enumerate(at.items())],
        reference=vc.Reference("coupler"),
        active=["a"],
    )
    q = mechanism.close(motors={"a": 0.4})
    assert not q.singular
    assert q.branch.assembly == "+"
    assert {m.branch.assembly for m in mechanism.assembly_modes({"a": 0.4}, starts=20)} == {"+", "-"}


def test_another_ground_changes_no_relative_motion() -> None:
    mechanism = four_bar()
    seen = mechanism.with_ground("coupler").with_reference("rocker").with_active(["b"])
    assert "coupler" not in seen.body
    assert "world" in seen.body
    q = seen.close(motors={"b": 0.3})
    same = mechanism.close(motors={"b": 0.3})
    for joint in mechanism.home:
        assert q[joint][0] == pytest.approx(same[joint][0], abs=1e-12)
    old, new = mechanism.body_poses(same), seen.body_poses(q)
    expected = old["coupler"].inverse() @ old["rocker"]
    np.testing.assert_allclose(new["rocker"].position, expected.position, atol=1e-12)
    result = vc.analyze(seen.linearize(q), vc.Weights()).to_dict()
    assert result["mobility"]["nullity"] == 1


def test_a_floating_base_that_becomes_the_ground_drops_its_free_joint() -> None:
    robot = vc.Mechanism.spatial(
        joints=[
            vc.Free("base", "ground", "trunk"),
            vc.Revolute("hip", "trunk", "leg", at=(0, 0, 1), axis=(0, 1, 0)),
        ],
        reference=vc.Reference("trunk"),
        active=["hip"],
    )
    seen = robot.with_ground("trunk")
    assert [joint.name for joint in seen.joints] == ["hip"]
    assert list(seen.body) == ["leg"]
    assert seen.reference is None
    assert seen.with_ground("ground") is seen
    assert list(robot.with_ground("leg").body) == ["trunk"], "nor does it float beside any other body"
    with pytest.raises(vc.UnknownNameError, match="did you mean 'trunk'"):
        robot.with_ground("trunc")
