"""Real robots followed for a thousand steps: one branch, loops closed throughout.

That no step jumps to another branch is checked by something the follower does not use: closed-form
solutions of the five-bar and the Delta, and for the Stewart platform the sign of the determinant of
its leg lines, for the Cassie-like leg the side on which each rod pulls, written by hand.
"""

from __future__ import annotations

import math
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from scipy.optimize import brentq
from tests.unit.mechanism.linkages import five_bar, five_bar_o3, joint_point

import vincula as vc
from vincula.mechanism.catalog import example

STEPS = 1000
TIGHT = 1e-12


def _residual(mechanism: vc.Mechanism, q: vc.Configuration) -> float:
    return max(r.gap for r in mechanism.residuals(q))


def _round(amplitudes: np.ndarray, phases: np.ndarray) -> np.ndarray:
    """A closed curve of motor displacements, steps + 1 by motors, beginning and ending at zero."""
    turn = np.linspace(0.0, 2 * np.pi, STEPS + 1)[:, None]
    return amplitudes * (np.sin(turn + phases) - np.sin(phases))


def test_five_bar() -> None:
    mechanism = five_bar()
    curve = _round(np.array([0.2, 0.15]), np.array([2.5, 1.0]))
    path = mechanism.follow([{"o1": a, "o5": b} for a, b in curve])
    assert path.complete
    assert len(path) == STEPS + 1
    for q, (a, b) in zip(path, curve, strict=True):
        assert _residual(mechanism, q) < TIGHT
        np.testing.assert_allclose(joint_point(mechanism, q, "o3"), five_bar_o3(a, b), atol=TIGHT)


@pytest.mark.slow
def test_delta() -> None:
    mechanism = example("delta")
    curve = _round(np.array([0.35, 0.3, 0.25]), np.array([0.0, 2.0, 4.0]))
    path = mechanism.follow([dict(zip(("a1", "a2", "a3"), row, strict=True)) for row in curve])
    assert path.complete
    for q, row in zip(path, curve, strict=True):
        assert _residual(mechanism, q) < TIGHT
        pose = mechanism.body_poses(q)["platform"]
        np.testing.assert_allclose(pose.rotation, np.eye(3), atol=TIGHT)
        assert mechanism.reference is not None
        centre = pose.apply(mechanism.reference.origin)
        np.testing.assert_allclose(centre, _delta_centre(row), atol=1e-11)


def _delta_centre(angles: np.ndarray) -> np.ndarray:
    """Lower intersection of three spheres about the elbows, moved by the platform's radius."""
    base, platform, arm, rod, down = 0.2, 0.06, 0.2, 0.5, math.radians(30)
    centres = []
    for leg, angle in enumerate(angles):
        turn = 2 * math.pi * leg / 3
        out = np.array([math.cos(turn), math.sin(turn), 0.0])
        # a positive angle about the tangent of the circle turns the arm down
        reach = base - platform + arm * math.cos(down + angle)
        centres.append(reach * out - arm * math.sin(down + angle) * np.array([0.0, 0.0, 1.0]))
    one, two, three = centres
    x = (two - one) / np.linalg.norm(two - one)
    along = float(x @ (three - one))
    y = three - one - along * x
    aside = float(np.linalg.norm(y))
    y = y / aside
    far = float(np.linalg.norm(two - one))
    px = 0.5 * far
    py = (along**2 + aside**2 - 2 * along * px) / (2 * aside)
    pz = math.sqrt(rod**2 - px**2 - py**2)
    z = np.cross(x, y)
    ways = [one + px * x + py * y + side * pz * z for side in (1, -1)]
    return min(ways, key=lambda point: float(point[2]))


@pytest.mark.slow
def test_stewart_platform() -> None:
    mechanism = example("stewart")
    motors = mechanism.active
    home = {name: float(mechanism.home[name][0]) for name in motors}
    rng = np.random.default_rng(7)
    curve = _round(rng.uniform(0.05, 0.12, 6), rng.uniform(0, 6, 6))
    path = mechanism.follow(
        [{name: home[name] + v for name, v in zip(motors, row, strict=True)} for row in curve]
    )
    assert path.complete
    feet, tops = _stewart_points(mechanism)
    drawn = np.linalg.norm(tops - feet, axis=1)
    side = np.sign(_lines(feet, tops, np.zeros(3)))
    before = np.array([0.0, 0.0, 2.0])
    for q, row in zip(path, curve, strict=True):
        assert _residual(mechanism, q) < TIGHT
        pose = mechanism.body_poses(q)["platform"]
        now = tops @ pose.rotation.T + pose.position
        np.testing.assert_allclose(np.linalg.norm(now - feet, axis=1), drawn + row, atol=1e-11)
        centre = pose.apply(np.array([0.0, 0.0, 2.0]))
        assert np.sign(_lines(feet, now, centre)) == side
        assert np.linalg.norm(centre - before) < 0.01
        before = centre
    for joint, values in path.end.items():
        np.testing.assert_allclose(values, mechanism.home[joint], atol=1e-10)


def _stewart_points(mechanism: vc.Mechanism) -> tuple[np.ndarray, np.ndarray]:
    """Ball centres on the ground and contact points on the platform, at home in ground axes."""
    balls = [joint for joint in mechanism.joints if joint.type == "spherical"]
    feet = np.array([joint_point(mechanism, mechanism.home, joint.name) for joint in balls])
    poses = mechanism.body_poses()
    tops = [(poses[c.second] @ c.frame_on_second).position for c in mechanism.contacts]
    return feet, np.array(tops)


def _lines(feet: np.ndarray, tops: np.ndarray, centre: np.ndarray) -> float:
    """Determinant of the six Plücker lines of the legs: zero where the platform is free."""
    ways = tops - feet
    ways = ways / np.linalg.norm(ways, axis=1)[:, None]
    return float(np.linalg.det(np.hstack([ways, np.cross(tops - centre, ways)])))


@pytest.mark.slow
@pytest.mark.parametrize("way", ["away", "beside", "through"])
def test_cassie_like_leg(models: Path, way: str) -> None:
    """A serial leg with two inner loops; each rod keeps its length and its side of the joint it moves.

    From its own start, 0.025 rad from the dead centre of its knee: away from it, up to 0.1 mrad beside it
    and back, and through it on request.
    """
    robot, start = _cassie_like_leg(models)
    curve = _round(np.full(5, 0.2), np.arange(5.0))
    knee = robot.active.index("motor_knee")
    to_go = float(start["motor_knee"][0]) - _dead_centre(models)
    back_and_forth = 0.5 - 0.5 * np.cos(np.linspace(0.0, 2 * np.pi, STEPS + 1))
    if way != "through":
        curve[:, knee] = (0.4 if way == "away" else 1e-4 - to_go) * back_and_forth
    waypoints = [
        {name: start[name][0] + v for name, v in zip(robot.active, row, strict=True)} for row in curve
    ]
    passing = ["motors without authority"] if way == "through" else []
    path = robot.follow(waypoints, start=start, through=passing)
    assert path.complete, str(path)
    assert len(path) == STEPS + 1
    for event in path.passed:
        assert event.configuration["motor_knee"][0] == pytest.approx(_dead_centre(models), abs=1e-8)
    assert len(path.passed) == (2 if way == "through" else 0)
    rods = [
        ("servo_gauche_half_planta_rode_rev0", "foot_2_half_planta_rode_2_rev0", "free_ankle"),
        ("tigh_half_hachil_rode_2_rev0", "tarsus_half_hachil_rode_rev0", "free_knee"),
    ]
    drawn = [_rod(robot, path[0], *rod) for rod in rods]
    before = path[0]
    for q in path:
        assert _residual(robot, q) < TIGHT
        for rod, (length, lever) in zip(rods, drawn, strict=True):
            now, pull = _rod(robot, q, *rod)
            assert now == pytest.approx(length, abs=1e-11)
            assert pull * lever > 0.0
        assert abs(q["free_knee"][0] - before["free_knee"][0]) < 0.02
        before = q


def _cassie_like_leg(models: Path) -> tuple[vc.Mechanism, vc.Configuration]:
    robot = vc.load(models / "gepetto_cassie_like" / "robot_nomesh.urdf").with_reference("foot_2")
    return robot, robot.close()


def _dead_centre(models: Path) -> float:
    """Angle of motor_knee at which the free knee stands on the line from the hip to the knee.

    The rod of the free knee begins on the axis of motor_tigh, so that thigh and shin can then turn
    with the foot at rest.  From the numbers of the file: in the axes of the thigh the hip is the
    origin, and all three axes are parallel to z.
    """
    root = ElementTree.parse(models / "gepetto_cassie_like" / "robot_nomesh.urdf").getroot()
    place = {}
    for name in ("motor_knee", "free_knee"):
        origin = root.find(f"joint[@name='{name}']/origin")
        assert origin is not None
        place[name] = [[float(v) for v in origin.attrib[key].split()] for key in ("xyz", "rpy")]
    (x, y, _), (roll, pitch, yaw) = place["motor_knee"]
    assert abs(roll - math.pi) + abs(pitch) < 1e-15
    (u, v, _), _ = place["free_knee"]
    # the shin's frame is turned over: its y points against the thigh's
    hip = np.array([x * math.cos(yaw) + y * math.sin(yaw), x * math.sin(yaw) - y * math.cos(yaw)])
    angle = math.atan2(hip[1], hip[0]) - math.atan2(v, u)
    return angle - math.pi * round((angle + 2.38) / math.pi)


def _rod(robot: vc.Mechanism, q: vc.Configuration, one: str, two: str, hinge: str) -> tuple[float, float]:
    """Length between two ball centres, and the moment arm of that line about a hinge (signed)."""
    poses = robot.body_poses(q)
    joint = robot.joint[hinge]
    frame = poses[joint.first] @ joint.frame_on_first
    end = joint_point(robot, q, two)
    way = end - joint_point(robot, q, one)
    return float(np.linalg.norm(way)), float(frame.rotation[:, 2] @ np.cross(end - frame.position, way))


def test_cassie_like_leg_stops_at_its_dead_centre(models: Path) -> None:
    """From any posture, on any way: to 1e-8 rad where the file puts it, and named by what moves."""
    robot, home = _cassie_like_leg(models)
    shares = []
    for goal in ({"motor_hip1": 0.1}, {"motor_tigh": -0.05, "motor_hip2": 0.08}, {"motor_ankle": 0.1}):
        to = {name: home[name][0] + step for name, step in goal.items()}
        path = robot.follow([{**to, "motor_knee": home["motor_knee"][0] - 0.1}], start=home)
        assert path.stopped is not None
        (found,) = path.stopped.singularities
        assert found.kind == "motors without authority"
        assert found.motors == ("motor_tigh", "motor_knee")
        assert path.end["motor_knee"][0] == pytest.approx(_dead_centre(models), abs=1e-8)
        shares.append(found.joints)
    # the rod spins freely at any posture: that has no part in it
    for other in shares[1:]:
        assert other == pytest.approx(shares[0], abs=1e-6)


def test_stewart_platform_stops_where_its_leg_lines_become_dependent() -> None:
    """Turned about the vertical; the angle is found apart by a root of the determinant of the lines."""
    mechanism = example("stewart")
    poses = [_turned(math.radians(a)) for a in (60.0, 120.0, 170.0)]
    path = mechanism.follow(poses, limits=False)
    assert path.stopped is not None, str(path)
    assert [s.kind for s in path.stopped.singularities] == ["platform free"]
    feet, tops = _stewart_points(mechanism)
    start = np.array([0.0, 0.0, 2.0])

    def determinant(angle: float) -> float:
        turn = _turned(angle).rotation
        return _lines(feet, (tops - start) @ turn.T + start, start)

    grid = np.radians(np.arange(0.0, 170.0, 0.5))
    signs = np.sign([determinant(angle) for angle in grid])
    first = int(np.flatnonzero(signs[1:] != signs[:-1])[0])
    expected = brentq(determinant, grid[first], grid[first + 1], xtol=1e-14)
    rotation = mechanism.body_poses(path.end)["platform"].rotation
    assert math.atan2(rotation[1, 0], rotation[0, 0]) == pytest.approx(expected, abs=1e-8)


def _turned(angle: float) -> vc.Pose:
    c, s = math.cos(angle), math.sin(angle)
    return vc.Pose.at((0.0, 0.0, 2.0), np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]))
