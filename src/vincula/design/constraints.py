"""What a design must keep: bounds on measures, relations, joint limits, no singularity inside.

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
from vincula.design.functions import of_many
from vincula.design.measures import Measure, SingularityDistance
from vincula.errors import ModelError
from vincula.mechanism.residuals import axis_values

if TYPE_CHECKING:
    from vincula.design.lanes import Lanes
    from vincula.kernels.compiled import CompiledMechanism

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

    def check(self, compiled: CompiledMechanism) -> None:  # noqa: B027
        """Refuse what this mechanism cannot be held to.

        Raises:
            ModelError: It does not fit the mechanism.
        """

    @abstractmethod
    def broken(self, lanes: Lanes) -> Vector:
        """By how much every design breaks it; 0 where it is kept."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Between(Constraint):
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

    def outside(self, values: Vector) -> Vector:
        """By how much values leave the bounds, relative to the bound; `LOST` where there is no value."""
        broken = np.zeros(np.shape(values))
        with np.errstate(invalid="ignore", over="ignore"):
            if self.least is not None:
                broken = np.maximum(broken, (self.least - values) / max(abs(self.least), 1.0))
            if self.most is not None:
                broken = np.maximum(broken, (values - self.most) / max(abs(self.most), 1.0))
        return np.where(np.isnan(values), LOST, np.minimum(np.maximum(broken, 0.0), 1e6))

    def bounds(self) -> str:
        """The bounds in words."""
        low = f"at least {self.least:g}" if self.least is not None else ""
        high = f"at most {self.most:g}" if self.most is not None else ""
        return " and ".join(part for part in (low, high) if part)


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Bound(Between):
    """A measure between bounds: `Bound(measure=vc.design..., most=10)`.

    Attributes:
        measure: The measure.
    """

    measure: Measure

    @property
    def title(self) -> str:
        """What it is, in words."""
        return f"{self.measure.name} {self.bounds()}"

    @property
    def quantities(self) -> tuple[str, ...]:
        """What it needs of a batch."""
        return self.measure.quantities

    def check(self, compiled: CompiledMechanism) -> None:
        """Refuse a mechanism that it does not fit."""
        self.measure.check(compiled)

    def broken(self, lanes: Lanes) -> Vector:
        """By how much every design breaks it."""
        return self.outside(self.measure.of(lanes))


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Relation(Between):
    """A function of the variables between bounds, checked before anything is built.

    Attributes:
        value: The function: from the values of the variables by name to a number.
    """

    value: Callable[[Mapping[str, float]], float]

    @property
    def title(self) -> str:
        """What it is, in words."""
        return f"{getattr(self.value, 'text', 'relation')} {self.bounds()}"

    def broken(self, lanes: Lanes) -> Vector:
        """Nothing here: the problem checks relations first, see `of_variables`."""
        return np.zeros(len(lanes.reached))

    def of_variables(self, columns: Mapping[str, Vector]) -> Vector:
        """By how much every design breaks it.

        Args:
            columns: Values of the variables by name, one a design.
        """
        return self.outside(of_many(self.value, columns))


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class JointLimits(Constraint):
    """Every joint value within the limits of the mechanism, at every configuration reached."""

    @property
    def title(self) -> str:
        """What it is, in words."""
        return "joint limits"

    @property
    def quantities(self) -> tuple[str, ...]:
        """What it needs of a batch."""
        return ("configuration",)

    def check(self, compiled: CompiledMechanism) -> None:
        """Refuse a mechanism that it does not fit."""
        joints = compiled.mechanism.all_joints
        if not any(limit.lower is not None or limit.upper is not None for j in joints for limit in j.limits):
            raise ModelError("constraint 'joint limits': no joint of the mechanism has limits")

    def broken(self, lanes: Lanes) -> Vector:
        """By how much every design breaks it."""
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
        """What it is, in words."""
        return "no singularity inside"

    @property
    def quantities(self) -> tuple[str, ...]:
        """What it needs of a batch."""
        return ("coordinated", "indeterminacy", *(SingularityDistance().quantities if self.margin else ()))

    def broken(self, lanes: Lanes) -> Vector:
        """`LOST` for every share of singular configurations, else what is missing to the margin."""
        lost = (lanes["indeterminacy"] > lanes.usual["indeterminacy"]) | (
            lanes["coordinated"] < lanes.usual["coordinated"]
        )
        found = np.where(lanes.reached, lost, False).mean(axis=1) * LOST
        if self.margin:
            near = SingularityDistance().of(lanes)
            found = found + np.where(np.isnan(near), LOST, np.maximum(self.margin - near, 0.0) / self.margin)
        return np.asarray(found)
