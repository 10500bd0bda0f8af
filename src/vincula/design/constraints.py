"""What a design must keep: bounds on measures, joint limits, lengths, clearances, no singularity inside.

A constraint gives every design the amount by which it is broken, 0 where it is kept; the amounts lead a
search back to what is allowed, and their names are what infeasible designs are counted by.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, final

import numpy as np

from vincula.arrays import Vector
from vincula.design.measures import Measure, SingularityDistance
from vincula.errors import ModelError, UnknownNameError
from vincula.mechanism.kinematics import part_frames
from vincula.mechanism.residuals import axis_values

if TYPE_CHECKING:
    from vincula.design.lanes import Lanes
    from vincula.kernels.compiled import CompiledMechanism
    from vincula.mechanism.configuration import Configuration
    from vincula.mechanism.mechanism import Mechanism

LOST = 1.0
"""By how much a configuration that is singular, or has no number at all, breaks a constraint."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Constraint(ABC):
    """Something that a design must keep.

    Attributes:
        label: Name in reports; None for one made from what it is.
    """

    label: str | None = None

    @property
    @abstractmethod
    def title(self) -> str:
        """What it is, in words."""

    @property
    def name(self) -> str:
        """Its name in reports."""
        return self.label or self.title

    @property
    def quantities(self) -> tuple[str, ...]:
        """What it needs of a batch."""
        return ()

    def check(self, compiled: CompiledMechanism) -> None:
        """Refuse what this mechanism cannot be held to.

        Raises:
            ModelError: It does not fit the mechanism.
        """

    @abstractmethod
    def broken(self, lanes: Lanes) -> Vector:
        """By how much every design breaks it; 0 where it is kept."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Between(Constraint):
    """A number between two bounds.

    Attributes:
        least: Smallest value allowed; None for no bound.
        most: Largest value allowed; None for no bound.
    """

    least: float | None = None
    most: float | None = None

    def __post_init__(self) -> None:
        if self.least is None and self.most is None:
            raise ModelError(f"constraint {self.name!r}: give least, most, or both")
        if self.least is not None and self.most is not None and self.least > self.most:
            raise ModelError(f"constraint {self.name!r}: least {self.least:g} is above most {self.most:g}")

    def _outside(self, values: Vector) -> Vector:
        """By how much values leave the bounds, relative to the bound; `LOST` where there is no value."""
        broken = np.zeros(np.shape(values))
        with np.errstate(invalid="ignore", over="ignore"):
            if self.least is not None:
                broken = np.maximum(broken, (self.least - values) / max(abs(self.least), 1.0))
            if self.most is not None:
                broken = np.maximum(broken, (values - self.most) / max(abs(self.most), 1.0))
        return np.where(np.isnan(values), LOST, np.minimum(np.maximum(broken, 0.0), 1e6))

    def _bounds(self) -> str:
        low = f"at least {self.least:g}" if self.least is not None else ""
        high = f"at most {self.most:g}" if self.most is not None else ""
        return " and ".join(part for part in (low, high) if part)


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Bound(_Between):
    """A measure between bounds: `Bound(measure=vc.design..., most=10)`.

    Attributes:
        measure: The measure.
    """

    measure: Measure

    @property
    def title(self) -> str:
        return f"{self.measure.name} {self._bounds()}"

    @property
    def quantities(self) -> tuple[str, ...]:
        return self.measure.quantities

    def check(self, compiled: CompiledMechanism) -> None:
        self.measure.check(compiled)

    def broken(self, lanes: Lanes) -> Vector:
        return self._outside(self.measure.of(lanes))


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Relation(_Between):
    """A function of the variables between bounds, checked before anything is built.

    Attributes:
        value: The function: from the values of the variables by name to a number.
    """

    value: Callable[[Mapping[str, float]], float]

    @property
    def title(self) -> str:
        return f"{getattr(self.value, 'text', 'relation')} {self._bounds()}"

    def broken(self, lanes: Lanes) -> Vector:
        """Nothing here: the problem checks relations first, see `of_variables`."""
        return np.zeros(len(lanes.reached))

    def of_variables(self, rows: list[dict[str, float]]) -> Vector:
        """By how much every design breaks it."""
        values = np.full(len(rows), np.nan)
        for k, row in enumerate(rows):
            try:
                values[k] = float(self.value(row))
            except (ArithmeticError, ValueError):
                continue
        return self._outside(values)


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class JointLimits(Constraint):
    """Every joint value within the limits of the mechanism, at every configuration reached."""

    @property
    def title(self) -> str:
        return "joint limits"

    @property
    def quantities(self) -> tuple[str, ...]:
        return ("configuration",)

    def check(self, compiled: CompiledMechanism) -> None:
        joints = compiled.mechanism.all_joints
        if not any(limit.lower is not None or limit.upper is not None for j in joints for limit in j.limits):
            raise ModelError("constraint 'joint limits': no joint of the mechanism has limits")

    def broken(self, lanes: Lanes) -> Vector:
        found = np.zeros(len(lanes.reached))
        for design, place in zip(*np.nonzero(lanes.reached), strict=True):
            mechanism = lanes.mechanism(int(design))
            values = axis_values(mechanism, lanes.configuration(int(design), int(place)))
            for joint in mechanism.all_joints:
                axes = mechanism.type_of(joint).axis_names(joint.name)
                for axis, limit in zip(axes, joint.limits, strict=False):
                    if axis not in values:
                        continue
                    low = -np.inf if limit.lower is None else limit.lower
                    high = np.inf if limit.upper is None else limit.upper
                    found[design] = max(found[design], low - values[axis], values[axis] - high)
        return found


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class NoSingularity(Constraint):
    """No singular configuration among those judged: nothing is free with motors locked, no motion is lost.

    It looks at the configurations of the problem only; how close they lie together is for the problem to
    choose.

    Attributes:
        margin: Least `singularity.distance` at every configuration.
    """

    margin: float = 0.0

    @property
    def title(self) -> str:
        return "no singularity inside"

    @property
    def quantities(self) -> tuple[str, ...]:
        return ("coordinated", "indeterminacy", *(SingularityDistance().quantities if self.margin else ()))

    def broken(self, lanes: Lanes) -> Vector:
        """`LOST` for every share of singular configurations, else what is missing to the margin."""
        lost = (lanes["indeterminacy"] > lanes.usual["indeterminacy"]) | (
            lanes["coordinated"] < lanes.usual["coordinated"]
        )
        found = np.where(lanes.reached, lost, False).mean(axis=1) * LOST
        if self.margin:
            near = SingularityDistance().of(lanes)
            found = found + np.where(
                np.isnan(near), LOST, np.maximum(self.margin - near, 0.0) / self.margin
            )
        return np.asarray(found)


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Distance(_Between):
    """The distance of two joints or contacts at every configuration: the length of a leg, say [m].

    Attributes:
        first: Name of a joint or contact.
        second: Name of another.
    """

    first: str
    second: str

    @property
    def title(self) -> str:
        return f"distance {self.first} to {self.second} {self._bounds()}"

    @property
    def quantities(self) -> tuple[str, ...]:
        return ("configuration",)

    def check(self, compiled: CompiledMechanism) -> None:
        points_of(compiled.mechanism, compiled.mechanism.home, (self.first, self.second))

    def broken(self, lanes: Lanes) -> Vector:
        def length(mechanism: Mechanism, q: Configuration) -> float:
            one, two = points_of(mechanism, q, (self.first, self.second))
            return float(np.linalg.norm(two - one))

        return _worst(lanes, lambda mechanism, q: self._outside(np.array(length(mechanism, q))))


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
        one, two = ("-".join(leg) for leg in self.legs)
        return f"clearance of {one} and {two} at least {self.least:g}"

    @property
    def quantities(self) -> tuple[str, ...]:
        return ("configuration",)

    def check(self, compiled: CompiledMechanism) -> None:
        if not self.least > 0.0:
            raise ModelError(f"constraint {self.name!r}: least is {self.least:g}: give a length above 0")
        points_of(compiled.mechanism, compiled.mechanism.home, (*self.legs[0], *self.legs[1]))

    def broken(self, lanes: Lanes) -> Vector:
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
    parts = {**{c.name: c for c in mechanism.contacts}, **{j.name: j for j in mechanism.all_joints}}
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
