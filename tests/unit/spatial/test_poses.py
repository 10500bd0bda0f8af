"""Poses and twists: theorems of the groups SE(2) and SE(3), and scipy as a peer."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from vincula.spatial.poses import (
    Pose,
    frame_with_z,
    rotation_about,
    rotation_from_quaternion_wxyz,
    rotation_vector,
)
from vincula.spatial.twists import block_rotation, moment_arm, transport

SPACES = pytest.mark.parametrize("s", [2, 3], ids=["planar", "spatial"])


def pose(rng: np.random.Generator, s: int) -> Pose:
    if s == 2:
        return Pose.from_angle(float(rng.uniform(-3, 3)), rng.normal(size=2))
    return Pose.at(rng.normal(size=3), Rotation.random(random_state=rng).as_matrix())


def same(one: Pose, two: Pose) -> bool:
    return bool(np.allclose(one.rotation, two.rotation) and np.allclose(one.position, two.position))


@SPACES
def test_poses_are_a_group_that_acts_on_points(s: int, rng: np.random.Generator) -> None:
    a, b, c = (pose(rng, s) for _ in range(3))
    point = rng.normal(size=s)
    assert same((a @ b) @ c, a @ (b @ c))
    assert same(a @ a.inverse(), Pose.identity(s))
    assert same(a.inverse().inverse(), a)
    assert (a @ b).apply(point) == pytest.approx(a.apply(b.apply(point)))


def test_quaternions_are_w_first_and_of_any_length(rng: np.random.Generator) -> None:
    turn = Rotation.random(random_state=rng)
    x, y, z, w = turn.as_quat()
    for length in (1.0, -3.0, 1e-3):
        found = rotation_from_quaternion_wxyz(length * np.array([w, x, y, z]))
        assert found == pytest.approx(turn.as_matrix())
    there = Pose.from_quaternion_wxyz((w, x, y, z), (1, 2, 3))
    assert there.position == pytest.approx([1, 2, 3])
    back = there.as_quaternion_wxyz()
    assert back[0] >= 0
    assert back == pytest.approx(np.array([w, x, y, z]) * np.sign(w))
    quarter = Pose.from_quaternion_wxyz((1, 0, 0, 1))
    assert quarter.apply(np.array([1.0, 0, 0])) == pytest.approx([0, 1, 0])


def test_rotation_about_an_axis_and_its_vector(rng: np.random.Generator) -> None:
    for angle in (0.0, 1e-9, 0.3, 3.0, np.pi - 1e-9):
        axis = rng.normal(size=3)
        axis /= np.linalg.norm(axis)
        turn = rotation_about(axis, angle)
        assert turn == pytest.approx(Rotation.from_rotvec(angle * axis).as_matrix())
        assert rotation_vector(turn) == pytest.approx(angle * axis, abs=1e-8)
    assert rotation_vector(Pose.from_angle(-2.5).rotation) == pytest.approx([-2.5])


def test_frames_with_a_given_z(rng: np.random.Generator) -> None:
    for _ in range(20):
        z, near = rng.normal(size=3), rng.normal(size=3)
        z /= np.linalg.norm(z)
        for frame in (frame_with_z(z), frame_with_z(z, near)):
            assert frame.T @ frame == pytest.approx(np.eye(3))
            assert np.linalg.det(frame) == pytest.approx(1)
            assert np.array_equal(frame[:, 2], z)
        x = frame_with_z(z, near)[:, 0]
        assert x @ near > 0
        assert np.linalg.det(np.column_stack([x, near, z])) == pytest.approx(0, abs=1e-12)


@SPACES
def test_transport_carries_the_velocity_field_of_a_rigid_body(s: int, rng: np.random.Generator) -> None:
    twist, one, two = rng.normal(size=3 if s == 2 else 6), rng.normal(size=s), rng.normal(size=s)
    omega = np.array([0, 0, twist[2]]) if s == 2 else twist[3:]
    arm = np.zeros(3)
    arm[:s] = one
    expected = twist[:s] + np.cross(omega, arm)[:s]
    assert (transport(one) @ twist)[:s] == pytest.approx(expected)
    assert (transport(one) @ twist)[s:] == pytest.approx(twist[s:])
    assert moment_arm(one) @ twist[s:] == pytest.approx(expected - twist[:s])
    assert transport(one) @ transport(two) == pytest.approx(transport(one + two))
    assert transport(one) @ transport(-one) == pytest.approx(np.eye(len(twist)))


@SPACES
def test_turning_and_transporting_commute_as_they_should(s: int, rng: np.random.Generator) -> None:
    turn, offset = pose(rng, s).rotation, rng.normal(size=s)
    block = block_rotation(turn)
    assert block @ transport(offset) == pytest.approx(transport(turn @ offset) @ block)
    assert block @ block.T == pytest.approx(np.eye(len(block)))
