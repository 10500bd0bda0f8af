"""Lengths that a design must keep: distances of joints, clearance between legs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, final

import numpy as np

from vincula.arrays import Vector
from vincula.design.constraints import Between, Constraint
from vincula.errors import ModelError, UnknownNameError
from vincula.mechanism.kinematics import part_frames
from vincula.mechanism.parts import ContactPart, Joint

if TYPE_CHECKING:
    from vincula.design.lanes import Lanes
    from vincula.kernels.compiled import CompiledMechanism
    from vincula.mechanism.configuration import Configuration
    from vincula.mechanism.mechanism import Mechanism


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Distance(Between):
    """The distance of two joints or contacts at every configuration: the length of a leg, say [m].

    Attributes:
        first: Name of a joint or contact.
        second: Name of another.
    """

    first: str
    second: str

    @property
    def title(self) -> str:
        """What it is, in words."""
        return f"distance {self.first} to {self.second} {self.bounds()}"

    @property
    def quantities(self) -> tuple[str, ...]:
        """What it needs of a batch."""
        return ("configuration",)

    def check(self, compiled: CompiledMechanism) -> None:
        """Refuse a mechanism that it does not fit."""
        points_of(compiled.mechanism, compiled.mechanism.home, (self.first, self.second))

    def broken(self, lanes: Lanes) -> Vector:
        """By how much every design breaks it."""

        def length(mechanism: Mechanism, q: Configuration) -> float:
            one, two = points_of(mechanism, q, (self.first, self.second))
            return float(np.linalg.norm(two - one))

        return _worst(lanes, lambda mechanism, q: self.outside(np.array(length(mechanism, q))))


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Clearance(Constraint):
    """The least distance of two straight legs at every configuration [m].

    Attributes:
        legs: Two pairs of names of joints or contacts: the ends of the legs' axes.
        least: Smallest distance of the axes that is allowed.
    """

    legs: tuple[tuple[str, str], tuple[str, str]]
    least: float

    @property
    def title(self) -> str:
        """What it is, in words."""
        one, two = ("-".join(leg) for leg in self.legs)
        return f"clearance of {one} and {two} at least {self.least:g}"

    @property
    def quantities(self) -> tuple[str, ...]:
        """What it needs of a batch."""
        return ("configuration",)

    def check(self, compiled: CompiledMechanism) -> None:
        """Refuse a mechanism that it does not fit."""
        if not self.least > 0.0:
            raise ModelError(f"constraint {self.name!r}: least is {self.least:g}: give a length above 0")
        points_of(compiled.mechanism, compiled.mechanism.home, (*self.legs[0], *self.legs[1]))

    def broken(self, lanes: Lanes) -> Vector:
        """By how much every design breaks it."""

        def missing(mechanism: Mechanism, q: Configuration) -> float:
            a, b, c, d = points_of(mechanism, q, (*self.legs[0], *self.legs[1]))
            return max(0.0, 1.0 - segment_distance(a, b, c, d) / self.least)

        return _worst(lanes, missing)


def _worst(lanes: Lanes, amount: Callable[[Mechanism, Configuration], float | Vector]) -> Vector:
    """The largest amount over the configurations reached by every design."""
    found = np.zeros(len(lanes.reached))
    for design, place in zip(*np.nonzero(lanes.reached), strict=True):
        q = lanes.configuration(int(design), int(place))
        found[design] = max(found[design], float(amount(lanes.mechanism(int(design)), q)))
    return found


def points_of(mechanism: Mechanism, q: Configuration, names: tuple[str, ...]) -> list[Vector]:
    """Where joints and contacts are in ground axes at a configuration [m].

    Raises:
        UnknownNameError: A name that is no joint and no contact.
    """
    poses = mechanism.body_poses(q)
    parts: dict[str, Joint | ContactPart] = {c.name: c for c in mechanism.contacts}
    parts.update({j.name: j for j in mechanism.all_joints})
    for name in names:
        if name not in parts:
            raise UnknownNameError("joint or contact", name, parts)
    return [part_frames(parts[name], poses)[1].position for name in names]


def segment_distance(a: Vector, b: Vector, c: Vector, d: Vector) -> float:
    """Distance of the segments a-b and c-d.

    It is attained inside both, or at an end of one of them; all five candidates are looked at.
    """
    ends = [_to_segment(a, c, d), _to_segment(b, c, d), _to_segment(c, a, b), _to_segment(d, a, b)]
    u, v, w = b - a, d - c, a - c
    table = np.array([[u @ u, -(u @ v)], [-(u @ v), v @ v]])
    determinant = float(table[0, 0] * table[1, 1] - table[0, 1] ** 2)
    if determinant > 0.0:
        s = float(-(w @ u) * table[1, 1] - (w @ v) * table[0, 1]) / determinant
        t = float((w @ v) * table[0, 0] + (w @ u) * table[0, 1]) / determinant
        if 0.0 <= s <= 1.0 and 0.0 <= t <= 1.0:
            ends.append(float(np.linalg.norm(w + s * u - t * v)))
    return min(ends)


def _to_segment(point: Vector, a: Vector, b: Vector) -> float:
    along = b - a
    square = float(along @ along)
    share = min(max(float((point - a) @ along) / square, 0.0), 1.0) if square > 0.0 else 0.0
    return float(np.linalg.norm(point - a - share * along))
