"""One sheet of a map: every point of a grid that the mechanism reaches without changing its branch.

From the start the grid is filled neighbour by neighbour, all neighbours of what is reached at once.  A
step is taken only where the closure corrects little and the determinant of the followed block keeps its sign,
so a fold is never jumped; what is not reached lies beyond a singularity, a joint limit, or out of reach.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np
from numpy.typing import NDArray

from vincula.arrays import Vector
from vincula.errors import ModelError
from vincula.maps.branch import CLOSE_ENOUGH, Branch, Numbers, Points
from vincula.maps.stacked_rows import Stack
from vincula.maps.variables import Plane
from vincula.mechanism.closure_problem import ClosureProblem, Equations
from vincula.mechanism.closure_solver import Limits, solve
from vincula.mechanism.closure_unknowns import MEMBER
from vincula.mechanism.closure_values import Mask
from vincula.mechanism.configuration import Configuration
from vincula.mechanism.holding import asked, held_columns, problem_for
from vincula.mechanism.watching import Watch, decided, locked, measured_block, watches
from vincula.numerics.rank import negligible

HALVINGS: Final = 3
"""How often a step to the next point of the grid is halved before it is given up."""
EFFORTS: Final = ((0, False), (0, True), (HALVINGS, True))
"""How steps to neighbours are tried, one way after the other: halvings, and whether with patience."""
MOST_AT_ONCE: Final = 4096
"""Most points that are decomposed together: they take memory."""

Node = tuple[int, int]
Progress = Callable[[int, int], None]
"""Called with the points done and the points in all."""
_WAYS: Final = np.array([(-1, 0), (1, 0), (0, -1), (0, 1)])


class Sheet:
    """The part of a map that one branch reaches.  Points of the grid are numbered row by row.

    Args:
        plane: The variables.
        limits: Whether joint limits end the sheet.

    Attributes:
        grid: Values of the two variables.
        shape: Number of them.
        reached: For every point of the grid, whether the branch reaches it.
        states: State of every point reached, in the order of numbers.
        smallest: What is watched there; see `branch.Points`.

    Raises:
        ModelError: What is held does not determine the configuration, or cannot move.
    """

    def __init__(self, plane: Plane, *, limits: bool = True) -> None:
        self.plane = plane
        mechanism = plane.mechanism
        self.grid = tuple(variable.values for variable in plane.variables)
        self.shape = len(self.grid[0]), len(self.grid[1])
        self.motors = tuple(mechanism.active)
        first = plane.held_at(plane.at_start())
        limited = [
            axis
            for joint in mechanism.joints
            if limits and joint.limits and not joint.closure
            for axis in mechanism.type_of(joint).axis_names(joint.name)
        ]
        also = tuple(dict.fromkeys([*self.motors, *limited]))
        self.problem: ClosureProblem = problem_for(
            mechanism, first, also, member=mechanism.reference is not None
        )
        held = held_columns(self.problem, first)
        bounds = Limits(*self.problem.variables.limits(mechanism)) if limits else None
        self._start = asked(self.problem, self.problem.start(plane.start), first)
        watching = self._watching(held)
        here = self.problem.equations(self._start)
        ranks, generic = self._generic(here, [w.columns for w in watching])
        self._refuse_freedom(generic, ~held & ~locked(self.problem))
        chosen = self._chosen(watching, ranks, held)
        watching = tuple(watching[k] for k in chosen)
        self.branch = Branch(plane, self.problem, watching, [ranks[k] for k in chosen], held, bounds)
        self._refuse_standstill(generic[0])
        size = self.shape[0] * self.shape[1]
        self.reached: Mask = np.zeros(size, dtype=bool)
        self.states = np.zeros((size, len(self._start)))
        self.smallest = np.full((size, len(watching)), np.nan)

    @property
    def steps(self) -> Vector:
        """Distance of neighbours along both variables."""
        return np.array([axis[1] - axis[0] for axis in self.grid])

    def fill(self, progress: Progress | None = None) -> None:
        """Reach everything that can be reached from the start."""
        number, point = self.entry()
        self._settle(np.array([number]), point)
        self.spread(np.array([number]), progress)

    def spread(self, numbers: Numbers, progress: Progress | None = None) -> None:
        """Go on from some points that are reached: quick steps first, what they leave with more patience."""
        todo = self.pairs_out(numbers)
        for halvings, patient in EFFORTS:
            late = todo[:0]
            while len(todo):
                todo = todo[~self.reached[todo[:, 1]]]
                _, first = np.unique(todo[:, 1], return_index=True)
                now, todo = todo[first[:MOST_AT_ONCE]], np.delete(todo, first[:MOST_AT_ONCE], axis=0)
                if not len(now):
                    break
                points = self.points_at(now[:, 0])
                here, there = self.places(now[:, 0]), self.places(now[:, 1])
                good, found = self.branch.advance(points, here, there, halvings=halvings, patient=patient)
                self._settle(now[good, 1], found)
                late = np.concatenate([late, now[~good]])
                todo = np.concatenate([todo, self.pairs_out(now[good, 1])])
                if progress is not None:
                    progress(int(self.reached.sum()), len(self.reached))
            todo = late

    def pairs_out(self, numbers: Numbers) -> NDArray[np.intp]:
        """Pairs of a point and a neighbour that is not reached, m x 2."""
        nodes = np.stack(np.unravel_index(numbers, self.shape), axis=1)
        found = []
        for way in _WAYS:
            other = nodes + way
            inside = ((other >= 0) & (other < self.shape)).all(axis=1)
            number = np.ravel_multi_index(tuple(other[inside].T), self.shape)
            pair = np.stack([numbers[inside], number], axis=1)
            found.append(pair[~self.reached[number]])
        return np.concatenate(found)

    def pairs_inside(self, apart: int = 1) -> NDArray[np.intp]:
        """Pairs of points that are both reached, in one row or column, m x 2, the smaller number first.

        Args:
            apart: How far apart in the grid; neighbours by default.
        """
        number = np.arange(len(self.reached)).reshape(self.shape)
        pairs = np.concatenate([
            np.stack([number[:-apart].ravel(), number[apart:].ravel()], axis=1),
            np.stack([number[:, :-apart].ravel(), number[:, apart:].ravel()], axis=1),
        ])  # fmt: skip
        pairs = pairs[self.reached[pairs].all(axis=1)]
        return np.asarray(pairs[np.argsort(pairs[:, 0], kind="stable")])

    def node(self, number: int) -> Node:
        """Place in the grid of a numbered point."""
        return int(number) // self.shape[1], int(number) % self.shape[1]

    def places(self, numbers: Numbers) -> Stack:
        """n x 2 values of the two variables at points of the grid."""
        first, second = np.unravel_index(numbers, self.shape)
        return np.stack([self.grid[0][first], self.grid[1][second]], axis=1)

    def points_at(self, numbers: Numbers) -> Points:
        """Points that are reached, with their decompositions."""
        return self.branch.points(self.states[numbers])

    def nearest(self, values: Stack) -> Numbers:
        """For n x 2 values the points reached that are nearest, in steps of the grid."""
        from scipy.spatial import cKDTree

        known = np.flatnonzero(self.reached)
        tree = cKDTree(self.places(known) / self.steps)
        return np.asarray(known[tree.query(values / self.steps)[1]])

    def are_continuous(self, pairs: NDArray[np.intp]) -> Mask:
        """Whether pairs of neighbours lie on one continuous piece: a sheet may wind about a hole."""
        if not len(pairs):
            return np.zeros(0, dtype=bool)
        good, found = self.branch.advance(
            self.points_at(pairs[:, 0]), self.places(pairs[:, 0]), self.places(pairs[:, 1]), halvings=HALVINGS
        )
        good[good] = self.branch.differences(found.states, self.states[pairs[good, 1]]) < 1e-6
        return good

    def configuration(self, state: Vector) -> Configuration:
        """The configuration of a state."""
        return self.problem.configuration(state, self.plane.start)

    def add(self, pairs: NDArray[np.intp], states: Stack, values: Stack, *, same_side: bool) -> Numbers:
        """Add points of the grid that lie on the same branch.

        Args:
            pairs: m x 2, a point that is reached and its neighbour that is to be added.
            states: States near the neighbours.
            values: m x 2 values of the two variables at those states.
            same_side: Whether the followed determinant must have the sign that it has at the points reached:
                what leads there touched a singularity.

        Returns:
            Those that could be closed at their places.
        """
        todo = np.flatnonzero(~self.reached[pairs[:, 1]])
        first = todo[np.unique(pairs[todo, 1], return_index=True)[1]]
        numbers = pairs[first, 1]
        near = self.branch.points(states[first])
        good, found = self.branch.advance(near, values[first], self.places(numbers), halvings=8)
        numbers, before = numbers[good], pairs[first[good], 0]
        if same_side and len(numbers):
            right = self.branch.signs(self.points_at(before), found, self.branch.followed) > 0.0
            numbers, found = numbers[right], found.take(right)
        self._settle(numbers, found)
        return np.asarray(numbers)

    def entry(self) -> tuple[int, Points]:
        """The first point: from the start to the nearest point of the grid that can be reached."""
        start = self.plane.at_start()
        first, second = np.meshgrid(*self.grid, indexing="ij")
        size = [float(axis[-1] - axis[0]) for axis in self.grid]
        away = ((first - start[0]) / size[0]) ** 2 + ((second - start[1]) / size[1]) ** 2
        begin = self.branch.points(self._start[None])
        for number in np.argsort(away, axis=None)[:9]:
            there = self.places(np.array([number]))
            good, found = self.branch.advance(begin, start[None], there, halvings=10)
            if good[0]:
                return int(number), found
        names = [v.name for v in self.plane.variables]
        raise ModelError(
            f"the branch of the start configuration, at {names[0]} = {start[0]:.6g}, "
            f"{names[1]} = {start[1]:.6g}, does not reach the grid: choose ranges around it, or another start"
        )

    def _settle(self, numbers: Numbers, found: Points) -> None:
        """Keep points that were reached."""
        self.reached[numbers] = True
        self.states[numbers], self.smallest[numbers] = found.states, found.smallest

    def _watching(self, held: Mask) -> tuple[Watch, ...]:
        """All blocks that may be watched, with the reference point locked among them where it may count."""
        known = watches(self.problem, self.motors, held)
        if not self.plane.point_counts:
            return known
        point = self._point_locked()
        return (*(w for w in known if not np.array_equal(w.columns, point)), Watch("held", point))

    def _point_locked(self) -> Mask:
        """Everything but the position of the reference point."""
        start = self.problem.variables.columns_of[MEMBER].start
        free = ~locked(self.problem)
        free[start : start + self.plane.mechanism.space.translations] = False
        return free

    def _chosen(self, watching: tuple[Watch, ...], ranks: list[int], held: Mask) -> list[int]:
        """Which blocks to watch: the reference point stands for the member if all its motions move the point.

        Where they do not (a foot that tilts about the point) the whole member is watched.
        """
        followed = ~held & ~locked(self.problem)
        where = {watch.name: k for k, watch in enumerate(watching)}
        if not self.plane.point_counts or "member locked" not in where:
            return list(range(len(watching)))
        loose = {k: int(watch.columns.sum()) - ranks[k] for k, watch in enumerate(watching)}
        member, point = where["member locked"], len(watching) - 1
        for_good = point if loose[point] == loose[member] else member
        return [
            k
            for k, watch in enumerate(watching)
            if k not in (member, point) or k == for_good or np.array_equal(watch.columns, followed)
        ]

    def _generic(self, here: Equations, blocks: list[Mask]) -> tuple[list[int], tuple[Vector, Equations]]:
        """Ranks of blocks, and a state that has them; at a singular start those of a point beside it."""
        residual = float(np.linalg.norm(here.gaps))
        ranks = [decided(here.jacobian[:, columns], residual).rank for columns in blocks]
        rng = np.random.default_rng(0)
        free = ~locked(self.problem)
        nudge = np.where(free, 0.02 * rng.uniform(-1.0, 1.0, self.problem.columns), 0.0)
        beside = solve(self.problem, self.problem.variables.moved(self._start, nudge), free)
        if beside.residual < CLOSE_ENOUGH:
            other = [decided(beside.equations.jacobian[:, c], beside.residual).rank for c in blocks]
            if other != ranks:
                ranks = [max(pair) for pair in zip(ranks, other, strict=True)]
                return ranks, (beside.state, beside.equations)
        return ranks, (self._start, here)

    def _refuse_freedom(self, generic: tuple[Vector, Equations], free: Mask) -> None:
        """Refuse to map what is not determined: the member or a motor that moves with everything held."""
        equations = generic[1]
        rank = decided(equations.jacobian[:, free], float(np.linalg.norm(equations.gaps))).rank
        block = measured_block(equations, free, rank)
        loose = np.zeros((self.problem.columns, block.right.shape[1] - rank))
        loose[free] = block.right[:, rank:]
        seen = [self.problem.variables.column[m] for m in self.motors]
        if self.plane.mechanism.reference is not None:
            place = self.problem.variables.columns_of[MEMBER]
            seen += list(range(place.start, place.stop))
        part = float(np.abs(loose[seen]).max(initial=0.0))
        if not negligible(part, 1.0, 1e-6):
            names = [v.name for v in self.plane.variables]
            raise ModelError(
                f"with {names[0]}, {names[1]} and the other motors held the mechanism can still move: "
                "a map needs variables that fix it; name other variables or other motors"
            )

    def _refuse_standstill(self, state: Vector) -> None:
        """Refuse variables that cannot change independently: what they reach is a curve, not a region."""
        branch, one = self.branch, self.branch.points(state[None])
        here = self.plane.at_start()
        rates = []
        for step in 1e-4 * np.diag([float(axis[-1] - axis[0]) for axis in self.grid]):
            low, high = (
                self.plane.held_states(self.problem, state[None], (here + s)[None]) for s in (-step, step)
            )
            rates.append(branch.equations.steps_between(low, high)[0, branch.held])
        names = [v.name for v in self.plane.variables]
        held = one.kernel[0, branch.held]
        for name, rate in zip(names, rates, strict=True):
            reached = held @ (branch.held_inverse(one)[0] @ rate)
            if not negligible(float(np.linalg.norm(reached - rate)), float(np.linalg.norm(rate)), 1e-6):
                other = names[1] if name == names[0] else names[0]
                raise ModelError(
                    f"{name} cannot change while {other} and whatever else is held stand: what is reached "
                    "is a curve at most, not a region; follow it with Mechanism.follow (vincula follow), or "
                    "hold less"
                )


def mask(sheet: Sheet) -> NDArray[np.bool_]:
    """For every point of the grid, whether the sheet reaches it."""
    return sheet.reached.reshape(sheet.shape)
