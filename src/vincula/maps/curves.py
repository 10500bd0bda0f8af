"""From points on the edges of a grid to curves: marching squares on what root finding has found."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from vincula.arrays import Matrix, Vector
from vincula.maps.loci import Crossing, Edge

AT_ONCE: Final = 2_000_000
"""Most distances that are computed together: they take memory."""


@dataclass(frozen=True, slots=True, eq=False)
class Chain:
    """Crossings in order along a curve.

    Attributes:
        crossings: Its points.
        closed: Whether the last joins the first.
    """

    crossings: tuple[Crossing, ...]
    closed: bool


@dataclass(frozen=True, slots=True, eq=False)
class Curve:
    """A singular curve, or a piece of the edge of a sheet.

    Attributes:
        kind: Kind of singularity, `limit`, `turn` (of the variables alone) or `lost`.
        edge: Whether the sheet ends there.
        points: n x 2 values of the variables, in order along the curve; one where a measure only touches
            zero.
        closed: Whether the last point joins the first.
        crossings: The points with their configurations.
    """

    kind: str
    edge: bool
    points: Matrix
    closed: bool
    crossings: tuple[Crossing, ...]


def chains(found: Mapping[Edge, Crossing], columns: int, crossed: Collection[int] = ()) -> list[Chain]:
    """Crossings linked from cell to cell of the grid.

    Args:
        found: Crossings by edge of the grid.
        columns: Number of grid values of the second variable.
        crossed: Cells, by their first corners, in which two curves cross each other.
    """
    by_edge = {_sorted(pair): crossing for pair, crossing in found.items()}
    links = _linked(by_edge, columns, crossed)
    return [Chain(tuple(by_edge[pair] for pair in chain), closed) for chain, closed in _followed(links)]


def full_cells(found: Mapping[Edge, Crossing], columns: int) -> dict[int, list[Crossing]]:
    """Cells with crossings on all four edges, by their first corners: in order round the cell."""
    cells = {a for a, _ in found}
    around = {corner: [found.get(pair) for pair in _around(corner, columns)] for corner in cells}
    return {corner: [c for c in four if c is not None] for corner, four in around.items() if None not in four}


def curves_of(chain: Chain, *, edge: bool) -> list[Curve]:
    """A chain as curves, cut where its kind changes."""
    result = []
    for piece, whole in _of_one_kind(list(chain.crossings), chain.closed):
        points = np.array([crossing.values for crossing in piece])
        result.append(Curve(piece[0].kind, edge, points, whole, tuple(piece)))
    return result


def outline(
    found: Mapping[Edge, Crossing], reached: NDArray[np.bool_], grid: Sequence[Vector]
) -> list[Chain]:
    """The edge of a sheet as closed chains; where it runs out of the grid they go along the grid's border.

    Args:
        found: Crossings where the sheet ends, by edge of the grid.
        reached: For every point of the grid whether the sheet reaches it.
        grid: Values of the two variables.
    """
    rows, columns = reached.shape
    wide = columns + 2

    def moved(number: int) -> int:
        return int((number // columns + 1) * wide + number % columns + 1)

    by_edge = {_sorted((moved(a), moved(b))): crossing for (a, b), crossing in found.items()}
    ways = ((0, None, -wide), (rows - 1, None, wide), (None, 0, -1), (None, columns - 1, 1))
    for row, column, step in ways:
        line = [(row, j) for j in range(columns)] if column is None else [(i, column) for i in range(rows)]
        for i, j in line:
            if i is not None and j is not None and reached[i, j]:
                place = np.array([grid[0][i], grid[1][j]])
                number = (i + 1) * wide + j + 1
                by_edge[_sorted((number, number + step))] = Crossing(None, place, GRID, np.zeros(0))
    linked = _followed(_linked(by_edge, wide))
    return [Chain(tuple(by_edge[pair] for pair in chain), closed) for chain, closed in linked if closed]


GRID: Final = "grid"
"""Kind of the points of an outline where the sheet goes on beyond the grid."""


def distances(places: NDArray[np.float64], found: Iterable[Curve], size: Vector) -> NDArray[np.float64]:
    """Distance of every place from the nearest curve, in units of `size` along the two variables.

    Args:
        places: (..., 2) values of the variables.
        found: The curves; none gives infinity.
        size: What one unit is, for each variable.
    """
    result = np.full(places.shape[:-1], np.inf).ravel()
    scaled = (places / size).reshape(-1, 2)
    begins, ends = [], []
    for curve in found:
        points = curve.points / size
        points = np.vstack([points, points[:1]]) if curve.closed or len(points) == 1 else points
        begins.append(points[:-1])
        ends.append(points[1:])
    if not begins:
        return result.reshape(places.shape[:-1])
    begin, along = np.vstack(begins), np.vstack(ends) - np.vstack(begins)
    lengths = np.maximum(np.sum(along * along, axis=1), 1e-300)
    part = max(AT_ONCE // len(begin), 1)
    for start in range(0, len(scaled), part):
        away = scaled[start : start + part, None, :] - begin
        share = np.clip(np.sum(away * along, axis=2) / lengths, 0.0, 1.0)
        away -= share[..., None] * along
        result[start : start + part] = np.sqrt(np.sum(away * away, axis=2).min(axis=1))
    return result.reshape(places.shape[:-1])


def _linked(
    by_edge: Mapping[Edge, Crossing], columns: int, crossed: Collection[int] = ()
) -> dict[Edge, list[Edge]]:
    """For every crossing the crossings that come next to it on a curve."""
    links: dict[Edge, list[Edge]] = {pair: [] for pair in by_edge}
    corners: set[int] = set()
    for a, b in by_edge:
        corners |= {a, a - 1} if b - a == columns else {a, a - columns}
    for corner in sorted(corners):
        around = [pair for pair in _around(corner, columns) if pair in by_edge]
        straight = [(around[0], around[2]), (around[1], around[3])] if corner in crossed else []
        for one, two in straight or _pairs(around, by_edge):
            links[one].append(two)
            links[two].append(one)
    return links


def _sorted(pair: Edge) -> Edge:
    return pair if pair[0] < pair[1] else (pair[1], pair[0])


def _around(corner: int, columns: int) -> list[Edge]:
    """The four edges of a cell, by the number of its first corner."""
    a, b, c, d = corner, corner + columns, corner + columns + 1, corner + 1
    return [(a, b), (b, c), (d, c), (a, d)]


def _pairs(edges: list[Edge], by_edge: Mapping[Edge, Crossing]) -> list[tuple[Edge, Edge]]:
    """Which crossings of a cell belong together: two, or of four the nearer pairs of one kind."""
    if len(edges) < 2:
        return []
    if len(edges) == 2:
        return [(edges[0], edges[1])]
    rest, result = list(edges), []
    while len(rest) > 1:
        options = [
            (by_edge[one].kind != by_edge[two].kind,
             float(np.linalg.norm(by_edge[one].values - by_edge[two].values)), one, two)
            for k, one in enumerate(rest) for two in rest[k + 1 :]
        ]  # fmt: skip
        _, _, one, two = min(options)
        result.append((one, two))
        rest.remove(one)
        rest.remove(two)
    return result


def _followed(links: Mapping[Edge, list[Edge]]) -> list[tuple[list[Edge], bool]]:
    """Chains of linked crossings, open ones first, each once."""
    left = set(links)
    result = []
    for start in sorted(links, key=lambda pair: (len(links[pair]) == 2, pair)):
        if start not in left:
            continue
        chain = [start]
        left.discard(start)
        while onward := [other for other in links[chain[-1]] if other in left]:
            chain.append(onward[0])
            left.discard(onward[0])
        result.append((chain, len(chain) > 2 and start in links[chain[-1]]))
    return result


def _of_one_kind(chain: list[Crossing], closed: bool) -> list[tuple[list[Crossing], bool]]:
    """A chain cut where its kind changes."""
    kinds = [crossing.kind for crossing in chain]
    if len(set(kinds)) == 1:
        return [(chain, closed)]
    if closed:
        begin = next(k for k in range(len(kinds)) if kinds[k] != kinds[k - 1])
        chain = [*chain[begin:], *chain[:begin]]
    pieces: list[list[Crossing]] = [[chain[0]]]
    for crossing in chain[1:]:
        if crossing.kind != pieces[-1][-1].kind:
            pieces.append([])
        pieces[-1].append(crossing)
    return [(piece, False) for piece in pieces]
