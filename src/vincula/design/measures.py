"""What designs are judged by: numbers at every configuration, the smaller or the larger the better."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final, Literal, final

import numpy as np
from numpy.typing import NDArray

from vincula.arrays import Vector
from vincula.errors import ModelError, listing
from vincula.kernels.plans import model_without_numbers
from vincula.kernels.quantities import CLASS_CODES
from vincula.numerics.rank import negligible
from vincula.weights import UNIT, Weights

if TYPE_CHECKING:
    from vincula.design.lanes import Lanes
    from vincula.kernels.compiled import CompiledMechanism

Array = NDArray[np.float64]
Over = Literal["worst", "mean"]
Sense = Literal["smaller", "larger"]

SENSES: Final[dict[str, Sense]] = {
    "condition": "smaller",
    "condition_number": "smaller",
    "inverse_condition_number": "larger",
    "isotropy": "larger",
    "yoshikawa_volume": "larger",
    "smallest_singular_value": "larger",
    "smallest": "larger",
    "closure.residual": "smaller",
}
"""Which way is better, where that is not a matter of taste."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Measure(ABC):
    """A number at every configuration of a design, and how they become one number a design.

    Attributes:
        over: `worst` or `mean` of the configurations.
        weights: Weights of this measure; None for those of the problem.
        label: Name in reports; None for one made from what it is.
    """

    over: Over = "worst"
    weights: Weights | None = field(default=None, compare=False)
    label: str | None = None

    @property
    @abstractmethod
    def title(self) -> str:
        """What it is, in words."""

    @property
    @abstractmethod
    def better(self) -> Sense:
        """Whether smaller or larger is better."""

    @property
    @abstractmethod
    def quantities(self) -> tuple[str, ...]:
        """What it needs of a batch."""

    @abstractmethod
    def at(self, lanes: Lanes) -> Array:
        """Its value at every configuration, designs x configurations; inf where it has no bound."""

    @property
    def name(self) -> str:
        """Its name in reports."""
        return self.label or self.title

    def check(self, compiled: CompiledMechanism) -> None:
        """Refuse what this mechanism cannot be judged by.

        Raises:
            ModelError: It does not fit the mechanism.
        """

    def of(self, lanes: Lanes) -> Vector:
        """One value a design, over the configurations that were reached."""
        values = np.where(lanes.reached, self.at(lanes), np.nan)
        any_there = lanes.reached.any(axis=1)
        found = np.full(len(values), np.nan)
        for k in np.flatnonzero(any_there):
            row = values[k][lanes.reached[k]]
            if np.isnan(row).any():
                continue
            worst = row.max() if self.better == "smaller" else row.min()
            found[k] = row.mean() if self.over == "mean" else worst
        return found

    def signed(self, values: Array) -> Array:
        """The values so that smaller is better."""
        return values if self.better == "smaller" else -values


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class SphereDistance(Measure):
    """Distance of the kinematic ellipsoid to the unit sphere, (lambda_max - 1)^2 + (lambda_min - 1)^2.

    The paper's cost of its second case study; the task ellipsoid is W_u, the `twist` weight.  A design that
    has lost a motion of the member counts with lambda_min = 0, one that is free with its motors locked is
    infinitely far away.
    """

    @property
    def title(self) -> str:
        return "distance to the unit sphere"

    @property
    def better(self) -> Sense:
        return "smaller"

    @property
    def quantities(self) -> tuple[str, ...]:
        return ("kinematic.efficiencies", "kinematic.classes")

    def at(self, lanes: Lanes) -> Array:
        values, classes = lanes["kinematic.efficiencies"], lanes["kinematic.classes"]
        finite = classes == CLASS_CODES["finite"]
        with np.errstate(invalid="ignore", over="ignore"):
            largest = np.where(finite, values, -np.inf).max(axis=-1)
            smallest = np.where(finite, values, np.inf).min(axis=-1)
            smallest = np.where(finite.sum(axis=-1) < lanes.freedom, 0.0, smallest)
            cost = (largest - 1.0) ** 2 + (smallest - 1.0) ** 2
        free = (classes == CLASS_CODES["infinite"]).any(axis=-1)
        return np.asarray(np.where(free, np.inf, cost))


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Index(Measure):
    """Any quantity of a batch with one number a configuration, such as `kinematic.condition:translation`.

    Attributes:
        quantity: Its name.
        sense: Which way is better; None where the quantity itself says it.
    """

    quantity: str
    sense: Sense | None = None

    def __post_init__(self) -> None:
        if self.sense is None and self._part not in SENSES:
            raise ModelError(
                f"{self.quantity}: say whether smaller or larger is better; known by itself: {listing(SENSES)}"
            )

    @property
    def _part(self) -> str:
        last = self.quantity.partition(":")[0]
        return last if last in SENSES else last.rpartition(".")[2]

    @property
    def title(self) -> str:
        return self.quantity

    @property
    def better(self) -> Sense:
        return self.sense or SENSES[self._part]

    @property
    def quantities(self) -> tuple[str, ...]:
        return (self.quantity,)

    def check(self, compiled: CompiledMechanism) -> None:
        known = compiled.quantities.get(self.quantity)
        if known is not None and known.shape:
            raise ModelError(f"{self.quantity} has {known.shape} numbers a configuration: choose one with one")

    def at(self, lanes: Lanes) -> Array:
        return np.asarray(lanes[self.quantity], dtype=float)


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Speed(Measure):
    """Largest component of the member's twist along a direction, for a unit of motor effort.

    Attributes:
        direction: Components of the twist, order and units as `Space.twist_components`.
    """

    direction: tuple[float, ...]

    @property
    def title(self) -> str:
        return f"speed along {_said(self.direction)}"

    @property
    def better(self) -> Sense:
        return "larger"

    @property
    def quantities(self) -> tuple[str, ...]:
        return ("kinematic.efficiencies", "kinematic.classes", "kinematic.task_directions")

    def check(self, compiled: CompiledMechanism) -> None:
        _refuse_direction(self.direction, compiled)

    def at(self, lanes: Lanes) -> Array:
        values, classes = lanes["kinematic.efficiencies"], lanes["kinematic.classes"]
        along = lanes["kinematic.task_directions"] @ np.asarray(self.direction)
        finite = classes == CLASS_CODES["finite"]
        squares = np.where(finite, np.where(finite, values, 0.0) * np.where(finite, along, 0.0) ** 2, 0.0)
        free = (classes == CLASS_CODES["infinite"]).any(axis=-1)
        return np.asarray(np.where(free, np.inf, np.sqrt(squares.sum(axis=-1))))


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Force(Measure):
    """Largest load along a direction that a unit of motor torque resists (passive force ellipsoid, eq. 21).

    Infinite where the structure carries it with no torque.

    Attributes:
        direction: Components of the wrench, order and units as `Space.wrench_components`.
    """

    direction: tuple[float, ...]

    @property
    def title(self) -> str:
        return f"force along {_said(self.direction)}"

    @property
    def better(self) -> Sense:
        return "larger"

    @property
    def quantities(self) -> tuple[str, ...]:
        parts = ("efficiencies", "classes", "task_directions")
        return (*(f"passive_force.{part}" for part in parts), "configuration")

    def check(self, compiled: CompiledMechanism) -> None:
        _refuse_direction(self.direction, compiled)

    def at(self, lanes: Lanes) -> Array:
        from vincula.analysis.manipulability import passive_force_ellipsoid

        load = np.asarray(self.direction)
        metric = lanes.metric("wrench")
        values, classes = lanes["passive_force.efficiencies"], lanes["passive_force.classes"]
        shares = lanes["passive_force.task_directions"] @ (metric.matrix @ load)
        finite, free = (classes == CLASS_CODES[kind] for kind in ("finite", "infinite"))
        whole = metric.definite & ((finite | free).sum(axis=-1) == len(load))
        size = float(np.linalg.norm(metric.factor @ load))
        found = np.full(values.shape[:-1], np.nan)
        for place in zip(*np.nonzero(lanes.reached), strict=True):
            if not whole[place]:
                # Some wrench moves the member or is not weighed: the set itself says whether this one does.
                model = lanes.model(*map(int, place))
                found[place] = passive_force_ellipsoid(model, lanes.weights).along(load)
                continue
            own = finite[place]
            part = shares[place][own]
            carried = negligible(float(np.linalg.norm(part)), size)
            found[place] = np.inf if carried else 1.0 / np.sqrt((part**2 / values[place][own]).sum())
        return found


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class SingularityDistance(Measure):
    """How far every configuration is from a singularity: the smallest number of `singularity.distance`."""

    @property
    def title(self) -> str:
        return "distance to singularity"

    @property
    def better(self) -> Sense:
        return "larger"

    @property
    def quantities(self) -> tuple[str, ...]:
        return ("singularity.distance",)

    def at(self, lanes: Lanes) -> Array:
        distances = lanes["singularity.distance"]
        known = np.where(np.isnan(distances), np.inf, distances).min(axis=-1)
        return np.asarray(np.where(np.isfinite(known), known, np.nan))


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class WorkspaceShare(Measure):
    """The share of the configurations asked for that the mechanism reaches, 0 to 1."""

    @property
    def title(self) -> str:
        return "share of the workspace"

    @property
    def better(self) -> Sense:
        return "larger"

    @property
    def quantities(self) -> tuple[str, ...]:
        return ()

    def at(self, lanes: Lanes) -> Array:
        return np.asarray(lanes.reached, dtype=float)

    def of(self, lanes: Lanes) -> Vector:
        return np.asarray(lanes.reached.mean(axis=1), dtype=float)




def _said(direction: Sequence[float]) -> str:
    return "(" + ", ".join(f"{x:g}" for x in direction) + ")"


def _refuse_direction(direction: Sequence[float], compiled: CompiledMechanism) -> None:
    size = compiled.mechanism.space.dimension
    values: Any = np.asarray(direction, dtype=float)
    if values.shape != (size,) or not np.isfinite(values).all() or not values.any():
        raise ModelError(f"direction {_said(direction)}: give {size} finite numbers, not all zero")


def chosen_weights(compiled: CompiledMechanism) -> Weights:
    """The weights that a compiled mechanism is evaluated with."""
    return compiled.weights or model_without_numbers(compiled.mechanism).weights or UNIT
