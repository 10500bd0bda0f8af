"""`analysis.sensitivity` for many configurations of the same ranks: the forces y and motions k of -y^T dA k.

Nothing is decided here: ranks are those that the evaluation of the configurations found.  Every configuration
is computed by itself, so its bits do not depend on the others.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vincula.analysis.distance_sensitivity import columns_of, value_alone
from vincula.analysis.ellipsoid import Kind
from vincula.arrays import Vector
from vincula.mechanism.many_frames import Stack
from vincula.mechanism.many_matrices import ManyMatrices, ordered
from vincula.mechanism.virtual_work import FrameForces, Pairs
from vincula.model import LinearModel
from vincula.numerics.counts import SummaryCounts
from vincula.numerics.ledger import MatrixName
from vincula.numerics.metric import Metric


@dataclass(frozen=True, slots=True, eq=False)
class ManyAxes:
    """Squared semi-axes of sets or of their shadows: `analysis.sensitivity.Semiaxis`, N x e of them.

    Attributes:
        kind: The ellipsoid.
        squares: N x e.
        tasks: N x e x t task sides, physical, of motor sides of cost one.
        motors: N x e x r motor sides, physical, of cost one.
        chosen: t numbers: 1 for components that count, 0 for the others.
    """

    kind: Kind
    squares: Stack
    tasks: Stack
    motors: Stack
    chosen: Vector

    def by_weights(self, task: Stack, motor: Stack, load: Stack | None) -> Stack:
        """Derivatives by p rates of both metrics, everything else held: N x e x p.

        Args:
            task: p x t x t.
            motor: p x r x r.
            load: Structural wrenches that shadows see of their slopes, N x e x t; None where there are none.
        """
        seen = self.chosen * self.tasks
        of_tasks = np.einsum("nea,pab,neb->nep", seen, task, seen)
        of_motors = np.einsum("nea,pab,neb->nep", self.motors, motor, self.motors)
        found = of_tasks - self.squares[..., None] * of_motors
        if load is not None:
            found = found - np.einsum("nea,pab,neb->nep", load, task, self.tasks)
        return np.asarray(found)


class ManySensitivities:
    """Kernels of A and derivatives by A, scaled as in `LinearModel.scaled`.

    Args:
        many: The configurations.
        model: The mechanism's linear model without numbers: names, units, scaling.
        counts: The counts of all these configurations.

    Attributes:
        kernel: N x n x mobility, orthonormal.
        row: Factors of the rows to scaled ones.
        column: Factors from scaled to physical motions, in the order (q_a, q_p, u).
    """

    def __init__(self, many: ManyMatrices, model: LinearModel, counts: SummaryCounts) -> None:
        self.many, self.counts = many, counts
        scaled = model.scaled
        self.row = scaled.row
        self.column = np.concatenate([scaled.active_column, scaled.passive_column, scaled.twist])
        self._factors = scaled.active_column, scaled.twist
        self.active, self.passive = len(model.motors), len(model.passives)
        self.matrix: Stack = self.row[:, None] * many.matrices() * self.column
        rows, columns = self.matrix.shape[1:]
        self.rank = columns - counts.mobility
        across = np.ascontiguousarray(np.swapaxes(self.matrix, 1, 2))
        if self.rank == rows:
            turn, triangle = np.linalg.qr(across, mode="complete")
            self.kernel: Stack = turn[:, :, rows:]
            self._range, self._triangle = turn[:, :, :rows], triangle[:, :rows]
            self.unreached: Stack = np.zeros((len(across), rows, 0))
        else:
            left, values, right = np.linalg.svd(self.matrix)
            self.kernel = np.swapaxes(right[:, self.rank :], 1, 2)
            self.unreached = left[:, :, self.rank :]
            kept = right[:, : self.rank] / values[:, : self.rank, None]
            self._inverse = np.swapaxes(kept, 1, 2) @ np.swapaxes(left[:, :, : self.rank], 1, 2)

    def pulled(self, covectors: Stack) -> Stack:
        """A^+T of N x e x n covectors: N x e x m."""
        if self.rank == self.matrix.shape[1]:
            wanted = np.swapaxes(covectors @ self._range, 1, 2)
            return np.swapaxes(np.linalg.solve(self._triangle, wanted), 1, 2)
        return np.asarray(covectors @ self._inverse)

    def closing(self, opening: Stack) -> tuple[Stack, Stack]:
        """The shortest motions that close gaps of the rows (N x p x m) again, and what stays open."""
        if self.rank == self.matrix.shape[1]:
            back = np.linalg.solve(np.swapaxes(self._triangle, 1, 2), np.swapaxes(opening, 1, 2))
            motions = -np.swapaxes(self._range @ back, 1, 2)
        else:
            motions = -(opening @ np.swapaxes(self._inverse, 1, 2))
        return motions, opening + motions @ np.swapaxes(self.matrix, 1, 2)

    def lifted(self, pairs: Stack) -> Stack:
        """Whole motions (q_a, q_p, u) of N x e pairs (q_a, u)."""
        block = np.delete(self.kernel, slice(self.active, self.active + self.passive), axis=1)
        size = self.counts.mobility - self.counts.passive_redundancy
        return np.asarray(pairs @ np.swapaxes(self.kernel @ pseudo_inverse(block, size), 1, 2))

    def dyads(self, axes: ManyAxes, task: Metric, motor: Metric) -> tuple[Stack, Stack, Stack | None]:
        """Forces y (N x e x m) and motions k (N x e x n) whose -y^T dA k are derivatives of semi-axes.

        Shadows of active forces beside structural wrenches have two terms: the second ones come after all
        the first ones, and with them the wrenches N x e x t that they see of their slopes.

        Args:
            axes: The semi-axes.
            task: Metric of the task side.
            motor: Metric of the motor side.
        """
        rate, twist = self._factors
        t, m = (twist, rate) if axes.kind == "kinematic" else (1.0 / twist, 1.0 / rate)
        if axes.kind == "internal force":
            t = self.row
        on_task = 2.0 * axes.chosen * ((axes.chosen * axes.tasks) @ task.matrix)
        beside = self._beside(axes, task, on_task)
        on_task = t * (on_task if beside is None else on_task - beside[2] @ task.matrix)
        on_motor = -2.0 * axes.squares[..., None] * m * (axes.motors @ motor.matrix)
        tasks, motors = axes.tasks / t, axes.motors / m
        if axes.kind == "internal force":
            held = self.matrix[:, :, self.active :]
            pull = on_task - on_motor @ np.swapaxes(self.matrix[:, :, : self.active], 1, 2)
            rank = held.shape[2] - self.counts.passive_redundancy - self.counts.indeterminacy
            rest = pull @ np.swapaxes(pseudo_inverse(held, rank), 1, 2)
            return tasks, np.concatenate([on_motor, rest], axis=-1), None
        pair, on_pair = (np.concatenate(sides, axis=-1) for sides in ((motors, tasks), (on_motor, on_task)))
        if axes.kind == "kinematic":
            return self.pulled(self._without_passive(on_pair)), self.lifted(pair), None
        # An equilibrium e is orthogonal to every motion: de = -N^+T dN^T e.
        forces, motions = -self.pulled(self._without_passive(pair)), self.lifted(on_pair)
        if beside is None:
            return forces, motions, None
        more = np.concatenate([forces, beside[0]], axis=1), np.concatenate([motions, beside[1]], axis=1)
        return *more, beside[2]

    def _beside(self, axes: ManyAxes, task: Metric, on_task: Stack) -> tuple[Stack, Stack, Stack] | None:
        """What structural wrenches add, see `Sensitivities`: forces, motions, and the wrenches."""
        count = self.counts.structural_wrenches
        if axes.kind not in ("active force", "dual force") or count <= 0 or axes.chosen.all():
            return None
        twist = self._factors[1]
        left, values, right = np.linalg.svd(self.kernel[:, self.active + self.passive :])
        reached = len(twist) - count
        structural = left[:, :, reached:] / twist[:, None]
        triangle = np.linalg.qr(task.factor @ structural)[1]
        structural = structural @ np.linalg.inv(triangle)
        load = (on_task @ structural) @ np.swapaxes(structural, 1, 2)
        way = ((axes.tasks @ task.matrix) / twist) @ left[:, :, :reached]
        motions = ((way / values[:, None, :reached]) @ right[:, :reached]) @ np.swapaxes(self.kernel, 1, 2)
        idle = np.zeros((*load.shape[:2], self.active))
        pairs = np.concatenate([idle, twist * load], axis=-1)
        return self.pulled(self._without_passive(pairs)), motions, load

    @property
    def watched_ranks(self) -> tuple[int, ...]:
        """Ranks of J_p, [J_a J_p], [J_p G^T] and [J_a J_p G^T]."""
        counts, columns = self.counts, self.matrix.shape[2]
        member = columns - self.active - self.passive
        held = counts.passive_redundancy
        return (
            self.passive - held,
            self.active + self.passive - held - counts.redundancy,
            self.passive + member - held - counts.indeterminacy,
            columns - counts.mobility,
        )

    def distances(
        self, names: tuple[MatrixName, ...], ranks: tuple[int, ...]
    ) -> tuple[Stack, Stack, Stack, NDArray[np.bool_]]:
        """Smallest singular values of some matrices over the largest of A: `distance_sensitivity`.

        Args:
            names: The matrices.
            ranks: Their ranks.

        Returns:
            N x names distances; for those of a rank above zero forces y and motions k of their derivatives
            -y^T dA k, first all of the values and then all of the scale; and whether each is alone.
        """
        whole = np.linalg.svd(self.matrix)
        lanes, columns = len(self.matrix), self.matrix.shape[2]
        scale = whole[1][:, :1]
        found = np.full((lanes, len(names)), np.inf)
        forces, motions, alone = [], [], []
        for k, (name, rank) in enumerate(zip(names, ranks, strict=True)):
            if rank <= 0:
                continue
            part = columns_of(name, self.active, self.passive, columns)
            left, values, right = np.linalg.svd(self.matrix[:, :, part])
            found[:, k] = values[:, rank - 1] / scale[:, 0]
            motion = np.zeros((lanes, columns))
            motion[:, part] = right[:, rank - 1]
            forces.append(-left[:, :, rank - 1] / scale)
            motions.append(motion)
            single = value_alone(values, rank - 1) & value_alone(whole[1], 0)
            alone.append(single)
        some = [k for k, rank in enumerate(ranks) if rank > 0]
        of_scale = (found[:, some] / scale)[..., None] * whole[0][:, None, :, 0]
        largest = np.broadcast_to(whole[2][:, None, 0], (lanes, len(some), columns))
        return (
            found,
            np.concatenate([np.stack(forces, axis=1), of_scale], axis=1),
            np.concatenate([np.stack(motions, axis=1), largest], axis=1),
            np.array(alone, dtype=bool).T,
        )

    def forces_of(self, forces: Stack, motions: Stack) -> FrameForces:
        """What y^T A k feels as frames move, for scaled forces (N x e x m) and motions (N x e x n)."""
        moved = motions * self.column
        columns = self.active + self.passive
        rates = np.empty((*moved.shape[:2], columns))
        rates[..., ordered(self.many.layout)] = moved[..., :columns]
        twists = self.many.in_ground_axes(moved[..., columns:])
        return FrameForces(self.many, Pairs(forces * self.row, rates, twists))

    def _without_passive(self, pairs: Stack) -> Stack:
        """(q_a, 0, u) of pairs (q_a, u)."""
        wide = np.zeros((*pairs.shape[:2], self.matrix.shape[2]))
        wide[..., : self.active] = pairs[..., : self.active]
        wide[..., self.active + self.passive :] = pairs[..., self.active :]
        return wide


def pseudo_inverse(matrices: Stack, rank: int) -> Stack:
    """Pseudo-inverses of N matrices of a known rank."""
    left, values, right = np.linalg.svd(matrices, full_matrices=False)
    kept = np.swapaxes(right[:, :rank] / values[:, :rank, None], 1, 2)
    return np.asarray(kept @ np.swapaxes(left[:, :, :rank], 1, 2))
