"""Mechanisms of the catalog of design problems, each a function of its dimensions [m]."""

from __future__ import annotations

import numpy as np

from vincula.arrays import Vector
from vincula.elementary import larger, sqrt
from vincula.errors import ModelError
from vincula.mechanism.drawing import DrawnJoint, Reference
from vincula.mechanism.drawn_joints import Prismatic, Revolute, Spherical, Universal
from vincula.mechanism.mechanism import Mechanism

TIP: float = 0.4
"""Height of the tip of the five-bar above its motors, in the drawing [m]."""


def five_bar(base: float = 0.2, near: float = 0.25, far: float = 0.35) -> Mechanism:
    """A symmetric planar five-bar, elbows outside, its tip 0.4 m above the middle of two motors.

    Args:
        base: Distance of the motors.
        near: Length of the two links at the motors.
        far: Length of the two links that meet at the tip.

    Raises:
        ModelError: The links do not reach the tip.
    """
    tip = np.array([0.0, TIP])
    left, right = np.array([-base / 2.0, 0.0]), np.array([base / 2.0, 0.0])
    elbow = _elbow(left, tip, near, far, 1.0)
    other = np.array([-elbow[0], elbow[1]])
    return _of_points(left, elbow, tip, other, right)


def uneven_five_bar(
    near_left: float = 0.25, near_right: float = 0.25, far_left: float = 0.35, far_right: float = 0.35
) -> Mechanism:
    """A planar five-bar on two motors 0.2 m apart, elbows outside, its four links of any lengths.

    Args:
        near_left: Length of the link at the left motor.
        near_right: Length of the link at the right motor.
        far_left: Length of the link from the left elbow to the tip.
        far_right: Length of the link from the right elbow to the tip.

    Raises:
        ModelError: The links do not reach the tip.
    """
    left, right, tip = np.array([-0.1, 0.0]), np.array([0.1, 0.0]), np.array([0.0, TIP])
    one = _elbow(left, tip, near_left, far_left, 1.0)
    two = _elbow(right, tip, near_right, far_right, -1.0)
    return _of_points(left, one, tip, two, right)


def finger(crank: float = 0.02, coupler: float = 0.06, lever: float = 0.03) -> Mechanism:
    """A planar gripper finger on a four-bar; its tip presses along x, 8 cm above the pivot.

    Args:
        crank: Length of the motor's crank, drawn upright.
        coupler: Length of the rod to the finger.
        lever: Distance of that rod's joint from the pivot of the finger.

    Raises:
        ModelError: The rod does not reach.
    """
    motor, pivot = np.array([0.0, 0.0]), np.array([0.05, 0.0])
    pin = motor + np.array([0.0, crank])
    joint = _elbow(pin, pivot, coupler, lever, 1.0)
    return Mechanism.planar(
        joints=[
            Revolute("motor", "ground", "crank", at=motor),
            Revolute("pin", "crank", "rod", at=pin),
            Revolute("knuckle", "rod", "finger", at=joint),
            Revolute("pivot", "finger", "ground", at=pivot),
        ],
        reference=Reference("finger", origin=pivot + np.array([0.0, 0.08])),
        active=["motor"],
        name="finger",
    )


def ankle(lever: float = 0.05, width: float = 0.04, height: float = 0.2) -> Mechanism:
    """A foot under a shank on a universal joint, moved by two linear motors behind it.

    The shank is the ground; x points forward, z up, the ankle is the origin.

    Args:
        lever: How far behind the ankle the motors hold the foot.
        width: How far to each side of it.
        height: How far above the ankle the motors begin.
    """
    joints: list[DrawnJoint] = [
        Universal("ankle", "ground", "foot", at=(0, 0, 0), axes=([0, 1, 0], [1, 0, 0]))
    ]
    for name, side in (("l", 1.0), ("r", -1.0)):
        top = np.array([-0.8 * lever, side * width, height])
        heel = np.array([-lever, side * width, -0.03])
        axis = heel - top
        joints += [
            Universal(f"t{name}", "ground", f"cylinder_{name}", at=top, axes=([0, 1, 0], [1, 0, 0])),
            Prismatic(f"p{name}", f"cylinder_{name}", f"rod_{name}", axis=axis, at=(top + heel) / 2.0),
            Spherical(f"h{name}", f"rod_{name}", "foot", at=heel),
        ]
    return Mechanism.spatial(
        joints=joints,
        reference=Reference("foot", origin=(0, 0, 0)),
        active=["pl", "pr"],
        name="ankle",
    )


def _of_points(left: Vector, one: Vector, tip: Vector, two: Vector, right: Vector) -> Mechanism:
    """The five-bar with these joints."""
    return Mechanism.planar(
        joints=[
            Revolute("m1", "ground", "near1", at=left),
            Revolute("e1", "near1", "far1", at=one),
            Revolute("tip", "far1", "far2", at=tip),
            Revolute("e2", "far2", "near2", at=two),
            Revolute("m2", "near2", "ground", at=right),
        ],
        reference=Reference("far1", origin=tip),
        active=["m1", "m2"],
        name="five-bar",
    )


def _elbow(start: Vector, end: Vector, first: float, second: float, side: float) -> Vector:
    """Where two links from two points meet, left of the line from the one to the other.

    Raises:
        ModelError: They do not meet.
    """
    line = end - start
    gap = np.linalg.norm(line)
    if not abs(first - second) < gap < first + second:
        raise ModelError(f"links of {first:g} and {second:g} m do not meet over {gap:g} m")
    along = (gap**2 + first**2 - second**2) / (2.0 * gap)
    across = side * sqrt(larger(first**2 - along**2, 0.0))
    unit = line / gap
    return np.asarray(start + along * unit + across * np.array([-unit[1], unit[0]]))
