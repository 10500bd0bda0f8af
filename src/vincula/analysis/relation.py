"""The linear relations behind all the ellipsoids, each a pair of blocks with its two counts.

Source: theory page, sections 4 and 5.  The task side moves or pushes, the motor side pays for it:
twists and rates (eq. 1 with passive joints eliminated), wrenches and torques (eq. 15), internal
contact forces and torques (eqs. 22-23).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

from vincula.analysis.graded import GradedParts, graded_equilibria, graded_motions
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
        graded: For given sizes of the weights of the task and of the motor components (scaled), the
            parts of the relation to high relative accuracy; None where there is no such basis.
        alike: Whether the factors themselves are of one size: 1/100 to 100.
    """

    task: Matrix
    motor: Matrix
    task_factor: Vector
    motor_factor: Vector
    infinite: int
    zero: int
    orthonormal: bool
    doubt: float
    graded: Callable[[Vector, Vector], GradedParts] | None = None
    alike: bool = False

    @property
    def size(self) -> int:
        """Dimension k of the relation."""
        return int(self.task.shape[1])


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
        infinite=max(0, counts.indeterminacy),
        zero=max(0, counts.redundancy),
        orthonormal=True,
        doubt=ledger.subspace_doubt,
        graded=partial(graded_motions, model) if _consistent(model) else None,
        alike=_alike(model),
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
        infinite=max(0, counts.structural_wrenches),
        zero=max(0, counts.internal_torques),
        orthonormal=True,
        doubt=ledger.subspace_doubt,
        graded=partial(graded_equilibria, model) if _consistent(model) else None,
        alike=_alike(model),
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
        infinite=max(0, ledger.summary.static_indeterminacy),
        zero=0,
        orthonormal=False,
        doubt=ledger.subspace_doubt,
    )


def _consistent(model: LinearModel) -> bool:
    """Whether no rank decision contradicts another: dimensions then fit together."""
    return min(model.ledger.summary.as_dict().values()) >= 0


def _alike(model: LinearModel) -> bool:
    return model.length is None or 0.01 <= model.length <= 100.0
