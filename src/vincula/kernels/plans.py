"""What a list of quantities needs, checked once: names, weights, units; then used at every call."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import get_args

import numpy as np

from vincula.analysis.doubt import mixed_units_message
from vincula.analysis.recipes import ellipsoid_of_kind, resolved_weights, task_quantity
from vincula.errors import MixedUnitsWarning
from vincula.kernels.quantities import INDICES, Quantity, chosen
from vincula.kernels.reference_path import ReferencePath, write_ellipsoid
from vincula.kernels.samples import general_ranks
from vincula.mechanism.mechanism import Mechanism
from vincula.mechanism.motor_weights import weights_of_motors
from vincula.model import LinearModel
from vincula.weights import Quantity as Weighed
from vincula.weights import Weights


@dataclass(frozen=True, slots=True, eq=False)
class Plan:
    """A checked list of quantities.

    Attributes:
        quantities: What is computed, `status` first.
        reference: The reference path for them.
        by_name: The quantities by name.
    """

    quantities: tuple[Quantity, ...]
    reference: ReferencePath
    by_name: Mapping[str, Quantity] = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "by_name", {quantity.name: quantity for quantity in self.quantities})


def plan_for(
    mechanism: Mechanism, known: Mapping[str, Quantity], names: Iterable[str], weights: Weights | None
) -> Plan:
    """The plan of a list of quantities.

    Raises:
        UnknownNameError: A name that is no quantity.
        MixedUnitsError: An index over metres and radians with weights that nobody chose.
        ModelError: An index of components that do not exist.

    Warns:
        MixedUnitsWarning: Metres and radians are added with weights that nobody chose.
    """
    quantities = chosen(known, names)
    model = model_without_numbers(mechanism)
    used = resolved_weights(model, weights)
    for quantity in quantities:
        if quantity.kind is not None and quantity.part in INDICES:
            # Whether an index exists depends on names, units and weights alone: it is refused here, once.
            probe = ellipsoid_of_kind(quantity.kind, model, used)
            write_ellipsoid(quantity, probe, quantity.empty(1), 0)
    kinds = {quantity.kind for quantity in quantities if quantity.kind is not None}
    for message in dict.fromkeys(mixed_units_message(model, used, task_quantity(k)) for k in sorted(kinds)):
        if message:
            warnings.warn(message, MixedUnitsWarning, stacklevel=4)
    ranks = general_ranks(mechanism) if any(q.name == "singularity.distance" for q in quantities) else ()
    return Plan(quantities, ReferencePath(quantities, weights, ranks))


def refuse_bad_weights(mechanism: Mechanism, weights: Weights | None) -> None:
    """Refuse weights that do not fit the mechanism before anything is computed.

    Raises:
        WeightError: Wrong size, not symmetric, negative or indefinite.
        UnknownNameError: A name that the mechanism does not have.
        MissingReferenceError: No reference member is named.
    """
    model = model_without_numbers(mechanism)
    used = resolved_weights(model, weights)
    for quantity in get_args(Weighed):
        used.metric(quantity, model)


def model_without_numbers(mechanism: Mechanism) -> LinearModel:
    """The linear model with its names, units and weights, all matrices zero: what does not depend on q."""
    layout = mechanism.layout
    rows, d = len(layout.rows), mechanism.space.dimension
    reference = mechanism.reference
    return LinearModel(
        jacobian_active=np.zeros((rows, len(layout.active))),
        jacobian_passive=np.zeros((rows, len(layout.passive))),
        grasp=np.zeros((d, rows)),
        rows=layout.rows,
        motors=tuple(layout.columns[k] for k in layout.active),
        passives=tuple(layout.columns[k] for k in layout.passive),
        space=mechanism.space,
        length=mechanism.length,
        mechanism=mechanism.name,
        reference=(reference.label or reference.body) if reference else "member",
        weights=weights_of_motors(mechanism),
    )
