"""Following: on the branch, to the singularity or limit, located and named."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import brentq
from tests.unit.mechanism.linkages import circles_meet, five_bar, five_bar_o3, four_bar, joint_point

import vincula as vc


def test_the_crank_of_a_four_bar_goes_round() -> None:
    mechanism = four_bar(ground=3.0, crank=0.5, coupler=3.0, rocker=2.0)
    path = mechanism.follow([{"a": 2 * math.pi}], samples=24)
    assert path.complete
    assert len(path) == 25
    for q in path:
        b = 0.5 * np.array([-math.sin(q["a"][0]), math.cos(q["a"][0])])
        expected = circles_meet(b, 3.0, np.array([3.0, 0.0]), 2.0)[0]
        np.testing.assert_allclose(joint_point(mechanism, q, "c"), expected, atol=1e-13)
    assert path.end["a"][0] == 2 * math.pi
    assert path.end["b"][0] == pytest.approx(-2 * math.pi, abs=1e-13)
    assert path.residual < 1e-13


def test_motors_that_the_path_does_not_name_stand_still() -> None:
    path = five_bar().follow([{"o1": -0.4}])
    assert path.complete
    assert path.end["o5"][0] == 0.0
    assert len(path) == 2


def _area(mechanism: vc.Mechanism, q: vc.Configuration) -> float:
    """Twice the signed area of the triangle o2-o3-o4: zero where they are in line."""
    one, middle, two = (joint_point(mechanism, q, name) for name in ("o2", "o3", "o4"))
    return float(np.linalg.det(np.column_stack([middle - one, two - one])))


def test_stops_where_the_platform_becomes_free() -> None:
    """o2-o3-o4 in line: |o2 - o4| = 1 + sqrt 2; the motor angle of it is known in closed form."""
    mechanism = five_bar()
    path = mechanism.follow([{"o1": 1.0}])

    def short(angle: float) -> float:
        o2 = np.array([-1 - 2 * math.sin(angle), -2 + 2 * math.cos(angle)])
        return float(np.linalg.norm(o2 - np.array([1.0, -1.0]))) - 1.0 - math.sqrt(2.0)

    event = path.stopped
    assert event is not None
    assert event.kind == "singularity"
    assert [s.kind for s in event.singularities] == ["platform free"]
    # between the locked cranks the two links turn like a stretched knee: o3 by as much as o2 and o4 together
    shares = event.singularities[0].joints
    assert event.joints == ("o3", "o2", "o4")
    assert shares["o3"] == pytest.approx(shares["o2"] + shares["o4"], abs=1e-9)
    assert shares["o2"] / shares["o4"] == pytest.approx(math.sqrt(2.0), abs=1e-9)
    angle = brentq(short, 0.0, 0.5, xtol=1e-15)
    assert path.end["o1"][0] == pytest.approx(angle, abs=1e-13)
    # the other angles change like the root of the distance to the fold: located to 1e-8 all the same
    assert abs(_area(mechanism, path.end)) < 1e-8
    assert path.end is event.configuration
    assert "'coupler' becomes free" in str(path)
    assert path.points[-1].margin < 1e-8 < path.points[0].margin


def test_stops_where_motors_lose_authority() -> None:
    """The leg o4-o5 stretches: its end o3, the reference point, can go no higher."""
    mechanism = vc.Mechanism.planar(
        joints=[
            vc.Revolute("o1", "ground", "crank", at=(-1, -1)),
            vc.Revolute("o2", "crank", "coupler", at=(-1, 0)),
            vc.Revolute("o3", "coupler", "link", at=(0, 0.5)),
            vc.Revolute("o4", "link", "rocker", at=(1, 0)),
            vc.Revolute("o5", "rocker", "ground", at=(2, -1)),
        ],
        reference=vc.Reference("link", origin=(0, 0.5)),
        active=["o1", "o5"],
    )
    path = mechanism.follow([(0.0, 1.5)])
    reach = math.hypot(1.0, 0.5) + math.sqrt(2.0)
    height = math.sqrt(reach**2 - 4.0) - 1.0
    assert path.stopped is not None
    assert [s.kind for s in path.stopped.singularities] == ["motors without authority"]
    # the point rests, the stretched leg buckles
    shares = path.stopped.singularities[0].joints
    assert path.stopped.joints == ("o4", "o3", "o5")
    assert shares["o4"] == pytest.approx(shares["o3"] + shares["o5"], abs=1e-9)
    assert joint_point(mechanism, path.end, "o3")[1] == pytest.approx(height, abs=1e-13)
    assert path.stopped.parameter == pytest.approx((height - 0.5) / mechanism.length, abs=1e-13)


def test_singularities_are_passed_on_request() -> None:
    """Two crossings of one type on the way; without the request the first one stops."""
    waypoints = [(-0.5, -0.3), (0.3, -0.3)]
    mechanism = five_bar()
    first = mechanism.follow(waypoints)
    passing = mechanism.follow(waypoints, through=["platform free"])
    assert first.stopped is not None
    assert passing.complete
    assert len(passing.passed) == 2
    assert passing.passed[0].parameter == pytest.approx(first.stopped.parameter, abs=1e-12)
    for event in passing.passed:
        assert abs(_area(mechanism, event.configuration)) < 1e-8


def test_a_parallelogram_stops_at_its_crossing() -> None:
    """In line, a parallelogram can go on as an antiparallelogram: a crossing of branches, not a fold."""
    mechanism = vc.Mechanism.planar(
        joints=[
            vc.Revolute("a", "ground", "crank", at=(0, 0)),
            vc.Revolute("b", "crank", "coupler", at=(0, 1)),
            vc.Revolute("c", "coupler", "rocker", at=(2, 1)),
            vc.Revolute("d", "rocker", "ground", at=(2, 0)),
        ],
        reference=vc.Reference("coupler", origin=(1, 1)),
        active=["a"],
    )
    path = mechanism.follow([{"a": -2.0}])
    assert path.stopped is not None
    assert path.stopped.kind == "singularity"
    assert path.end["a"][0] == pytest.approx(-math.pi / 2, abs=1e-8)
    assert "internal" in {s.kind for s in path.stopped.singularities}
    kinds = ["internal", "platform free", "motors without authority"]
    through = mechanism.follow([{"a": -2.0}], through=kinds)
    assert through.complete
    assert through.end["d"][0] == pytest.approx(2.0, abs=1e-12), "still a parallelogram"


def test_stops_at_a_limit() -> None:
    mechanism = five_bar(limit=0.05)
    path = mechanism.follow([{"o1": -1.0}])
    assert path.stopped is not None
    assert path.stopped.kind == "limit"
    assert path.stopped.axis == "o4"
    assert path.stopped.joints == ("o4",)
    assert path.end["o4"][0] == pytest.approx(path.stopped.limit, abs=1e-12)
    assert "o4 reaches its limit 0.05" in str(path)
    assert mechanism.follow([{"o1": -0.9}], limits=False).complete


def test_too_much_held_cannot_move() -> None:
    path = five_bar(active=("o1", "o2", "o5")).follow([{"o1": -0.3}])
    assert path.stopped is not None
    assert path.stopped.kind == "incompatible"
    assert "do not let o1 move" in str(path)


def test_a_start_on_a_fold_is_named_as_such() -> None:
    stretched = five_bar().follow([{"o1": 1.0}]).end
    path = five_bar().follow([{"o1": 1.0}], start=stretched)
    assert path.stopped is not None
    assert path.stopped.kind == "singularity"
    assert path.stopped.parameter == 0.0


def test_samples_are_evenly_spaced_over_corners() -> None:
    path = five_bar().follow([{"o1": -0.2, "o5": 0.0}, {"o1": -0.2, "o5": 0.1}], samples=6)
    parameters = [point.parameter for point in path.points]
    np.testing.assert_allclose(parameters, np.linspace(0.0, 0.3, 7), atol=1e-13)
    assert path.end["o5"][0] == 0.1


def test_waypoints_at_the_start_and_repeated() -> None:
    path = five_bar().follow([{"o1": 0.0}, {"o1": -0.1}, {"o1": -0.1}, {"o1": 0.0}])
    assert [round(float(q["o1"][0]), 12) for q in path] == [0.0, -0.1, -0.1, 0.0]


def test_waypoints_must_give_the_same_things() -> None:
    with pytest.raises(vc.ModelError, match="the same things"):
        five_bar().follow([{"o1": -0.1}, {"o5": 0.1}])
    with pytest.raises(vc.ModelError, match="at least one waypoint"):
        five_bar().follow([])


def test_poses_are_followed_along_geodesics() -> None:
    """A planar arm with three joints: position and orientation change in step."""
    arm = vc.Mechanism.planar(
        joints=[
            vc.Revolute("j1", "ground", "a", at=(0, 0)),
            vc.Revolute("j2", "a", "b", at=(1, 0)),
            vc.Revolute("j3", "b", "tool", at=(2, 0)),
        ],
        reference=vc.Reference("tool", origin=(2.5, 0)),
    )
    start = arm.close({"j2": 0.5}, pose=vc.Pose.from_angle(1.0, (0.8, 1.2)))
    path = arm.follow([vc.Pose.from_angle(2.0, (0.4, 1.3))], start=start, samples=4)
    assert path.complete
    for k, q in enumerate(path):
        pose = arm.body_poses(q)["tool"]
        wanted = vc.Pose.from_angle(1.0 + 0.25 * k, (0.8 - 0.1 * k, 1.2 + 0.025 * k))
        np.testing.assert_allclose(pose.rotation, wanted.rotation, atol=1e-13)
        np.testing.assert_allclose(pose.apply(np.array([2.5, 0.0])), wanted.position, atol=1e-13)


def test_table_and_frames() -> None:
    mechanism = five_bar()
    path = mechanism.follow([{"o1": -0.2, "o5": 0.1}], samples=3)
    names, rows = path.table()
    assert names == ("parameter", "o1", "o2", "o3", "o4", "o5", "residual", "margin")
    assert [row[1] for row in rows] == [float(q["o1"][0]) for q in path]
    frames = list(path.frames())
    position, _ = frames[-1]["rocker"]
    np.testing.assert_array_equal(position, mechanism.body_poses(path.end)["rocker"].position)


@pytest.mark.parametrize(("o1", "o5"), [(-0.4, 0.3), (-0.1, 0.2), (-0.5, 0.1)])
def test_there_and_back_is_home(o1: float, o5: float) -> None:
    mechanism = five_bar()
    path = mechanism.follow([{"o1": o1, "o5": o5}, {"o1": 0.0, "o5": 0.0}])
    assert path.complete
    np.testing.assert_allclose(joint_point(mechanism, path[1], "o3"), five_bar_o3(o1, o5), atol=1e-13)
    for joint, values in path.end.items():
        np.testing.assert_allclose(values, mechanism.home[joint], atol=1e-13)


@pytest.mark.parametrize("before", [1e-6, 1e-7, 1e-8, 0.0, -1e-8])
def test_a_waypoint_next_to_a_singularity_does_not_blur_it(before: float) -> None:
    """Within 1e-7 no rank is decided; the singularity is located all the same: crank and coupler in line."""
    ground, crank, coupler, rocker = 3.0, 0.5, 3.0, 2.0
    mechanism = four_bar(ground, crank, coupler, rocker).with_reference("rocker")
    far = coupler + crank
    line = math.acos((ground**2 + far**2 - rocker**2) / (2 * ground * far))
    expected = line + 1.5 * math.pi  # the crank is drawn upright and goes round to the line
    path = mechanism.follow(
        [{"a": expected - before}, {"a": expected + 1.0}], through=["motors without authority"]
    )
    assert path.complete
    assert path.passed[-1].configuration["a"][0] == pytest.approx(expected, abs=1e-10)
    assert [s.motors for s in path.passed[-1].singularities] == [("a",)]


def test_a_rod_that_spins_has_no_part_in_a_singularity() -> None:
    """A rod with a ball at both ends can always turn about itself: it does not become free."""
    mechanism = vc.Mechanism.spatial(
        joints=[
            vc.Revolute("crank", "ground", "arm", at=(0, 0, 0), axis=(0, 0, 1)),
            vc.Spherical("near", "arm", "rod", at=(0, 1, 0.1)),
            vc.Spherical("far", "rod", "rocker", at=(2, 1.5, -0.1)),
            vc.Revolute("hinge", "rocker", "ground", at=(2, 0, 0), axis=(0, 0, 1)),
        ],
        reference=vc.Reference("rocker"),
        active=["crank"],
    )
    path = mechanism.follow([{"crank": -3.0}])
    assert path.stopped is not None
    found = path.stopped.singularities[0]
    assert found.kind == "motors without authority"
    near, far = (joint_point(mechanism, path.end, name) for name in ("near", "far"))
    assert abs(np.cross(near, far - near)[2]) < 1e-8, "the rod passes through the axis of the crank"
    # the rocker rests, the rod turns about `far`; its spin shares the turn of the crank between both balls
    turn, rod = np.array([0.0, 0.0, 1.0]), (far - near) / np.linalg.norm(far - near)
    swing = -np.cross(rod, np.cross(turn, near)) / np.linalg.norm(far - near) + 0.5 * (rod @ turn) * rod
    expected = {"crank": 1.0, "near": np.linalg.norm(swing - turn), "far": np.linalg.norm(swing)}
    size = math.sqrt(sum(value**2 for value in expected.values()))
    assert found.joints == pytest.approx({name: value / size for name, value in expected.items()}, abs=1e-6)


def test_two_motors_that_lose_authority_at_once_are_both_named() -> None:
    """Two equal legs stretch together: no combination of the two motors is preferred."""
    mechanism = vc.Mechanism.planar(
        joints=[
            vc.Revolute("left", "ground", "left_arm", at=(-1, 0)),
            vc.Revolute("left_knee", "left_arm", "left_rod", at=(-2, 1)),
            vc.Revolute("left_hand", "left_rod", "plate", at=(-1, 2)),
            vc.Revolute("right_hand", "plate", "right_rod", at=(1, 2)),
            vc.Revolute("right_knee", "right_rod", "right_arm", at=(2, 1)),
            vc.Revolute("right", "right_arm", "ground", at=(1, 0)),
        ],
        reference=vc.Reference("plate", origin=(0, 2)),
        active=["left", "right"],
    )
    path = mechanism.follow([vc.Pose.at((0.0, 4.0))])
    assert path.stopped is not None
    (found,) = (s for s in path.stopped.singularities if s.kind == "motors without authority")
    assert set(found.motors) == {"left", "right"}
    for name in ("", "_knee", "_hand"):
        assert found.joints[f"left{name}"] == pytest.approx(found.joints[f"right{name}"], abs=1e-6)
    poses = mechanism.body_poses(path.end)
    height = poses["plate"].apply(np.array([0.0, 2.0]))[1]
    assert height == pytest.approx(2.0 * math.sqrt(2.0), abs=1e-8)


@pytest.mark.parametrize(
    ("start", "goal"),
    [
        ([-0.8323878, -2.43794786, -2.58294663, 6.04124083, -0.18795853], [-0.8323878, 0.67128048]),
        ([-0.61757804, -2.42180104, -3.27276035, 7.35933699, -1.04719755], [-0.61757804, -0.18795853]),
    ],
)
def test_the_end_is_closed_also_where_the_last_step_curves_beyond_it(
    start: list[float], goal: list[float]
) -> None:
    """A step whose correction passed the goal was taken for the end, with the motors put back to it."""
    linkage = vc.load("example:five-bar").with_active(["o1", "o5"])
    began = linkage.close(linkage.home.from_flat(np.array(start)), attempts=1)
    motors = dict(zip(("o1", "o5"), goal, strict=True))
    passing = ("platform free", "motors without authority")
    path = linkage.follow([motors], start=began, limits=False, through=passing)
    assert path.complete
    for point in path.points:
        assert max(residual.gap for residual in linkage.residuals(point.configuration)) < 1e-12
    assert [path.end[name][0] for name in motors] == goal
