"""Maps of mechanisms whose workspaces and singular sets are known in closed form."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest

import vincula as vc
from vincula.mechanism.catalog.registry import example
from vincula.mechanism.kinematics import part_frames

EXACT = 1e-9
BASE, PROXIMAL, DISTAL = 0.5, 1.0, 1.2


def arm(*links: float, limits: vc.Limits | None = None) -> vc.Mechanism:
    bodies = ["ground", *(f"link {k}" for k in range(1, len(links) + 1))]
    places = np.concatenate([[0.0], np.cumsum(links)])
    joints = [
        vc.Revolute(f"j{k + 1}", bodies[k], bodies[k + 1], at=(places[k], 0), limits=limits)
        for k in range(len(links))
    ]
    return vc.Mechanism.planar(
        joints=joints, reference=vc.Reference(bodies[-1], origin=(places[-1], 0)), active=vc.ALL
    )


def elbow(base: np.ndarray, tip: np.ndarray, side: float) -> np.ndarray:
    way = tip - base
    length = float(np.hypot(*way))
    turn = math.acos((PROXIMAL**2 + length**2 - DISTAL**2) / (2 * PROXIMAL * length))
    angle = math.atan2(way[1], way[0]) + side * turn
    return base + PROXIMAL * np.array([math.cos(angle), math.sin(angle)])


def five_bar(active: tuple[str, str]) -> vc.Mechanism:
    """A symmetric five-bar led by its tip, elbows outwards."""
    left, right, tip = np.array([-BASE, 0.0]), np.array([BASE, 0.0]), np.array([0.0, 1.5])
    joints = [
        vc.Revolute("o1", "ground", "crank", at=left),
        vc.Revolute("o2", "crank", "coupler", at=elbow(left, tip, 1.0)),
        vc.Revolute("o3", "coupler", "link", at=tip),
        vc.Revolute("o4", "link", "rocker", at=elbow(right, tip, -1.0)),
        vc.Revolute("o5", "rocker", "ground", at=right),
    ]
    return vc.Mechanism.planar(
        joints=joints, reference=vc.Reference("coupler", origin=tip), active=list(active)
    )


@cache
def map_of_five_bar(active: tuple[str, str], count: int = 22) -> vc.SingularityMap:
    over = [vc.Variable("x", -2.4, 2.4, count), vc.Variable("y", -2.4, 2.4, count)]
    return vc.map_over(five_bar(active), over)


def crossed(one: np.ndarray, two: np.ndarray) -> float:
    return float((one[0] * two[1] - one[1] * two[0]) / (np.linalg.norm(one) * np.linalg.norm(two)))


def joint_points(mechanism: vc.Mechanism, q: vc.Configuration) -> dict[str, np.ndarray]:
    poses = mechanism.body_poses(q)
    return {joint.name: part_frames(joint, poses)[0].position for joint in mechanism.joints}


def platform(kind: str) -> vc.Mechanism:
    """3-RPR with base and platform similar triangles."""
    joints = []
    for k in range(3):
        way = np.array([math.cos(2 * math.pi * k / 3), math.sin(2 * math.pi * k / 3)])
        joints += [
            vc.Revolute(f"a{k}", "ground", f"u{k}", at=2 * way),
            vc.Prismatic(f"p{k}", f"u{k}", f"v{k}", at=2 * way, axis=-way),
            vc.Revolute(f"c{k}", f"v{k}", kind, at=0.5 * way),
        ]
    return vc.Mechanism.planar(
        joints=joints, reference=vc.Reference(kind, origin=(0, 0)), active=["p0", "p1", "p2"]
    )


def test_two_links_reach_a_ring() -> None:
    """Circles of the sum and the difference of the links, and every point of the grid between them."""
    found = vc.map_over(
        arm(1.0, 0.7),
        [vc.Variable("x", -2, 2, 17), vc.Variable("y", -2, 2, 17)],
        start={"j1": 0.3, "j2": 0.8},
    )
    sheet = found.sheets[0]
    first, second = np.meshgrid(*found.grid, indexing="ij")
    away = np.hypot(first, second)
    assert np.array_equal(sheet.reached, (away < 1.7 - EXACT) & (away > 0.3 + EXACT))
    assert [curve.closed for curve in sheet.curves] == [True, True]
    for curve in sheet.curves:
        assert curve.kind == "motors without authority"
        radii = np.hypot(*curve.points.T)
        assert min(np.abs(radii - 1.7).max(), np.abs(radii - 0.3).max()) < EXACT
    exact = np.minimum(1.7 - away, away - 0.3)[sheet.reached]
    # Chords of the curve lie inside the circle: their sagitta is what the distance misses at most.
    assert np.abs(sheet.distance[sheet.reached] - exact).max() < 5e-3
    assert set(sheet.nearest[sheet.reached]) == {"motors without authority"}


def test_a_curve_on_the_lines_of_the_grid_through_a_singular_start() -> None:
    """Over its motors the arm is singular where it is straight: a line of points of the grid, home on it."""
    found = vc.map_over(arm(1.0, 0.7), [vc.Variable("j1", -1, 1, 9), vc.Variable("j2", -2, 2, 9)])
    assert found.sheets[0].reached.all()
    (curve,) = found.curves
    assert curve.kind == "motors without authority"
    assert np.abs(curve.points[:, 1]).max() < EXACT
    assert sorted(curve.points[[0, -1], 0]) == [-1.0, 1.0]


def test_five_bar_reaches_where_two_rings_meet() -> None:
    """Edges are arcs of the legs' limiting circles; the tip is free where the outer links are in line."""
    found = map_of_five_bar(("o1", "o5"))
    sheet = found.sheets[0]
    places = np.stack(np.meshgrid(*found.grid, indexing="ij"), axis=-1)
    left, right = (np.hypot(places[..., 0] - x, places[..., 1]) for x in (-BASE, BASE))
    low, high = DISTAL - PROXIMAL, DISTAL + PROXIMAL
    assert np.array_equal(sheet.reached, (left < high) & (left > low) & (right < high) & (right > low))
    edges = [curve for curve in sheet.curves if curve.edge]
    assert {curve.kind for curve in edges} == {"motors without authority"}
    for x, y in np.vstack([curve.points for curve in edges]):
        legs = [math.hypot(x - at, y) for at in (-BASE, BASE)]
        assert min(abs(leg - radius) for leg in legs for radius in (low, high)) < EXACT
    inner = [curve for curve in sheet.curves if not curve.edge]
    assert {curve.kind for curve in inner} == {"platform free"}
    for curve in inner:
        for crossing in curve.crossings:
            p = joint_points(found.mechanism, crossing.configuration)
            assert abs(crossed(p["o3"] - p["o2"], p["o4"] - p["o3"])) < EXACT


def test_motors_at_the_elbows_are_singular_on_the_line_of_the_bases() -> None:
    """With o2 and o4 locked each leg is a link from its base to the tip."""
    found = map_of_five_bar(("o2", "o4"))
    inner = [curve for curve in found.curves if not curve.edge]
    assert {curve.kind for curve in inner} == {"platform free"}
    points = np.vstack([curve.points for curve in inner])
    assert np.abs(points[:, 1]).max() < EXACT
    # The line is seen from one side of the region to the other, but for the two holes about the bases.
    assert points[:, 0].min() < -1.65
    assert points[:, 0].max() > 1.65


def test_similar_triangles_are_singular_at_every_point() -> None:
    """The lines of the legs of such a platform meet in the centre of similarity, wherever it is moved to."""
    over = [vc.Variable("x", -0.5, 0.5, 5), vc.Variable("y", -0.5, 0.5, 5)]
    sheet = vc.map_over(platform("plate"), over).sheets[0]
    assert sheet.reached.all()
    assert list(sheet.everywhere) == ["platform free"]
    assert "can move with p0, p1, p2 locked" in sheet.everywhere["platform free"]
    assert not sheet.distance.any()
    turned = [vc.Variable("x", -0.5, 0.5, 5), vc.Variable("angle", -4.0, 4.0, 9)]
    curves = vc.map_over(platform("plate"), turned).curves
    angles = sorted(float(curve.points[:, 1].mean()) for curve in curves)
    assert angles == pytest.approx([-math.pi, 0.0, math.pi], abs=EXACT)
    assert all(np.ptp(curve.points[:, 1]) < EXACT for curve in curves)


@pytest.mark.parametrize("before", [1e-3, 1e-4])
def test_loops_smaller_than_the_grid_are_found(before: float) -> None:
    """The type-2 loop of the 3-RRR shrinks to a point as the platform turns; it is followed down to that."""
    robot = example("3rrr")
    path = robot.follow([vc.Pose.from_angle(-1.0, (0, 0))], through=["platform free"])
    there = robot.body_poses(path.passed[0].configuration)["platform"].rotation
    angle = math.atan2(there[1, 0], there[0, 0]) + before
    start = robot.follow([vc.Pose.from_angle(angle, (0.1, 0.05))], through=["platform free"]).end
    over = [vc.Variable("x", -0.45, 0.52, 12), vc.Variable("y", -0.5, 0.47, 12)]
    found = vc.map_over(robot, over, start=start)
    (loop,) = [curve for curve in found.curves if not curve.edge]
    assert loop.kind == "platform free"
    assert loop.closed
    radii = np.hypot(*loop.points.T)
    assert radii.max() < 1.1 * math.sqrt(before) * 2.1  # it shrinks with the root of the angle that is left
    for crossing in loop.crossings:
        p = joint_points(robot, crossing.configuration)
        rows = []
        for leg in "123":
            way = p[f"c{leg}"] - p[f"b{leg}"]
            way = way / np.linalg.norm(way)
            rows.append([*way, p[f"c{leg}"][0] * way[1] - p[f"c{leg}"][1] * way[0]])
        assert abs(np.linalg.det(rows)) < EXACT


def test_joints_that_follow_the_motors_can_be_the_variables() -> None:
    """The motors follow; where these joints turn back though nothing is singular the edge says so."""
    found = vc.map_over(
        example("five-bar"), [vc.Variable("o2", -0.7, 0.7, 9), vc.Variable("o3", -0.7, 0.7, 9)]
    )
    assert {curve.kind for curve in found.curves if curve.edge} == {"turn"}
    for curve in found.curves:
        for crossing in curve.crossings:
            p = joint_points(found.mechanism, crossing.configuration)
            if crossing.kind == "turn":
                # Held o2 and o3 make one link of o1 to o4: it turns back in line with the rocker.
                assert abs(crossed(p["o4"] - p["o1"], p["o5"] - p["o4"])) < EXACT
                assert "nothing is singular" in crossing.words


def test_redundant_motors_follow_the_variables() -> None:
    over = [vc.Variable("o1", -0.3, 0.3, 5), vc.Variable("o5", -0.3, 0.3, 5)]
    one = vc.map_over(example("five-bar"), over).sheets[0]
    all_driven = vc.map_over(example("five-bar").with_active(vc.ALL), over).sheets[0]
    assert np.array_equal(one.reached, all_driven.reached)
    known = one.reached
    assert np.abs(one.configurations[known] - all_driven.configurations[known]).max() < 1e-11


def test_one_freedom_is_refused_with_what_to_do() -> None:
    """A coupler point of a four-bar runs on a curve."""
    bars = vc.Mechanism.planar(
        joints=[
            vc.Revolute("a", "ground", "crank", at=(0, 0)),
            vc.Revolute("b", "crank", "coupler", at=(0, 1)),
            vc.Revolute("c", "coupler", "rocker", at=(2.0, 1.5)),
            vc.Revolute("d", "rocker", "ground", at=(2.5, 0)),
        ],
        reference=vc.Reference("coupler", origin=(1, 2)),
        active=["a"],
    )
    for names in (("x", "y"), ("a", "d")):
        with pytest.raises(vc.ModelError, match="a curve at most, not a region"):
            vc.map_over(bars, [vc.Variable(name, -1, 2.5, 5) for name in names])
