"""What the matrices say will move does move: 300 random mechanisms against their own positions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tests.laws.holding import IN_BLOCKS, hold, model_of
from tests.laws.motion_spaces import apart, assert_same_numbers, assert_same_relation, motions, span
from tests.laws.random_mechanisms import Drawn, random_drawn, random_mechanism
from tests.unit.mechanism.joint_samples import moved_values, twist_between

import vincula as vc
from vincula.analysis.manipulability import kinematic_ellipsoid
from vincula.arrays import Matrix, Vector
from vincula.mechanism.drawing import DrawnJoint
from vincula.mechanism.joint_types import axis_twists
from vincula.mechanism.kinematics import part_frames
from vincula.mechanism.mechanism import Mechanism
from vincula.model import LinearModel
from vincula.spatial.space import PLANAR
from vincula.spatial.twists import transport
from vincula.weights import Weights


def physical_motions(mechanism: Mechanism, model: LinearModel) -> tuple[dict[str, Vector], dict[str, Matrix]]:
    """For every motion of the kernel: rates of all joint axes, twists of all bodies at the ground's origin.

    The rates of free joints between the roots, which have no columns, are read off the member's twist.
    """
    found = motions(model)
    s = model.scaled
    rates = {
        column.name: found.of([column.name])[0] * factor
        for column, factor in zip(model.columns, [*s.active_column, *s.passive_column], strict=True)
    }
    twist = found.of([f"u.{c}" for c in model.twist_components]) * s.twist[:, None]
    assert model.motions is not None
    all_rates = np.array([rates[c.name] for c in model.columns]).reshape(len(model.columns), twist.shape[1])
    home = transport(-model.motions.origin)
    twists = {}
    each = [model.motions.twists(q, u) for q, u in zip(all_rates.T, twist.T, strict=True)]
    groups = mechanism.reduction.clusters.values()
    for k, bodies in enumerate(groups):
        of_group = np.array([home @ one[:, k] for one in each]).reshape(-1, model.dimension).T
        twists.update(dict.fromkeys(bodies, of_group))
    for name in mechanism.reduction.unused:
        joint = mechanism.joint[name]
        kind = mechanism.type_of(joint)
        first, second = part_frames(joint, mechanism.body_poses())
        axes = axis_twists(kind, first, second, 0.0, joint.second_axis, np.zeros(len(first.position)))
        of_axes = np.linalg.solve(axes, twists[joint.second] - twists[joint.first])
        rates.update(zip(kind.axis_names(name), of_axes, strict=True))
    return rates, twists


def configuration_after(mechanism: Mechanism, rates: dict[str, float], time: float) -> dict[str, Vector]:
    """Joint values after a time at constant rates of the axes named; the others rest."""
    q = {}
    for joint in mechanism.all_joints:
        kind = mechanism.type_of(joint)
        own = np.array([rates.get(axis, 0.0) for axis in kind.axis_names(joint.name)])
        q[joint.name] = moved_values(kind, mechanism.home[joint.name], own, time)
    return q


def worst_gap(mechanism: Mechanism, rates: dict[str, float], time: float) -> float:
    gaps = [r.gap for r in mechanism.residuals(configuration_after(mechanism, rates, time))]
    return max(gaps, default=0.0)


@IN_BLOCKS
def test_motions_keep_loops_closed_and_nothing_else_does(block: range) -> None:
    """Residual O(eps^2) along the kernel, O(eps) across it."""

    def law(seed: int, rng: np.random.Generator) -> None:
        mechanism, model = random_mechanism(seed), model_of(seed)
        rates, _ = physical_motions(mechanism, model)
        drives = {d.name for d in mechanism.drives}
        axes = [axis for axis in rates if axis not in drives]
        along = np.array([rates[axis] for axis in axes]).reshape(len(axes), -1)
        far, near = 1e-3, 1e-4
        if along.shape[1]:
            mixed = along @ rng.normal(size=along.shape[1])
            motion = dict(zip(axes, mixed / max(np.linalg.norm(mixed), 1e-12), strict=True))
            first, second = (worst_gap(mechanism, motion, t) for t in (far, near))
            assert second <= 0.02 * first + 1e-12
            assert first <= 1e-3
        tangent = span(along)
        across = rng.normal(size=len(axes))
        across -= tangent @ (tangent.T @ across)
        if len(axes) > tangent.shape[1]:
            stray = dict(zip(axes, across / np.linalg.norm(across), strict=True))
            first, second = (worst_gap(mechanism, stray, t) for t in (far, near))
            assert second == pytest.approx(0.1 * first, rel=0.3)
            assert second > 1e-3 * near

    hold(block, law)


@IN_BLOCKS
def test_bodies_move_with_the_twists_that_are_told(block: range) -> None:
    """Every body's twist, the member's above all, against central differences of its pose."""

    def law(seed: int, rng: np.random.Generator) -> None:
        mechanism, model = random_mechanism(seed), model_of(seed)
        rates, twists = physical_motions(mechanism, model)
        count = twists["member"].shape[1]
        if not count:
            return
        mix = rng.normal(size=count)
        mix /= np.linalg.norm(mix)
        motion = {axis: float(of_axis @ mix) for axis, of_axis in rates.items()}
        step = 1e-4
        before, after = (
            mechanism.body_poses(configuration_after(mechanism, motion, t)) for t in (-step, step)
        )
        origin = np.zeros(mechanism.space.translations)
        home = mechanism.body_poses()
        for name in home:
            found = twist_between(before[name], after[name], home[name], origin, 2 * step)
            assert found == pytest.approx(twists[name] @ mix, abs=2e-6 * (1 + np.abs(found).max()))
        member = motions(model).of([f"u.{c}" for c in model.twist_components]) * model.scaled.twist[:, None]
        assert model.motions is not None
        told = transport(-model.motions.origin) @ member @ mix
        assert twists["member"] @ mix == pytest.approx(told, abs=1e-12)

    hold(block, law)


@IN_BLOCKS
def test_reference_member_exchanged(block: range) -> None:
    """Another member: the same motions of all joints and all bodies."""

    def law(seed: int, rng: np.random.Generator) -> None:
        mechanism, model = random_mechanism(seed), model_of(seed)
        moving = [b.name for b in mechanism.bodies if b.name not in mechanism.reduction.clusters["ground"]]
        other = mechanism.with_reference(str(rng.choice(moving)))
        changed = other.linearize()
        rates_one, twists_one = physical_motions(mechanism, model)
        rates_two, twists_two = physical_motions(other, changed)
        assert set(twists_one) == set(twists_two)
        axes = sorted(set(rates_one) & set(rates_two))
        one = np.vstack([*(rates_one[a] for a in axes), *(twists_one[b] for b in sorted(twists_one))])
        two = np.vstack([*(rates_two[a] for a in axes), *(twists_two[b] for b in sorted(twists_two))])
        assert apart(one, two) < 1e-6

    hold(block, law)


@IN_BLOCKS
def test_a_passive_ball_is_three_hinges(block: range) -> None:
    def law(seed: int, rng: np.random.Generator) -> None:
        drawn, base = random_drawn(seed), model_of(seed)
        balls = [
            j
            for j in drawn.joints
            if j.type == "spherical" and not set(drawn.kind(j)) & {*drawn.active, *drawn.lock}
        ]
        if not balls:
            return
        other = split(drawn, balls, rng).mechanism().linearize()
        assert_same_relation(base, other)
        assert_same_numbers(base, other)

    hold(block, law)


def split(drawn: Drawn, balls: list[DrawnJoint], rng: np.random.Generator) -> Drawn:
    """Balls replaced by three revolute joints with independent axes through their centres."""
    joints: list[DrawnJoint] = []
    for joint in drawn.joints:
        if joint not in balls:
            joints.append(joint)
            continue
        axes = np.linalg.qr(rng.normal(size=(3, 3)))[0] + 0.2 * rng.normal(size=(3, 3))
        bodies = [joint.first, f"{joint.name}_1", f"{joint.name}_2", joint.second]
        joints += [
            vc.Revolute(f"{joint.name}_r{k}", bodies[k], bodies[k + 1], joint.at, axes[k]) for k in range(3)
        ]
    return replace(drawn, joints=tuple(joints))


@pytest.mark.parametrize("planar", [True, False], ids=["planar", "spatial"])
def test_one_serial_arm_gives_the_classical_ellipsoid(planar: bool, rng: np.random.Generator) -> None:
    """All joints of one arm driven: the efficiencies are the eigenvalues of J J^T, J by differences."""
    for _ in range(30):
        count = int(rng.integers(1, 5 if planar else 9))
        s = 2 if planar else 3
        bodies = ["ground", *(f"b{k}" for k in range(count))]
        joints = []
        for k in range(count):
            kind = str(
                rng.choice(["revolute", "prismatic"] if planar else ["revolute", "prismatic", "screw"])
            )
            axis = None if planar and kind == "revolute" else rng.normal(size=s)
            joints.append(
                DrawnJoint(f"q{k}", kind, bodies[k], bodies[k + 1], rng.normal(size=s), axis, lead=0.3)
            )
        make = vc.Mechanism.planar if planar else vc.Mechanism.spatial
        origin = rng.normal(size=s)
        arm = make(joints=joints, reference=vc.Reference(bodies[-1], origin=origin), active=vc.ALL)
        columns = []
        home = arm.body_poses()[bodies[-1]]
        for k in range(count):
            poses = [arm.body_poses({f"q{k}": sign * 1e-5})[bodies[-1]] for sign in (-1, 1)]
            columns.append(twist_between(poses[0], poses[1], home, origin, 2e-5))
        jacobian = np.column_stack(columns)
        squares = np.linalg.svd(jacobian, compute_uv=False) ** 2
        rank = min(jacobian.shape)
        found = kinematic_ellipsoid(arm.linearize(), Weights()).efficiencies
        assert found[:rank] == pytest.approx(squares[:rank], rel=1e-5)
        assert (found[rank:] == 0.0).all()
        assert len(found) == count
        assert arm.space is PLANAR or not planar
