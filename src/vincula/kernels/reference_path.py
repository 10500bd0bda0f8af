"""One configuration after the other through the ordinary functions: the meaning of every batch.

Whatever the lanes compute is compared with this, and what they cannot decide comes here.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vincula.analysis import indices
from vincula.analysis.doubt import doubt_messages
from vincula.analysis.ellipsoid import Ellipsoid
from vincula.analysis.recipes import ellipsoid_of_kind, resolved_weights
from vincula.arrays import Vector
from vincula.errors import ClosureError, VinculaError
from vincula.kernels.evaluation import DOUBTFUL, FAILED, OK, OPEN
from vincula.kernels.quantities import CLASS_CODES, SIDE_OF, SUMMARY, Quantity
from vincula.kernels.samples import distances
from vincula.mechanism.branch_groups import Side
from vincula.mechanism.branches import branch_measures
from vincula.mechanism.configuration import Configuration
from vincula.mechanism.kinematics import body_poses, reference_position
from vincula.mechanism.mechanism import Mechanism
from vincula.model import LinearModel
from vincula.weights import Weights

Arrays = Mapping[str, NDArray[Any]]


@dataclass(frozen=True, slots=True)
class Outcome:
    """How one configuration came out.

    Attributes:
        status: Its status code.
        reason: Why it is not ok; empty when it is.
    """

    status: int
    reason: str = ""


class ReferencePath:
    """Evaluates chosen quantities one configuration at a time.

    Args:
        quantities: What is written.
        weights: Weights for all configurations; None for those of the mechanism.
        ranks: Ranks of the watched matrices in general, for `singularity.distance`.
    """

    def __init__(
        self, quantities: tuple[Quantity, ...], weights: Weights | None, ranks: tuple[int, ...] = ()
    ) -> None:
        self._weights, self._ranks = weights, ranks
        self._ellipsoids = [q for q in quantities if q.kind is not None]
        self._others = [q for q in quantities if q.kind is None and q.name not in _NOT_OF_THE_MODEL]
        self._configuration = any(q.name == "configuration" for q in quantities)
        self._all_ranks = any(q.name == "counts" for q in quantities)

    def fill(self, mechanism: Mechanism, flat: Vector, arrays: Arrays, lane: int) -> Outcome:
        """Evaluate one configuration and write it at its place.

        Args:
            mechanism: The mechanism with the geometry of this lane.
            flat: The configuration.
            arrays: One array a quantity, lanes first; they hold their fill values here.
            lane: Where to write.
        """
        try:
            q = mechanism.home.from_flat(flat)
            outcome = self._evaluated(mechanism, q, arrays, lane)
        except VinculaError as error:
            outcome = Outcome(FAILED, str(error))
        arrays["status"][lane] = outcome.status
        return outcome

    def _evaluated(self, mechanism: Mechanism, q: Configuration, arrays: Arrays, lane: int) -> Outcome:
        if self._configuration:
            arrays["configuration"][lane] = q.flat
        try:
            model = mechanism.linearize(q)
        except ClosureError as error:
            if "closure.residual" in arrays:
                arrays["closure.residual"][lane] = error.gap
            return Outcome(OPEN, str(error))
        ledger = model.ledger
        summary = ledger.summary
        if self._all_ranks:
            ledger.counts  # noqa: B018  decides the other four ranks
        reason = doubt_of(model)
        for quantity in self._others:
            if quantity.part == "singularity.distance":
                arrays[quantity.name][lane] = distances(model, self._ranks)
            else:
                arrays[quantity.name][lane] = _OF_MODEL[quantity.part](mechanism, q, model)
        if min(summary.as_dict().values()) >= 0:
            self._fill_ellipsoids(model, arrays, lane)
        return Outcome(DOUBTFUL if reason else OK, reason)

    def _fill_ellipsoids(self, model: LinearModel, arrays: Arrays, lane: int) -> None:
        weights = resolved_weights(model, self._weights)
        found: dict[str, Ellipsoid] = {}
        for quantity in self._ellipsoids:
            kind = quantity.kind
            if kind is None:
                continue
            if kind not in found:
                found[kind] = ellipsoid_of_kind(kind, model, weights)
            write_ellipsoid(quantity, found[kind], arrays[quantity.name], lane)


def doubt_of(model: LinearModel) -> str:
    """Why the ranks decided so far are in doubt, in words; empty when they are certain."""
    negative = [name for name, count in model.ledger.summary.as_dict().items() if count < 0]
    if negative:
        return f"the rank decisions contradict each other: {', '.join(negative)} would be negative"
    return "  ".join(doubt_messages(model)) if model.ledger.status == "doubtful" else ""


def write_ellipsoid(quantity: Quantity, ellipsoid: Ellipsoid, array: NDArray[Any], lane: int) -> None:
    """Write one quantity of an ellipsoid at the place of its configuration."""
    count = len(ellipsoid.classes)
    if quantity.part == "efficiencies":
        array[lane, :count] = ellipsoid.efficiencies
    elif quantity.part == "classes":
        array[lane, :count] = [CLASS_CODES[name] for name in ellipsoid.classes]
    elif quantity.part in ("task_directions", "motor_directions"):
        for entry, direction in enumerate(getattr(ellipsoid, quantity.part)):
            if direction is not None:
                array[lane, entry] = direction
    elif quantity.part == "bounds":
        array[lane, :count] = [
            max(upper - value, value - lower) if name == "finite" else 0.0 if name != "undefined" else np.nan
            for value, name, (lower, upper) in zip(
                ellipsoid.efficiencies, ellipsoid.classes, ellipsoid.bounds, strict=True
            )
        ]
    elif quantity.part in ("smallest", "largest"):
        finite = ellipsoid.finite
        if len(finite):
            array[lane] = finite[-1 if quantity.part == "smallest" else 0]
    else:
        array[lane] = _INDEX[quantity.part](ellipsoid, quantity.on)


def pose_of_reference(mechanism: Mechanism, q: Configuration) -> Vector:
    """Reference point and body axes of the reference member: x y angle, or x y z qw qx qy qz, qw >= 0."""
    poses = body_poses(mechanism, q)
    body = poses[mechanism.reference.body if mechanism.reference else "ground"]
    point = reference_position(mechanism, poses)
    if len(point) == 2:
        return np.array([*point, np.arctan2(body.rotation[1, 0], body.rotation[0, 0])])
    return np.concatenate([point, body.as_quaternion_wxyz()])


_INDEX: Mapping[str, Callable[..., float]] = {
    "yoshikawa_volume": indices.yoshikawa_volume,
    "condition": indices.condition_number,
    "condition_number": indices.condition_number,
    "inverse_condition_number": indices.inverse_condition_number,
    "isotropy": indices.isotropy,
    "smallest_singular_value": indices.smallest_singular_value,
}


def _count(name: str) -> Callable[[Mechanism, Configuration, LinearModel], int]:
    return lambda _mechanism, _q, model: int(getattr(model.ledger.summary, name))


def _branch(side: Side) -> Callable[[Mechanism, Configuration, LinearModel], Vector]:
    return lambda mechanism, _q, model: branch_measures(mechanism, model, side)


_OF_MODEL: Mapping[str, Callable[[Mechanism, Configuration, LinearModel], Any]] = {
    "counts": lambda _mechanism, _q, model: list(model.ledger.counts.as_dict().values()),
    "summary": lambda _mechanism, _q, model: list(model.ledger.summary.as_dict().values()),
    "closure.residual": lambda _mechanism, _q, model: model.uncertainty.residual,
    "reference.pose": lambda mechanism, q, _model: pose_of_reference(mechanism, q),
    **{name: _count(name) for name in SUMMARY},
    **{name: _branch(side) for name, side in SIDE_OF.items()},
}
_NOT_OF_THE_MODEL = frozenset({"status", "configuration", "closure.iterations"})
