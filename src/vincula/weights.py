"""Weights: what a metre is worth beside a radian, a fast motor beside a slow one.

W_q, W_u, W_tau, W_w, W_f of the paper are `rate`, `twist`, `torque`, `wrench`, `contact_force`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from vincula.arrays import Vector, checked, frozen
from vincula.errors import NonFiniteError, ShapeError, UnknownNameError, WeightError, listing
from vincula.spatial.space import Space

if TYPE_CHECKING:
    from vincula.model import LinearModel
    from vincula.numerics.metric import Metric

WeightSpec = ArrayLike | Mapping[str, float] | Literal["all rows"] | None
Quantity = Literal["rate", "twist", "torque", "wrench", "contact_force"]
QUANTITIES: tuple[Quantity, ...] = get_args(Quantity)
LARGEST = 1e100
"""Weights above this, or below one over this but not zero, are refused: their products would overflow."""


@dataclass(frozen=True, eq=False)
class Weights:
    """The five weights, in m, rad, N, N m.  What is not given is the identity.

    A weight is a number (times the identity), a list (one number a component), a mapping from names
    to numbers (what is not named weighs 1), or a symmetric matrix.  Zero ignores a component.

    Attributes:
        rate: W_q on the active rates; names are motors or their joints.
        twist: W_u on the twist; names are its components (vx ... wz).
        torque: W_tau on the motor torques; names as for `rate`.
        wrench: W_w on the wrench; names are its components (fx ... mz).
        contact_force: W_f on the constraint forces; names are rows or their sources.  Not given: 1 on
            contact and member-cut rows, 0 on the others; "all rows": 1 on all.
        reciprocal: True sets torque = rate^-1 and wrench = twist^-1.
        explicit: False for weights that nobody chose: mixed units are then warned about.
    """

    rate: WeightSpec = None
    twist: WeightSpec = None
    torque: WeightSpec = None
    wrench: WeightSpec = None
    contact_force: WeightSpec = None
    reciprocal: bool = False
    explicit: bool = True

    def __post_init__(self) -> None:
        for name in QUANTITIES:
            spec = getattr(self, name)
            if isinstance(spec, Mapping):
                spec = dict(spec)
                for key, value in spec.items():
                    _refuse_bad_number(value, f"{name}[{key!r}]")
            elif isinstance(spec, str):
                if name != "contact_force" or spec != "all rows":
                    raise WeightError(
                        f"weight {name} is {spec!r}: give numbers, names with numbers, or a matrix"
                    )
            elif spec is not None:
                spec = _checked_numbers(spec, name)
            object.__setattr__(self, name, spec)
        if self.reciprocal and (self.torque is not None or self.wrench is not None):
            raise WeightError(
                "weights: reciprocal=True sets torque and wrench; leave them out, or reciprocal off"
            )

    @staticmethod
    def from_mapping(mapping: Mapping[str, object]) -> Weights:
        """Weights from a mapping with the names of the attributes, as in a file.

        Raises:
            UnknownNameError: A key that is not a weight.
            WeightError: A value that cannot be a weight.
        """
        known = (*QUANTITIES, "reciprocal")
        for key in mapping:
            if key not in known:
                raise UnknownNameError("weight", str(key), known)
        return Weights(**mapping)  # type: ignore[arg-type]

    @property
    def dual(self) -> bool:
        """Whether torques and wrenches are measured by the reciprocals of the metrics of motion."""
        given = (self.rate, self.twist, self.torque, self.wrench)
        return self.reciprocal or all(spec is None for spec in given)

    def metric(self, quantity: Quantity, model: LinearModel) -> Metric:
        """The metric of one quantity for a model.

        Raises:
            WeightError: Wrong size, not symmetric, negative or indefinite.
            UnknownNameError: A name that the model does not have.
        """
        from vincula.numerics.metric import identity_metric

        if self.reciprocal and quantity in ("torque", "wrench"):
            base = self.metric("rate" if quantity == "torque" else "twist", model)
            return base if base.unit else base.reciprocal()
        spec = getattr(self, quantity)
        names = _names_of(quantity, model)
        if quantity == "contact_force" and spec is None:
            spec = [float(r.kind in ("contact", "member cut")) for r in model.rows]
        if spec is None or isinstance(spec, str):
            return identity_metric(len(names))
        return metric_of(spec, quantity, names)


UNIT = Weights(explicit=False)
"""The weights used when nobody gave any."""


def characteristic_length_weights(length: float, space: Space | LinearModel) -> Weights:
    """Weights that make radians comparable to metres: an angle counts as the arc it cuts at `length`.

    Twist weights are 1 for translations and length^2 for rotations; with a model also the rates of
    revolute motors get length^2.  Torque and wrench are reciprocal.

    Args:
        length: Characteristic length [m].
        space: PLANAR or SPATIAL, or a model.

    Raises:
        WeightError: The length is not positive.
    """
    if not (math.isfinite(length) and length > 0.0):
        raise WeightError(f"characteristic length is {length}: give a positive length in metres")
    square = length * length
    if isinstance(space, Space):
        return Weights(twist=[1.0] * space.translations + [square] * space.rotations, reciprocal=True)
    return Weights(
        twist=[1.0 if linear else square for linear in space.twist_linear],
        rate=[1.0 if motor.linear else square for motor in space.motors],
        reciprocal=True,
    )


def metric_of(spec: object, quantity: str, names: Sequence[tuple[str, ...]]) -> Metric:
    """The metric of one weight on named components.

    Args:
        spec: A number, a list, a mapping or a matrix.
        quantity: What it weighs, for messages.
        names: Names of every component.

    Raises:
        WeightError: Wrong size, not symmetric, negative or indefinite.
        UnknownNameError: A name that is not that of a component.
    """
    from vincula.numerics.metric import metric_of_diagonal, metric_of_matrix

    size = len(names)
    if isinstance(spec, Mapping):
        return metric_of_diagonal(_by_name(spec, quantity, names))
    array = np.asarray(spec, dtype=float)
    if array.ndim == 0:
        array = np.full(size, float(array))
    if array.shape not in ((size,), (size, size)):
        raise WeightError(
            f"weight {quantity} has shape {array.shape}, expected {size} numbers or a {size} x {size} matrix "
            f"for {listing(group[0] for group in names)}"
        )
    return metric_of_diagonal(array) if array.ndim == 1 else metric_of_matrix(array, quantity)


def _by_name(spec: Mapping[str, float], quantity: str, names: Sequence[tuple[str, ...]]) -> Vector:
    weights = np.ones(len(names))
    for key, value in spec.items():
        exact = [i for i, group in enumerate(names) if group[0] == key]
        found = exact or [i for i, group in enumerate(names) if key in group]
        if not found:
            raise UnknownNameError(f"{quantity} component", key, _every(names))
        weights[found] = value
    return weights


def _every(names: Iterable[tuple[str, ...]]) -> list[str]:
    return list(dict.fromkeys(name for group in names for name in group))


def _names_of(quantity: Quantity, model: LinearModel) -> list[tuple[str, ...]]:
    if quantity in ("rate", "torque"):
        return [(motor.name, motor.joint) for motor in model.motors]
    if quantity == "contact_force":
        return [(row.name, row.source) for row in model.rows]
    components = model.twist_components if quantity == "twist" else model.wrench_components
    return [(name,) for name in components]


def _checked_numbers(spec: object, name: str) -> Vector:
    dimensions = np.ndim(np.asarray(spec, dtype=object)) if not isinstance(spec, np.ndarray) else spec.ndim
    if dimensions > 2:
        raise WeightError(f"weight {name} has {dimensions} dimensions: give numbers or a square matrix")
    try:
        array = checked(spec, f"weight {name}", (None,) * dimensions)  # type: ignore[arg-type]
    except (NonFiniteError, ShapeError) as problem:
        raise WeightError(f"{problem}; weights are zero (ignored) or positive numbers") from None
    if dimensions == 2 and array.shape[0] != array.shape[1]:
        raise WeightError(f"weight {name} has shape {array.shape}: a matrix of weights must be square")
    if dimensions == 2:
        sizes, least = np.diag(array), 1.0 / LARGEST
        if np.abs(array).max(initial=0.0) > LARGEST or sizes[sizes > 0.0].min(initial=1.0) < least:
            raise WeightError(f"weight {name}: components are zero or from {least:g} to {LARGEST:g} in size")
    if dimensions < 2:
        for index, value in enumerate(np.atleast_1d(array)):
            _refuse_bad_number(float(value), f"{name}[{index}]" if dimensions else name)
    return frozen(array)


def _refuse_bad_number(value: object, place: str) -> None:
    good = isinstance(value, (int, float, np.integer, np.floating)) and not isinstance(value, bool)
    if not good or not math.isfinite(float(value)) or float(value) < 0.0:  # type: ignore[arg-type]
        raise WeightError(f"weight {place} is {value}: weights are zero (ignored) or positive, and finite")
    if value and not 1.0 / LARGEST <= float(value) <= LARGEST:  # type: ignore[arg-type]
        raise WeightError(
            f"weight {place} is {value}: weights are zero or from {1.0 / LARGEST:g} to {LARGEST:g}"
        )
