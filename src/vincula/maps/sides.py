"""On which side of the singular curves the points of a sheet lie.

Neighbours are compared by the sign of a determinant, each pair in bases of its own.  A point of the grid that
lies on a curve to rounding has no side: those about it are compared across it, and it counts as positive.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from vincula.arrays import Vector
from vincula.maps.branch import ON_CURVE
from vincula.maps.sheet import Sheet

SLAB: Final = 8192
"""Most pairs that are compared together: they take memory."""
EVERYWHERE: Final = 0.9
"""Where more than this share of a sheet is singular, it is no curve that is."""
Pairs = NDArray[np.intp]


def sign_changes(sheet: Sheet, pairs: Pairs) -> dict[int, NDArray[np.bool_]]:
    """Between which neighbours every watched determinant changes its sign, by number of the watch.

    Args:
        sheet: The sheet.
        pairs: m x 2 neighbours.
    """
    watches = [k for k, kept in enumerate(sheet.branch.kept) if kept and k not in singular_everywhere(sheet)]
    across = _across(sheet, watches)
    signs, beyond = _signs(sheet, pairs, watches), _signs(sheet, across, watches)
    found = {}
    for k in watches:
        on = sheet.smallest[:, k] <= ON_CURVE
        regular = ~on[pairs].any(axis=1)
        changed = regular & (signs[k] < 0.0)
        if not regular.all():
            middle = across.sum(axis=1) // 2
            linked = on[middle] & ~on[across].any(axis=1)
            sides = _sides(
                np.concatenate([pairs[regular], across[linked]]),
                np.concatenate([signs[k][regular], beyond[k][linked]]),
                len(sheet.reached),
            )
            sides[on] = 1.0
            odd = ~regular
            changed[odd] = sides[pairs[odd, 0]] != sides[pairs[odd, 1]]
        found[k] = changed
    return found


def singular_everywhere(sheet: Sheet) -> tuple[int, ...]:
    """The watches that vanish all over a sheet: the plane of the variables lies in the singular set."""
    on = sheet.smallest[sheet.reached] <= ON_CURVE
    return tuple(k for k in range(on.shape[1]) if len(on) and float(on[:, k].mean()) > EVERYWHERE)


def _across(sheet: Sheet, watches: list[int]) -> Pairs:
    """Points two apart with one between them that is on a curve."""
    pairs = sheet.pairs_inside(2)
    middle = pairs.sum(axis=1) // 2
    on = (sheet.smallest[middle][:, watches] <= ON_CURVE).any(axis=1) & sheet.reached[middle]
    return np.asarray(pairs[on])


def _signs(sheet: Sheet, pairs: Pairs, watches: list[int]) -> dict[int, Vector]:
    """For every pair 1, or -1 where a watched determinant changes its sign between the two."""
    found = {k: np.ones(len(pairs)) for k in watches}
    for start in range(0, len(pairs), SLAB):
        part = pairs[start : start + SLAB]
        numbers, places = np.unique(part, return_inverse=True)
        points, places = sheet.points_at(numbers), places.reshape(-1, 2)
        for k in watches:
            ones, others = points.take(places[:, 0]), points.take(places[:, 1])
            found[k][start : start + SLAB] = sheet.branch.signs(ones, others, k)
    return found


def _sides(pairs: Pairs, signs: Vector, size: int) -> Vector:
    """A sign for every point such that pairs have the given products, as far as that can be."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import breadth_first_order, connected_components

    both = np.concatenate([pairs, pairs[:, ::-1]])
    sign = dict(zip(map(tuple, both.tolist()), np.concatenate([signs, signs]).tolist(), strict=True))
    graph = coo_array((np.ones(len(both)), (both[:, 0], both[:, 1])), shape=(size, size)).tocsr()
    sides = np.ones(size)
    parts = connected_components(graph, directed=False)[1]
    for part in np.unique(parts[pairs]):
        first = int(np.flatnonzero(parts == part)[0])
        order, before = breadth_first_order(graph, first, directed=False)
        for number in order[1:]:
            sides[number] = sides[before[number]] * sign[int(before[number]), int(number)]
    return sides
