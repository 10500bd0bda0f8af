"""What designs are judged by: numbers at every configuration, the smaller or the larger the better."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final, Literal, final

import numpy as np
from numpy.typing import NDArray

from vincula.arrays import Vector
from vincula.errors import ModelError, listing
from vincula.kernels.quantities import CLASS_CODES
from vincula.weights import Weights

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

    def check(self, compiled: CompiledMechanism) -> None:  # noqa: B027
        """Refuse what this mechanism cannot be judged by.

        Raises:
            ModelError: It does not fit the mechanism.
        """

    def of(self, lanes: Lanes) -> Vector:
        """One value a design, over the configurations that were reached."""
        values, reached = self.at(lanes), lanes.reached
        counts = reached.sum(axis=1)
        with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
            # NaN at a configuration that was reached makes the whole design NaN.
            if self.over == "mean":
                found = np.where(reached, values, 0.0).sum(axis=1) / counts
            elif self.better == "smaller":
                found = np.where(reached, values, -np.inf).max(axis=1, initial=-np.inf)
            else:
                found = np.where(reached, values, np.inf).min(axis=1, initial=np.inf)
        return np.asarray(np.where(counts > 0, found, np.nan))

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
        """What it is, in words."""
        return "distance to the unit sphere"

    @property
    def better(self) -> Sense:
        """Whether smaller or larger is better."""
        return "smaller"

    @property
    def quantities(self) -> tuple[str, ...]:
        """What it needs of a batch."""
        return ("kinematic.efficiencies", "kinematic.classes")

    def at(self, lanes: Lanes) -> Array:
        """Its value at every configuration, designs x configurations."""
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
                f"{self.quantity}: say whether smaller or larger is better; known without: {listing(SENSES)}"
            )

    @property
    def _part(self) -> str:
        last = self.quantity.partition(":")[0]
        return last if last in SENSES else last.rpartition(".")[2]

    @property
    def title(self) -> str:
        """What it is, in words."""
        return self.quantity

    @property
    def better(self) -> Sense:
        """Whether smaller or larger is better."""
        return self.sense or SENSES[self._part]

    @property
    def quantities(self) -> tuple[str, ...]:
        """What it needs of a batch."""
        return (self.quantity,)

    def check(self, compiled: CompiledMechanism) -> None:
        """Refuse a mechanism that it does not fit."""
        known = compiled.quantities.get(self.quantity)
        if known is not None and known.shape:
            raise ModelError(
                f"{self.quantity} has {known.shape} numbers a configuration: choose one with one"
            )

    def at(self, lanes: Lanes) -> Array:
        """Its value at every configuration, designs x configurations."""
        return np.asarray(lanes[self.quantity], dtype=float)


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class SingularityDistance(Measure):
    """How far every configuration is from a singularity: the smallest number of `singularity.distance`."""

    @property
    def title(self) -> str:
        """What it is, in words."""
        return "distance to singularity"

    @property
    def better(self) -> Sense:
        """Whether smaller or larger is better."""
        return "larger"

    @property
    def quantities(self) -> tuple[str, ...]:
        """What it needs of a batch."""
        return ("singularity.distance",)

    def at(self, lanes: Lanes) -> Array:
        """Its value at every configuration, designs x configurations."""
        distances = lanes["singularity.distance"]
        known = np.where(np.isnan(distances), np.inf, distances).min(axis=-1)
        return np.asarray(np.where(np.isfinite(known), known, np.nan))


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class WorkspaceShare(Measure):
    """The share of the configurations asked for that the mechanism reaches, 0 to 1."""

    @property
    def title(self) -> str:
        """What it is, in words."""
        return "share of the workspace"

    @property
    def better(self) -> Sense:
        """Whether smaller or larger is better."""
        return "larger"

    @property
    def quantities(self) -> tuple[str, ...]:
        """What it needs of a batch."""
        return ()

    def at(self, lanes: Lanes) -> Array:
        """Its value at every configuration, designs x configurations."""
        return np.asarray(lanes.reached, dtype=float)

    def of(self, lanes: Lanes) -> Vector:
        """One value a design."""
        return np.asarray(lanes.reached.mean(axis=1), dtype=float)
