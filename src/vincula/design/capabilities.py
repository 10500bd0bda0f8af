"""Speed, stiffness and force along a direction, as measures of a design."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, final

import numpy as np

from vincula.design.measures import Array, Measure, Sense
from vincula.errors import ModelError
from vincula.kernels.quantities import CLASS_CODES
from vincula.numerics.rank import negligible

if TYPE_CHECKING:
    from vincula.design.lanes import Lanes
    from vincula.kernels.compiled import CompiledMechanism

_OF_SPEED: Final = ("kinematic.efficiencies", "kinematic.classes", "kinematic.task_directions")
"""What `_largest_along` needs of a batch."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Directed(Measure):
    """A measure along one direction, the larger the better.

    Attributes:
        direction: Components of a twist or a wrench, order and units as `Space.twist_components`.
    """

    direction: tuple[float, ...]

    @property
    def better(self) -> Sense:
        """Whether smaller or larger is better."""
        return "larger"

    def check(self, compiled: CompiledMechanism) -> None:
        """Refuse a mechanism that it does not fit."""
        _refuse_direction(self.direction, compiled)


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Speed(Directed):
    """Largest component of the member's twist along a direction, for a unit of motor effort.

    Attributes:
        direction: Components of the twist, order and units as `Space.twist_components`.
    """

    @property
    def title(self) -> str:
        """What it is, in words."""
        return f"speed along {_said(self.direction)}"

    @property
    def quantities(self) -> tuple[str, ...]:
        """What it needs of a batch."""
        return _OF_SPEED

    def at(self, lanes: Lanes) -> Array:
        """Its value at every configuration, designs x configurations."""
        return _largest_along(lanes, self.direction)


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Stiffness(Directed):
    """Stiffness of the member along a direction when the motors are springs and everything else is rigid.

    A load F along the unit direction d moves the member by F d'Cd along it, C = J W_q^-1 J' with the
    weights of the motors as stiffnesses of their springs; d'Cd is the square of the largest speed along d
    (kinematic ellipsoid, eq. 13).  With unit weights it is therefore N/m for springs of 1 N m/rad or 1 N/m.
    Infinite where the motors cannot move the member along d, zero where it is free with motors locked.

    Attributes:
        direction: Components of the twist, order and units as `Space.twist_components`; made a unit vector.
        against: Another direction: the measure is the ratio of the two stiffnesses; None for no ratio.
    """

    against: tuple[float, ...] | None = None

    @property
    def title(self) -> str:
        """What it is, in words."""
        other = "" if self.against is None else f" over that along {_said(self.against)}"
        return f"stiffness along {_said(self.direction)}{other}"

    @property
    def quantities(self) -> tuple[str, ...]:
        """What it needs of a batch."""
        return _OF_SPEED

    def check(self, compiled: CompiledMechanism) -> None:
        """Refuse a mechanism that it does not fit."""
        Directed.check(self, compiled)
        if self.against is not None:
            _refuse_direction(self.against, compiled)

    def at(self, lanes: Lanes) -> Array:
        """Its value at every configuration, designs x configurations; NaN for a ratio that is 0/0."""
        yielding = _largest_along(lanes, _unit(self.direction)) ** 2
        other = 1.0 if self.against is None else _largest_along(lanes, _unit(self.against)) ** 2
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(other / yielding)


def _largest_along(lanes: Lanes, direction: Sequence[float]) -> Array:
    """Largest component of the twist along a direction for a unit of motor effort: the support function."""
    values, classes = lanes["kinematic.efficiencies"], lanes["kinematic.classes"]
    along = lanes["kinematic.task_directions"] @ np.asarray(direction)
    finite = classes == CLASS_CODES["finite"]
    squares = np.where(finite, np.where(finite, values, 0.0) * np.where(finite, along, 0.0) ** 2, 0.0)
    free = (classes == CLASS_CODES["infinite"]).any(axis=-1)
    return np.asarray(np.where(free, np.inf, np.sqrt(squares.sum(axis=-1))))


def _unit(direction: Sequence[float]) -> tuple[float, ...]:
    values = np.asarray(direction, dtype=float)
    return tuple((values / np.linalg.norm(values)).tolist())


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Force(Directed):
    """Largest load along a direction that a unit of motor torque resists (passive force ellipsoid, eq. 21).

    Infinite where the structure carries it with no torque.

    Attributes:
        direction: Components of the wrench, order and units as `Space.wrench_components`.
    """

    @property
    def title(self) -> str:
        """What it is, in words."""
        return f"force along {_said(self.direction)}"

    @property
    def quantities(self) -> tuple[str, ...]:
        """What it needs of a batch."""
        parts = ("efficiencies", "classes", "task_directions")
        return (*(f"passive_force.{part}" for part in parts), "configuration")

    def at(self, lanes: Lanes) -> Array:
        """Its value at every configuration, designs x configurations."""
        from vincula.analysis.manipulability import passive_force_ellipsoid

        load = np.asarray(self.direction)
        metric = lanes.metric("wrench")
        values, classes = lanes["passive_force.efficiencies"], lanes["passive_force.classes"]
        shares = lanes["passive_force.task_directions"] @ (metric.matrix @ load)
        finite, free = (classes == CLASS_CODES[kind] for kind in ("finite", "infinite"))
        whole = metric.definite & ((finite | free).sum(axis=-1) == len(load))
        size = float(np.linalg.norm(metric.factor @ load))
        with np.errstate(invalid="ignore", divide="ignore"):
            parts = np.where(finite, shares, 0.0) ** 2
            length: Any = np.sqrt(parts.sum(axis=-1))
            carried = negligible(length, size)
            most = 1.0 / np.sqrt((parts / np.where(finite, values, 1.0)).sum(axis=-1))
            found = np.where(lanes.reached, np.where(carried, np.inf, most), np.nan)
        for place in zip(*np.nonzero(lanes.reached & ~whole), strict=True):
            # Some wrench moves the member or is not weighed: the set itself says whether this one does.
            model = lanes.model(*map(int, place))
            found[place] = passive_force_ellipsoid(model, lanes.weights).along(load)
        return np.asarray(found)


def _said(direction: Sequence[float]) -> str:
    return "(" + ", ".join(f"{x:g}" for x in direction) + ")"


def _refuse_direction(direction: Sequence[float], compiled: CompiledMechanism) -> None:
    size = compiled.mechanism.space.dimension
    values: Any = np.asarray(direction, dtype=float)
    if values.shape != (size,) or not np.isfinite(values).all() or not values.any():
        raise ModelError(f"direction {_said(direction)}: give {size} finite numbers, not all zero")
