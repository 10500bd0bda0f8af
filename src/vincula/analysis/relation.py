"""The linear relations behind all the ellipsoids, each a pair of blocks with its two counts.

Source: theory page, sections 4 and 5.  The task side moves or pushes, the motor side pays for it:
twists and rates (eq. 1 with passive joints eliminated), wrenches and torques (eq. 15), internal
contact forces and torques (eqs. 22-23).
"""

from __future__ import annotations

from dataclasses import dataclass

from vincula.arrays import Matrix, Vector
from vincula.model import LinearModel


@dataclass(frozen=True, slots=True, eq=False)
class Relation:
    """A subspace of (task, motor) pairs, in scaled coordinates.

    Attributes:
        task: t x k block of the basis; physical values are task_factor times these.
        motor: r x k block.
        task_factor: t factors from scaled to physical.
        motor_factor: r factors from scaled to physical.
        infinite: Dimension of the pairs with motor side zero, from the ledger.
        zero: Dimension of the pairs with task side zero, from the ledger.
        orthonormal: Whether the stacked basis (task; motor) is orthonormal.
        doubt: Relative uncertainty of the subspace.
    """

    task: Matrix
    motor: Matrix
    task_factor: Vector
    motor_factor: Vector
    infinite: int
    zero: int
    orthonormal: bool
    doubt: float


def kinematic_relation(model: LinearModel) -> Relation:
    """M = {(q_a, u)}: twists of the member and the motor rates that go with them (eqs. 8-13)."""
    ledger = model.ledger
    motions, _ = ledger.subspaces.motions_and_equilibria
    n_a = len(model.motors)
    counts = ledger.summary
    return Relation(
        task=motions[n_a:],
        motor=motions[:n_a],
        task_factor=model.scaled.twist,
        motor_factor=model.scaled.active_column,
        infinite=counts.indeterminacy,
        zero=counts.redundancy,
        orthonormal=True,
        doubt=ledger.subspace_doubt,
    )


def force_relation(model: LinearModel) -> Relation:
    """F = {(tau, w)}: wrenches on the member and the torques that balance them (eqs. 15, 19-21, 24)."""
    ledger = model.ledger
    _, equilibria = ledger.subspaces.motions_and_equilibria
    n_a = len(model.motors)
    counts = ledger.summary
    return Relation(
        task=equilibria[n_a:],
        motor=equilibria[:n_a],
        task_factor=1.0 / model.scaled.twist,
        motor_factor=1.0 / model.scaled.active_column,
        infinite=counts.structural_wrenches,
        zero=counts.internal_torques,
        orthonormal=True,
        doubt=ledger.subspace_doubt,
    )


def internal_relation(model: LinearModel) -> Relation:
    """{(f, tau): G f = 0, J_p^T f = 0, tau = -J_a^T f}: squeezing forces and their torques (22)-(23)."""
    ledger = model.ledger
    forces = ledger.subspaces.left_kernel("passive+member")
    return Relation(
        task=forces,
        motor=-model.scaled.active.T @ forces,
        task_factor=model.scaled.row,
        motor_factor=1.0 / model.scaled.active_column,
        infinite=ledger.summary.static_indeterminacy,
        zero=0,
        orthonormal=False,
        doubt=ledger.subspace_doubt,
    )
