"""From a relation and two metrics to efficiencies and directions: the heart of every ellipsoid.

Source: theory page, section 4; numerics page, step 5.  Dimensions are settled first, on unweighted
orthonormal bases: which part of the relation is infinite, zero, finite, undefined.  Weights enter
only then, so they can never change a count.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vincula.analysis.relation import Relation
from vincula.arrays import Matrix, Vector
from vincula.numerics.csd import angles_of_pair, deflated
from vincula.numerics.csd_graded import angles_of_graded_pair
from vincula.numerics.lapack import svd
from vincula.numerics.metric import Metric
from vincula.numerics.rank import decide_rank


@dataclass(frozen=True, slots=True, eq=False)
class Spectrum:
    """Efficiencies and directions of a relation under two metrics.

    Directions are physical vectors of length one in their metric, one a column.

    Attributes:
        ratios: Finite ratios task / motor, descending; efficiencies are their squares.
        task: Task directions of the finite ones.
        motor: Motor directions of the finite ones, paired with `task` (signs included).
        infinite: Task directions that cost nothing, mutually orthogonal in the metric.
        zero: Motor directions that move nothing.
        unreached: Task directions orthogonal to all the others: the relation never goes there.
        unused: Motor directions that take part in nothing.
        undefined: Number of pairs that neither metric weighs.
    """

    ratios: Vector
    task: Matrix
    motor: Matrix
    infinite: Matrix
    zero: Matrix
    unreached: Matrix
    unused: Matrix
    undefined: int


@dataclass(frozen=True, slots=True, eq=False)
class _Parts:
    infinite: Matrix
    finite_task: Matrix
    finite_motor: Matrix
    zero: Matrix
    undefined: int
    graded: bool = False


def spectrum(relation: Relation, task: Metric, motor: Metric) -> Spectrum:
    """Efficiencies and directions of a relation.

    Args:
        relation: Its basis and counts.
        task: Metric of the task side.
        motor: Metric of the motor side.
    """
    basis = _sectioned(relation, task, motor)
    parts = _graded(basis, task, motor) or _split(basis, task, motor)
    # Worst case over what is free, best case over what is redundant (eqs. 11-13): finite directions
    # are taken orthogonal, in the metrics, to the infinite and to the zero ones.
    t, free, task_basis = deflated(
        _weighed(task, basis.task_factor, parts.finite_task),
        _weighed(task, basis.task_factor, parts.infinite),
    )
    s, idle, motor_basis = deflated(
        _weighed(motor, basis.motor_factor, parts.finite_motor),
        _weighed(motor, basis.motor_factor, parts.zero),
    )
    angles = angles_of_graded_pair(t, s) if parts.graded else angles_of_pair(t, s)
    task_side = _physical(task, task_basis @ angles.task)
    motor_side = _physical(motor, motor_basis @ angles.motor)
    signs = _signs(task_side)
    return Spectrum(
        ratios=angles.ratios,
        task=task_side * signs + 0.0,
        motor=motor_side * signs + 0.0,
        infinite=_oriented(_physical(task, free)),
        zero=_oriented(_physical(motor, idle)),
        unreached=_oriented(_physical(task, _rest(task_basis, angles.task))),
        unused=_oriented(_physical(motor, _rest(motor_basis, angles.motor))),
        undefined=parts.undefined,
    )


def dual_spectrum(motions: Spectrum, twist: Metric, rate: Metric) -> Spectrum:
    """The spectrum of equilibria under the reciprocal metrics, from that of motions.

    The same angles with sines and cosines swapped: what is never reached carries every wrench, what
    never moves holds every torque.  tau.q_a + w.u = 0 makes the torques negative.

    Args:
        motions: Spectrum of the kinematic relation.
        twist: W_u; wrenches are measured by its reciprocal.
        rate: W_q; torques are measured by its reciprocal.
    """
    wrenches = twist.matrix @ motions.task[:, ::-1]
    torques = rate.matrix @ motions.motor[:, ::-1]
    signs = _signs(wrenches)
    return Spectrum(
        ratios=1.0 / motions.ratios[::-1],
        task=wrenches * signs + 0.0,
        motor=-torques * signs + 0.0,
        infinite=_oriented(twist.matrix @ motions.unreached),
        zero=_oriented(rate.matrix @ motions.unused),
        unreached=_oriented(twist.matrix @ motions.infinite),
        unused=_oriented(rate.matrix @ motions.zero),
        undefined=0,
    )


def _weighed(metric: Metric, factor: Vector, block: Matrix) -> Matrix:
    """Scaled coordinates to physical ones, and those to lengths in the metric."""
    physical = factor[:, None] * block
    return physical if metric.unit else metric.factor @ physical


def _physical(metric: Metric, block: Matrix) -> Matrix:
    return block if metric.unit else metric.inverse @ block


def _rest(basis: Matrix, used: Matrix) -> Matrix:
    """The part of an orthonormal basis that orthonormal coordinates `used` leave over."""
    size, count = used.shape
    return basis[:, :0] if size == count else basis @ svd(used)[0][:, count:]


GRADED = 100.0
"""Weights whose roots differ by more than this call for a basis that is accurate entry by entry."""

LONG = 1e4
"""Weights whose roots differ by more than this call for long arithmetic as well."""


def _graded(relation: Relation, task: Metric, motor: Metric) -> _Parts | None:
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
    return _Parts(found.infinite, found.finite_task, found.finite_motor, found.zero, 0, graded=long)


def _grading(sizes: Vector) -> float:
    return float(sizes.max() / sizes.min()) if len(sizes) else 1.0


def _sectioned(relation: Relation, task: Metric, motor: Metric) -> Relation:
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
    rank = decide_rank(
        conditions, name="required zeros", scale=1.0, uncertainty={"subspace": relation.doubt}
    ).rank
    kept = svd(conditions)[2][:, rank:]
    return Relation(
        relation.task @ kept, relation.motor @ kept, relation.task_factor, relation.motor_factor,
        -1, -1, relation.orthonormal, relation.doubt,
    )  # fmt: skip


def _split(relation: Relation, task: Metric, motor: Metric) -> _Parts:
    """Infinite, finite, zero and undefined parts, decided on unweighted orthonormal bases."""
    k = relation.task.shape[1]
    counted = task.definite and motor.definite and relation.infinite >= 0
    room = min(relation.task.shape[0], relation.motor.shape[0])
    if counted and relation.infinite == 0 and relation.zero == 0 and k <= room:
        return _Parts(relation.task[:, :0], relation.task, relation.motor, relation.motor[:, :0], 0)
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
    return _Parts(
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


def _signs(columns: Matrix) -> Vector:
    """Signs that make the largest component of every column positive (the first among equals)."""
    if not columns.size:
        return np.ones(columns.shape[1])
    size = np.abs(columns)
    first = (size >= size.max(axis=0) * (1.0 - 1e-9)).argmax(axis=0)
    return np.where(columns[first, np.arange(columns.shape[1])] < 0.0, -1.0, 1.0)


def _oriented(columns: Matrix) -> Matrix:
    return columns * _signs(columns) + 0.0 if columns.size else columns
