"""The derivative of J and G along motions, against central differences of closed configurations."""

from __future__ import annotations

import numpy as np
import pytest
from tests.laws.random_closed import displaced, random_closed

import vincula as vc
from vincula.mechanism.catalog.registry import example, examples
from vincula.mechanism.kinematics import body_poses, reference_position
from vincula.mechanism.mechanism import Mechanism
from vincula.mechanism.second_order import MatrixDerivative
from vincula.spatial.poses import rotation_vector

STEP = 1e-4


def matrices(mechanism: Mechanism, q: vc.Configuration) -> tuple[np.ndarray, np.ndarray]:
    model = mechanism.linearize(q)
    jacobian = np.zeros((len(model.rows), len(mechanism.layout.columns)))
    jacobian[:, mechanism.layout.active] = model.jacobian_active
    jacobian[:, mechanism.layout.passive] = model.jacobian_passive
    return jacobian, model.grasp.T


def motion_between(derivative: MatrixDerivative, mechanism: Mechanism, a: vc.Configuration,
                   b: vc.Configuration) -> tuple[np.ndarray, np.ndarray]:  # fmt: skip
    """Column rates and member twist that explain how all frames went from b to a; fails if none do."""
    poses_a, poses_b = body_poses(mechanism, a), body_poses(mechanism, b)
    table = mechanism.layout.frames
    one, two = table.placed(poses_a), table.placed(poses_b)
    turned = [
        np.atleast_1d(rotation_vector(p @ r.T)) for p, r in zip(one.rotation, two.rotation, strict=True)
    ]
    seen = np.concatenate([np.ravel(turned), np.ravel(one.position - two.position)]) / (2 * STEP)
    columns, d = len(mechanism.layout.columns), mechanism.space.dimension
    basis = []
    for unit in np.eye(columns + d):
        moving = derivative.frame_motion(unit[:columns], unit[columns:])
        basis.append(np.concatenate([moving.turn.ravel(), moving.velocity.ravel()]))
    found = np.linalg.lstsq(np.array(basis).T, seen, rcond=None)[0]
    assert np.abs(np.array(basis).T @ found - seen).max() < 1e-6
    member = mechanism.reference.body
    turn = np.atleast_1d(rotation_vector(poses_a[member].rotation @ poses_b[member].rotation.T))
    speed = reference_position(mechanism, poses_a) - reference_position(mechanism, poses_b)
    return found[:columns], np.concatenate([speed, turn]) / (2 * STEP)


def check(mechanism: Mechanism, rng: np.random.Generator) -> None:
    q = mechanism.close(near=displaced(rng, mechanism, 0.2))
    way = {name: np.array(v) - mechanism.home[name] for name, v in displaced(rng, mechanism, 1.0).items()}
    ends = [mechanism.close(near={n: q[n] + s * STEP * way[n] for n in q}) for s in (1.0, -1.0)]
    derivative = MatrixDerivative(mechanism, q)
    rates, twist = motion_between(derivative, mechanism, *ends)
    jacobian, member = derivative.along(rates, twist)
    for exact, plus, minus in zip(
        (jacobian, member), *(matrices(mechanism, end) for end in ends), strict=True
    ):
        assert np.abs(exact - (plus - minus) / (2 * STEP)).max() < 1e-6 * max(1.0, np.abs(exact).max())


@pytest.mark.parametrize("name", [entry.name for entry in examples()])
def test_examples(name: str) -> None:
    check(example(name), np.random.default_rng(7))


@pytest.mark.parametrize("name", ["five-bar", "stewart"])
def test_member_told_in_its_own_axes(name: str) -> None:
    mechanism = example(name)
    reference = mechanism.reference
    check(mechanism.with_reference(reference.body, reference.origin, axes="body"), np.random.default_rng(8))


@pytest.mark.parametrize("seed", range(9))
def test_random_mechanisms(seed: int) -> None:
    rng = np.random.default_rng(seed)
    check(random_closed(rng, planar=seed % 3 == 0, loops=1 + seed % 3), rng)


def test_polynomial_coupling() -> None:
    arm = vc.Mechanism.planar(
        joints=[vc.Revolute("a", "ground", "one", at=(0, 0)), vc.Revolute("b", "one", "two", at=(1, 0))],
        couplings=[vc.Coupling("bent", {"b": 1.0}, driver={"a": 1.0}, polynomial=[0.0, 0.5, 0.3, -0.2])],
        reference=vc.Reference("two", origin=(1.5, 0)),
    )
    check(arm, np.random.default_rng(0))
