"""Where signed measures vanish on a sheet: singular curves by root finding, and the sheet's own edge.

Along every edge of the grid a watched determinant that changes sign is zero somewhere: that point is
found to rounding by root finding on the closed mechanism.  The edge of the sheet is found by following the
mechanism outwards until it stops; what stops it says of which kind the edge is.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Final

import numpy as np

from vincula.arrays import Vector
from vincula.errors import ModelError
from vincula.maps.branch import ON_CURVE, Numbers, Points
from vincula.maps.ends import End, ends
from vincula.maps.roots import roots
from vincula.maps.sheet import HALVINGS, Sheet
from vincula.maps.sides import sign_changes
from vincula.maps.stacked_rows import Stack
from vincula.mechanism.closure_unknowns import MEMBER
from vincula.mechanism.configuration import Configuration
from vincula.mechanism.singularities import SHARE, Singularity, classified
from vincula.mechanism.watching import SingularityKind, decided, measured_block

KINDS: Final[tuple[SingularityKind, ...]] = ("platform free", "motors without authority", "internal")
"""Kinds of singularity, as `mechanism.singularities` names them."""
ZERO: Final = 1e-8
"""A measure that changes its sign and stays above this has jumped: that is no zero."""
LOST: Final = 1e-3
"""Where what is followed is farther from singular than this and still stops, the branch was lost."""

SINGULAR: Final = 1e-6
"""At a fold another watched measure below this is zero too."""
TURN: Final = "turn"
"""Kind of an edge where the variables turn back and the mechanism is not singular."""

Edge = tuple[int, int]
"""Two neighbours of the grid by their numbers, the smaller first."""


class Crossing:
    """A point of a curve.

    Args:
        sheet: The sheet it is on.
        values: The two variables there [m, rad].
        kind: Kind of singularity, `limit` (a joint limit), `turn` (of the variables alone), or `lost`.
        state: The state there.
        words: What is singular, or which joint is at its limit; a singularity is told when it is asked for.
        watch: The block that is singular; -1 where none is.
        beside: Regular states on both sides, or on one.
        inside: For a point of the edge, values of the variables inside the sheet from where it was found.
    """

    def __init__(
        self,
        sheet: Sheet | None,
        values: Vector,
        kind: str,
        state: Vector,
        *,
        words: str = "",
        watch: int = -1,
        beside: tuple[Vector, ...] = (),
        inside: Vector | None = None,
    ) -> None:
        self.values, self.kind, self.state, self.inside = values, kind, state, inside
        self._sheet, self._words, self._watch, self._beside = sheet, words, watch, beside

    @cached_property
    def configuration(self) -> Configuration:
        """The configuration there."""
        if self._sheet is None:
            raise ModelError("a point of the grid's border has no configuration of its own")
        return self._sheet.configuration(self.state)

    @cached_property
    def words(self) -> str:
        """What is singular there, or which joint is at its limit."""
        if self._sheet is None or self._watch < 0 or self._words:
            return self._words
        return str(singularity(self._sheet, self.state, self._watch, self._beside))


def singularity(sheet: Sheet, state: Vector, k: int, beside: Sequence[Vector]) -> Singularity:
    """The singularity of a watched block at a state.

    Args:
        sheet: The sheet.
        state: The singular state.
        k: Number of the block.
        beside: Regular states near by, evenly about it if they can be had.
    """
    problem, watch, rank = sheet.problem, sheet.branch.watching[k], sheet.branch.ranks[k]
    here = problem.equations(state)
    measure = measured_block(here, watch.columns, rank)
    around = []
    if measure.right.shape[1] > rank:
        around = [measured_block(problem.equations(s), watch.columns, rank).right[:, rank:] for s in beside]
    found = decided(measure.jacobian, float(np.linalg.norm(here.gaps)), measure.values).rank
    return classified(problem, state, watch, *measure.lost(around, found), sheet.motors)


def crossings(sheet: Sheet) -> dict[str, dict[Edge, Crossing]]:
    """Zeros of the watched measures on the edges between points of a sheet, by name of the block."""
    pairs = sheet.pairs_inside()
    found: dict[str, dict[Edge, Crossing]] = {}
    for k, changes in sign_changes(sheet, pairs).items():
        changed = pairs[changes]
        changed = changed[sheet.are_continuous(changed)]
        here, there = sheet.places(changed[:, 0]), sheet.places(changed[:, 1])
        zeros = zeros_on(sheet, k, sheet.points_at(changed[:, 0]), here, there)
        known = {
            (int(one), int(two)): zero
            for (one, two), zero in zip(changed, zeros, strict=True)
            if zero is not None
        }
        if known:
            found[sheet.branch.watching[k].name] = known
    return found


def zeros_on(sheet: Sheet, k: int, begin: Points, here: Stack, there: Stack) -> list[Crossing | None]:
    """Zeros of a watched measure on lines in the plane of the variables, one a line.

    Args:
        sheet: The sheet.
        k: Number of the watched block.
        begin: Points at the begins of the lines.
        here: n x 2 values there.
        there: n x 2 values at their ends; None is found where the measure has the same sign there.
    """
    branch, count = sheet.branch, len(begin)
    if not count:
        return []
    same_side = k != branch.followed
    done, end = branch.advance(begin, here, there, halvings=HALVINGS, same_side=same_side)
    lanes = np.flatnonzero(done)
    begin, here, there = begin.take(lanes), here[lanes], there[lanes]
    at_begin, at_end = begin.smallest[:, k], end.smallest[:, k]
    share, size = np.where(at_begin <= at_end, 0.0, 1.0), np.minimum(at_begin, at_end)
    states = np.where((share == 0.0)[:, None], begin.states, end.states)
    near = begin.copy()

    def values(which: Numbers, at: Vector) -> Vector:
        """The signed measure at shares of some lines, closed from the nearest place known so far."""
        lane = open_[which]
        target = here[lane] + at[:, None] * (there[lane] - here[lane])
        good, found = branch.leap(near.take(lane), target, same_side=same_side)
        bad = np.flatnonzero(~good)
        if len(bad):
            from_begin = begin.take(lane[bad]), here[lane[bad]], target[bad]
            again, more = branch.advance(*from_begin, halvings=HALVINGS, same_side=same_side)
            order = np.argsort(np.concatenate([np.flatnonzero(good), bad[again]]), kind="stable")
            found, good[bad[again]] = Points.joined([found, more]).take(order), True
        signed = np.full(len(lane), np.nan)
        where = lane[good]
        signed[good] = branch.signs(begin.take(where), found, k) * found.smallest[:, k]
        better = found.smallest[:, k] < size[where]
        kept = where[better]
        size[kept], share[kept] = found.smallest[better, k], at[good][better]
        states[kept] = found.states[better]
        near.put(kept, found.take(better))
        return signed

    changed = branch.signs(begin, end, k) < 0.0
    open_ = np.flatnonzero(changed & (at_begin > ON_CURVE) & (at_end > ON_CURVE))
    zero, one = np.zeros(len(open_)), np.ones(len(open_))
    roots(values, zero, one, at_begin[open_], -at_end[open_])
    result: list[Crossing | None] = [None] * count
    hits = np.flatnonzero(size <= ZERO)
    kinds = _kinds(sheet, branch.points(states[hits]), k)
    for j, kind in zip(hits, kinds, strict=True):
        beside = (begin.states[j], end.states[j])
        told = kind or singularity(sheet, states[j], k, beside).kind
        place = here[j] + share[j] * (there[j] - here[j])
        result[lanes[j]] = Crossing(sheet, place, told, states[j], watch=k, beside=beside)
    return result


def _kinds(sheet: Sheet, points: Points, k: int) -> list[str]:
    """Kinds of singularities of a watched block; empty where several motions are lost at once."""
    branch = sheet.branch
    if k == 0:
        return ["internal"] * len(points)
    if not len(points):
        return []
    kept = branch.kept[k]
    _, values, right = np.linalg.svd(points.kernel[:, branch.rows[k]])
    # What is always free moves neither member nor motors: it may stay among what is lost.
    lost = points.kernel @ right[:, kept - 1 :].swapaxes(1, 2)
    single = values[:, kept - 2] > 1e-4 if kept > 1 else np.ones(len(points), dtype=bool)
    where = sheet.problem.variables
    everything = np.arange(where.columns)
    if branch.watching[k].name == "motors locked":
        kind, columns = "platform free", everything[where.columns_of.get(MEMBER, slice(0, 0))]
    else:
        kind, columns = "motors without authority", everything[[where.column[m] for m in sheet.motors]]
    part = np.linalg.norm(lost[:, columns], axis=(1, 2))
    plain = single & ((part > 100.0 * SHARE) | (part < 0.01 * SHARE))
    return [
        "" if not sure else kind if size > SHARE else "internal"
        for sure, size in zip(plain, part, strict=True)
    ]


def outer_edge(sheet: Sheet) -> dict[Edge, Crossing]:
    """Where the sheet ends on the edges that lead out of it, by (point reached, point not reached).

    A point that following reaches in shorter steps than the filling took belongs to the sheet: it is
    added, and the filling goes on from there.
    """
    found: dict[Edge, Crossing] = {}
    while True:
        pairs = sheet.pairs_out(np.flatnonzero(sheet.reached))
        pairs = pairs[[(int(a), int(b)) not in found for a, b in pairs]]
        if not len(pairs):
            break
        here, there = sheet.places(pairs[:, 0]), sheet.places(pairs[:, 1])
        stops = ends(sheet.branch, sheet.points_at(pairs[:, 0]), here, there)
        for kind in ("reached", "lost"):
            over = np.flatnonzero([stop.kind == kind for stop in stops])
            if len(over):
                states = np.array([stops[k].state for k in over])
                share = np.array([stops[k].share for k in over])[:, None]
                values = here[over] + share * (there[over] - here[over])
                new = sheet.add(pairs[over], states, values, same_side=kind == "lost")
                sheet.spread(new)
        points = edge_points(sheet, stops, here, there)
        found.update({(int(a), int(b)): point for (a, b), point in zip(pairs, points, strict=True)})
    return {pair: crossing for pair, crossing in found.items() if not sheet.reached[pair[1]]}


def edge_points(sheet: Sheet, stops: Sequence[End], here: Stack, there: Stack) -> list[Crossing]:
    """Ends of lines as points of a sheet's edge, with their kinds.

    Args:
        sheet: The sheet.
        stops: The ends.
        here: n x 2 values at the begins of the lines.
        there: n x 2 values where they lead.
    """
    k = sheet.branch.followed
    points = sheet.branch.points(np.array([stop.state for stop in stops]))
    turning, names = _turning(sheet, points), " and ".join(v.name for v in sheet.plane.variables)
    result: list[Crossing] = []
    for stop, kind, size, a, b in zip(
        stops, _kinds(sheet, points, k), points.smallest[:, k], here, there, strict=True
    ):
        values = a + min(stop.share, 1.0) * (b - a)
        if stop.kind == "limit":
            words = _limit_words(sheet, stop.state)
            result.append(Crossing(sheet, values, "limit", stop.state, words=words, inside=a))
        elif size > LOST:
            words = "the branch could not be followed any further"
            result.append(Crossing(sheet, values, "lost", stop.state, words=words, inside=a))
        elif (other := turning[len(result)]) is None:
            told = kind or singularity(sheet, stop.state, k, stop.beside).kind
            result.append(Crossing(sheet, values, told, stop.state, watch=k, beside=stop.beside, inside=a))
        elif other < 0:
            words = f"{names} turn back here: nothing is singular, other variables go on"
            result.append(Crossing(sheet, values, TURN, stop.state, words=words, inside=a))
        else:
            told = singularity(sheet, stop.state, other, stop.beside).kind
            result.append(
                Crossing(sheet, values, told, stop.state, watch=other, beside=stop.beside, inside=a)
            )
    return result


def _turning(sheet: Sheet, points: Points) -> list[int | None]:
    """Whether it is the choice of variables alone that ends a sheet at folds.

    Returns:
        For every point None where what is followed is a block of its own (motors, or member, locked); else
        the watched block that is singular there, -1 if none is.
    """
    branch = sheet.branch
    if sheet.plane.of_member or branch.watching[branch.followed].name == "motors locked":
        return [None] * len(points)
    size = np.where(np.arange(len(branch.watching)) == branch.followed, np.inf, points.smallest)
    lowest = size.argmin(axis=1)
    return [int(k) if row[k] < SINGULAR else -1 for row, k in zip(size, lowest, strict=True)]


def _limit_words(sheet: Sheet, state: Vector) -> str:
    bounds = sheet.branch.bounds
    if bounds is None:
        return ""
    values = sheet.problem.variables.scalar_values(state)
    over = np.minimum(values - bounds.lower, bounds.upper - values)
    column = int(over.argmin())
    low = values[column] - bounds.lower[column] <= bounds.upper[column] - values[column]
    bound = bounds.lower[column] if low else bounds.upper[column]
    return f"{sheet.problem.variables.names[column]} reaches its limit {bound:.6g}"
