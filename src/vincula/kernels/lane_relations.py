"""Relations of many configurations: motions, equilibria, internal forces, as stacks of pairs of vectors.

Source: theory page, sections 4 and 5.  Lanes give motions in their finite, free and idle parts under the
metrics of their program; equilibria are what does no work in any of them.  Internal forces come from the
whole matrices, passive joints eliminated limb by limb.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from vincula.arrays import Vector
from vincula.kernels.lane_block import LaneBlock
from vincula.kernels.small_matrices import Stack, products
from vincula.kernels.small_subspaces import complements, orthonormal
from vincula.numerics.rank import decide_rank

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism
    from vincula.model import LinearModel

AT_ONCE: Final = 1 << 18
"""Numbers of whole matrices that are held at a time."""


@dataclass(frozen=True, slots=True, eq=False)
class Parts:
    """A relation of every lane, in its parts; vectors are physical, in m, rad, N, N m.

    Attributes:
        infinite: N x e x t task sides of the pairs without a motor side.
        task: N x f x t task sides of a complement of the others.
        motor: N x f x r its motor sides.
        zero: N x z x r motor sides of the pairs without a task side.
    """

    infinite: Stack
    task: Stack
    motor: Stack
    zero: Stack

    def joined(self, of_task: Vector, of_motor: Vector) -> tuple[Stack, Stack]:
        """All pairs as one basis, task sides and motor sides, multiplied by factors a component."""
        count, e, t = self.infinite.shape
        z, r = self.zero.shape[1:]
        tasks = [self.infinite * of_task, self.task * of_task, np.zeros((count, z, t))]
        motors = [np.zeros((count, e, r)), self.motor * of_motor, self.zero * of_motor]
        return np.concatenate(tasks, axis=1), np.concatenate(motors, axis=1)


def motions(block: LaneBlock) -> Parts:
    """Twists of the member and the rates that go with them; `MOTIONS` and `REST` must have been wanted."""
    free, twists, rates, idle = _in_lengths(block)
    of_rates, of_twists = block.program.roots
    sines, cosines = _sines_and_cosines(block)
    return Parts(free / of_twists, twists * cosines / of_twists, rates * sines / of_rates, idle / of_rates)


def equilibria(block: LaneBlock) -> Parts:
    """Wrenches on the member and the torques that balance them: tau.q_a + w.u = 0 in every motion."""
    _, twists, rates, _ = _in_lengths(block)
    of_rates, of_twists = block.program.roots
    sines, cosines = _sines_and_cosines(block)
    return Parts(
        structural(block) * of_twists,
        twists * sines * of_twists,
        rates * -cosines * of_rates,
        internal(block) * of_rates,
    )


def structural(block: LaneBlock) -> Stack:
    """Wrenches that no motion of the member feels, orthonormal in lengths of the reciprocal metric."""
    free, twists, _, _ = _in_lengths(block)
    return block.once("structural", lambda: complements(np.concatenate([free, twists], axis=1), block.sure))


def internal(block: LaneBlock) -> Stack:
    """Torques that no allowed rate feels, orthonormal in lengths of the reciprocal metric."""
    _, _, rates, idle = _in_lengths(block)
    return block.once("internal", lambda: complements(np.concatenate([idle, rates], axis=1), block.sure))


def _in_lengths(block: LaneBlock) -> tuple[Stack, Stack, Stack, Stack]:
    """Free twists, twists, rates and idle rates, each orthonormal in lengths of the program's metrics."""
    raw = block.raw
    if raw.twists is None or raw.rates is None or raw.free is None or raw.idle is None:
        raise RuntimeError("lanes were not asked for motions")
    of_rates, of_twists = block.program.roots
    return raw.free, raw.twists * of_twists, raw.rates * of_rates, raw.idle


def _sines_and_cosines(block: LaneBlock) -> tuple[Stack, Stack]:
    """Shares of motors and twist in the motions, N x f x 1."""
    sines = 1.0 / np.sqrt(1.0 + block.raw.efficiencies)
    cosines = np.sqrt(block.raw.efficiencies) * sines
    return sines[:, :, None], cosines[:, :, None]


@dataclass(frozen=True, slots=True, eq=False)
class LimbRows:
    """One limb in the equations of internal forces.

    Attributes:
        rows: Its rows.
        passive: Its passive columns, in the order of A.
        rank: Rank of these columns.
    """

    rows: list[int]
    passive: list[int]
    rank: int


@dataclass(frozen=True, slots=True, eq=False)
class Squeezing:
    """How internal forces of a mechanism are found: {f: G f = 0, J_p^T f = 0}, tau = -J_a^T f.

    Attributes:
        limbs: Its limbs.
        motors: Number of motors.
        rows: Number of rows m.
        columns: Number of joint columns.
        member: Rank that the member's columns add to the passive ones.
    """

    limbs: tuple[LimbRows, ...]
    motors: int
    rows: int
    columns: int
    member: int

    @staticmethod
    def of(mechanism: Mechanism, model: LinearModel) -> Squeezing | str:
        """The limbs of a mechanism with their ranks at a configuration; or why they do not tell.

        Args:
            mechanism: The mechanism.
            model: Its matrices where all ranks are those of lanes that are certain.
        """
        from vincula.kernels.lanes.structure import Structure

        structure, ledger = Structure.of(mechanism.layout), model.ledger
        matrix, motors = ledger.matrix("all"), structure.motors
        limbs = []
        for blocks, columns in structure.limbs:
            rows = [structure.first[b] + k for b in blocks for k in range(structure.rows[b])]
            passive = sorted(c for c in columns if c >= motors)
            own = matrix[np.ix_(rows, passive)]
            limbs.append(LimbRows(rows, passive, decide_rank(own, scale=ledger.scale).rank))
        known = ledger.rank("passive")
        if sum(limb.rank for limb in limbs) != known:
            return "ranks limb by limb do not add up"
        member = ledger.rank("passive+member") - known
        return Squeezing(tuple(limbs), motors, len(matrix), len(structure.occurs[0]), member)

    def forces(self, block: LaneBlock) -> tuple[Stack, Stack]:
        """Orthonormal internal forces (N x h x m) and their torques (N x h x n_a), scaled."""
        count = len(block.values)
        step = max(1, AT_ONCE // (self.rows * (self.columns + 6)))
        found = [self._of_some(block, k, min(k + step, count)) for k in range(0, count, step)]
        if len(found) == 1:
            return found[0]
        return np.concatenate([f for f, _ in found]), np.concatenate([tau for _, tau in found])

    def _of_some(self, block: LaneBlock, first: int, last: int) -> tuple[Stack, Stack]:
        matrices, sure = block.matrices(first, last), block.sure[first:last]
        held: list[Stack] = []
        for limb in self.limbs:
            own = matrices[:, limb.rows]
            basis = orthonormal(own[:, :, limb.passive].transpose(0, 2, 1), sure, limb.rank)
            held.append(complements(basis, sure))
        reduced = [
            products(z, matrices[:, limb.rows, self.columns :], sure)
            for z, limb in zip(held, self.limbs, strict=True)
        ]
        of_member = np.concatenate(reduced, axis=1).transpose(0, 2, 1)
        kept = complements(orthonormal(of_member, sure, self.member), sure)
        forces = np.zeros((len(matrices), kept.shape[1], self.rows))
        place = 0
        for z, limb in zip(held, self.limbs, strict=True):
            forces[:, :, limb.rows] = products(kept[:, :, place : place + z.shape[1]], z, sure)
            place += z.shape[1]
        return forces, -products(forces, matrices[:, :, : self.motors], sure)
