"""Steps along one assembly branch, many at once: closing, and what is watched at the states reached.

One decomposition of the whole Jacobian gives everything at a state: its kernel holds all motions that the
loops allow, so a block of columns loses rank exactly where the rows of the kernel that belong to the other
columns do.  These blocks are small: the motors' rates, the member's twist, what is held.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Final

import numpy as np
from numpy.typing import NDArray

from vincula.arrays import Vector
from vincula.maps.stacked import StackedProblem
from vincula.maps.stacked_rows import Stack
from vincula.maps.variables import Plane
from vincula.mechanism.closure_problem import ClosureProblem
from vincula.mechanism.closure_solver import Limits
from vincula.mechanism.closure_unknowns import MEMBER
from vincula.mechanism.closure_values import Mask
from vincula.mechanism.watching import Watch, locked

CLOSE_ENOUGH: Final = 1e-12
"""Scaled closure residual of every point on a sheet."""
POLISHED: Final = 1e-13
"""A scaled residual that is worth no further decomposition."""
ROUNDING: Final = 5e-15
"""A scaled residual that needs no further correction."""
FAR: Final = 0.3
"""A correction longer than this share of its step may lead to another branch."""
ON_CURVE: Final = 1e-10
"""A kept singular value of a kernel's rows (at most one) below this is zero at a point of the grid."""
CORRECTIONS: Final = 6
"""Most corrections with one decomposition."""
DECOMPOSITIONS: Final = 3
"""Most decompositions for one closing."""
SHRINKS: Final = 0.5
"""A correction must leave less than this share of a residual, or is the last one."""
SLACK: Final = 1e-12
"""How far rounding may carry a value beyond its limit [m, rad]."""

Numbers = NDArray[np.intp]


@dataclass(slots=True, eq=False)
class Points:
    """Closed states with what is known there; the first dimension counts them.

    Attributes:
        states: Values of all unknowns.
        inverse: Pseudo-inverses of the Jacobian, columns x rows, scaled.
        jacobian: The Jacobians, rows x columns, scaled.
        kernel: Orthonormal bases of the motions that closure allows, columns x freedoms.
        smallest: For every watch the smallest kept singular value of its rows of the kernel, of the Jacobian
            for the loops; infinite where a watch can lose nothing.
    """

    states: Stack
    inverse: Stack
    jacobian: Stack
    kernel: Stack
    smallest: Stack

    def __len__(self) -> int:
        return len(self.states)

    def take(self, which: Numbers | Mask | slice) -> Points:
        """Some of the points."""
        return Points(*(getattr(self, field.name)[which] for field in fields(self)))

    @staticmethod
    def joined(parts: Sequence[Points]) -> Points:
        """Points one group after the other."""
        return Points(*(np.concatenate([getattr(p, f.name) for p in parts]) for f in fields(Points)))

    def copy(self) -> Points:
        """The same points in memory of their own."""
        return Points(*(getattr(self, field.name).copy() for field in fields(self)))

    def put(self, which: Numbers | Mask, others: Points) -> None:
        """Replace some of the points."""
        for field in fields(self):
            getattr(self, field.name)[which] = getattr(others, field.name)


class Branch:
    """Closing near states that are known, for two variables that are held.

    Args:
        plane: The variables.
        problem: Equations in which motors, what is held and the member are unknowns.
        watching: The watched blocks.
        ranks: Their generic ranks.
        held: For every rate, whether it is held.
        bounds: Limits of the values; None to ignore them.

    Attributes:
        freedoms: Dimension of the kernels.
        ranks: Generic ranks of the watched blocks.
        kept: Generic rank of every watch's rows of the kernel; of the Jacobian for the loops.
        seen: Rates of motors, member and what is held, by number.
        followed: The watch that must not vanish for the held values to be followed.
    """

    def __init__(
        self,
        plane: Plane,
        problem: ClosureProblem,
        watching: tuple[Watch, ...],
        ranks: list[int],
        held: Mask,
        bounds: Limits | None,
    ) -> None:
        self.plane, self.problem, self.watching, self.bounds = plane, problem, watching, bounds
        self.equations = StackedProblem(problem)
        self.held = np.flatnonzero(held & ~locked(problem))
        self.seen = _seen(plane, problem, self.held)
        self._moving = np.flatnonzero(~locked(problem))
        self.ranks = ranks
        self.freedoms = len(self._moving) - ranks[0]
        self.rows = [np.flatnonzero(~locked(problem) & ~watch.columns) for watch in watching]
        self.kept = [
            self.freedoms - (int(watch.columns.sum()) - rank) if k else rank
            for k, (watch, rank) in enumerate(zip(watching, ranks, strict=True))
        ]
        self.followed = next(
            k for k, watch in enumerate(watching) if np.array_equal(watch.columns, ~held & ~locked(problem))
        )

    def points(self, states: Stack) -> Points:
        """Closed states with their decompositions."""
        _, jacobian = self.equations.equations(states)
        count, rows, columns = jacobian.shape
        left, values, right = np.linalg.svd(jacobian[:, :, self._moving])
        r = self.ranks[0]
        safe = np.maximum(values[:, :r], 1e-300)
        inverse = np.zeros((count, columns, rows))
        kernel = np.zeros((count, columns, self.freedoms))
        weighted = right[:, :r].swapaxes(1, 2) / safe[:, None, :]
        inverse[:, self._moving] = weighted @ left[:, :, :r].swapaxes(1, 2)
        kernel[:, self._moving] = right[:, r:].swapaxes(1, 2)
        smallest = np.full((count, len(self.watching)), np.inf)
        for k, kept in enumerate(self.kept):
            if kept and k == 0:
                smallest[:, 0] = values[:, kept - 1]
            elif kept:
                spectrum = np.linalg.svd(kernel[:, self.rows[k]], compute_uv=False)
                smallest[:, k] = spectrum[:, kept - 1]
        return Points(states, inverse, jacobian, kernel, smallest)

    def signs(self, ones: Points, others: Points, k: int) -> Vector:
        """For pairs of neighbours 1, or -1 where the determinant of a watch changes its sign between them."""
        if self.kept[k] == 0:
            return np.ones(len(ones))
        if k == 0:
            turned = ones.inverse @ others.jacobian + ones.kernel @ ones.kernel.swapaxes(1, 2)
            still = locked(self.problem).astype(float)
            return _signs(turned + np.diag(still))
        kept, rows = self.kept[k], self.rows[k]
        left, _, right = np.linalg.svd(ones.kernel[:, rows])
        carried = others.kernel @ self._carrying(ones, others)
        block = left[:, :, :kept].swapaxes(1, 2) @ carried[:, rows] @ right[:, :kept].swapaxes(1, 2)
        return _signs(block)

    def _carrying(self, ones: Points, others: Points) -> Stack:
        """n x freedoms x freedoms: motions of others that are most like those of ones.

        Where something is always free (a rod that spins) motors and member alone are compared: how far it
        has spun is different on every way, and turns the axes of its ball with it.
        """
        if self.kept[self.followed] == self.freedoms:
            return np.asarray(others.kernel.swapaxes(1, 2) @ ones.kernel)
        mine, theirs = ones.kernel[:, self.seen], others.kernel[:, self.seen]
        left, values, right = np.linalg.svd(theirs)
        kept = self.kept[self.followed]
        safe = np.maximum(values[:, :kept], 1e-300)
        back = (right[:, :kept].swapaxes(1, 2) / safe[:, None, :]) @ left[:, :, :kept].swapaxes(1, 2)
        return np.asarray(back @ mine)

    def differences(self, states: Stack, others: Stack) -> Vector:
        """How far states are apart, without what is always free."""
        steps = self.equations.steps_between(states, others)
        if self.kept[self.followed] < self.freedoms:
            steps = steps[:, self.seen]
        return np.asarray(np.linalg.norm(steps, axis=1))

    def held_inverse(self, points: Points) -> Stack:
        """n x freedoms x held: the shortest motion of the kernel for rates that are held."""
        k = self.followed
        left, values, right = np.linalg.svd(points.kernel[:, self.held])
        kept = self.kept[k]
        safe = np.maximum(values[:, :kept], 1e-300)
        return np.asarray(
            (right[:, :kept].swapaxes(1, 2) / safe[:, None, :]) @ left[:, :, :kept].swapaxes(1, 2)
        )

    def leap(
        self,
        points: Points,
        values: Stack,
        *,
        same_side: bool = True,
        patient: bool = True,
    ) -> tuple[Mask, Points]:
        """One step each to other values of the two variables.

        Args:
            points: Where from.
            values: n x 2.
            same_side: Whether the followed determinant must keep its sign.
            patient: Whether what one decomposition does not close gets another.

        Returns:
            Which steps were good, and the points of those alone.
        """
        place, inverse = self.equations, self.held_inverse(points)
        goals = self.plane.held_states(self.problem, points.states, values)
        way = place.steps_between(points.states, goals)[:, self.held]
        step = _applied(points.kernel, _applied(inverse, way))
        step[:, self.held] = way
        predicted = self.plane.held_states(self.problem, place.moved(points.states, step), values)
        with np.errstate(over="ignore", invalid="ignore"):
            closed, residual = self._closed(predicted, patient)
            away = np.linalg.norm(place.steps_between(predicted, closed), axis=1)
            good = (residual <= CLOSE_ENOUGH) & (away <= FAR * np.linalg.norm(step, axis=1) + 1e-9)
        good &= self.within(np.where(good[:, None], closed, points.states))
        where = np.flatnonzero(good)
        found = self.points(closed[where])
        if same_side and len(where):
            ahead = (found.smallest[:, self.followed] > ON_CURVE) & (
                self.signs(points.take(where), found, self.followed) > 0.0
            )
            good[where] = ahead
            found = found.take(ahead)
        return good, found

    def advance(
        self,
        points: Points,
        here: Stack,
        there: Stack,
        *,
        halvings: int,
        same_side: bool = True,
        patient: bool = True,
    ) -> tuple[Mask, Points]:
        """From values to others, in shorter steps where one is too long; see `leap`."""
        count, points = len(points), points.copy()
        at, share, going = np.zeros(count), np.ones(count), np.ones(count, dtype=bool)
        while going.any():
            lanes = np.flatnonzero(going)
            target = np.minimum(at[lanes] + share[lanes], 1.0)
            values = here[lanes] + target[:, None] * (there[lanes] - here[lanes])
            good, found = self.leap(points.take(lanes), values, same_side=same_side, patient=patient)
            points.put(lanes[good], found)
            at[lanes[good]] = target[good]
            share[lanes[~good]] *= 0.5
            going = (at < 1.0) & (share >= 0.5**halvings)
        done = at >= 1.0
        return done, points.take(done)

    def within(self, states: Stack) -> Mask:
        """Which states respect the limits."""
        return np.asarray(self.room(states) >= -SLACK)

    def room(self, states: Stack) -> Vector:
        """Distance of the nearest limit, negative beyond it; infinite without limits [m, rad]."""
        if self.bounds is None:
            return np.full(len(states), np.inf)
        values = self.equations.scalar_values(states)
        return np.asarray(np.minimum(values - self.bounds.lower, self.bounds.upper - values).min(axis=1))

    def corrections(self, points: Points, inverse: Stack, gaps: Stack) -> Stack:
        """Gauss-Newton steps that leave what is held where it is."""
        steps = -_applied(points.inverse, gaps)
        steps -= _applied(points.kernel, _applied(inverse, steps[:, self.held]))
        steps[:, self.held] = 0.0
        return steps

    def _closed(self, states: Stack, patient: bool) -> tuple[Stack, Vector]:
        """States closed with what is held fixed, and their residuals.

        A few corrections share one decomposition; what they do not close gets another one.
        """
        gaps = self.equations.gaps(states)
        states, residual = states.copy(), np.linalg.norm(gaps, axis=1)
        for _ in range(DECOMPOSITIONS if patient else 1):
            near_by = np.flatnonzero((residual > POLISHED) & (residual < 1.0))
            if not len(near_by):
                break
            near = self.points(states[near_by])
            inverse = self.held_inverse(near)
            going = np.arange(len(near_by))
            for _ in range(CORRECTIONS):
                where = near_by[going]
                step = self.corrections(near.take(going), inverse[going], gaps[where])
                trial = self.equations.moved(states[where], step)
                found = self.equations.gaps(trial)
                size, before = np.linalg.norm(found, axis=1), residual[where]
                better = size < before
                kept = where[better]
                states[kept], gaps[kept], residual[kept] = trial[better], found[better], size[better]
                # What shrinks slowly will not close here: it must not keep all others waiting.
                going = going[(size < SHRINKS * before) & (size > ROUNDING)]
                if not len(going):
                    break
        return states, residual


def _seen(plane: Plane, problem: ClosureProblem, held: Numbers) -> Numbers:
    """Rates of the motors, of the member, and of what is held."""
    where = problem.variables
    seen = {int(k) for k in held} | {where.column[motor] for motor in plane.mechanism.active}
    member = where.columns_of.get(MEMBER, slice(0, 0))
    return np.array(sorted(seen | set(range(member.start, member.stop))), dtype=np.intp)


def _applied(matrices: Stack, vectors: Stack) -> Stack:
    return np.asarray((matrices @ vectors[:, :, None])[:, :, 0])


def _signs(blocks: Stack) -> Vector:
    """Signs of determinants; 1 for zero."""
    signs = np.linalg.slogdet(blocks)[0]
    return np.where(signs == 0.0, 1.0, signs)
