"""Linkages with answers worked out by hand, for the tests of closing and following."""

from __future__ import annotations

import math

import numpy as np

import vincula as vc


def five_bar(limit: float | None = None, active: tuple[str, ...] = ("o1", "o5")) -> vc.Mechanism:
    """The paper's five-bar; o4 may have limits of plus and minus `limit` [rad]."""
    limits = None if limit is None else vc.Limits(lower=-limit, upper=limit)
    return vc.Mechanism.planar(
        joints=[
            vc.Revolute("o1", "ground", "crank", at=(-1, -2)),
            vc.Revolute("o2", "crank", "coupler", at=(-1, 0)),
            vc.Revolute("o3", "coupler", "link", at=(0, 0)),
            vc.Revolute("o4", "link", "rocker", at=(1, -1), limits=limits),
            vc.Revolute("o5", "rocker", "ground", at=(1, -2)),
        ],
        reference=vc.Reference("coupler", origin=(-0.5, 0)),
        active=active,
    )


def four_bar(
    ground: float = 3.0, crank: float = 1.0, coupler: float = 3.0, rocker: float = 2.5
) -> vc.Mechanism:
    """A four-bar a-b-c-d with its crank upright; c is above the ground link."""
    b, d = np.array([0.0, crank]), np.array([ground, 0.0])
    c = circles_meet(b, coupler, d, rocker)[0]
    return vc.Mechanism.planar(
        joints=[
            vc.Revolute("a", "ground", "crank", at=(0, 0)),
            vc.Revolute("b", "crank", "coupler", at=b),
            vc.Revolute("c", "coupler", "rocker", at=c),
            vc.Revolute("d", "rocker", "ground", at=d),
        ],
        reference=vc.Reference("coupler"),
        active=["a"],
    )


def circles_meet(
    one: np.ndarray, first: float, two: np.ndarray, second: float
) -> tuple[np.ndarray, np.ndarray]:
    """The two points at distance `first` from `one` and `second` from `two`, the left one first."""
    way = two - one
    far = float(np.linalg.norm(way))
    along = (first**2 - second**2 + far**2) / (2 * far)
    aside = math.sqrt(max(first**2 - along**2, 0.0))
    middle = one + along * way / far
    left = np.array([-way[1], way[0]]) / far
    return middle + aside * left, middle - aside * left


def five_bar_o3(o1: float, o5: float) -> np.ndarray:
    """Where o3 is for given motor angles on the drawn branch, by intersecting circles."""
    o2 = np.array([-1.0, -2.0]) + 2.0 * np.array([-math.sin(o1), math.cos(o1)])
    # o5 turns the ground against the rocker: the rocker turns by -o5 in ground axes
    o4 = np.array([1.0, -2.0]) + np.array([math.sin(o5), math.cos(o5)])
    return circles_meet(o2, 1.0, o4, math.sqrt(2.0))[0]


def joint_point(mechanism: vc.Mechanism, q: vc.Configuration, joint: str) -> np.ndarray:
    """Position of a joint's frame A in ground axes."""
    part = mechanism.joint[joint]
    return np.asarray((mechanism.body_poses(q)[part.first] @ part.frame_on_first).position)
