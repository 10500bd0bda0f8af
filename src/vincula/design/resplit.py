"""The same linear model with other motors: columns change sides, nothing is computed again.

J_a and J_p are columns of one Jacobian; which of them are active is a choice that changes no number.  Motors
that drive a combination of axes are extra: one that is not chosen loses its column and its row.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from vincula.arrays import frozen
from vincula.errors import DuplicateNameError, UnknownNameError
from vincula.labels import BodyMotions, Column
from vincula.model import LinearModel
from vincula.weights import Weights, WeightSpec


def with_motors(model: LinearModel, motors: Sequence[str]) -> LinearModel:
    """A model with other active columns, at the same configuration and with the same cuts.

    The member's motions and forces are those of the mechanism linearised anew with these motors.  Proofs and
    the search for the nearest singular configuration belong to a choice of motors and are left out.

    Args:
        model: A model that has the columns.
        motors: Names of the columns that are to be active, in order.

    Raises:
        UnknownNameError: A name that is no column of the model.
        DuplicateNameError: A name given twice.
    """
    names = [column.name for column in model.columns]
    for name in motors:
        if name not in names:
            raise UnknownNameError("joint axis or motor", name, names)
        if list(motors).count(name) > 1:
            raise DuplicateNameError("motor", name)
    idle = {row.source for row in model.rows if row.kind == "drive" and row.source not in motors}
    active = [names.index(name) for name in motors]
    passive = [k for k, name in enumerate(names) if name not in motors and name not in idle]
    kept = [k for k, row in enumerate(model.rows) if row.kind != "drive" or row.source not in idle]
    jacobian = np.hstack([model.jacobian_active, model.jacobian_passive])[kept]
    columns = model.columns
    return replace(
        model,
        jacobian_active=jacobian[:, active],
        jacobian_passive=jacobian[:, passive],
        grasp=model.grasp[:, kept],
        rows=tuple(model.rows[k] for k in kept),
        motors=tuple(columns[k] for k in active),
        passives=tuple(columns[k] for k in passive),
        motions=None if model.motions is None else _reordered(model.motions, [*active, *passive]),
        exact=None,
        nearest=None,
    )


def weights_of_choice(
    weights: Weights | None, columns: Sequence[Column], motors: Sequence[str]
) -> Weights | None:
    """Weights without names that carry no motor in this choice.

    Rates and torques may be weighed by name for every joint that may ever carry a motor.  A name that no
    column has stays, and is refused when it is used.

    Args:
        weights: Weights with names of axes, joints or motors.
        columns: All columns of the model.
        motors: Names of the active ones.
    """
    if weights is None or not any(isinstance(spec, Mapping) for spec in (weights.rate, weights.torque)):
        return weights
    known = {name for column in columns for name in (column.name, column.joint)}
    used = {name for column in columns if column.name in motors for name in (column.name, column.joint)}
    unused = known - used
    return replace(weights, rate=_without(weights.rate, unused), torque=_without(weights.torque, unused))


def _without(spec: WeightSpec, unused: set[str]) -> WeightSpec:
    if not isinstance(spec, Mapping):
        return spec
    return {name: value for name, value in spec.items() if name not in unused}


def _reordered(motions: BodyMotions, order: Sequence[int]) -> BodyMotions:
    """Motions of bodies with the columns in another order."""
    return replace(motions, screws=frozen(motions.screws[:, order]), path=frozen(motions.path[:, order]))
