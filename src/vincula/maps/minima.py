"""Zeros that no edge of the grid shows: loops smaller than a cell, points where a measure only touches zero.

Where a watched measure has a minimum at a point of the grid, and could reach zero between it and its
neighbours, the minimum itself is sought.  If the sign changes on the way there is a loop, which is found
along rays; if the minimum is zero the curve is a point.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from vincula.arrays import Vector
from vincula.maps.branch import Numbers, Points
from vincula.maps.curves import Chain
from vincula.maps.loci import Crossing, Edge, singularity, zeros_on
from vincula.maps.sheet import HALVINGS, Sheet
from vincula.maps.stacked_rows import Stack
from vincula.mechanism.watching import decided

ROUNDS: Final = 14
"""Most looks about one minimum, each nearer than the last."""
NEARER: Final = 0.35
"""Radius of a look as a share of the one before."""
FALLS: Final = 0.9
"""A minimum is followed while a look leaves at most this share of it."""
RAYS: Final = 24
"""Directions in which a loop is sought from inside."""
REACH: Final = 2.0
"""A measure may fall below the point of the grid by so many times what it rises to the neighbours."""
_STENCIL: Final = np.array([(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1)], dtype=float)
_CENTRE: Final = 4


def hidden(sheet: Sheet, k: int, known: dict[Edge, Crossing]) -> list[Chain]:
    """Loops and touching points of a watched measure that no edge of the grid shows.

    Args:
        sheet: The sheet.
        k: Number of the watched block.
        known: Its zeros on edges of the grid: what lies beside them is not looked at again.
    """
    numbers = _candidates(sheet, k, known)
    if not len(numbers):
        return []
    centres, found, inside = _minima(sheet, k, numbers)
    chains: list[Chain] = []
    places: list[Vector] = []
    for j in range(len(numbers)):
        if any(np.abs((centres[j] - place) / sheet.steps).max() < 0.5 for place in places):
            continue
        within = inside[j]
        if within is None:
            chain = _touch(sheet, k, centres[j], found[j])
        else:
            chain = _loop(sheet, k, within[0], within[1])
        if chain is not None:
            places.append(centres[j])
            chains.append(chain)
    return chains


def _candidates(sheet: Sheet, k: int, known: dict[Edge, Crossing]) -> Numbers:
    """Points of the grid that are minima from which zero can be reached within a cell."""
    size = np.where(sheet.reached, sheet.smallest[:, k], np.nan).reshape(sheet.shape)
    if min(sheet.shape) < 3:
        return np.zeros(0, dtype=np.intp)
    beside = np.zeros(sheet.reached.shape, dtype=bool)
    for pair in known:
        beside[list(pair)] = True
    wide = np.pad(beside.reshape(sheet.shape), 1)
    values = np.pad(size, 1, constant_values=np.nan)
    rows, columns = sheet.shape
    shifts = [(i, j) for i in (0, 1, 2) for j in (0, 1, 2) if (i, j) != (1, 1)]
    around = np.stack([values[i : i + rows, j : j + columns] for i, j in shifts])
    near = np.stack([wide[i : i + rows, j : j + columns] for i, j in [*shifts, (1, 1)]]).any(axis=0)
    known_around = np.isfinite(around).sum(axis=0) >= 5
    with np.errstate(invalid="ignore"):
        lowest = (np.where(np.isfinite(around), around, np.inf) >= size).all(axis=0)
        rise = np.where(np.isfinite(around), around, -np.inf).max(axis=0) - size
        chosen = lowest & known_around & ~near & (size <= REACH * rise)
    return np.flatnonzero(chosen.ravel())


def _minima(
    sheet: Sheet, k: int, numbers: Numbers
) -> tuple[Stack, list[tuple[float, Vector]], list[tuple[Vector, Points] | None]]:
    """Places of minima, their values and states, and where the sign changed a point on the other side."""
    centres = sheet.places(numbers).copy()
    best = [(float(sheet.smallest[n, k]), sheet.states[n]) for n in numbers]
    inside: list[tuple[Vector, Points] | None] = [None] * len(numbers)
    radius = np.full(len(numbers), 0.6)
    last = np.full(len(numbers), np.inf)
    going = np.arange(len(numbers))
    for _ in range(ROUNDS):
        if not len(going):
            break
        still = []
        for j in going:
            places = centres[j] + radius[j] * _STENCIL * sheet.steps
            signed, points, good = _measured(sheet, k, places)
            if not good[_CENTRE] or good.sum() < len(good):
                # At the edge of the sheet no whole neighbourhood can be seen.
                radius[j] *= NEARER
                still.append(j)
                continue
            if (signed < 0.0).any():
                low = int(signed.argmin())
                inside[j] = places[low], points.take(slice(low, low + 1))
                continue
            targets = _model_minima(signed, places, radius[j] * sheet.steps)
            ahead, more, fine = _measured(sheet, k, targets)
            values = np.concatenate([np.abs(signed), np.abs(ahead[fine])])
            both = Points.joined([points, more])
            at = np.concatenate([places, targets[fine]])
            low = int(values.argmin())
            centres[j], best[j] = at[low], (float(values[low]), both.states[low])
            radius[j] *= NEARER
            before, last[j] = last[j], float(values[low])
            # A minimum that no longer falls is none that reaches zero.
            if 0.0 < values[low] <= FALLS * before:
                still.append(j)
        going = np.array(still, dtype=int)
    return centres, best, inside


def _measured(sheet: Sheet, k: int, places: Stack) -> tuple[Vector, Points, NDArray[np.bool_]]:
    """A watched measure at places near by, signed against the middle one; the points are those reached."""
    begin = np.repeat(sheet.nearest(places[len(places) // 2][None]), len(places))
    good, points = sheet.branch.advance(
        sheet.points_at(begin), sheet.places(begin), places, halvings=HALVINGS
    )
    signed = np.full(len(places), np.nan)
    if good[len(places) // 2] and len(places) == len(_STENCIL):
        middle = int(good[: len(places) // 2].sum())
        against = points.take(np.full(len(points), middle))
        signed[good] = sheet.branch.signs(against, points, k) * points.smallest[:, k]
        signed[len(places) // 2] = points.smallest[middle, k]
    else:
        signed[good] = points.smallest[:, k]
    return signed, points, good


def _model_minima(values: Vector, places: Stack, size: Vector) -> Stack:
    """Minima of quadratic models of a measure and of its square (a cone), inside the stencil."""
    x, y = _STENCIL.T
    design = np.stack([np.ones(len(x)), x, y, x * x, x * y, y * y], axis=1)
    found = []
    for observed in (values, values * values):
        _, b, c, d, e, f = np.linalg.lstsq(design, observed, rcond=None)[0]
        hessian = np.array([[2.0 * d, e], [e, 2.0 * f]])
        curvature, turned = np.linalg.eigh(hessian)
        safe = np.maximum(curvature, 1e-3 * max(float(np.abs(curvature).max()), 1e-300))
        step = -turned @ ((turned.T @ np.array([b, c])) / safe)
        found.append(places[_CENTRE] + np.clip(step, -1.5, 1.5) * size)
    return np.array(found)


def _touch(sheet: Sheet, k: int, place: Vector, found: tuple[float, Vector]) -> Chain | None:
    """A point where the measure is zero without changing its sign; None where it is not zero."""
    state, rank = found[1], sheet.branch.ranks[k]
    here = sheet.problem.equations(state)
    block = here.jacobian[:, sheet.branch.watching[k].columns]
    if decided(block, float(np.linalg.norm(here.gaps))).rank >= rank:
        return None
    told = singularity(sheet, state, k, ())
    return Chain((Crossing(sheet, place, told.kind, state, watch=k),), False)


def _loop(sheet: Sheet, k: int, centre: Vector, point: Points) -> Chain | None:
    """A small loop about a point inside it, by the zeros on rays."""
    angles = np.arange(RAYS) * (2.0 * np.pi / RAYS)
    ring = centre + 1.2 * np.stack([np.cos(angles), np.sin(angles)], axis=1) * sheet.steps
    begin = point.take(np.zeros(RAYS, dtype=int))
    zeros = zeros_on(sheet, k, begin, np.repeat(centre[None], RAYS, axis=0), ring)
    known = tuple(zero for zero in zeros if zero is not None)
    return Chain(known, len(known) == RAYS) if len(known) > 1 else None
