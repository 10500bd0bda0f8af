"""The four parts of a relation: infinite, finite, zero, undefined; dimensions first, weights later.

Source: theory page, section 4; numerics page, step 5.  Everything here is decided on unweighted
orthonormal bases, so that weights can never change a count.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vincula.analysis.relation import Relation
from vincula.arrays import Matrix, Vector
from vincula.numerics.lapack import svd
from vincula.numerics.metric import Metric
from vincula.numerics.rank import decide_rank


@dataclass(frozen=True, slots=True, eq=False)
class Parts:
    """Bases of the parts, scaled coordinates.

    Attributes:
        infinite: Task side of the pairs whose motor side is zero.
        finite_task: Task side of the finite part: a complement of the others.
        finite_motor: Its motor side.
        zero: Motor side of the pairs whose task side is zero.
        undefined: Number of pairs that no metric weighs.
        graded: Whether the weights call for long arithmetic.
    """

    infinite: Matrix
    finite_task: Matrix
    finite_motor: Matrix
    zero: Matrix
    undefined: int
    graded: bool = False


GRADED = 100.0
"""Weights whose roots differ by more than this call for a basis that is accurate entry by entry."""

LONG = 1e4
"""Weights whose roots differ by more than this call for long arithmetic as well."""


def graded_parts(relation: Relation, task: Metric, motor: Metric) -> Parts | None:
    """The parts for diagonal weights of very different size; None where weights are of one size."""
    if relation.graded is None or (task.unit and motor.unit and relation.alike):
        return None
    weights = task.diagonal, motor.diagonal
    regular = relation.infinite >= 0 and relation.size >= relation.infinite + relation.zero
    if not regular or not (task.definite and motor.definite):
        return None
    if weights[0] is None or weights[1] is None:
        return None
    sizes = np.sqrt(weights[0]) * relation.task_factor, np.sqrt(weights[1]) * relation.motor_factor
    if max(_grading(sizes[0]), _grading(sizes[1])) <= GRADED:
        return None
    found = relation.graded(*sizes)
    long = max(_grading(sizes[0]), _grading(sizes[1])) > LONG
    return Parts(found.infinite, found.finite_task, found.finite_motor, found.zero, 0, graded=long)


def _grading(sizes: Vector) -> float:
    return float(sizes.max() / sizes.min()) if len(sizes) else 1.0


def sectioned(relation: Relation, task: Metric, motor: Metric) -> Relation:
    """The part of the relation that vanishes on every component required to be zero."""
    if not (task.required_zero.shape[1] or motor.required_zero.shape[1]):
        return relation
    conditions = np.vstack(
        [
            _unit_rows(metric.required_zero.T * factor) @ block
            for metric, factor, block in (
                (task, relation.task_factor, relation.task),
                (motor, relation.motor_factor, relation.motor),
            )
        ]
    )
    decision = decide_rank(
        conditions, name="required zeros", scale=1.0, uncertainty={"subspace": relation.doubt}
    )
    kept = svd(conditions)[2][:, decision.rank :]
    # Nearly dependent conditions turn what is left: the next decisions must know.
    doubt = min(1.0, decision.cutoff / decision.kept + relation.doubt)
    return Relation(
        relation.task @ kept, relation.motor @ kept, relation.task_factor, relation.motor_factor,
        -1, -1, relation.orthonormal, doubt,
    )  # fmt: skip


def split_parts(relation: Relation, task: Metric, motor: Metric) -> Parts:
    """Infinite, finite, zero and undefined parts, decided on unweighted orthonormal bases."""
    k = relation.task.shape[1]
    counted = task.definite and motor.definite and relation.infinite >= 0
    room = min(relation.task.shape[0], relation.motor.shape[0])
    if counted and relation.infinite == 0 and relation.zero == 0 and k <= room:
        return Parts(relation.task[:, :0], relation.task, relation.motor, relation.motor[:, :0], 0)
    basis = np.eye(k)
    if not relation.orthonormal:
        basis = _orthonormalising(np.vstack([relation.task, relation.motor]), k)
    rows_task = _row_space(task, relation.task_factor) @ relation.task
    rows_motor = _row_space(motor, relation.motor_factor) @ relation.motor
    if counted:
        # Contradictory rank decisions (flagged by the counts) must still leave bases of a kind.
        infinite = min(max(relation.infinite, k - relation.motor.shape[0]), k)
        zero, undefined = min(max(relation.zero, k - relation.task.shape[0]), k - infinite), 0
    else:
        rows = rows_task @ basis, rows_motor @ basis
        infinite, zero, undefined = _decided_counts(relation, task, motor, *rows)
        basis = basis @ _orthonormalising(np.vstack(rows), k - undefined)
    rest, free = _separated(rows_motor @ basis, basis, infinite)
    rest, idle = _separated(rows_task @ rest, rest, zero)
    return Parts(
        relation.task @ free, relation.task @ rest, relation.motor @ rest, relation.motor @ idle, undefined
    )


def _decided_counts(
    relation: Relation, task: Metric, motor: Metric, rows_task: Matrix, rows_motor: Matrix
) -> tuple[int, int, int]:
    """Infinite, zero and undefined counts where a metric ignores something.

    A side that is weighed completely keeps the count of the ledger; the others are decided on
    orthonormal rows, never on weighted ones.
    """
    k = rows_task.shape[1]
    doubt = {"subspace": relation.doubt}
    both = decide_rank(
        np.vstack([rows_task, rows_motor]), name="weighted relation", scale=1.0, uncertainty=doubt
    ).rank
    known = relation.infinite >= 0
    of_task, of_motor = (
        k - count
        if known and metric.definite
        else decide_rank(rows, name=f"weighted {side}", scale=1.0, uncertainty=doubt).rank
        for side, metric, rows, count in (
            ("task", task, rows_task, relation.zero),
            ("motors", motor, rows_motor, relation.infinite),
        )
    )
    both = max(both, of_task, of_motor)
    return both - of_motor, both - of_task, k - both


def _unit_rows(rows: Matrix) -> Matrix:
    return np.asarray(rows / np.linalg.norm(rows, axis=1, keepdims=True))


def _row_space(metric: Metric, factor: Vector) -> Matrix:
    """Orthonormal rows that span what the metric weighs, in scaled coordinates."""
    if metric.definite:
        return np.eye(metric.size)
    rows = _unit_rows(metric.factor * factor)
    return svd(rows.T)[0][:, : rows.shape[0]].T


def _orthonormalising(stack: Matrix, rank: int) -> Matrix:
    """A basis change X (k x rank) that makes stack @ X orthonormal and drops the kernel of the stack."""
    _, values, right = svd(stack)
    return right[:, :rank] / values[:rank]


def _separated(block: Matrix, basis: Matrix, count: int) -> tuple[Matrix, Matrix]:
    """Split basis columns into those that `block` maps to something and the `count` it maps to zero."""
    if count == 0:
        return basis, basis[:, :0]
    right = svd(block)[2]
    kept = right.shape[1] - count
    return basis @ right[:, :kept], basis @ right[:, kept:]
