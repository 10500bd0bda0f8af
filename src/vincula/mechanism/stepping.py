"""Steps along a track, each checked for singularities and limits between its ends.

A step is taken only where the corrector contracts fast and the tangent turns little, so that it cannot
jump to another branch.  Singularities show as sign changes of watched measures, as dips that touch
zero, or as a rank lost at the point itself.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import dataclass
from functools import partial
from typing import Final

import numpy as np

from vincula.arrays import Vector
from vincula.mechanism.closure_problem import ClosureProblem, Equations
from vincula.mechanism.closure_solver import Limits
from vincula.mechanism.closure_values import Mask
from vincula.mechanism.locating import HIT, Measuring, kernels_beside, minimum, root, settled
from vincula.mechanism.singularities import Singularity, classified
from vincula.mechanism.tracks import Track, TrackPoint
from vincula.mechanism.watching import Measure, SingularityKind, Watch, decided, measured_block
from vincula.numerics.rank import negligible

LONGEST: Final = 0.2
"""Longest step [rad, or lengths L, over all unknowns together]."""
SHORTEST: Final = 1e-9
"""A step that would have to be shorter than this is not taken: the branch is lost."""
SLOW: Final = 0.3
"""Corrections must shrink at least by this factor."""
STRAIGHT: Final = 0.96
"""Smallest cosine between tangents before and after a step."""
CLOSE_ENOUGH: Final = 1e-12
"""Scaled closure residual of every point on a path."""
FOLLOWS: Final = 1e-6
"""Share of a held motion that rounding may seem to forbid."""
TOGETHER: Final = 1e-6
"""Events whose shares of a step differ by less are one."""


@dataclass(frozen=True, slots=True, eq=False)
class Found:
    """Something met on a track.

    Attributes:
        kind: `singularity`, `limit`, `incompatible` or `lost`.
        point: Where.
        share: Share of the step at which it lies.
        singularities: What is singular there.
        column: Rate whose value is at a limit.
        bound: That limit.
        turns: Whether the held values cannot go on beyond it.
    """

    kind: str
    point: TrackPoint
    share: float = 1.0
    singularities: tuple[Singularity, ...] = ()
    column: int = -1
    bound: float = float("nan")
    turns: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class _Here:
    """A point, its tangent, and what is watched there."""

    point: TrackPoint
    tangent: Vector
    measures: tuple[Measure, ...]


class Stepper:
    """Follows tracks one after the other, remembering step size and watched measures.

    Args:
        problem: The closure equations.
        free: For every rate, whether it follows.
        watching: The watched blocks.
        motors: Names of the motors.
        bounds: Limits of the values; None to ignore them.
        through: Kinds of singularity that are passed.
    """

    def __init__(
        self,
        problem: ClosureProblem,
        free: Mask,
        watching: Iterable[Watch],
        motors: tuple[str, ...],
        bounds: Limits | None,
        through: Collection[SingularityKind],
    ) -> None:
        self.problem, self.free, self.motors, self.bounds = problem, free, motors, bounds
        self.watching, self.through = tuple(watching), frozenset(through)
        self.steps, self.passed = 0, list[Found]()
        self._size = LONGEST
        self._ranks: list[int] = []
        self._told: Found | None = None
        self._first = True

    def ranks_at(self, equations: Equations) -> None:
        """Take the ranks at a state as the generic ones."""
        residual = float(np.linalg.norm(equations.gaps))
        self._ranks = [decided(equations.jacobian[:, w.columns], residual).rank for w in self.watching]
        self.rank = decided(equations.jacobian[:, self.free], residual).rank

    def margin(self, point: TrackPoint) -> float:
        """Smallest kept singular value over all watched blocks."""
        return min((m.smallest for m in self._measures(point)), default=float("inf"))

    def follow(self, track: Track, start: TrackPoint, target: float) -> tuple[TrackPoint, Found | None]:
        """Along a track from a point to a value of s, or to what stops it."""
        tangent, missed = track.tangent(start)
        if not negligible(missed, 1.0, FOLLOWS):
            return start, Found("incompatible", start)
        here = _Here(start, tangent, self._measures(start))
        before: _Here | None = None
        while here.point.travelled < target:
            there = self._step(track, here, target)
            if there is None:
                return here.point, Found("lost", here.point)
            if self._first:
                self._first = False
                here = self._learnt(track, here, there)
            for found in self._met(track, before, here, there):
                if found.turns or found.kind != "singularity" or not self._is_passed(found):
                    return found.point, found
                if not self._is_told(found):
                    self._told = found
                    self.passed.append(found)
            before, here = here, there
        return here.point, None

    def _is_passed(self, found: Found) -> bool:
        return all(s.kind in self.through for s in found.singularities)

    def _is_told(self, found: Found) -> bool:
        """Whether it is the singularity passed last, met once more at the begin of the next step."""
        if self._told is None:
            return False
        way = self.problem.variables.step_between(self._told.point.state, found.point.state)
        return float(np.linalg.norm(way)) <= 10.0 * HIT

    def _measures(self, point: TrackPoint) -> tuple[Measure, ...]:
        return tuple(
            measured_block(point.equations, watch.columns, rank)
            for watch, rank in zip(self.watching, self._ranks, strict=True)
        )

    def _step(self, track: Track, here: _Here, target: float) -> _Here | None:
        """The next point, as far as the branch can safely be followed; None where it cannot."""
        size = self._size
        remaining = target - here.point.travelled
        speed = float(here.tangent[-1])
        while size > SHORTEST:
            landing = speed > 0.0 and remaining <= size * speed * (1.0 + 1e-9)
            length = remaining / speed if landing else size
            predicted = track.moved(here.point, length * here.tangent)
            if landing:
                predicted = TrackPoint(predicted.state, target, predicted.equations)
            point, sizes = track.corrected(predicted, landing=landing)
            # A curved step may go beyond where it ends: what is held would be put back there without closing.
            if point.travelled <= target and _is_safe(point, sizes, length):
                tangent, _ = track.tangent(point, here.tangent)
                straight = float(tangent @ here.tangent)
                if straight > STRAIGHT:
                    if straight > 0.99 and length >= 0.5 * self._size:
                        self._size = min(1.5 * self._size, LONGEST)
                    self.steps += 1
                    return _Here(point, tangent, self._measures(point))
            size = 0.5 * length
            self._size = max(size, 1e-4)
        return None

    def _learnt(self, track: Track, here: _Here, there: _Here) -> _Here:
        """Generic ranks from the first point after the start, in case the start is singular."""
        old = list(self._ranks)
        self.ranks_at(there.point.equations)
        track.rank = self.rank
        return here if self._ranks == old else _Here(here.point, here.tangent, self._measures(here.point))

    def _met(self, track: Track, before: _Here | None, here: _Here, there: _Here) -> list[Found]:
        """The singularities and limits of a step in their order; those at one point are one."""
        events = [*self._crossings(track, here, there), *self._limits(track, here, there)]
        if not events and before is not None:
            events = self._touches(track, before, here, there)
        events.sort(key=lambda event: event.share)
        found = []
        while events:
            first = events[0]
            same = [e for e in events if e.kind == first.kind and e.share - first.share < TOGETHER]
            events = [e for e in events if e not in same]
            singular = {s.kind: s for event in reversed(same) for s in event.singularities}
            turns = any(event.turns for event in same)
            found.append(
                Found(
                    first.kind,
                    first.point,
                    first.share,
                    tuple(singular.values()),
                    first.column,
                    first.bound,
                    turns,
                )
            )
        return found

    def _crossings(self, track: Track, here: _Here, there: _Here) -> list[Found]:
        """Watched measures that change sign in the step, or vanish in it or at its end."""
        found = []
        for k in range(len(self.watching)):
            before, after = here.measures[k], there.measures[k]
            signed = self._signed(k, before)
            met: tuple[TrackPoint, float] | None = None
            if before.has_sign and after.sign_against(before) < 0.0:
                met = root(track, here.point, there.point, signed)
            elif self._is_singular(there.point, k):
                met = settled(track, here.point, there.point, signed, partial(self._is_singular, k=k))
            if met is not None:
                found.append(self._singular(track, k, *met, here, there))
        return found

    def _touches(self, track: Track, before: _Here, here: _Here, there: _Here) -> list[Found]:
        """Watched measures that touch zero near a local minimum without changing sign."""
        found = []
        for k in range(len(self.watching)):
            one, low, two = (h.measures[k].smallest for h in (before, here, there))
            if low > min(one, two) or low > 2.0 * max(one - low, two - low):
                continue
            signed = self._signed(k, before.measures[k])
            point = minimum(track, before.point, there.point, signed)
            if self._is_singular(point, k):
                found.append(self._singular(track, k, point, 0.5, before, there))
        return found

    def _limits(self, track: Track, here: _Here, there: _Here) -> list[Found]:
        """Values that leave their limits."""
        if self.bounds is None:
            return []
        where = self.problem.variables
        old, new = where.scalar_values(here.point.state), where.scalar_values(there.point.state)
        found = []
        for bound, sign in ((self.bounds.lower, 1.0), (self.bounds.upper, -1.0)):
            slack = 1e-12 * (1.0 + np.abs(bound))
            for k in np.flatnonzero((sign * (new - bound) < -slack) & (new != old)):
                limit = float(bound[k])

                def beyond(point: TrackPoint, k: int = int(k), limit: float = limit) -> float:
                    return float(where.scalar_values(point.state)[k]) - limit

                if sign * (old[k] - limit) <= 0.0:
                    found.append(Found("limit", here.point, 0.0, column=int(k), bound=limit))
                else:
                    point, share = root(track, here.point, there.point, beyond)
                    found.append(Found("limit", point, share, column=int(k), bound=limit))
        return found

    def _signed(self, k: int, against: Measure) -> Measuring:
        columns, rank = self.watching[k].columns, self._ranks[k]

        def measure(point: TrackPoint) -> float:
            there = measured_block(point.equations, columns, rank)
            return there.sign_against(against) * there.smallest

        return measure

    def _is_singular(self, point: TrackPoint, k: int) -> bool:
        measure = measured_block(point.equations, self.watching[k].columns, self._ranks[k])
        return decided(measure.jacobian, point.residual, measure.values).rank < self._ranks[k]

    def _singular(
        self, track: Track, k: int, point: TrackPoint, share: float, here: _Here, there: _Here
    ) -> Found:
        """What is singular at a point between two others, by the block that shows it."""
        watch, rank = self.watching[k], self._ranks[k]
        measure = measured_block(point.equations, watch.columns, rank)
        around = []
        if measure.right.shape[1] > rank:
            chord = track.step_between(here.point, there.point)
            around = kernels_beside(track, point, chord / np.linalg.norm(chord), watch.columns, rank)
        here_rank = decided(measure.jacobian, point.residual, measure.values).rank
        lost = measure.lost(around, here_rank)
        one = classified(self.problem, point.state, watch, *lost, self.motors)
        turns = bool(np.array_equal(watch.columns, track.free)) and float(there.tangent[-1]) <= 0.0
        return Found("singularity", point, share, (one,), turns=turns)


def _is_safe(point: TrackPoint, sizes: list[float], length: float) -> bool:
    """Whether the corrector found the branch it came from: closed, near, and quickly."""
    if not point.residual <= CLOSE_ENOUGH or not sizes:
        return point.residual <= CLOSE_ENOUGH
    if sizes[0] > 0.3 * length + 1e-9:
        return False
    return len(sizes) < 2 or sizes[0] < 1e-9 or sizes[1] <= SLOW * sizes[0]
