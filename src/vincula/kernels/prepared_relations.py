"""What lanes need of the relations of a mechanism under its metrics, found once at one configuration.

Imported late, and only where numba is installed.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from vincula.analysis.ellipsoid import Kind
from vincula.analysis.recipes import magnification, motor_quantity, spectrum_of_kind, task_quantity
from vincula.arrays import Vector
from vincula.kernels.lane_relations import Squeezing
from vincula.kernels.lane_spectra import LaneRelation, RelationName, Sizes
from vincula.kernels.lanes.flatten import Unsupported
from vincula.kernels.lanes.metrics import APART, metric_constants
from vincula.mechanism.mechanism import Mechanism
from vincula.model import LinearModel
from vincula.numerics.lapack import singular_values
from vincula.numerics.metric import Metric
from vincula.weights import Weights

_KIND: Final[dict[RelationName, Kind]] = {
    "motions": "kinematic", "equilibria": "passive force", "internal forces": "internal force"
}  # fmt: skip


def relation_of(kind: Kind) -> RelationName:
    """The relation that an ellipsoid is made of."""
    return next((name for name, own in _KIND.items() if own == kind), "equilibria")


def lane_relation(
    mechanism: Mechanism, model: LinearModel, weights: Weights, name: RelationName
) -> LaneRelation | str:
    """A relation ready for lanes; or why only the reference path has it.

    Args:
        mechanism: The mechanism.
        model: Its matrices where all ranks are those of lanes that are certain.
        weights: Weights of all evaluations.
        name: Which relation.
    """
    kind = _KIND[name]
    task, motor = (weights.metric(side(kind), model) for side in (task_quantity, motor_quantity))
    of_task, of_motor = _factors(model, name)
    for metric, factor, side in (
        (task, of_task, task_quantity(kind)),
        (motor, of_motor, motor_quantity(kind)),
    ):
        if _spread(metric, factor) > APART:
            return f"weights of {side} differ by more than {APART**2:g} in units of the characteristic length"
    squeezing = Squeezing.of(mechanism, model) if name == "internal forces" else None
    if isinstance(squeezing, str):
        return squeezing
    found = spectrum_of_kind(kind, model, weights, task, motor)
    sizes = Sizes(found.infinite.shape[1], len(found.ratios), found.zero.shape[1], found.undefined)
    counted = (
        task.definite and motor.definite and not (task.required_zero.shape[1] or motor.required_zero.shape[1])
    )
    return LaneRelation(
        name, task, motor, of_task, of_motor, sizes, counted, magnification(model, task, motor), squeezing
    )


def weights_for_kernels(
    model: LinearModel, weights: Weights | None, used: Weights
) -> tuple[Weights | None, bool]:
    """Weights that kernels take, and whether they are others than those given.

    Kernels take positive weights of one size, one a component.  Where they are otherwise, lanes compute
    motions in scaled units, and the weights enter afterwards.

    Args:
        model: The mechanism.
        weights: Weights given; None for those of the mechanism.
        used: The same, resolved.
    """
    try:
        metric_constants(model, used.metric("twist", model), used.metric("rate", model))
    except Unsupported:
        return Weights(twist=model.scaled.twist**-2.0, rate=model.scaled.active_column**-2.0), True
    return weights, False


def _factors(model: LinearModel, name: RelationName) -> tuple[Vector, Vector]:
    """Factors from scaled to physical components of both sides, as in `analysis.relation`."""
    scaled = model.scaled
    if name == "motions":
        return scaled.twist, scaled.active_column
    return scaled.row if name == "internal forces" else 1.0 / scaled.twist, 1.0 / scaled.active_column


def _spread(metric: Metric, factor: Vector) -> float:
    """How much the sizes of what a metric weighs differ, in scaled components."""
    values = singular_values(np.asarray(metric.factor * factor))
    return float(values[0] / values[-1]) if len(values) else 1.0
