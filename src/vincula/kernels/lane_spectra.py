"""Efficiencies and directions of many configurations under metrics that kernels do not take.

Source: theory page, section 4; the steps are those of `analysis.spectrum` and `analysis.parts`.  How many
efficiencies are infinite, finite, zero and undefined is known beforehand, from a configuration that stands
for all; a lane in which one of these numbers is not certain is handed back.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Literal

import numpy as np

from vincula.arrays import Matrix, Vector
from vincula.kernels.lane_block import LaneBlock
from vincula.kernels.lane_relations import Parts, Squeezing, equilibria, motions
from vincula.kernels.small_matrices import Stack, decomposed, paired_angles, products
from vincula.kernels.small_subspaces import cleared, orthonormal, settled_bases
from vincula.numerics.rank import SAFETY, rounding_unit

if TYPE_CHECKING:
    from vincula.numerics.metric import Metric

ASKED: Final = 1.2 * SAFETY
"""How many times above the uncertainty a singular value must be to count, as in `lanes.certificates`."""
ZERO: Final = 0.5
"""Share of rounding below which a singular value is zero for every rule."""

RelationName = Literal["motions", "equilibria", "internal forces"]


@dataclass(frozen=True, slots=True, eq=False)
class Sizes:
    """How many of every class there are in lanes that are certain.

    Attributes:
        infinite: Infinite efficiencies.
        finite: Finite ones.
        zero: Those that are zero.
        undefined: Pairs that neither metric weighs.
    """

    infinite: int
    finite: int
    zero: int
    undefined: int

    @property
    def weighed(self) -> int:
        """Dimension of what at least one metric weighs."""
        return self.infinite + self.finite + self.zero


@dataclass(frozen=True, slots=True, eq=False)
class LaneSpectra:
    """Spectra of a block: see `analysis.spectrum.Spectrum`; directions are rows here.

    Attributes:
        ratios: N x f finite ratios, descending.
        task: N x f x t physical directions of length one in the metric.
        motor: N x f x r their motor sides.
        infinite: N x e x t task directions that cost nothing.
        zero: N x z x r motor directions that move nothing.
    """

    ratios: Matrix
    task: Stack
    motor: Stack
    infinite: Stack
    zero: Stack


@dataclass(frozen=True, eq=False)
class LaneRelation:
    """A relation under two metrics, as it is in all lanes that are certain.

    Attributes:
        name: Which relation.
        task: Metric of the task side.
        motor: Metric of the motor side.
        task_factor: From scaled to physical task components, at the length of the program.
        motor_factor: The same for motors.
        sizes: How many of every class.
        counted: Whether free and idle pairs are counted by ranks that the lanes are certain of.
        magnified: How much the metrics may magnify an angle.
        squeezing: How internal forces are found; None for other relations.
    """

    name: RelationName
    task: Metric
    motor: Metric
    task_factor: Vector
    motor_factor: Vector
    sizes: Sizes
    counted: bool
    magnified: float
    squeezing: Squeezing | None = None

    def spectra(self, block: LaneBlock) -> LaneSpectra:
        """The spectra of a block, computed once; lanes that turn out doubtful are marked in it."""
        return block.once(self, lambda: self._spectra(block))

    def bounds(self, block: LaneBlock) -> Matrix:
        """How far every finite efficiency may be off, N x f."""
        ratios = self.spectra(block).ratios
        angle = np.minimum(self.magnified * block.raw.angle, 0.5 * np.pi)
        with np.errstate(all="ignore"):
            relative = 2.0 * angle[:, None] * (ratios + 1.0 / ratios)
            return np.where(relative < 0.5, 2.0 * ratios**2 * relative, np.inf)

    def _spectra(self, block: LaneBlock) -> LaneSpectra:
        return self._weighed(self._parts(block), block)

    def _parts(self, block: LaneBlock) -> Parts:
        """The four parts, physical."""
        if self.squeezing is None:
            found = (motions if self.name == "motions" else equilibria)(block)
            if self.counted:
                return found
            tasks, motors = found.joined(1.0 / self.task_factor, 1.0 / self.motor_factor)
        else:
            tasks, motors = self.squeezing.forces(block)
        block.sure &= block.of_one_length
        tasks, motors = self._sectioned(tasks, motors, block)
        both = orthonormal(np.concatenate([tasks, motors], axis=2), block.sure)
        return self._split(both[:, :, : tasks.shape[2]], both[:, :, tasks.shape[2] :], block)

    @property
    def _cut(self) -> bool:
        """Whether components are required to be zero."""
        return bool(self.task.required_zero.shape[1] or self.motor.required_zero.shape[1])

    def _sectioned(self, tasks: Stack, motors: Stack, block: LaneBlock) -> tuple[Stack, Stack]:
        """What vanishes on every component that is required to be zero."""
        if not self._cut:
            return tasks, motors
        sides = ((self.task, self.task_factor, tasks), (self.motor, self.motor_factor, motors))
        held = [(m.required_zero.T * factor, side) for m, factor, side in sides]
        count = sum(len(rows) for rows, _ in held)
        conditions = np.concatenate([on_rows(side, _unit(rows), block) for rows, side in held], axis=2)
        rank = tasks.shape[1] - self.sizes.weighed - self.sizes.undefined
        kept = _certain_turn(conditions, rank, count, block)[:, rank:]
        return products(kept, tasks, block.sure), products(kept, motors, block.sure)

    def _split(self, tasks: Stack, motors: Stack, block: LaneBlock) -> Parts:
        """Infinite, finite and zero parts of an orthonormal basis in scaled units."""
        sizes, sure = self.sizes, block.sure
        seen = on_rows(tasks, _row_space(self.task, self.task_factor), block)
        felt = on_rows(motors, _row_space(self.motor, self.motor_factor), block)
        k = tasks.shape[1]
        turn: Stack = np.array(np.broadcast_to(np.eye(k), (len(sure), k, k)))
        if not self.counted:
            # Sides that are weighed as a whole have the counts of ranks that lanes are certain of.
            if self._cut or not self.task.definite:
                _certain_turn(seen, k - sizes.undefined - sizes.zero, seen.shape[2], block)
            if self._cut or not self.motor.definite:
                _certain_turn(felt, k - sizes.undefined - sizes.infinite, felt.shape[2], block)
            whole = np.concatenate([seen, felt], axis=2)
            values, turn = decomposed(whole, sure)
            certainly(values, sizes.weighed, whole.shape[2], block)
            turn = turn[:, : sizes.weighed] / values[:, : sizes.weighed, None]
        turn, free = _separated(felt, turn, sizes.infinite, block)
        turn, idle = _separated(seen, turn, sizes.zero, block)
        return Parts(
            products(free, tasks, sure) * self.task_factor,
            products(turn, tasks, sure) * self.task_factor,
            products(turn, motors, sure) * self.motor_factor,
            products(idle, motors, sure) * self.motor_factor,
        )

    def _weighed(self, parts: Parts, block: LaneBlock) -> LaneSpectra:
        """Parts in the metrics, finite ones orthogonal to the infinite and to the zero ones."""
        sure = block.sure
        free = orthonormal(_lengths(self.task, parts.infinite, block), sure)
        idle = orthonormal(_lengths(self.motor, parts.zero, block), sure)
        tasks = cleared(_lengths(self.task, parts.task, block), free, sure)
        motors = cleared(_lengths(self.motor, parts.motor, block), idle, sure)
        both = orthonormal(np.concatenate([tasks, motors], axis=2), sure)
        ratios, tasks, motors = paired_angles(both, tasks.shape[2], sure)
        tasks, motors = _physical(self.task, tasks, block), _physical(self.motor, motors, block)
        signs = signs_of(tasks)
        return LaneSpectra(
            ratios,
            tasks * signs + 0.0,
            motors * signs + 0.0,
            oriented(_physical(self.task, settled_bases(free, sure), block)),
            oriented(_physical(self.motor, settled_bases(idle, sure), block)),
        )


def certainly(values: Matrix, rank: int, components: int, block: LaneBlock) -> None:
    """Mark lanes in which the rank of some vectors is not certain.

    Args:
        values: N x vectors singular values, relative to their scale.
        rank: Their rank.
        components: Components of a vector.
        block: The lanes.
    """
    k = values.shape[1]
    unit = rounding_unit(k, components)
    with np.errstate(invalid="ignore"):
        if rank:
            block.sure &= values[:, rank - 1] > ASKED * (unit + block.raw.angle)
        if rank < k:
            block.sure &= values[:, rank] < ZERO * unit


def _certain_turn(vectors: Stack, rank: int, components: int, block: LaneBlock) -> Stack:
    """Orthonormal combinations of vectors: `rank` that do not vanish, then those that do; certain ones."""
    values, turn = decomposed(vectors, block.sure)
    certainly(values, rank, components, block)
    return turn


def _separated(vectors: Stack, turn: Stack, count: int, block: LaneBlock) -> tuple[Stack, Stack]:
    """Combinations that vectors do not send to zero, and the `count` that they do."""
    if count == 0:
        return turn, turn[:, :0]
    _, right = decomposed(products(turn, vectors, block.sure), block.sure)
    kept = right.shape[1] - count
    return products(right[:, :kept], turn, block.sure), products(right[:, kept:], turn, block.sure)


def _row_space(metric: Metric, factor: Vector) -> Matrix:
    """Orthonormal rows that span what the metric weighs, in scaled coordinates."""
    if metric.definite:
        return np.eye(metric.size)
    rows = _unit(metric.factor * factor)
    return np.linalg.svd(rows, full_matrices=False)[2] if len(rows) else rows


def _unit(rows: Matrix) -> Matrix:
    return np.asarray(rows / np.linalg.norm(rows, axis=1, keepdims=True))


def on_rows(vectors: Stack, rows: Matrix, block: LaneBlock) -> Stack:
    """Every vector's products with some rows."""
    return products(vectors, rows.T[None], block.sure)


def _lengths(metric: Metric, vectors: Stack, block: LaneBlock) -> Stack:
    return vectors if metric.unit else on_rows(vectors, metric.factor, block)


def _physical(metric: Metric, vectors: Stack, block: LaneBlock) -> Stack:
    return vectors if metric.unit else on_rows(vectors, metric.inverse, block)


def oriented(vectors: Stack) -> Stack:
    """The largest component of every vector positive, the first among equals; no negative zeros."""
    return vectors * signs_of(vectors) + 0.0


def signs_of(vectors: Stack) -> Stack:
    """Signs that make the largest component of every vector positive, the first among equals."""
    if not vectors.size:
        return np.ones((*vectors.shape[:2], 1))
    size = np.abs(vectors)
    first = (size >= size.max(axis=2, keepdims=True) * (1.0 - 1e-9)).argmax(axis=2)
    return np.where(np.take_along_axis(vectors, first[:, :, None], axis=2) < 0.0, -1.0, 1.0)
