"""Every joint type: its axes are the rates of its motion, its rows are what these leave out."""

from __future__ import annotations

import numpy as np
import pytest
from tests.unit.mechanism.joint_samples import (
    ALL_TYPES,
    IDS,
    differenced_twists,
    moved_values,
    random_pose,
    sample,
)

from vincula.errors import TopologyError, UnknownNameError
from vincula.mechanism.blocked import blocked_directions, joint_rows
from vincula.mechanism.joint_types import JOINT_TYPES, axis_twists, joint_type, values_between
from vincula.spatial.poses import Pose
from vincula.spatial.space import PLANAR, SPATIAL, Space

EVERY = pytest.mark.parametrize(("space", "name"), ALL_TYPES, ids=IDS)

FREEDOMS = {
    "revolute": 1, "prismatic": 1, "screw": 1, "cylindrical": 2, "universal": 2, "spherical": 3,
    "planar": 3, "fixed": 0, "free": 6,
}  # fmt: skip


@EVERY
def test_axis_twists_are_the_rates_of_the_motion(space: Space, name: str, rng: np.random.Generator) -> None:
    for _ in range(20):
        joint = sample(rng, space, name)
        point = rng.normal(size=space.translations)
        found = axis_twists(joint.kind, joint.first, joint.second, joint.lead, joint.second_axis, point)
        assert found == pytest.approx(differenced_twists(joint, point), abs=2e-9)


@EVERY
def test_values_between_inverts_the_motion(space: Space, name: str, rng: np.random.Generator) -> None:
    for _ in range(20):
        joint = sample(rng, space, name)
        found = values_between(joint.kind, joint.first, joint.second, joint.second_axis)
        assert found == pytest.approx(joint.values, abs=1e-12)


@EVERY
def test_zero_values_are_no_motion(space: Space, name: str, rng: np.random.Generator) -> None:
    joint = sample(rng, space, name)
    still = joint.motion(joint.kind.zero)
    assert np.array_equal(still.rotation, np.eye(space.translations))
    assert not still.position.any()


@EVERY
def test_rows_annihilate_the_axes_and_complete_them(
    space: Space, name: str, rng: np.random.Generator
) -> None:
    for _ in range(20):
        joint = sample(rng, space, name)
        rows = blocked_directions(joint.kind, joint.first, joint.second, joint.lead, joint.second_axis)
        axes = axis_twists(
            joint.kind, joint.first, joint.second, joint.lead, joint.second_axis, joint.second.position
        )
        assert np.abs(rows.matrix @ axes).max(initial=0.0) < 1e-12
        assert np.abs(rows.gaps).max(initial=0.0) < 1e-12
        assert rows.matrix.shape[0] + axes.shape[1] == space.dimension
        if rows.matrix.size:
            assert np.linalg.svd(rows.matrix, compute_uv=False).min() > 0.5


@EVERY
def test_number_of_rows_of_table_two(space: Space, name: str) -> None:
    kind = joint_type(name, space)
    freedoms = 3 if (space is PLANAR and name == "free") else FREEDOMS[name]
    rows = joint_rows(kind, 0.1, np.array([1.0, 0.0, 0.0]))
    assert len(kind.axes) == len(kind.linear) == freedoms
    assert len(rows) == space.dimension - freedoms


@EVERY
def test_rows_are_the_rates_of_the_gaps(space: Space, name: str, rng: np.random.Generator) -> None:
    """B is moved off by a small twist of every direction; gaps must open at the rates of the rows."""
    step = 1e-6
    for _ in range(5):
        joint = sample(rng, space, name)
        rows = blocked_directions(joint.kind, joint.first, joint.second, joint.lead, joint.second_axis)
        free = joint_type("free", space)
        for k in range(space.dimension):
            twist = np.eye(space.dimension)[k]
            gaps = []
            for sign in (-1, 1):
                shift = _displacement(free, twist, sign * step)
                off = Pose(shift.rotation @ joint.second.rotation, joint.second.position + shift.position)
                gaps.append(
                    blocked_directions(joint.kind, joint.first, off, joint.lead, joint.second_axis).gaps
                )
            rate = (gaps[1] - gaps[0]) / (2 * step)
            assert rate == pytest.approx(rows.matrix[:, k], abs=1e-8)


def _displacement(free, twist, time):  # type: ignore[no-untyped-def]
    """The pose that a frame at the origin reaches with a twist in a short time."""
    from vincula.mechanism.joint_types import motion

    values = moved_values(free, free.zero, twist, time)
    return motion(free, values, 0.0, np.array([1.0, 0.0, 0.0]))


def test_axis_names_are_those_of_the_contract() -> None:
    def names(name: str, space: Space = SPATIAL) -> tuple[str, ...]:
        return joint_type(name, space).axis_names("j")

    assert names("revolute") == names("prismatic") == names("screw") == ("j",)
    assert names("universal") == ("j.1", "j.2")
    assert names("cylindrical") == ("j.rotation", "j.translation")
    assert names("spherical") == ("j.x", "j.y", "j.z")
    assert names("planar") == ("j.x", "j.y", "j.rotation")
    assert names("free") == ("j.vx", "j.vy", "j.vz", "j.wx", "j.wy", "j.wz")
    assert names("free", PLANAR) == ("j.vx", "j.vy", "j.wz")
    assert names("fixed") == ()


@EVERY
def test_units_of_rates_and_values(space: Space, name: str, rng: np.random.Generator) -> None:
    """In millimetres every linear rate gives a thousandth of the twist's linear part, angles the same."""
    joint = sample(rng, space, name)
    big = Pose(joint.first.rotation, 1000 * joint.first.position)
    values = np.where(joint.kind.value_linear, 1000.0, 1.0) * joint.values
    from vincula.mechanism.joint_types import motion

    second = big @ motion(joint.kind, values, 1000 * joint.lead, joint.second_axis)
    assert second.position == pytest.approx(1000 * joint.second.position)
    point = rng.normal(size=space.translations)
    one = axis_twists(joint.kind, joint.first, joint.second, joint.lead, joint.second_axis, point)
    two = axis_twists(joint.kind, big, second, 1000 * joint.lead, joint.second_axis, 1000 * point)
    s = space.translations
    expected = one * np.where(joint.kind.linear, 1.0, 1000.0) if len(joint.kind.axes) else one
    assert two[:s] == pytest.approx(expected[:s])
    assert two[s:] == pytest.approx(one[s:])


def test_a_screw_closes_at_every_turn(rng: np.random.Generator) -> None:
    joint = sample(rng, SPATIAL, "screw")
    for turns in range(-3, 4):
        second = joint.first @ joint.motion(joint.values + 2 * np.pi * turns)
        gaps = blocked_directions(joint.kind, joint.first, second, joint.lead, joint.second_axis).gaps
        assert np.abs(gaps).max() < 1e-12


def test_types_that_do_not_exist() -> None:
    with pytest.raises(UnknownNameError, match="did you mean 'revolute'") as refused:
        joint_type("revolut", SPATIAL)
    assert refused.value.choices == JOINT_TYPES
    with pytest.raises(TopologyError, match="'screw' exists in space only; in the plane use revolute, "):
        joint_type("screw", PLANAR)
    with pytest.raises(UnknownNameError, match="Known: revolute, prismatic, fixed, free"):
        joint_type("hinge", PLANAR)


def test_opposite_axes_are_half_a_turn_apart(rng: np.random.Generator) -> None:
    """Turned over by half a turn a hinge is as open as can be, and says so without failing."""
    frame = random_pose(rng, SPATIAL)
    over = frame @ Pose.at((0, 0, 0), np.diag([1.0, -1.0, -1.0]))
    gaps = blocked_directions(
        joint_type("revolute", SPATIAL), frame, over, 0.0, np.array([1.0, 0.0, 0.0])
    ).gaps
    assert np.linalg.norm(gaps) == pytest.approx(np.pi)
