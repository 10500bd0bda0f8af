"""The mechanisms of the benchmarks, and configurations of theirs in closed form.

Platforms stand on n legs like the catalog's Stewart platform (ball, prismatic motor, soft-finger contact); a
ladder is a row of four-bar loops in which the rocker of one is the crank of the next.  A pose is x y z of the
reference point [m] and a quaternion w x y z.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

import vincula as vc

Array = NDArray[np.float64]
HEIGHT, UPPER, LOWER = 2.0, 1.5, 2.0


@dataclass(frozen=True)
class Platform:
    """A platform on legs.

    Attributes:
        base: legs x 3 base joints [m].
        upper: legs x 3 platform joints against the reference point, platform level [m].
    """

    base: Array
    upper: Array

    @cached_property
    def mechanism(self) -> vc.Mechanism:
        """The mechanism, its reference point at height 2 m."""
        joints: list[vc.Spherical | vc.Prismatic] = []
        contacts = []
        for k, (low, arm) in enumerate(zip(self.base, self.upper, strict=True), start=1):
            high = arm + np.array([0.0, 0.0, HEIGHT])
            joints += [
                vc.Spherical(f"b{k}", "ground", f"cylinder{k}", at=low),
                vc.Prismatic(f"p{k}", f"cylinder{k}", f"rod{k}", axis=high - low, at=(low + high) / 2),
            ]
            contacts.append(
                vc.Contact(f"c{k}", f"rod{k}", "platform", type="soft-finger", at=high, normal=high - low)
            )
        return vc.Mechanism.spatial(
            joints=joints,
            contacts=contacts,
            reference=vc.Reference("platform", origin=(0.0, 0.0, HEIGHT)),
            active=[f"p{k}" for k in range(1, len(self.base) + 1)],
            weights=vc.Weights(),
            name=f"platform on {len(self.base)} legs",
        )

    def legs(self, poses: Array) -> tuple[Array, Array]:
        """Unit vectors (n x legs x 3) and lengths (n x legs) of the legs, base to platform."""
        ends = np.einsum("nij,kj->nki", rotation(poses[:, 3:]), self.upper) + poses[:, None, :3]
        way = ends - self.base
        length = np.linalg.norm(way, axis=2)
        return way / length[:, :, None], length

    def configurations(self, poses: Array) -> Array:
        """Closed configurations: for every leg its ball and its extension, then the platform's free joint."""
        drawn = np.concatenate([[0.0, 0.0, HEIGHT], [1.0, 0.0, 0.0, 0.0]])[None]
        (home,), (rest,) = self.legs(drawn)
        now, length = self.legs(poses)
        turn = poses[:, 3:]
        found = np.empty((len(poses), 5 * len(home) + 7))
        for k, start in enumerate(home):
            swing = np.concatenate(
                [1.0 + now[:, k] @ start[:, None], np.cross(start[None], now[:, k])], axis=1
            )
            swing /= np.linalg.norm(swing, axis=1, keepdims=True)
            left = product(swing * [1.0, -1.0, -1.0, -1.0], turn)  # what is left for the contact
            half = np.arctan2(left[:, 1:] @ start, left[:, 0])  # the spin that a soft finger does not allow
            spin = np.concatenate([np.cos(half)[:, None], np.sin(half)[:, None] * start], axis=1)
            found[:, 5 * k : 5 * k + 4] = product(swing, spin)
            found[:, 5 * k + 4] = length[:, k] - rest[k]
        found[:, -7:-4] = poses[:, :3] - rotation(turn) @ [0.0, 0.0, HEIGHT]
        found[:, -4:] = turn
        return found


def stewart() -> Platform:
    """The catalog's Stewart platform: alpha = 1 deg, beta = -120 deg."""
    third = 2.0 * math.pi / 3.0
    corner = np.arange(6) // 2 * third
    lower = corner + np.where(np.arange(6) % 2 == 0, math.radians(1.0), math.radians(-120.0))
    return Platform(on_circle(LOWER, lower), on_circle(UPPER, corner))


def many_legs(count: int) -> Platform:
    """A platform on `count` legs, in pairs that lean against each other."""
    place = 2.0 * math.pi * np.arange(count) / count
    lean = np.where(np.arange(count) % 2 == 0, 0.5, -0.5) + 0.11 * np.sin(3.0 * place)
    return Platform(on_circle(LOWER, place + lean), on_circle(UPPER, place))


def ladder(loops: int) -> vc.Mechanism:
    """`loops` four-bar loops in a row: every rocker is the crank of the next; the first bar has the motor.

    Bars stand on the ground, couplers join neighbouring bars; the reference member is the last coupler.
    """
    feet = np.array([[1.0 * k, 0.0] for k in range(loops + 1)])
    tops = feet + [
        [0.10 + 0.03 * math.sin(2.0 * k), 0.80 + 0.05 * math.cos(3.0 * k)] for k in range(loops + 1)
    ]
    joints = [vc.Revolute(f"foot{k}", "ground", f"bar{k}", at=foot) for k, foot in enumerate(feet)]
    for k in range(loops):
        joints.append(vc.Revolute(f"left{k}", f"bar{k}", f"coupler{k}", at=tops[k]))
        joints.append(vc.Revolute(f"right{k}", f"coupler{k}", f"bar{k + 1}", at=tops[k + 1]))
    middle = (tops[-1] + tops[-2]) / 2
    return vc.Mechanism.planar(
        joints=joints,
        reference=vc.Reference(f"coupler{loops - 1}", origin=middle),
        active=["foot0"],
        weights=vc.Weights(),
        name=f"ladder of {loops} loops",
    )


def ladder_configurations(loops: int, count: int, seed: int = 5) -> Array:
    """Closed configurations of a ladder: the first bar swings, the others follow in closed form.

    Order of the values: feet, then left and right of every coupler, as the joints are declared.
    """
    mechanism = ladder(loops)
    feet = np.array([mechanism.joint[f"foot{k}"].frame_on_first.position for k in range(loops + 1)])
    tops = np.array([mechanism.joint[f"left{k}"].frame_on_first.position for k in range(loops)])
    tops = np.concatenate([tops, [mechanism.joint[f"right{loops - 1}"].frame_on_first.position]])
    swing = 0.02 * np.sin(np.linspace(0.0, 40.0, count) + seed)
    found = np.empty((count, 3 * loops + 1))
    bar = swing
    found[:, 0] = bar
    for k in range(loops):
        start = _turned(bar, tops[k] - feet[k]) + feet[k]
        end, reach = feet[k + 1], np.linalg.norm(tops[k + 1] - feet[k + 1])
        coupler = float(np.linalg.norm(tops[k + 1] - tops[k]))
        way = end - start
        far = np.linalg.norm(way, axis=1)
        along = (coupler**2 - reach**2 + far**2) / (2.0 * far)
        drawn = tops[k + 1] - tops[k]
        base = feet[k + 1] - tops[k]
        side = math.copysign(1.0, base[0] * drawn[1] - base[1] * drawn[0])
        across = side * np.sqrt(coupler**2 - along**2)
        unit = way / far[:, None]
        moved = along[:, None] * unit + across[:, None] * np.stack([-unit[:, 1], unit[:, 0]], axis=1)
        turn = _angle(drawn, moved)
        rocker = _angle(tops[k + 1] - feet[k + 1], start + moved - end)
        found[:, loops + 1 + 2 * k] = turn - bar
        found[:, loops + 2 + 2 * k] = rocker - turn
        found[:, k + 1] = bar = rocker
    return found


def _turned(angle: Array, vector: Array) -> Array:
    c, s = np.cos(angle), np.sin(angle)
    return np.stack([c * vector[0] - s * vector[1], s * vector[0] + c * vector[1]], axis=1)


def _angle(drawn: Array, moved: Array) -> Array:
    return np.asarray(
        np.arctan2(drawn[0] * moved[:, 1] - drawn[1] * moved[:, 0], moved @ drawn), dtype=np.float64
    )


def random_poses(count: int, seed: int = 0, reach: float = 0.2) -> Array:
    """Poses about the drawn one, independent of each other: +-0.2 m and about +-0.4 rad an axis."""
    return _poses(np.random.default_rng(seed).uniform(-reach, reach, (count, 6)))


def path_poses(count: int, reach: float = 0.2) -> Array:
    """The same region along one smooth path, a thousand configurations a period: neighbours are near."""
    angle = 2.0 * math.pi * np.arange(count)[:, None] / 1000.0
    return _poses(reach * np.sin(angle * np.array([1.0, 0.83, 0.71, 0.59, 0.47, 0.37]) + np.arange(6)))


def path_motors(count: int) -> Array:
    """Motor angles of the five-bar along one smooth path of +-0.2 rad, within its reach [rad]."""
    angle = 2.0 * math.pi * np.arange(count)[:, None] / 1000.0
    return np.asarray([-0.2, -0.1] + 0.2 * np.sin(angle * np.array([1.0, 0.79])))


def _poses(offset: Array) -> Array:
    turn = np.concatenate([np.ones((len(offset), 1)), offset[:, 3:]], axis=1)
    turn /= np.linalg.norm(turn, axis=1, keepdims=True)
    return np.ascontiguousarray(np.concatenate([offset[:, :3] + [0.0, 0.0, HEIGHT], turn], axis=1))


def on_circle(radius: float, angle: Array) -> Array:
    """Points on a horizontal circle about the origin."""
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), 0.0 * angle], axis=1)


def rotation(turn: Array) -> Array:
    """n x 3 x 3 rotations of n quaternions."""
    w, x, y, z = turn.T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), 2, 0)


def product(one: Array, two: Array) -> Array:
    """Products of quaternions, row by row."""
    (a, b, c, d), (w, x, y, z) = one.T, two.T
    return np.stack(
        [
            a * w - b * x - c * y - d * z,
            a * x + b * w + c * z - d * y,
            a * y - b * z + c * w + d * x,
            a * z + b * y - c * x + d * w,
        ],
        axis=1,
    )
