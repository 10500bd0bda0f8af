"""Where signed measures vanish on a sheet: singular curves by root finding, and the sheet's own edge.

Along every edge of the grid a watched determinant that changes sign is zero somewhere: that point is
found to rounding by root finding on the closed mechanism.  The edge of the sheet is found by following the
mechanism outwards until it stops; what stops it says of which kind the edge is.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from vincula.arrays import Vector
from vincula.maps.sheet import Node, Point, Sheet
from vincula.mechanism.configuration import Configuration
from vincula.mechanism.singularities import Singularity, classified
from vincula.mechanism.watching import SingularityKind, decided

EXACT: Final = 1e-13
"""Accuracy of a root, as a share of the grid's step."""
KINDS: Final[tuple[SingularityKind, ...]] = ("platform free", "motors without authority", "internal")
"""Kinds of singularity, as `mechanism.singularities` names them."""

Edge = tuple[Node, Node]


@dataclass(frozen=True, slots=True, eq=False)
class Crossing:
    """A point of a curve on an edge of the grid.

    Attributes:
        values: The two variables there [m, rad].
        kind: Kind of singularity, `limit` (a joint limit), or `lost`.
        configuration: The configuration there.
        words: What is singular, or which joint is at its limit.
    """

    values: Vector
    kind: str
    configuration: Configuration
    words: str


def crossings(sheet: Sheet, progress: Callable[[], None] | None = None) -> dict[str, dict[Edge, Crossing]]:
    """Zeros of the watched measures on the edges between points of a sheet, by name of the block."""
    found: dict[str, dict[Edge, Crossing]] = {}
    for one in sheet.points:
        for two in sheet.neighbours(one):
            if two < one or two not in sheet.points:
                continue
            a, b = sheet.points[one], sheet.points[two]
            blocks = [k for k in range(len(sheet.watching)) if _changes(a, b, k)]
            if blocks and sheet.is_continuous(one, two):
                for k in blocks:
                    crossing = _root(sheet, a, sheet.place(one), sheet.place(two), k)
                    if crossing is not None:
                        found.setdefault(sheet.watching[k].name, {})[one, two] = crossing
            if progress is not None:
                progress()
    return found


def outer_edge(sheet: Sheet, progress: Callable[[], None] | None = None) -> dict[Edge, Crossing]:
    """Where the sheet ends on the edges that lead out of it.

    A point that following reaches in shorter steps than the filling took belongs to the sheet: it is
    added, and the filling goes on from there.
    """
    found: dict[Edge, Crossing] = {}
    todo = [(one, two) for one in sheet.points for two in sheet.neighbours(one) if two not in sheet.points]
    while todo:
        one, two = todo.pop()
        if two in sheet.points or (one, two) in found:
            continue
        end = _end(sheet, one, two)
        if isinstance(end, Crossing):
            found[one, two] = end
        else:
            for new in sheet.extend(two, end):
                todo += [(new, other) for other in sheet.neighbours(new) if other not in sheet.points]
        if progress is not None:
            progress()
    return {pair: crossing for pair, crossing in found.items() if pair[1] not in sheet.points}


def _changes(one: Point, two: Point, k: int) -> bool:
    a, b = one.measures[k], two.measures[k]
    return a.rank > 0 and b.sign_against(a) < 0.0


def between(sheet: Sheet, block: str, one: Crossing, two: Crossing) -> Crossing | None:
    """A point of a curve midway between two of its points, found across it; None where there is none."""
    k = next(k for k, watch in enumerate(sheet.watching) if watch.name == block)
    middle, along = 0.5 * (one.values + two.values), two.values - one.values
    across = 0.5 * np.array([-along[1], along[0]])
    near = sheet.nearest(middle)
    begin = sheet.step(sheet.points[near], sheet.place(near), middle - across)
    return None if begin is None else _root(sheet, begin, middle - across, middle + across, k)


def _root(sheet: Sheet, begin: Point, here: Vector, there: Vector, k: int) -> Crossing | None:
    """The zero of a measure on a line in the plane of the variables, from a point with its sign."""
    from scipy.optimize import brentq

    end = sheet.step(begin, here, there)
    if end is None or not _changes(begin, end, k):
        return None
    reference = begin.measures[k]
    kept: dict[float, Point] = {0.0: begin, 1.0: end}

    def measured(share: float) -> float:
        if share not in kept:
            near = min(kept, key=lambda other: abs(other - share))
            values = here + share * (there - here)
            point = sheet.at(kept[near], values) or sheet.step(begin, here, values)
            if point is None:
                raise _LostError
            kept[share] = point
        measure = kept[share].measures[k]
        return measure.sign_against(reference) * measure.smallest

    try:
        share = float(brentq(measured, 0.0, 1.0, xtol=EXACT, rtol=8.9e-16))
        measured(share)
    except _LostError:
        return None
    point = kept[share]
    around = [p.measures[k].right[:, p.measures[k].rank :] for p in (begin, end)]
    measure = point.measures[k]
    rank = decided(measure.jacobian, float(np.linalg.norm(point.equations.gaps)), measure.values).rank
    lost = measure.lost(around, rank)
    singular = classified(sheet.problem, point.state, sheet.watching[k], *lost, sheet.motors)
    return Crossing(here + share * (there - here), singular.kind, sheet.configuration(point), str(singular))


class _LostError(Exception):
    """A point between two of a sheet that its branch does not reach."""


def _end(sheet: Sheet, one: Node, two: Node) -> Crossing | Configuration:
    """Where following from a point of the sheet towards one outside stops; its end if it does not."""
    plane = sheet.plane
    here, there = sheet.place(one), sheet.place(two)
    q = sheet.configuration(sheet.points[one])
    goal = plane.held_at(there)
    way: Any = goal.pose if goal.pose is not None else goal.point
    if way is None:
        way = {**goal.joints, **goal.axes, **goal.drives}
    path = plane.mechanism.follow([way], start=q, limits=sheet.bounds is not None, through=KINDS)
    if path.stopped is None:
        return path.end
    stop = path.stopped
    share = min(stop.parameter / path.length, 1.0) if path.length else 0.0
    kind = _kind(stop.singularities, plane.of_member) if stop.kind == "singularity" else stop.kind
    if kind == "incompatible" and share == 0.0:
        # The point itself lies on the edge, to rounding: what is held can move along it only.
        kind = KINDS[1] if plane.of_member else KINDS[0]
    return Crossing(here + share * (there - here), kind, stop.configuration, stop.reason)


def _kind(singularities: tuple[Singularity, ...], of_member: bool) -> str:
    """The kind that ends a sheet; where several meet, the one that stops what is held."""
    kinds = [s.kind for s in singularities]
    order = KINDS[1::-1] + KINDS[2:] if of_member else KINDS
    return next((kind for kind in order if kind in kinds), "lost")
