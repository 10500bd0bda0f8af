"""From a relation and two metrics to efficiencies and directions: the heart of every ellipsoid.

Source: theory page, section 4; numerics page, step 5.  Dimensions are settled first, on unweighted
orthonormal bases: which part of the relation is infinite, zero, finite, undefined.  Weights enter
only then, so they can never change a count.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vincula.analysis.parts import graded_parts, sectioned, split_parts
from vincula.analysis.relation import Relation
from vincula.arrays import Matrix, Vector
from vincula.numerics.csd import angles_of_pair, deflated, orthonormal
from vincula.numerics.csd_graded import angles_of_graded_pair
from vincula.numerics.lapack import svd
from vincula.numerics.metric import Metric
from vincula.numerics.subspaces import settled


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
        undefined: Number of pairs that neither metric weighs.
    """

    ratios: Vector
    task: Matrix
    motor: Matrix
    infinite: Matrix
    zero: Matrix
    undefined: int


def spectrum(relation: Relation, task: Metric, motor: Metric) -> Spectrum:
    """Efficiencies and directions of a relation.

    Args:
        relation: Its basis and counts.
        task: Metric of the task side.
        motor: Metric of the motor side.
    """
    basis = sectioned(relation, task, motor)
    parts = graded_parts(basis, task, motor) or split_parts(basis, task, motor)
    t, e = (_weighed(task, basis.task_factor, part) for part in (parts.finite_task, parts.infinite))
    s, z = (_weighed(motor, basis.motor_factor, part) for part in (parts.finite_motor, parts.zero))
    # Worst case over what is free, best case over what is redundant (eqs. 11-13): finite directions
    # are taken orthogonal, in the metrics, to the infinite and to the zero ones.
    if parts.graded:
        free, idle = orthonormal(e), orthonormal(z)
        angles = angles_of_graded_pair(t, s, e, z)
        task_side, motor_side = angles.task, angles.motor
    else:
        t, free, task_basis = deflated(t, e)
        s, idle, motor_basis = deflated(s, z)
        angles = angles_of_pair(t, s)
        task_side, motor_side = task_basis @ angles.task, motor_basis @ angles.motor
    task_side, motor_side = _physical(task, task_side), _physical(motor, motor_side)
    signs = _signs(task_side)
    return Spectrum(
        ratios=angles.ratios,
        task=task_side * signs + 0.0,
        motor=motor_side * signs + 0.0,
        infinite=_oriented(_physical(task, settled(free))),
        zero=_oriented(_physical(motor, settled(idle))),
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
        infinite=_oriented(twist.factor.T @ _rest(twist.factor, motions.infinite, motions.task)),
        zero=_oriented(rate.factor.T @ _rest(rate.factor, motions.zero, motions.motor)),
        undefined=0,
    )


def _weighed(metric: Metric, factor: Vector, block: Matrix) -> Matrix:
    """Scaled coordinates to physical ones, and those to lengths in the metric."""
    physical = factor[:, None] * block
    return physical if metric.unit else metric.factor @ physical


def _physical(metric: Metric, block: Matrix) -> Matrix:
    return block if metric.unit else metric.inverse @ block


def _rest(factor: Matrix, *used: Matrix) -> Matrix:
    """Orthonormal basis, in the metric, of what directions orthonormal in the metric leave over."""
    size, count = factor.shape[0], sum(columns.shape[1] for columns in used)
    if size == count:
        return factor[:, :0]
    return settled(svd(factor @ np.hstack(used))[0][:, count:])


def _signs(columns: Matrix) -> Vector:
    """Signs that make the largest component of every column positive (the first among equals)."""
    if not columns.size:
        return np.ones(columns.shape[1])
    size = np.abs(columns)
    first = (size >= size.max(axis=0) * (1.0 - 1e-9)).argmax(axis=0)
    return np.where(columns[first, np.arange(columns.shape[1])] < 0.0, -1.0, 1.0)


def _oriented(columns: Matrix) -> Matrix:
    return columns * _signs(columns) + 0.0 if columns.size else columns
