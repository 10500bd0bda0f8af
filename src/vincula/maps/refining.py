"""More points on curves, found like the first ones: between any two, and at bends and ends.

Along a singular curve a new point is the zero on a line across it; along the edge of a sheet it is where the
mechanism, followed outwards, stops.  No point is ever interpolated.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

import numpy as np

from vincula.arrays import Vector
from vincula.maps.curves import GRID, Chain, full_cells
from vincula.maps.ends import ends
from vincula.maps.loci import Crossing, Edge, edge_points, zeros_on
from vincula.maps.sheet import HALVINGS, Sheet
from vincula.maps.stacked_rows import Stack
from vincula.mechanism.closure_values import Mask

LEVELS: Final = 4
"""How often a piece between two neighbours of the first points is halved at most."""
BEND: Final = 0.15
"""A bend sharper than this between two pieces of a curve is looked at more closely [rad]."""
SHORT: Final = 0.02
"""Pieces shorter than this share of the grid's step are not halved."""
CROSSED: Final = 0.2
"""Where two curves cross a measure is below this share of what it is at the corners of the cell."""
FOLDED: Final = 1e-7
"""What is followed is zero at a fold to this accuracy."""
EXTENSIONS: Final = 5
"""How often an open end of a curve is carried on, by half as much wherever it cannot be."""
CIRCLE: Final = 12
"""Corners of the circle about a single point of a curve."""
RADIUS: Final = 0.3
"""Its radius, as a share of the grid's step."""
LAST: Final = 0.02
"""Steps shorter than this share of the grid's step carry nothing on."""


def refined(sheet: Sheet, found: list[Chain], k: int | None) -> list[Chain]:
    """Chains with more points: one between any two, and more where they bend.

    Args:
        sheet: The sheet.
        found: The chains.
        k: Number of the watched block; None along the edge of the sheet.
    """
    lines = [list(chain.crossings) for chain in found]
    todo = [_pieces(line, chain) for line, chain in zip(lines, found, strict=True)]
    for _ in range(LEVELS):
        where = [(c, int(j)) for c, pieces in enumerate(todo) for j in np.flatnonzero(pieces)]
        if not where:
            break
        ones = [lines[c][j] for c, j in where]
        twos = [lines[c][(j + 1) % len(lines[c])] for c, j in where]
        middles = _across(sheet, ones, twos, k) if k is not None else _outwards(sheet, ones, twos)
        new: list[dict[int, Crossing]] = [{} for _ in lines]
        for (c, j), middle in zip(where, middles, strict=True):
            if middle is not None:
                new[c][j] = middle
        for c, chain in enumerate(found):
            merged: list[Crossing] = []
            fresh: list[bool] = []
            for j, point in enumerate(lines[c]):
                here = [point, new[c][j]] if j in new[c] else [point]
                merged += here
                fresh += [len(here) > 1] * len(here)
            lines[c] = merged
            todo[c] = _bends(sheet, merged, chain) & np.array(
                fresh[: len(_pieces(merged, chain))], dtype=bool
            )
    return [Chain(tuple(line), chain.closed) for line, chain in zip(lines, found, strict=True)]


def _pieces(points: list[Crossing], chain: Chain) -> Mask:
    """One truth value for every piece between neighbours of a chain."""
    count = len(points) if chain.closed else len(points) - 1
    return np.ones(max(count, 0), dtype=bool)


def crossed_cells(sheet: Sheet, found: Mapping[Edge, Crossing], k: int) -> list[int]:
    """Cells of the grid in which two curves cross each other, by their first corners.

    Four zeros on the edges of a cell are two curves that keep apart, or two that cross: then the measure all
    but vanishes where the straight lines between opposite zeros meet.

    Args:
        sheet: The sheet.
        found: Zeros of a watched measure on edges of the grid.
        k: Number of the watched block.
    """
    result = []
    for corner, four in full_cells(found, sheet.shape[1]).items():
        a, b, c, d = (crossing.values for crossing in four)
        ways = np.stack([c - a, b - d], axis=1)
        if abs(float(np.linalg.det(ways / sheet.steps[:, None]))) < 1e-9:
            continue
        place = a + np.linalg.solve(ways, b - a)[0] * (c - a)
        begin = np.array([corner])
        good, points = sheet.branch.advance(
            sheet.points_at(begin), sheet.places(begin), place[None], halvings=HALVINGS
        )
        corners = corner + np.array([0, 1, sheet.shape[1], sheet.shape[1] + 1])
        if good[0] and points.smallest[0, k] < CROSSED * sheet.smallest[corners, k].min():
            result.append(corner)
    return result


def extended(sheet: Sheet, found: list[Chain], k: int) -> list[Chain]:
    """Open chains of a singular curve carried on to where the sheet, or the grid, ends.

    Args:
        sheet: The sheet.
        found: The chains.
        k: Number of the watched block.
    """
    found = [_grown(sheet, chain, k) for chain in found]
    points = [list(chain.crossings) for chain in found]
    open_ends = [
        (j, front)
        for j, chain in enumerate(found)
        if not chain.closed and len(chain.crossings) > 1
        for front in (True, False)
    ]
    low, high = (np.array([f(axis) for axis in sheet.grid]) for f in (np.min, np.max))
    share = np.full(len(open_ends), 0.5)
    for _ in range(EXTENSIONS):
        asked = []
        for e, (j, front) in enumerate(open_ends):
            last, before = (points[j][0], points[j][1]) if front else (points[j][-1], points[j][-2])
            along = last.values - before.values
            length = float(np.linalg.norm(along / sheet.steps))
            way = along * (share[e] / max(length, 1e-9))
            inside = bool(((last.values + way >= low) & (last.values + way <= high)).all())
            if not inside or length < 1e-9:
                share[e] *= 0.5
            elif share[e] > LAST:
                asked.append((e, last, way))
        if not asked:
            continue
        ways = np.array([way for _, _, way in asked])
        new = _zeros(sheet, np.array([last.values for _, last, _ in asked]) + ways, ways, k)
        for (e, last, _), crossing in zip(asked, new, strict=True):
            j, front = open_ends[e]
            if crossing is None or crossing.kind != last.kind:
                share[e] *= 0.5
            else:
                points[j].insert(0 if front else len(points[j]), crossing)
    return [Chain(tuple(p), chain.closed) for p, chain in zip(points, found, strict=True)]


def _grown(sheet: Sheet, chain: Chain, k: int) -> Chain:
    """A chain of one point together with where its curve leaves a small circle about it."""
    if chain.closed or len(chain.crossings) != 1:
        return chain
    centre = chain.crossings[0]
    angles = np.arange(CIRCLE) * (2.0 * np.pi / CIRCLE)
    ring = centre.values + RADIUS * np.stack([np.cos(angles), np.sin(angles)], axis=1) * sheet.steps
    numbers = sheet.nearest(ring)
    good, begin = sheet.branch.advance(
        sheet.points_at(numbers), sheet.places(numbers), ring, halvings=HALVINGS
    )
    found = zeros_on(sheet, k, begin, ring[good], np.roll(ring, -1, axis=0)[good])
    low, high = (np.array([f(axis) for axis in sheet.grid]) for f in (np.min, np.max))
    near = [
        point
        for point in found
        if point is not None
        and point.kind == centre.kind
        and bool(((point.values >= low) & (point.values <= high)).all())
    ]
    if not near:
        return chain
    first = near[0]
    ways = [(point.values - centre.values) / sheet.steps for point in near]
    others = [point for point, way in zip(near, ways, strict=True) if float(way @ ways[0]) < 0.0]
    return Chain((first, centre, *others[:1]), False)


def _bends(sheet: Sheet, points: list[Crossing], chain: Chain) -> Mask:
    """For every piece of a chain, whether it bends at one of its ends and is long enough to be halved."""
    if len(points) < 2:
        return np.zeros(0, dtype=bool)
    places = np.array([point.values for point in points]) / sheet.steps
    ways = np.roll(places, -1, axis=0) - places
    lengths = np.linalg.norm(ways, axis=1)
    angles = np.arctan2(ways[:, 1], ways[:, 0])
    turns = np.abs((angles - np.roll(angles, 1) + np.pi) % (2.0 * np.pi) - np.pi)
    kinds = np.array([point.kind for point in points])
    if not chain.closed:
        turns[0] = turns[-1] = 0.0
    bent = (np.maximum(turns, np.roll(turns, -1)) > BEND) | (kinds != np.roll(kinds, -1))
    found = np.asarray(bent & (lengths > SHORT))
    return found if chain.closed else found[:-1]


def _across(sheet: Sheet, ones: list[Crossing], twos: list[Crossing], k: int) -> list[Crossing | None]:
    """Zeros midway between points of a singular curve."""
    first, second = (np.array([point.values for point in side]) for side in (ones, twos))
    found = _zeros(sheet, 0.5 * (first + second), second - first, k)
    return [
        new if new is not None and new.kind in (one.kind, two.kind) else None
        for new, one, two in zip(found, ones, twos, strict=True)
    ]


def _zeros(sheet: Sheet, middles: Stack, along: Stack, k: int) -> list[Crossing | None]:
    """Zeros on lines through places, across directions; the line is as long as the direction."""
    scaled = along / sheet.steps
    across = 0.5 * np.stack([-scaled[:, 1], scaled[:, 0]], axis=1) * sheet.steps
    result: list[Crossing | None] = [None] * len(middles)
    for side in (1.0, -1.0):
        left = np.array([j for j, found in enumerate(result) if found is None], dtype=int)
        if not len(left):
            break
        here, there = middles[left] - side * across[left], middles[left] + side * across[left]
        numbers = sheet.nearest(here)
        good, begin = sheet.branch.advance(
            sheet.points_at(numbers), sheet.places(numbers), here, halvings=HALVINGS
        )
        found = zeros_on(sheet, k, begin, here[good], there[good])
        for j, crossing in zip(left[good], found, strict=True):
            result[j] = crossing
    return result


def _outwards(sheet: Sheet, ones: list[Crossing], twos: list[Crossing]) -> list[Crossing | None]:
    """Points of the edge midway between others: the mechanism followed outwards from inside the sheet."""
    result: list[Crossing | None] = [None] * len(ones)
    lines: list[tuple[int, Vector, Vector]] = []
    for j, (one, two) in enumerate(zip(ones, twos, strict=True)):
        if GRID in (one.kind, two.kind) or one.inside is None or two.inside is None:
            continue
        along = (two.values - one.values) / sheet.steps
        middle = 0.5 * (one.values + two.values)
        inwards = (0.5 * (one.inside + two.inside) - middle) / sheet.steps
        normal = np.array([-along[1], along[0]])
        size = float(np.linalg.norm(normal))
        if size < 1e-9:
            continue
        normal *= np.sign(float(normal @ inwards)) or 1.0
        lines.append((j, middle + 0.5 * normal * sheet.steps, middle - normal * sheet.steps))
    if not lines:
        return result
    here, there = np.array([line[1] for line in lines]), np.array([line[2] for line in lines])
    numbers = sheet.nearest(here)
    good, begin = sheet.branch.advance(
        sheet.points_at(numbers), sheet.places(numbers), here, halvings=HALVINGS
    )
    if not good.any():
        return result
    stops = ends(sheet.branch, begin, here[good], there[good])
    points = edge_points(sheet, stops, here[good], there[good])
    sizes = sheet.branch.points(np.array([stop.state for stop in stops])).smallest[:, sheet.branch.followed]
    found = [lines[k][0] for k in np.flatnonzero(good)]
    for j, stop, point, size in zip(found, stops, points, sizes, strict=True):
        # In a corner of two edges the mechanism stops short of the fold.
        if stop.kind == "limit" or (stop.kind == "fold" and size <= FOLDED):
            result[j] = point
    return result
