"""How efficiencies and indices change when the matrices change: exact first derivatives.

An efficiency is a stationary value of a ratio of two quadratic forms on the kernel of
A = [J_a J_p -G^T], so its derivative needs one motion k and one force y only:

    d lambda = -y^T dA k.

For the kinematic ellipsoid k is the motion itself and y the contact forces that go with it (virtual
work); for forces the two change places.  The formula is that of a simple value; summed over a cluster
of equal ones it is still right (the sum is smooth), for one member of a cluster there is no derivative.
Everything is in the scaled coordinates of `LinearModel.scaled`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from vincula.analysis.ellipsoid import Ellipsoid
from vincula.analysis.recipes import motor_quantity, task_quantity
from vincula.arrays import Matrix, Vector
from vincula.model import LinearModel
from vincula.numerics.lapack import svd

CLUSTER = 1e-7
"""Efficiencies whose angles differ by less than this, relative, count as equal: the derivative of one
alone would carry rounding errors divided by the difference."""
CONSTANT_RANK = 1e-7
"""How far dA may lead out of the range of A, relative to dA, where the rank is constant along it."""


@dataclass(frozen=True, slots=True, eq=False)
class Weighing:
    """How one number depends on the metrics: sum of shares (r^T W_t t - costs s^T W_m s), vectors held.

    Attributes:
        tasks: t x i task sides, physical.
        mates: t x i, what they are weighed with; mostly themselves.
        motors: r x i motor sides, physical.
        shares: i factors.
        costs: i factors.
    """

    tasks: Matrix
    mates: Matrix
    motors: Matrix
    shares: Vector
    costs: Vector

    def along(self, task: Matrix, motor: Matrix) -> float:
        """The derivative for rates of change of both metrics."""
        of_tasks = np.einsum("ai,ab,bi->i", self.mates, task, self.tasks)
        of_motors = np.einsum("ai,ab,bi->i", self.motors, motor, self.motors)
        return float(self.shares @ (of_tasks - self.costs * of_motors))


@dataclass(frozen=True, slots=True, eq=False)
class Sensitivity:
    """The derivative of one number with respect to the matrix A, as a sum of dyads: -y^T dA k.

    Attributes:
        forces: m x j, the vectors y.
        motions: columns x j, the vectors k, ordered (q_a, q_p, u).
        weighing: How the number depends on the metrics.
    """

    forces: Matrix
    motions: Matrix
    weighing: Weighing

    def along(self, rate: Matrix) -> float:
        """The derivative for a rate of change of A = [J_a J_p -G^T], in scaled coordinates."""
        return float(-np.einsum("ij,ik,kj->", self.forces, rate, self.motions))

    def times(self, factor: float) -> Sensitivity:
        """The same with a factor."""
        return Sensitivity(
            self.forces * factor,
            self.motions,
            replace(self.weighing, shares=self.weighing.shares * factor),
        )

    def __add__(self, other: Sensitivity) -> Sensitivity:
        one, two = self.weighing, other.weighing
        return Sensitivity(
            np.hstack([self.forces, other.forces]),
            np.hstack([self.motions, other.motions]),
            Weighing(
                np.hstack([one.tasks, two.tasks]),
                np.hstack([one.mates, two.mates]),
                np.hstack([one.motors, two.motors]),
                np.concatenate([one.shares, two.shares]),
                np.concatenate([one.costs, two.costs]),
            ),
        )


@dataclass(frozen=True, slots=True, eq=False)
class Semiaxis:
    """A stationary value of task^T W_t task / motor^T W_m motor over some components of the task.

    Attributes:
        kind: The ellipsoid it belongs to.
        square: The value.
        task: Task side, physical, of a motor side of cost one.
        motor: Motor side, physical, of cost one.
        chosen: 1 for components of the task that count, 0 for the others.
    """

    kind: str
    square: float
    task: Vector
    motor: Vector
    chosen: Vector


@dataclass(frozen=True, slots=True, eq=False)
class _Beside:
    """What structural wrenches add to the derivative of a shadow.

    Attributes:
        load: The structural wrench that the shadow sees of its own slope.
        force: The force y of the term -y^T dA k, scaled.
        motion: Its motion k.
    """

    load: Vector
    force: Vector
    motion: Vector


class Sensitivities:
    """Derivatives of a model's efficiencies with respect to its matrices.

    Args:
        model: The model; its ranks decide what is a kernel.
    """

    def __init__(self, model: LinearModel) -> None:
        self.model = model
        self._ledger = model.ledger
        self._widths = len(model.motors), len(model.passives)

    def scaled_rate(self, active: Matrix, passive: Matrix, member: Matrix) -> Matrix:
        """dA in scaled coordinates from rates of J_a, J_p and G^T in m, rad, s."""
        s = self.model.scaled
        parts = [active * s.active_column, passive * s.passive_column, -member * s.twist]
        return s.row[:, None] * np.hstack(parts)

    @cached_property
    def kernel(self) -> Matrix:
        """Orthonormal basis of all motions (q_a, q_p, u), scaled."""
        return self._decomposed[2][:, self._ledger.rank("all") :]

    def keeps_rank(self, rate: Matrix) -> bool:
        """Whether the rank of A stays what it is along a rate of change that keeps the loops closed."""
        rank = self._ledger.rank("all")
        rest = self._decomposed[0][:, rank:].T @ rate @ self.kernel
        size = float(np.linalg.norm(rate))
        return rest.size == 0 or float(np.linalg.norm(rest)) <= CONSTANT_RANK * size

    def closing(self, opening: Vector) -> tuple[Vector, Vector]:
        """The shortest motion whose rates of gaps are the negative of some, and what stays open.

        Args:
            opening: Rates at which the rows of A open, scaled.
        """
        motion = -(self._inverse @ opening)
        return motion, np.asarray(opening + self._ledger.matrix("all") @ motion)

    def efficiency(self, ellipsoid: Ellipsoid, index: int) -> Sensitivity:
        """The derivative of one finite efficiency of an ellipsoid of this model.

        Args:
            ellipsoid: One of the five.
            index: Position in its list; the class there must be finite.
        """
        value = float(ellipsoid.efficiencies[index])
        task = math.sqrt(value) * np.asarray(ellipsoid.task_directions[index], dtype=float)
        motor = np.asarray(ellipsoid.motor_directions[index], dtype=float)
        return self.semiaxis(ellipsoid, Semiaxis(ellipsoid.kind, value, task, motor, np.ones(len(task))))

    def semiaxis(self, ellipsoid: Ellipsoid, axis: Semiaxis) -> Sensitivity:
        """The derivative of one squared semi-axis of an ellipsoid of this model, or of a shadow of it.

        Args:
            ellipsoid: The ellipsoid.
            axis: The semi-axis.
        """
        weigh_motor = ellipsoid.motor_weight.matrix
        t, m = self._factors(ellipsoid)
        seen = axis.chosen * axis.task
        on_task = 2.0 * axis.chosen * (ellipsoid.task_weight.matrix @ seen)
        beside = self._beside(ellipsoid, axis, on_task)
        forces, motions = self._of_pair(
            axis.kind,
            axis.task / t,
            axis.motor / m,
            t * (on_task if beside is None else on_task - ellipsoid.task_weight.matrix @ beside.load),
            -2.0 * axis.square * m * (weigh_motor @ axis.motor),
        )
        own = seen[:, None], seen[:, None], axis.motor[:, None], np.ones(1), np.array([axis.square])
        found = Sensitivity(forces, motions, Weighing(*own))
        if beside is None:
            return found
        nothing = np.zeros((len(axis.motor), 1))
        turned = Weighing(axis.task[:, None], -beside.load[:, None], nothing, np.ones(1), np.zeros(1))
        return found + Sensitivity(beside.force[:, None], beside.motion[:, None], turned)

    def _beside(self, ellipsoid: Ellipsoid, axis: Semiaxis, on_task: Vector) -> _Beside | None:
        """How a shadow of active forces turns with the structural wrenches that they are orthogonal to.

        Wrenches that motors push with are, in the metric, orthogonal to those that cost no torque; W times
        one of them is a twist t that the motors reach.  As A changes, structural wrenches S turn by what
        the motions of t do along them, and the active ones after them: S^T t stays zero.
        """
        count = self._ledger.summary.structural_wrenches
        if axis.kind not in ("active force", "dual force") or count <= 0 or axis.chosen.all():
            return None
        n_a, n_p = self._widths
        twist, metric = self.model.scaled.twist, ellipsoid.task_weight
        left, values, right = svd(self.kernel[n_a + n_p :])
        reached = len(twist) - count
        structural = left[:, reached:] / twist[:, None]
        structural = structural @ np.linalg.inv(np.linalg.qr(metric.factor @ structural)[1])
        load = structural @ (structural.T @ on_task)
        way = left[:, :reached].T @ ((metric.matrix @ axis.task) / twist)
        motion = self.kernel @ (right[:, :reached] @ (way / values[:reached]))
        return _Beside(load, self._pulled(np.concatenate([np.zeros(n_a), twist * load])), motion)

    def _of_pair(
        self, kind: str, task: Vector, motor: Vector, on_task: Vector, on_motor: Vector
    ) -> tuple[Matrix, Matrix]:
        """Forces and motions of the derivative by A, of a stationary function of a pair."""
        if kind == "internal force":
            return self._of_internal(task, on_task, on_motor)
        pair, on_pair = np.concatenate([motor, task]), np.concatenate([on_motor, on_task])
        if kind == "kinematic":
            motion, force = self._lifted(pair), self._pulled(on_pair)
        else:
            # An equilibrium e is orthogonal to every motion: de = -N^+T dN^T e.
            motion, force = self._lifted(on_pair), -self._pulled(pair)
        return force[:, None], motion[:, None]

    def _of_internal(self, force: Vector, on_force: Vector, on_torque: Vector) -> tuple[Matrix, Matrix]:
        """f in the left kernel of B = [J_p -G^T], tau = -J_a^T f: eqs. (22)-(23)."""
        held = self._ledger.matrix("passive+member")
        rank = self._ledger.rank("passive+member")
        pull = on_force - self.model.scaled.active @ on_torque
        rest = _pseudo_inverse(held, rank) @ pull
        return force[:, None], np.concatenate([on_torque, rest])[:, None]

    @cached_property
    def _decomposed(self) -> tuple[Matrix, Vector, Matrix]:
        return svd(self._ledger.matrix("all"))

    @cached_property
    def _inverse(self) -> Matrix:
        left, values, right = self._decomposed
        rank = self._ledger.rank("all")
        return np.asarray((right[:, :rank] / values[:rank]) @ left[:, :rank].T)

    @cached_property
    def _relation(self) -> tuple[Matrix, Matrix]:
        """N = (q_a; u) blocks of the kernel, and its pseudo-inverse."""
        n_a, n_p = self._widths
        block = np.delete(self.kernel, slice(n_a, n_a + n_p), axis=0)
        size = block.shape[1] - max(0, self._ledger.summary.passive_redundancy)
        return block, _pseudo_inverse(block, size)

    def _lifted(self, pair: Vector) -> Vector:
        """The whole motion (q_a, q_p, u) of a pair (q_a, u)."""
        return np.asarray(self.kernel @ (self._relation[1] @ pair))

    def _pulled(self, pair: Vector) -> Vector:
        """A^+T (q_a, 0, u)."""
        n_a, n_p = self._widths
        return np.asarray(self._inverse.T @ np.concatenate([pair[:n_a], np.zeros(n_p), pair[n_a:]]))

    def _factors(self, ellipsoid: Ellipsoid) -> tuple[Vector, Vector]:
        """Factors from scaled to physical, of the task and of the motor side."""
        s = self.model.scaled
        of = {
            "twist": s.twist,
            "rate": s.active_column,
            "wrench": 1.0 / s.twist,
            "torque": 1.0 / s.active_column,
            "contact_force": s.row,
        }
        return of[task_quantity(ellipsoid.kind)], of[motor_quantity(ellipsoid.kind)]


def alone(ellipsoid: Ellipsoid, index: int) -> bool:
    """Whether a finite efficiency is apart from all the others: only then it has a derivative."""
    finite = [k for k, c in enumerate(ellipsoid.classes) if c == "finite"]
    angle = np.arctan(np.sqrt(np.array([float(ellipsoid.efficiencies[k]) for k in finite])))
    own = angle[finite.index(index)]
    near = np.abs(angle - own) <= CLUSTER * min(own, np.pi / 2 - own)
    return int(np.count_nonzero(near)) == 1


def _pseudo_inverse(matrix: Matrix, rank: int) -> Matrix:
    left, values, right = svd(matrix)
    return np.asarray((right[:, :rank] / values[:rank]) @ left[:, :rank].T)
