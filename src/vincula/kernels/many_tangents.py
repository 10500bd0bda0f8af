"""Ways in which many configurations can change, and derivatives along them: `tangents`, many at once.

Derivatives come as the forces of `virtual_work`; along a motion each is one product.  What is not clear from
the counts alone (motors that cannot move alone, ranks that change along a direction, loops that do not close
again) is left to the path for one configuration, which says why.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from vincula.kernels.many_sensitivities import ManySensitivities, pseudo_inverse
from vincula.kernels.tangents import CLOSES, SEEN
from vincula.mechanism.many_frames import Stack
from vincula.mechanism.many_matrices import ordered
from vincula.mechanism.placement_rates import PlacementRates
from vincula.mechanism.redrawn import Redrawn
from vincula.mechanism.virtual_work import FrameForces
from vincula.numerics.rank import decide_rank

CLEARLY_KEPT: Final = 1e-10
"""How far a direction may lead out of the range of A, relative to A and the direction, where the rank is
clearly constant: rounding of a well conditioned mechanism."""

Kept = NDArray[np.bool_]


class ManyTangents:
    """Directions of N configurations with the same ranks, none of which lets the member move by itself.

    Args:
        found: Their kernels.
    """

    def __init__(self, found: ManySensitivities) -> None:
        self.found = found
        self._motions: Stack = found.column[:, None] * found.kernel
        counts = found.counts
        self._driven = counts.mobility - counts.passive_redundancy - counts.indeterminacy

    def by_motors(self, forces: FrameForces) -> tuple[Stack, Kept]:
        """Derivatives of y^T A k by motors, N x e x n_a, and where they are certain."""
        motors = self._motions[:, : self.found.active]
        motions = self._motions @ pseudo_inverse(motors, self._driven)
        rates = np.swapaxes(motions, 1, 2)
        return forces.on_motions() @ motions, self._keeps_rank(rates, None)

    def by_joints(self, forces: FrameForces) -> tuple[Stack, Kept]:
        """The shortest covectors on all joint rates, in the order of the layout, N x e x columns."""
        along = forces.on_motions() @ self._motions
        columns = self.found.active + self.found.passive
        rates = np.empty((len(along), columns, self._motions.shape[2]))
        rates[:, ordered(self.found.many.layout)] = self._motions[:, :columns]
        left, values, right = np.linalg.svd(rates)
        kept = self._keeps_rank(np.swapaxes(self._motions, 1, 2), None)
        result = np.full((*along.shape[:2], columns), np.nan)
        turned = along @ np.swapaxes(right, 1, 2)
        for lane in np.flatnonzero(kept):
            rank = decide_rank(rates[lane], name="joint rates that are possible", values=values[lane]).rank
            unseen, size = turned[lane][:, rank:], max(1.0, float(np.abs(along[lane]).max(initial=0.0)))
            kept[lane] = not float(np.abs(unseen).max(initial=0.0)) > SEEN * size
            result[lane] = (turned[lane][:, :rank] / values[lane, :rank]) @ left[lane][:, :rank].T
        return result, kept

    def by_dimensions(self, forces: FrameForces, rates: PlacementRates) -> tuple[Stack, Kept]:
        """Derivatives of y^T A k by dimensions, motors held and loops closed again, N x e x p."""
        found, n_a = self.found, self.found.active
        redrawn = Redrawn(found.many, rates)
        size = np.linalg.norm(redrawn.frames, axis=(2, 3)) + np.linalg.norm(redrawn.opening, axis=2)
        shortest, left_open = found.closing(redrawn.opening * found.row)
        back = pseudo_inverse(found.kernel[:, :n_a], self._driven)
        motions = shortest - (shortest[..., :n_a] @ np.swapaxes(back, 1, 2)) @ np.swapaxes(found.kernel, 1, 2)
        wrong = np.maximum(np.linalg.norm(left_open, axis=2), np.linalg.norm(motions[..., :n_a], axis=2))
        if redrawn.rigid.shape[2]:
            wrong = np.maximum(wrong, np.abs(redrawn.rigid).max(axis=(2, 3)))
        kept = (wrong <= CLOSES * size).all(axis=1)
        moved = motions * found.column
        along = forces.of(redrawn) + forces.on_motions() @ np.swapaxes(moved, 1, 2)
        return along, kept & self._keeps_rank(moved, redrawn)

    def _keeps_rank(self, motions: Stack, redrawn: Redrawn | None) -> Kept:
        """Whether the rank of A clearly stays what it is along N x p motions, and as dimensions change."""
        found = self.found
        lanes, mobility = len(motions), found.kernel.shape[2]
        idle = found.unreached.shape[2]
        if not idle or not mobility or not motions.shape[1]:
            return np.ones(lanes, dtype=bool)
        unreached = np.repeat(np.swapaxes(found.unreached, 1, 2), mobility, axis=1)
        kernel = np.tile(np.swapaxes(found.kernel, 1, 2), (1, idle, 1))
        forces = found.forces_of(unreached, kernel)
        out = forces.on_motions() @ np.swapaxes(motions, 1, 2)
        size = np.linalg.norm(motions / found.column, axis=2)
        if redrawn is not None:
            out = out + forces.of(redrawn)
            size = size + np.linalg.norm(redrawn.frames, axis=(2, 3))
        scale = np.linalg.norm(found.matrix, axis=(1, 2))
        return np.asarray((np.linalg.norm(out, axis=1) <= CLEARLY_KEPT * scale[:, None] * size).all(axis=1))
