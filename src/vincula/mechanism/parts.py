"""The parts of a resolved mechanism: bodies, frames, joints, contacts, couplings, drives.

Positions are held in body frames, so that the parts are true at every configuration.  File readers
build these directly; people draw mechanisms in ground axes with the constructors of `drawing`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final, Literal

import numpy as np

from vincula.arrays import Vector, checked, frozen
from vincula.errors import ModelError
from vincula.labels import ALL as ALL  # noqa: PLC0414  part of this module's names
from vincula.labels import _All as _All  # noqa: PLC0414
from vincula.mechanism.written import Written
from vincula.spatial.poses import Pose

GROUND: Final = "ground"
"""Name of the fixed body."""


ROTATION_ERROR: Final = 1e-6
"""Largest error of a rotation matrix or unit vector: what files with seven digits have."""

SMALLEST_DIRECTION: Final = 1e-9
"""Directions shorter than this are refused: nobody means them, and they amplify rounding."""


def _checked_pose(what: str, pose: Pose) -> Pose:
    """The pose with read-only arrays, refused when it is not finite or no rotation."""
    position = checked(pose.position, f"{what}: position", (None,))
    s = len(position)
    rotation = checked(pose.rotation, f"{what}: rotation", (s, s))
    if rotation.dtype == object:
        return Pose(rotation, position)
    error = float(np.abs(rotation.T @ rotation - np.eye(s)).max(initial=0.0))
    if error > ROTATION_ERROR or np.linalg.det(rotation) < 0.0:
        raise ModelError(
            f"{what}: the matrix {rotation.tolist()} is no rotation: its columns are not a right-handed set "
            f"of perpendicular unit vectors (off by {error:.3g})"
        )
    return Pose(rotation, position)


@dataclass(frozen=True, slots=True, eq=False)
class Body:
    """A rigid body.

    Attributes:
        name: Unique name.
        pose: Pose of the body frame in ground axes at the home configuration.
        drawn: True when the body was drawn in ground axes and its frame has no meaning of its own.
    """

    name: str
    pose: Pose
    drawn: bool = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "pose", _checked_pose(f"body {self.name!r}", self.pose))


@dataclass(frozen=True, slots=True, eq=False)
class Frame:
    """A named frame (site) on a body.

    Attributes:
        name: Unique name.
        body: The body that carries it.
        pose: Its pose in the body frame.
    """

    name: str
    body: str
    pose: Pose

    def __post_init__(self) -> None:
        object.__setattr__(self, "pose", _checked_pose(f"frame {self.name!r}", self.pose))


@dataclass(frozen=True, slots=True)
class Limits:
    """Limits of one joint axis; None where the file gives none.

    Attributes:
        lower: Smallest value [rad or m].
        upper: Largest value.
        rate: Largest speed [rad/s or m/s].
        effort: Largest torque or force [N m or N].
    """

    lower: float | None = None
    upper: float | None = None
    rate: float | None = None
    effort: float | None = None


def _unit_x() -> Vector:
    return frozen(np.array([1.0, 0.0, 0.0]))


@dataclass(frozen=True, slots=True, eq=False)
class Joint:
    """A joint between two bodies: X_first @ frame_on_first @ motion(q) = X_second @ frame_on_second.

    Attributes:
        name: Unique name.
        type: Name of the joint type.
        first: Body that carries frame A; rates are of the second body relative to the first.
        second: Body that carries frame B.
        frame_on_first: Frame A in the first body's frame; z is the axis (plane: x the sliding axis).
        frame_on_second: Frame B in the second body's frame.
        home: Configuration values at the home configuration; empty for a closure.
        lead: Advance of a screw a turn [m].
        second_axis: Second axis of a universal joint in the joint frame.
        limits: Limits by axis, in the order of the axes; empty when there are none.
        closure: True for a loop joint known only by its two frames: it has no configuration value.
        cut: How the joint is cut when the reduction must cut it; None for the default (kept, except
            closures of MJCF that stand for rows only).
        written: Where it was drawn, exactly; None where that is not known.
    """

    name: str
    type: str
    first: str
    second: str
    frame_on_first: Pose
    frame_on_second: Pose
    home: tuple[float, ...] = ()
    lead: float = 0.0
    second_axis: Vector = field(default_factory=_unit_x)
    limits: tuple[Limits, ...] = ()
    closure: bool = False
    cut: Literal["kept", "contact"] | None = None
    written: Written | None = None

    def __post_init__(self) -> None:
        what = f"joint {self.name!r}"
        first = _checked_pose(f"{what}: frame on the first body", self.frame_on_first)
        second = _checked_pose(f"{what}: frame on the second body", self.frame_on_second)
        object.__setattr__(self, "frame_on_first", first)
        object.__setattr__(self, "frame_on_second", second)
        axis = checked(self.second_axis, f"{what}: second axis", (3,))
        if axis.dtype != object and abs(float(np.linalg.norm(axis)) - 1.0) > ROTATION_ERROR:
            raise ModelError(f"{what}: the second axis {axis.tolist()} is not a unit vector")
        object.__setattr__(self, "second_axis", axis)


@dataclass(frozen=True, slots=True, eq=False)
class ContactPart:
    """A contact between two bodies; z of both frames is the normal from the first into the second.

    Attributes:
        name: Unique name.
        type: Name of the contact type (Table I).
        first: Limb-side body.
        second: Object-side body.
        frame_on_first: Contact frame in the first body's frame.
        frame_on_second: Contact frame in the second body's frame.
        friction: Coefficient of friction, None when the file gives none.
        written: Where it was drawn, exactly; None where that is not known.
    """

    name: str
    type: str
    first: str
    second: str
    frame_on_first: Pose
    frame_on_second: Pose
    friction: float | None = None
    written: Written | None = None

    def __post_init__(self) -> None:
        what = f"contact {self.name!r}"
        first = _checked_pose(f"{what}: frame on the first body", self.frame_on_first)
        second = _checked_pose(f"{what}: frame on the second body", self.frame_on_second)
        object.__setattr__(self, "frame_on_first", first)
        object.__setattr__(self, "frame_on_second", second)


@dataclass(frozen=True, slots=True)
class Coupling:
    """A constraint between joint axes (mimic, gears, differentials, MJCF joint and tendon equalities).

    The residual is  sum rates[i] (q_i - ref_i) - p(sum driver[j] (q_j - ref_j)); its derivative is
    the coupling row.

    Attributes:
        name: Unique name.
        rates: Coefficient of every axis of the linear part.
        driver: Coefficients of the axes inside the polynomial; empty for a linear coupling.
        polynomial: Coefficients a0, a1, ... of p.
        references: Values at which the sums are zero, by axis; absent ones are the home values.
    """

    name: str
    rates: Mapping[str, float]
    driver: Mapping[str, float] = field(default_factory=dict)
    polynomial: Sequence[float] = ()
    references: Mapping[str, float] = field(default_factory=dict)

    @property
    def axes(self) -> tuple[str, ...]:
        """Every axis that the coupling names."""
        return tuple(dict.fromkeys([*self.rates, *self.driver]))

    def residual(self, values: Mapping[str, float], home: Mapping[str, float]) -> float:
        """How far scalar axis values are from satisfying the coupling [rad or m].

        Args:
            values: Value by axis.
            home: Home value by axis.
        """

        def total(terms: Mapping[str, float]) -> float:
            return sum(c * (values[a] - self.references.get(a, home[a])) for a, c in terms.items())

        return total(self.rates) - float(
            np.polynomial.polynomial.polyval(total(self.driver), self.polynomial or [0.0])
        )

    def coefficients(self, values: Mapping[str, float], home: Mapping[str, float]) -> dict[str, float]:
        """The coupling row: derivative of the residual by axis."""
        row = {axis: float(c) for axis, c in self.rates.items()}
        if self.driver:
            inner = sum(c * (values[a] - self.references.get(a, home[a])) for a, c in self.driver.items())
            slope = float(
                np.polynomial.polynomial.polyval(
                    inner, np.polynomial.polynomial.polyder(list(self.polynomial) or [0.0])
                )
            )
            for axis, c in self.driver.items():
                row[axis] = row.get(axis, 0.0) - slope * c
        return row


@dataclass(frozen=True, slots=True)
class Drive:
    """A motor that drives a combination of joint axes: motor rate = sum coefficient x axis rate.

    Attributes:
        name: Unique name of the motor.
        drives: Coefficient by axis.
        linear: Whether the motor's rate is in m/s; None to take it from the driven axes.
    """

    name: str
    drives: Mapping[str, float]
    linear: bool | None = None


@dataclass(frozen=True, slots=True)
class Cut:
    """How a joint is cut when the reduction must cut it.

    Attributes:
        kind: `kept` (columns stay, complete rows at the cut point) or `contact` (selector rows,
            columns vanish).
        at: Cut point in ground axes at the home configuration [m]; None for the joint's centre.
    """

    kind: Literal["kept", "contact"] = "kept"
    at: tuple[float, ...] | None = None


@dataclass(frozen=True, slots=True, eq=False)
class ReferenceMember:
    """The reference member: the body whose motion and forces are asked for.

    Attributes:
        body: Its name.
        origin: The reference point in the body's frame [m].
        axes: `ground` or `body`: the axes of twist and wrench.
        cuts: Cuts by joint name.
        label: How the user named the point, for results.
    """

    body: str
    origin: Vector
    axes: Literal["ground", "body"] = "ground"
    cuts: Mapping[str, Cut] = field(default_factory=dict)
    label: str = ""

    def __post_init__(self) -> None:
        object.__setattr__(self, "origin", checked(self.origin, "reference point", (None,)))


@dataclass(frozen=True, slots=True)
class Precision:
    """How exactly the numbers of a mechanism are known.

    Attributes:
        digits_length: Half a unit of the last typed digit, largest over all lengths [m].
        digits_angle: The same over angles and directions [rad].
        tolerance_length: Manufacturing tolerance on lengths [m].
        tolerance_angle: Manufacturing tolerance on angles [rad].
    """

    digits_length: float = 0.0
    digits_angle: float = 0.0
    tolerance_length: float = 0.0
    tolerance_angle: float = 0.0

    def __post_init__(self) -> None:
        for name, value in ((name, getattr(self, name)) for name in self.__slots__):
            if not 0.0 <= value < math.inf:
                raise ModelError(f"{name.replace('_', ' of ')} is {value}: give zero or a positive number")
