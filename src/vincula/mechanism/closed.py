"""A closed configuration, and what it says of itself: how it was found, how well it closes, where it is.

Nothing is ever moved silently: it tells how far it is from the start, and whether a regular solution is
proved to be near (Kantorovich).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from vincula.arrays import Vector
from vincula.mechanism.closure_problem import ClosureProblem
from vincula.mechanism.closure_solver import Solution
from vincula.mechanism.closure_unknowns import MEMBER
from vincula.mechanism.closure_values import Mask
from vincula.mechanism.configuration import Configuration
from vincula.mechanism.holding import Holding
from vincula.mechanism.residuals import LoopResidual, axis_values
from vincula.numerics.lapack import svd
from vincula.numerics.rank import decide_rank

if TYPE_CHECKING:
    from vincula.mechanism.branches import Branch
    from vincula.mechanism.mechanism import Mechanism
    from vincula.mechanism.singularities import Singularity


@dataclass(frozen=True, slots=True, eq=False)
class Closing:
    """How a configuration was found.

    Attributes:
        mechanism: The mechanism.
        held: What was held.
        problem: The equations.
        solution: Their solution.
        free: For every rate, whether it was free to move.
        start: The state that the search started from.
        near: The configuration that the search started from.
    """

    mechanism: Mechanism
    held: Holding
    problem: ClosureProblem
    solution: Solution
    free: Mask
    start: Vector
    near: Configuration


class ClosedConfiguration(Configuration):
    """A configuration that closes all loops; usable wherever a configuration is.

    Attributes:
        residuals: Gap of every loop, contact and coupling.
        iterations: Jacobians evaluated, over all starts.
        attempts: Starts tried.
        held: Names of what was held.
        at_limits: Axes that ended on a limit.
    """

    def __init__(self, values: Configuration, found: Closing, iterations: int, attempts: int) -> None:
        super().__init__(values)
        self._found = found
        self.iterations, self.attempts = iterations, attempts
        self.held = found.held.names
        self.residuals: tuple[LoopResidual, ...] = found.mechanism.residuals(values)
        names = found.problem.variables.names
        self.at_limits = tuple(names[k] for k in np.flatnonzero(found.solution.held_by_limit))

    @property
    def residual(self) -> float:
        """Largest gap, metres with angles times the characteristic length."""
        return max((r.gap for r in self.residuals), default=0.0)

    @cached_property
    def kantorovich(self) -> float:
        """h = residual / sigma^2 in scaled units: below 1/2 a regular closed configuration is near.

        sigma is the smallest singular value of the closure Jacobian that its own rank keeps.
        """
        jacobian = self._found.solution.equations.jacobian[:, self._found.free]
        sigma = decide_rank(jacobian, name="closure equations").kept
        return float(self._found.solution.residual / (sigma * sigma))

    @cached_property
    def free_motions(self) -> int:
        """Dimension of the motions that what was held leaves, to first order."""
        jacobian = self._found.solution.equations.jacobian[:, self._found.free]
        return int(jacobian.shape[1] - decide_rank(jacobian, name="closure equations").rank)

    def nudged(self, size: float) -> Iterator[Configuration]:
        """This configuration displaced along every free motion; open by the square of `size`."""
        problem, free = self._found.problem, self._found.free
        jacobian = self._found.solution.equations.jacobian[:, free]
        _, values, right = svd(jacobian)
        rank = decide_rank(jacobian, name="closure equations", values=values).rank
        for k in range(rank, right.shape[1]):
            step = np.zeros(problem.columns)
            step[free] = size * right[:, k]
            yield problem.configuration(problem.variables.moved(self._found.solution.state, step), self)

    @cached_property
    def moved(self) -> dict[str, float]:
        """How far closing moved every axis from the start [rad, m], motors over several axes included.

        Axes of balls that close loops have no value to compare and are left out.
        """
        where = self._found.problem.variables
        step = where.step_between(self._found.start, self._found.solution.state) * where.column_scale
        moved = {
            name: float(value)
            for name, value in zip(where.names, step, strict=True)
            if not name.startswith(MEMBER)
        }
        before, after = (axis_values(self._found.mechanism, q) for q in (self._found.near, self))
        moved.update({axis: after[axis] - before[axis] for axis in after if axis not in moved})
        return moved

    @cached_property
    def branch(self) -> Branch:
        """Signs that name the assembly branch: with the motors locked, and with the member locked."""
        from vincula.mechanism.branches import branch_of

        return branch_of(self._found.mechanism, self)

    @cached_property
    def singularities(self) -> tuple[Singularity, ...]:
        """What is singular here: loops, motors, reference member; empty at a regular configuration."""
        from vincula.mechanism.singularities import singularities_at

        found: tuple[Singularity, ...] = singularities_at(self._found.mechanism, self)
        return found

    @property
    def singular(self) -> bool:
        """Whether anything is singular here."""
        return bool(self.singularities)
