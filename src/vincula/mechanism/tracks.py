"""One stretch of a path: held values move along a geodesic, everything else follows by closure.

The unknowns of a track are the free rates and the distance s that the held values have travelled.
Tangent, predictor and corrector work in both together (pseudo-arclength), so that a fold, where the
held values must turn back, is an ordinary point of the curve and can be located.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from vincula.arrays import Matrix, Vector
from vincula.mechanism.closure_problem import ClosureProblem, Equations
from vincula.mechanism.closure_values import Mask
from vincula.mechanism.watching import measured, measured_block

POLISHED: Final = 5e-15
"""Scaled closure residual that needs no further correction."""


@dataclass(frozen=True, eq=False)
class TrackPoint:
    """A closed state on a track.

    Attributes:
        state: Values of all unknowns.
        travelled: Distance s of the held values since the start of the track.
        equations: Gaps and Jacobian there.
    """

    state: Vector
    travelled: float
    equations: Equations

    @property
    def residual(self) -> float:
        """Norm of the scaled gaps."""
        return float(np.linalg.norm(self.equations.gaps))


class Track:
    """A stretch between two values of what is held.

    Args:
        problem: The closure equations.
        free: For every rate, whether it follows.
        way: Step of the held rates from begin to end of the track, zero on the free ones.
        rank: Generic rank of the free block.
    """

    def __init__(self, problem: ClosureProblem, free: Mask, way: Vector, rank: int) -> None:
        self.problem, self.free, self.rank = problem, free, rank
        self.length = float(np.linalg.norm(way))
        self.direction = way / self.length

    def at(self, state: Vector, travelled: float) -> TrackPoint:
        """The point of a state."""
        return TrackPoint(state, travelled, self.problem.equations(state))

    def augmented(self, point: TrackPoint) -> Matrix:
        """[J_free, J s-direction] at a point."""
        jacobian = point.equations.jacobian
        return np.column_stack([jacobian[:, self.free], jacobian @ self.direction])

    def moved(self, point: TrackPoint, step: Vector) -> TrackPoint:
        """The point after a step (free rates, then s)."""
        full = step[-1] * self.direction
        full[self.free] = step[:-1]
        return self.at(self.problem.variables.moved(point.state, full), point.travelled + float(step[-1]))

    def step_between(self, one: TrackPoint, two: TrackPoint) -> Vector:
        """The step (free rates, then s) from one point to another."""
        full = self.problem.variables.step_between(one.state, two.state)
        return np.append(full[self.free], two.travelled - one.travelled)

    def tangent(self, point: TrackPoint, along: Vector | None = None) -> tuple[Vector, float]:
        """Unit tangent of the curve, and the share of the held motion that closure forbids.

        Free motions that need no held motion are left out (minimum norm).

        Args:
            point: Where.
            along: A direction that the tangent must not oppose; by default s increases.
        """
        follow = measured_block(point.equations, self.free, self.rank)
        driven = point.equations.jacobian @ self.direction
        rates = -follow.solved(driven)
        size = float(np.linalg.norm(driven))
        missed = float(np.linalg.norm(follow.jacobian @ rates + driven))
        tangent = np.append(rates, 1.0)
        tangent /= np.linalg.norm(tangent)
        if along is not None and float(tangent @ along) < 0.0:
            tangent = -tangent
        return tangent, missed / size if size > 0.0 else 0.0

    def corrected(
        self, point: TrackPoint, *, normal: Vector | None = None, landing: bool = False
    ) -> tuple[TrackPoint, list[float]]:
        """The closed point near a predicted one, and the lengths of the corrections.

        Args:
            point: The prediction.
            normal: Unit vector that corrections are orthogonal to; by default they are shortest.
            landing: Whether s keeps its value.
        """
        sizes: list[float] = []
        best = point.residual
        for _ in range(8):
            if landing:
                follow = measured_block(point.equations, self.free, self.rank)
                step = np.append(follow.solved(-point.equations.gaps), 0.0)
            else:
                block = self.augmented(point)
                if normal is not None:
                    block = block - np.outer(block @ normal, normal)
                step = measured(block, self.rank).solved(-point.equations.gaps)
            trial = self.moved(point, step)
            size = float(np.linalg.norm(step))
            if best < 1e-13 and trial.residual >= best:
                break
            sizes.append(size)
            point, best = trial, trial.residual
            if not size < 1e3 or best < POLISHED:
                break
        return point, sizes

    def between(self, one: TrackPoint, two: TrackPoint, share: float) -> TrackPoint:
        """The closed point at a share of the chord from one point to another near by."""
        chord = self.step_between(one, two)
        size = float(np.linalg.norm(chord))
        unit = chord / size
        start, _ = self.tangent(one, unit)
        end, _ = self.tangent(two, unit)
        slope_0 = start * (size / max(float(start @ unit), 0.1))
        slope_1 = end * (size / max(float(end @ unit), 0.1))
        a, b = share, 1.0 - share
        step = a * a * (3.0 - 2.0 * a) * chord + a * b * b * slope_0 - a * a * b * slope_1
        step += (share * size - float(step @ unit)) * unit
        return self.corrected(self.moved(one, step), normal=unit)[0]
