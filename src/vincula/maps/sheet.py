"""One sheet of a map: every point of a grid that the mechanism reaches without changing its branch.

From the start the grid is filled neighbour by neighbour.  A step is taken only where the closure
corrects little and the determinant of the followed block keeps its sign, so a fold is never jumped;
what is not reached lies beyond a singularity, a joint limit, or out of reach.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from vincula.arrays import Vector
from vincula.errors import ModelError
from vincula.maps.variables import Plane
from vincula.mechanism.closure_problem import ClosureProblem, Equations
from vincula.mechanism.closure_solver import Limits, minimum_norm, solve
from vincula.mechanism.configuration import Configuration
from vincula.mechanism.holding import asked, held_columns, problem_for
from vincula.mechanism.watching import Measure, Watch, decided, measured_block, watches
from vincula.numerics.rank import negligible

CLOSE_ENOUGH: Final = 1e-11
"""Scaled closure residual of every point on a sheet."""
FAR: Final = 0.3
"""A correction longer than this share of its step may lead to another branch."""
HALVINGS: Final = 3
"""How often a step to the next point of the grid is halved before it is given up."""

Node = tuple[int, int]
Progress = Callable[[int, int], None]
"""Called with the points done and the points in all."""


@dataclass(frozen=True, slots=True, eq=False)
class Point:
    """A closed state on a sheet, with the blocks that are watched there."""

    state: Vector
    equations: Equations
    measures: tuple[Measure, ...]


class Sheet:
    """The part of a map that one branch reaches.

    Args:
        plane: The variables.
        limits: Whether joint limits end the sheet.

    Attributes:
        grid: Values of the two variables.
        points: The points reached, by place in the grid.

    Raises:
        ModelError: What is held does not determine the configuration.
    """

    def __init__(self, plane: Plane, *, limits: bool = True) -> None:
        self.plane = plane
        mechanism = plane.mechanism
        self.grid = tuple(variable.values for variable in plane.variables)
        self.motors = tuple(mechanism.active)
        first = plane.held_at(plane.at_start())
        self.problem: ClosureProblem = problem_for(
            mechanism, first, self.motors, member=mechanism.reference is not None
        )
        fixed = held_columns(self.problem, first)
        self.free = ~fixed
        self.bounds = Limits(*self.problem.variables.limits(mechanism)) if limits else None
        self._start = self.problem.start(plane.start)
        here = self.problem.equations(self._start)
        residual = float(np.linalg.norm(here.gaps))
        everything = watches(self.problem, self.motors, fixed)
        self.watching: tuple[Watch, ...] = everything
        self._ranks = self._generic_ranks(here, residual)
        self._followed = decided(here.jacobian[:, self.free], residual).rank
        self._refuse_freedom(here)
        self.points: dict[Node, Point] = {}

    def fill(self, progress: Progress | None = None) -> None:
        """Reach everything that can be reached from the start."""
        node, point = self.entry()
        self.points = {node: point}
        self._spread(node, progress)

    def extend(self, node: Node, q: Configuration) -> list[Node]:
        """Add a configuration at a point of the grid that lies on the same branch, and go on from it.

        Returns:
            The points added.
        """
        before = set(self.points)
        state = asked(self.problem, self.problem.start(q), self.plane.held_at(self.place(node)))
        self.points[node] = self.measure(solve(self.problem, state, self.free, iterations=6).state)
        self._spread(node, None)
        return [new for new in self.points if new not in before]

    def _spread(self, node: Node, progress: Progress | None) -> None:
        queue = deque([node])
        total = len(self.grid[0]) * len(self.grid[1])
        while queue:
            node = queue.popleft()
            for other in self.neighbours(node):
                if other not in self.points:
                    found = self.step(self.points[node], self.place(node), self.place(other))
                    if found is not None:
                        self.points[other] = found
                        queue.append(other)
            if progress is not None:
                progress(len(self.points), total)

    def place(self, node: Node) -> Vector:
        """Values of the two variables at a point of the grid."""
        return np.array([self.grid[0][node[0]], self.grid[1][node[1]]])

    def neighbours(self, node: Node) -> Iterator[Node]:
        """The up to four neighbours in the grid."""
        i, j = node
        for other in ((i - 1, j), (i + 1, j), (i, j - 1), (i, j + 1)):
            if 0 <= other[0] < len(self.grid[0]) and 0 <= other[1] < len(self.grid[1]):
                yield other

    def step(self, point: Point, here: Vector, there: Vector, halvings: int = HALVINGS) -> Point | None:
        """The point at other values on the same branch; None where the branch does not lead there."""
        done, share = point, 1.0
        at = 0.0
        while at < 1.0:
            target = min(at + share, 1.0)
            found = self._leap(done, here + target * (there - here))
            if found is None:
                share *= 0.5
                if share < 0.5**halvings:
                    return None
            else:
                done, at = found, target
        return done

    def nearest(self, values: Vector) -> Node:
        """The point reached that is nearest to some values, in steps of the grid."""
        steps = np.array([axis[1] - axis[0] for axis in self.grid])
        return min(self.points, key=lambda node: float(np.sum(((self.place(node) - values) / steps) ** 2)))

    def at(self, point: Point, values: Vector) -> Point | None:
        """The point at values near a point on the same branch, in one step."""
        return self._leap(point, values)

    def is_continuous(self, one: Node, two: Node) -> bool:
        """Whether two neighbouring points lie on one continuous piece: a sheet may wind about a hole."""
        there = self._predicted(self.points[one], self.place(two))
        apart = self.problem.variables.step_between(there, self.points[two].state)
        length = np.linalg.norm(self.problem.variables.step_between(self.points[one].state, there))
        if float(np.linalg.norm(apart)) <= FAR * float(length):
            return True
        again = self.step(self.points[one], self.place(one), self.place(two))
        if again is None:
            return False
        apart = self.problem.variables.step_between(again.state, self.points[two].state)
        return float(np.linalg.norm(apart)) < 1e-6

    def configuration(self, point: Point) -> Configuration:
        """The configuration of a point."""
        return self.problem.configuration(point.state, self.plane.start)

    def measure(self, state: Vector) -> Point:
        """A state with its equations and watched blocks."""
        equations = self.problem.equations(state)
        blocks = zip(self.watching, self._ranks, strict=True)
        return Point(state, equations, tuple(measured_block(equations, w.columns, r) for w, r in blocks))

    def entry(self) -> tuple[Node, Point]:
        """The first point: from the start to the nearest point of the grid that can be reached."""
        start = self.plane.at_start()
        first, second = np.meshgrid(*self.grid, indexing="ij")
        size = [float(axis[-1] - axis[0]) for axis in self.grid]
        away = ((first - start[0]) / size[0]) ** 2 + ((second - start[1]) / size[1]) ** 2
        begin = self.measure(self._start)
        for flat in np.argsort(away, axis=None)[:9]:
            node = tuple(int(k) for k in np.unravel_index(flat, away.shape))
            found = self.step(begin, start, self.place((node[0], node[1])), halvings=10)
            if found is not None:
                return (node[0], node[1]), found
        names = [v.name for v in self.plane.variables]
        raise ModelError(
            f"the branch of the start configuration, at {names[0]} = {start[0]:.6g}, "
            f"{names[1]} = {start[1]:.6g}, does not reach the grid: choose ranges around it, or another start"
        )

    def _predicted(self, point: Point, values: Vector) -> Vector:
        where = self.problem.variables
        goal = asked(self.problem, point.state, self.plane.held_at(values))
        way = where.step_between(point.state, goal)
        way[self.free] = 0.0
        jacobian = point.equations.jacobian
        way[self.free] = minimum_norm(jacobian[:, self.free], -(jacobian @ way))
        return asked(self.problem, where.moved(point.state, way), self.plane.held_at(values))

    def _leap(self, point: Point, values: Vector) -> Point | None:
        where = self.problem.variables
        predicted = self._predicted(point, values)
        length = float(np.linalg.norm(where.step_between(point.state, predicted)))
        found = solve(self.problem, predicted, self.free, iterations=6)
        if found.residual > CLOSE_ENOUGH:
            return None
        if float(np.linalg.norm(where.step_between(predicted, found.state))) > FAR * length + 1e-9:
            return None
        if self.bounds is not None:
            scalars = where.scalar_values(found.state)
            if ((scalars < self.bounds.lower - 1e-12) | (scalars > self.bounds.upper + 1e-12)).any():
                return None
        there = self.measure(found.state)
        before = measured_block(point.equations, self.free, self._followed)
        after = measured_block(there.equations, self.free, self._followed)
        return there if after.sign_against(before) > 0.0 else None

    def _generic_ranks(self, here: Equations, residual: float) -> list[int]:
        """Ranks of the watched blocks; at a singular start those of a point beside it."""
        ranks = [decided(here.jacobian[:, w.columns], residual).rank for w in self.watching]
        rng = np.random.default_rng(0)
        free = np.ones(self.problem.columns, dtype=bool)
        nudge = 0.02 * rng.uniform(-1.0, 1.0, self.problem.columns)
        beside = solve(self.problem, self.problem.variables.moved(self._start, nudge), free)
        if beside.residual < CLOSE_ENOUGH:
            other = [
                decided(beside.equations.jacobian[:, w.columns], beside.residual).rank for w in self.watching
            ]
            ranks = [max(pair) for pair in zip(ranks, other, strict=True)]
        return ranks

    def _refuse_freedom(self, here: Equations) -> None:
        """Refuse to map what is not determined: the member or a motor that moves with everything held."""
        block = measured_block(here, self.free, self._followed)
        loose = np.zeros((self.problem.columns, block.right.shape[1] - self._followed))
        loose[self.free] = block.right[:, self._followed :]
        seen = [self.problem.variables.column[m] for m in self.motors]
        if self.plane.mechanism.reference is not None:
            from vincula.mechanism.closure_unknowns import MEMBER

            place = self.problem.variables.columns_of[MEMBER]
            seen += list(range(place.start, place.stop))
        part = float(np.abs(loose[seen]).max(initial=0.0))
        if not negligible(part, 1.0, 1e-6):
            names = [v.name for v in self.plane.variables]
            raise ModelError(
                f"with {names[0]}, {names[1]} and the other motors held the mechanism can still move: "
                "a map needs variables that fix it; name other variables or other motors"
            )


def mask(sheet: Sheet) -> NDArray[np.bool_]:
    """For every point of the grid, whether the sheet reaches it."""
    reached = np.zeros((len(sheet.grid[0]), len(sheet.grid[1])), dtype=bool)
    for node in sheet.points:
        reached[node] = True
    return reached
