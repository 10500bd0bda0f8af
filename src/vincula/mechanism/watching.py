"""Watching the ranks of the closure equations along a path: signed measures that vanish at singularities.

Three blocks are watched: all columns (the loops themselves), the motors locked (what then still moves is
out of control), the reference member locked (motors that then still move have no authority over it).
The measure of a block is its smallest kept singular value, with the sign of a determinant taken
against the bases of the step before; so a simple singularity is a simple root.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np

from vincula.arrays import Matrix, Vector
from vincula.mechanism.closure_problem import ClosureProblem, Equations
from vincula.mechanism.closure_unknowns import MEMBER
from vincula.mechanism.closure_values import Mask
from vincula.numerics.lapack import svd
from vincula.numerics.rank import EPS, RankDecision, decide_rank

SingularityKind = Literal["platform free", "motors without authority", "internal"]
"""What a singularity is: the member moves with the motors locked; motors move with the member locked;
loops or passive joints alone."""


@dataclass(frozen=True, slots=True, eq=False)
class Watch:
    """One block of columns.

    Attributes:
        name: `loops`, `motors locked`, `member locked`, or `held` (the reference point alone locked).
        columns: The columns of the block.
    """

    name: Literal["loops", "motors locked", "member locked", "held"]
    columns: Mask


@dataclass(frozen=True, slots=True, eq=False)
class Measure:
    """The singular value decomposition of a block at one state, to a given rank.

    Attributes:
        rank: The generic rank that is assumed.
        left: All left singular vectors.
        values: Singular values.
        right: All right singular vectors.
        jacobian: The block.
    """

    rank: int
    left: Matrix
    values: Vector
    right: Matrix
    jacobian: Matrix

    @property
    def smallest(self) -> float:
        """Smallest kept singular value: the distance to the nearest singular block, scaled units."""
        return float(self.values[self.rank - 1]) if self.rank else float("inf")

    @property
    def has_sign(self) -> bool:
        """Whether the smallest kept value is above rounding, so that signs of determinants mean something."""
        return decide_rank(self.jacobian, name="closure equations", values=self.values).rank == self.rank

    def solved(self, target: Vector) -> Vector:
        """Minimum-norm solution of jacobian @ x = target at the assumed rank."""
        kept = self.values[: self.rank]
        coordinates = (self.left[:, : self.rank].T @ target) / kept
        return np.asarray(self.right[:, : self.rank] @ coordinates)

    def sign_against(self, before: Measure) -> float:
        """-1 when the determinant on the bases of `before` has changed sign, else +1."""
        r = self.rank
        if r == 0:
            return 1.0
        reduced = before.left[:, :r].T @ self.jacobian @ before.right[:, :r]
        return float(np.linalg.slogdet(reduced)[0]) or 1.0

    def lost(self, around: Sequence[Matrix], rank: int) -> tuple[Matrix, Matrix]:
        """The kernel where kept values vanish, and the directions that are new in it.

        There they cannot be told from what is never constrained (a rod that spins about its own axis)
        by singular values: they are what the kernels around do not hold.

        Args:
            around: Orthonormal bases of the kernels at regular points near by, evenly about this one, so
                that what is linear in their distance cancels; none where nothing is generically free.
            rank: The rank here, below the generic one.
        """
        kernel = self.right[:, min(rank, self.rank - 1) :]
        count = self.rank - min(rank, self.rank - 1)
        if kernel.shape[1] == count or not around:
            return kernel, kernel[:, :count]
        return kernel, beyond(kernel, around, count)


def beyond(kernel: Matrix, others: Sequence[Matrix], count: int) -> Matrix:
    """Orthonormal directions of a kernel that are least in other kernels, on the average of them.

    Args:
        kernel: Orthonormal basis.
        others: Orthonormal bases of smaller kernels.
        count: How many directions.
    """
    inside = np.zeros((kernel.shape[1], kernel.shape[1]))
    for other in others:
        shared = other.T @ kernel
        inside += shared.T @ shared
    return np.asarray(kernel @ np.linalg.eigh(inside)[1][:, :count])


def measured(jacobian: Matrix, rank: int) -> Measure:
    """The measure of a block at an assumed rank."""
    return Measure(rank, *svd(jacobian), jacobian)


def measured_block(equations: Equations, columns: Mask, rank: int) -> Measure:
    """The measure of some columns at an assumed rank; decomposed once a state."""
    key = columns.tobytes()
    block = equations.jacobian[:, columns]
    if key not in equations.decomposed:
        equations.decomposed[key] = svd(block)
    return Measure(rank, *equations.decomposed[key], block)


def decided(jacobian: Matrix, residual: float, values: Vector | None = None) -> RankDecision:
    """Rank of a block of the closure equations when they are satisfied to `residual` (scaled).

    The closure part of the uncertainty is the ledger's: residual / sigma where a regular solution is
    proved to be near (Kantorovich), else the square root of twice the residual.
    """
    first = decide_rank(jacobian, name="closure equations", values=values)
    rho = max(residual, EPS)
    size = float(first.singular_values[0]) if len(first.singular_values) else 1.0
    sigma = first.kept
    doubt = rho / sigma if rho < 0.5 * sigma * sigma else (2.0 * rho) ** 0.5
    return decide_rank(
        jacobian,
        name="closure equations",
        uncertainty={"closure": doubt / size if size > 0.0 else 0.0},
        values=first.singular_values,
    )


def watches(problem: ClosureProblem, motors: Iterable[str], held: Mask) -> tuple[Watch, ...]:
    """What is watched along a path.

    Args:
        problem: Equations in which the motors, and the member if there is one, are unknowns.
        motors: Names of the motors' axes and drives.
        held: For every rate, whether the path holds it.
    """
    everything = np.ones(problem.columns, dtype=bool)
    everything &= ~locked(problem)
    where = problem.variables
    driven = everything.copy()
    for name in motors:
        driven[where.column[name]] = False
    found = [Watch("loops", everything)]
    if not np.array_equal(driven, everything):
        found.append(Watch("motors locked", driven))
    if MEMBER in where.columns_of:
        still = everything.copy()
        still[where.columns_of[MEMBER]] = False
        found.append(Watch("member locked", still))
    free = everything & ~held
    if not any(np.array_equal(free, watch.columns) for watch in found):
        found.append(Watch("held", free))
    return tuple(found)


def locked(problem: ClosureProblem) -> Mask:
    """For every rate, whether its axis is locked for good."""
    mask = np.zeros(problem.columns, dtype=bool)
    for axis in problem.mechanism.lock:
        if axis in problem.variables.column:
            mask[problem.variables.column[axis]] = True
    return mask


ZERO_SHARE: Final = 1e-3
"""A joint whose part in a singular direction is below this is not named in words."""
