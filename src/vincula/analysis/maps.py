"""The rate map and the torque map: the two matrices that many users come for.

Source: theory page, sections 4 and 5: u = T q_a for motor rates that the loops allow, tau = S w for the
motor torques that balance a wrench.
"""

from __future__ import annotations

from dataclasses import dataclass

from vincula.analysis.relation import force_relation, kinematic_relation
from vincula.analysis.spectrum import spectrum
from vincula.arrays import Matrix, frozen
from vincula.model import LinearModel
from vincula.numerics.metric import Metric


@dataclass(frozen=True, slots=True, eq=False)
class LinearMap:
    """A matrix with units, or the reason why there is none.

    Attributes:
        matrix: rows x columns; None where it is undefined.
        rows: Names of the rows.
        columns: Names of the columns.
        row_units: Units of the results.
        column_units: Units of the arguments.
        reason: Why there is no such map; empty when there is one.
        note: What the matrix does beyond the plain map; empty when it is just that.
    """

    matrix: Matrix | None
    rows: tuple[str, ...]
    columns: tuple[str, ...]
    row_units: tuple[str, ...]
    column_units: tuple[str, ...]
    reason: str
    note: str


def twist_from_rates(model: LinearModel, twist: Metric, rate: Metric) -> LinearMap:
    """d x n_a matrix T with u = T q_a.

    Rates that the loops do not allow are projected on the allowed ones, least error in W_q.

    Args:
        model: The mechanism at one configuration.
        twist: W_u, definite.
        rate: W_q, definite.
    """
    counts = model.ledger.summary
    matrix, reason, note = None, _undetermined_reason(model), ""
    if not reason:
        found = spectrum(kinematic_relation(model), twist, rate)
        matrix = frozen((found.task * found.ratios) @ (found.motor.T @ rate.matrix))
    if counts.internal_torques:
        note = (
            f"the loops tie the motors together by {counts.internal_torques} conditions: other rates are "
            "projected on the allowed ones (least error in the rate metric)"
        )
    units = tuple("m/s" if c.linear else "rad/s" for c in model.motors)
    names = tuple(c.name for c in model.motors)
    return LinearMap(
        matrix, model.twist_components, names, model.twist_units, units, reason, "" if reason else note
    )


def torque_from_wrench(model: LinearModel, wrench: Metric, torque: Metric) -> LinearMap:
    """n_a x d matrix S with tau = S w: motor torques that balance the wrench w on the member.

    w acts on the member from outside (15); a member that pushes with p needs tau = -S p.  Internal
    torques are left out: least torque in W_tau.

    Args:
        model: The mechanism at one configuration.
        wrench: W_w, definite.
        torque: W_tau, definite.
    """
    counts = model.ledger.summary
    matrix, reason, note = None, "", ""
    if counts.indeterminacy:
        reason = (
            f"not every wrench can be balanced: {model.reference} can move in {counts.indeterminacy} "
            "direction(s) with all motors locked, and yields to a wrench along them"
        )
    else:
        found = spectrum(force_relation(model), wrench, torque)
        matrix = frozen((found.motor / found.ratios) @ (found.task.T @ wrench.matrix))
    if counts.internal_torques and not reason:
        note = f"{counts.internal_torques} internal torques may be added freely: these are the least ones"
    units = tuple("N" if c.linear else "N m" for c in model.motors)
    names = tuple(c.name for c in model.motors)
    return LinearMap(matrix, names, model.wrench_components, units, model.wrench_units, reason, note)


def _undetermined_reason(model: LinearModel) -> str:
    count = model.ledger.summary.indeterminacy
    if not count:
        return ""
    return (
        f"the motor rates do not determine the twist: {model.reference} can move in {count} direction(s) "
        "with all motors locked"
    )
