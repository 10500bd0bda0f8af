"""Where a branch ends on lines out of a sheet: at a fold, where held values must turn back, or at a limit.

Held values and mechanism are followed together in short chords (pseudo-arclength), many lines at once.  A
fold is an ordinary point of that curve: the zero of the held values' share in its tangent, which root
finding gives to rounding.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from vincula.arrays import Vector
from vincula.maps.branch import (
    CLOSE_ENOUGH,
    CORRECTIONS,
    DECOMPOSITIONS,
    FAR,
    POLISHED,
    ROUNDING,
    SHRINKS,
    SLACK,
    Branch,
    Numbers,
    Points,
)
from vincula.maps.roots import roots
from vincula.maps.stacked_rows import Stack
from vincula.mechanism.closure_values import Mask

ROUNDS: Final = 60
"""Most chords on one line."""
STRAIGHT: Final = 0.75
"""Smallest cosine between tangents at both ends of a chord."""
SHORTEST: Final = 1e-7
"""A chord shorter than this share of its line is not taken: the branch is lost there."""
BEYOND: Final = 1e-9
"""What ends a line farther than this share behind its end does not end it."""
EndKind = Literal["fold", "limit", "reached", "lost"]


@dataclass(frozen=True, slots=True, eq=False)
class End:
    """Where one line ends.

    Attributes:
        kind: What ends it; `reached` if nothing does before its end.
        share: Share of the line; of a line whose end is reached that of the last state known, before it or
            behind it.
        state: The state there.
        beside: Regular states before it, and behind it where one is known.
    """

    kind: EndKind
    share: float
    state: Vector
    beside: tuple[Vector, ...]


def ends(branch: Branch, begin: Points, here: Stack, there: Stack) -> list[End]:
    """The ends of lines in the plane of the variables.

    Args:
        branch: The branch.
        begin: Points at the begins of the lines.
        here: n x 2 values there.
        there: n x 2 values where the lines lead.
    """
    return _Lines(branch, begin, here, there).run()


@dataclass(slots=True)
class _Bases:
    """Points on lines from which chords start."""

    points: Points
    shares: Vector
    tangents: Stack
    inverses: Stack
    lengths: Vector

    def take(self, which: Numbers | Mask) -> _Bases:
        return _Bases(self.points.take(which), self.shares[which], self.tangents[which],
                      self.inverses[which], self.lengths[which])  # fmt: skip

    def put(self, which: Numbers, others: _Bases) -> None:
        self.points.put(which, others.points)
        self.shares[which], self.tangents[which] = others.shares, others.tangents
        self.inverses[which], self.lengths[which] = others.inverses, others.lengths

    @staticmethod
    def joined(parts: Sequence[_Bases]) -> _Bases:
        names = ("shares", "tangents", "inverses", "lengths")
        rest = (np.concatenate([getattr(part, name) for part in parts]) for name in names)
        return _Bases(Points.joined([part.points for part in parts]), *rest)


@dataclass(frozen=True, slots=True)
class _Stop:
    """Chords of some lines in which they end."""

    lanes: Numbers
    one: _Bases
    two: _Bases
    chord: Vector

    @staticmethod
    def joined(parts: Sequence[_Stop]) -> _Stop:
        one, two = ([getattr(part, name) for part in parts] for name in ("one", "two"))
        lanes = np.concatenate([part.lanes for part in parts])
        chord = np.concatenate([part.chord for part in parts])
        return _Stop(lanes, _Bases.joined(one), _Bases.joined(two), chord)


class _Lines:
    def __init__(self, branch: Branch, begin: Points, here: Stack, there: Stack) -> None:
        self.branch, self.here, self.there = branch, here, there
        count = len(begin)
        everything = np.arange(count)
        first = np.zeros((count, branch.freedoms + 1))
        first[:, -1] = 1.0
        self.bases = self._based(everything, begin.copy(), np.zeros(count), first)
        self.found: list[End | None] = [None] * count

    def run(self) -> list[End]:
        """Chords along all lines until each has ended."""
        chord = 0.5 * self.bases.lengths / np.maximum(self.bases.tangents[:, -1], 0.05)
        going = np.arange(len(chord))
        stops: dict[EndKind, list[_Stop]] = {"fold": [], "limit": []}
        for _ in range(ROUNDS):
            if not len(going):
                break
            bases = self.bases.take(going)
            good, there = self._chords(going, bases, chord[going])
            chord[going[~good]] *= 0.5
            lost = ~good & (chord[going] < SHORTEST * bases.lengths)
            self._lost(going[lost])
            lanes, bases = going[good], bases.take(good)
            fold = there.tangents[:, -1] <= 0.0
            limit = ~self.branch.within(there.points.states)
            over = ~fold & ~limit & (there.shares >= 1.0)
            for stopped, parts in ((fold, stops["fold"]), (limit, stops["limit"])):
                if stopped.any():
                    ends_here = bases.take(stopped), there.take(stopped)
                    parts.append(_Stop(lanes[stopped], *ends_here, chord[lanes[stopped]]))
            for k in np.flatnonzero(over):
                beside = (bases.points.states[k],)
                self.found[lanes[k]] = End("reached", float(there.shares[k]), there.points.states[k], beside)
            on = ~fold & ~limit & ~over
            self.bases.put(lanes[on], there.take(on))
            chord[lanes[on]] *= 1.6
            going = np.concatenate([going[~good & ~lost], lanes[on]])
        self._lost(going)
        for kind, parts in stops.items():
            if parts:
                self._stopped(kind, _Stop.joined(parts))
        return [end for end in self.found if end is not None]

    def _lost(self, lanes: Numbers) -> None:
        for lane in lanes:
            state = self.bases.points.states[lane]
            self.found[lane] = End("lost", float(self.bases.shares[lane]), state, (state,))

    def _stopped(self, kind: EndKind, stop: _Stop) -> None:
        """Lines that end in a chord: at the fold or the limit, whichever comes first."""
        shares, states = self._located(kind, stop)
        for k, lane in enumerate(stop.lanes):
            begin, known = stop.one.points.states[k], self.found[lane]
            end = End(kind, float(shares[k]), states[k], (begin, stop.two.points.states[k]))
            if end.share > 1.0 + BEYOND:
                end = End("reached", float(stop.one.shares[k]), begin, (begin,))
            if known is None or self._is_before(end, known, begin):
                self.found[lane] = end

    def _is_before(self, end: End, known: End, begin: Vector) -> bool:
        """Which of two ends in one chord comes first: beyond a fold the held values turn back."""
        both = np.array([end.state, known.state])
        ways = self.branch.equations.steps_between(np.array([begin, begin]), both)
        size = np.linalg.norm(ways, axis=1)
        return bool(size[0] < size[1])

    def _located(self, kind: EndKind, stop: _Stop) -> tuple[Vector, Stack]:
        """Shares and states where the held values turn back, or a limit is met, inside chords."""
        branch, lanes, one, two = self.branch, stop.lanes, stop.one, stop.two
        shares, states = one.shares.copy(), one.points.states.copy()
        nearest = np.full(len(lanes), np.inf)

        def values(which: Numbers, at: Vector) -> Vector:
            base, found = one.take(which), np.full(len(which), np.nan)
            if kind == "fold":
                good, there = self._chords(lanes[which], base, at, strict=False)
                size, ahead, closed = there.tangents[:, -1], there.shares, there.points.states
            else:
                closed, ahead, residual, _ = self._corrected(lanes[which], base, at)
                good = residual <= CLOSE_ENOUGH
                closed, ahead = closed[good], ahead[good]
                size = branch.room(closed)
            found[good] = size
            nearer = np.abs(size) < nearest[which[good]]
            kept = which[good][nearer]
            nearest[kept], shares[kept] = np.abs(size)[nearer], ahead[nearer]
            states[kept] = closed[nearer]
            return found

        if kind == "fold":
            begin, end = one.tangents[:, -1], two.tangents[:, -1]
        else:
            begin, end = branch.room(one.points.states), branch.room(two.points.states)
        open_ = np.flatnonzero(begin > (0.0 if kind == "fold" else SLACK))
        if len(open_):
            roots(
                lambda which, at: values(open_[which], at),
                np.zeros(len(open_)), stop.chord[open_], begin[open_], end[open_],
            )  # fmt: skip
        return shares, states

    def _chords(
        self, lanes: Numbers, bases: _Bases, chord: Vector, *, strict: bool = True
    ) -> tuple[Mask, _Bases]:
        """Points at the ends of chords, and which chords were good."""
        states, shares, residual, away = self._corrected(lanes, bases, chord)
        good = residual <= CLOSE_ENOUGH
        if strict:
            good &= away <= FAR * np.abs(chord) + 1e-9
        where = np.flatnonzero(good)
        base = bases.take(where)
        points = self.branch.points(states[where])
        rates = (base.points.kernel @ base.tangents[:, :-1, None])[:, :, 0]
        carried = np.column_stack([_applied(points.kernel.swapaxes(1, 2), rates), base.tangents[:, -1]])
        there = self._based(lanes[where], points, shares[where], carried)
        if strict:
            straight = np.sum(there.tangents * carried, axis=1) >= STRAIGHT
            good[where] = straight
            there = there.take(straight)
        return good, there

    def _based(self, lanes: Numbers, points: Points, shares: Vector, along: Stack) -> _Bases:
        """What chords from some points need: tangents nearest to a direction, and pseudo-inverses."""
        branch = self.branch
        rates, lengths = self._directions(lanes, points, shares)
        block = np.concatenate([points.kernel[:, branch.held], -rates[:, :, None]], axis=2)
        left, values, right = np.linalg.svd(block)
        kept = branch.kept[branch.followed]
        free = right[:, kept:]
        tangents = (free.swapaxes(1, 2) @ (free @ along[:, :, None]))[:, :, 0]
        tangents /= np.maximum(np.linalg.norm(tangents, axis=1), 1e-300)[:, None]
        safe = np.maximum(values[:, :kept], 1e-300)
        inverse = (right[:, :kept].swapaxes(1, 2) / safe[:, None, :]) @ left[:, :, :kept].swapaxes(1, 2)
        return _Bases(points, shares.copy(), tangents, inverse, lengths)

    def _directions(self, lanes: Numbers, points: Points, shares: Vector) -> tuple[Stack, Vector]:
        """Unit rates of what is held along lines, and how long whole lines are in these rates."""
        small = 1e-4
        plane, problem = self.branch.plane, self.branch.problem
        low, high = (
            plane.held_states(problem, points.states, self._values(lanes, shares + s))
            for s in (-small, small)
        )
        rates = self.branch.equations.steps_between(low, high)[:, self.branch.held] / (2.0 * small)
        lengths = np.linalg.norm(rates, axis=1)
        return rates / lengths[:, None], lengths

    def _values(self, lanes: Numbers, shares: Vector) -> Stack:
        here = self.here[lanes]
        return np.asarray(here + shares[:, None] * (self.there[lanes] - here))

    def _corrected(
        self, lanes: Numbers, bases: _Bases, chord: Vector
    ) -> tuple[Stack, Vector, Vector, Vector]:
        """Closed states at the ends of chords: states, shares, residuals, and how far they were corrected."""
        branch, place = self.branch, self.branch.equations
        plane, problem, held = branch.plane, branch.problem, branch.held
        step = chord[:, None] * bases.tangents
        shares = bases.shares + step[:, -1] / bases.lengths
        rates = _applied(bases.points.kernel, step[:, :-1])
        rates[:, held] = 0.0
        states = place.moved(bases.points.states, rates)
        states = plane.held_states(problem, states, self._values(lanes, shares))
        predicted, states = states, states.copy()
        gaps = place.gaps(states)
        residual = np.linalg.norm(gaps, axis=1)
        for turn in range(DECOMPOSITIONS):
            where = np.flatnonzero(residual > POLISHED)
            if not len(where):
                break
            near = bases.take(where)
            if turn:
                there = branch.points(states[where])
                near = self._based(lanes[where], there, shares[where], near.tangents)
            going = np.arange(len(where))
            for _ in range(CORRECTIONS):
                lane, base = where[going], near.take(going)
                steps = -_applied(base.points.inverse, gaps[lane])
                extra = _applied(base.inverses, -steps[:, held])
                steps += _applied(base.points.kernel, extra[:, :-1])
                steps[:, held] = 0.0
                ahead = shares[lane] + extra[:, -1] / base.lengths
                moved = place.moved(states[lane], steps)
                trial = plane.held_states(problem, moved, self._values(lanes[lane], ahead))
                found = place.gaps(trial)
                size, before = np.linalg.norm(found, axis=1), residual[lane]
                better = size < before
                kept = lane[better]
                states[kept], gaps[kept], shares[kept] = trial[better], found[better], ahead[better]
                residual[kept] = size[better]
                going = going[(size < SHRINKS * before) & (size > ROUNDING)]
                if not len(going):
                    break
        away = np.linalg.norm(place.steps_between(predicted, states), axis=1)
        return states, shares, residual, away


def _applied(matrices: NDArray[np.float64], vectors: Stack) -> Stack:
    return np.asarray((matrices @ vectors[:, :, None])[:, :, 0])
