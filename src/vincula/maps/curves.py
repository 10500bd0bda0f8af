"""From points on the edges of a grid to curves: marching squares on what root finding has found."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from vincula.arrays import Matrix, Vector
from vincula.maps.loci import Crossing, Edge


@dataclass(frozen=True, slots=True, eq=False)
class Curve:
    """A singular curve, or a piece of the edge of a sheet.

    Attributes:
        kind: Kind of singularity, `limit` or `lost`.
        edge: Whether the sheet ends there.
        points: n x 2 values of the variables, in order along the curve.
        closed: Whether the last point joins the first.
        crossings: The points with their configurations.
    """

    kind: str
    edge: bool
    points: Matrix
    closed: bool
    crossings: tuple[Crossing, ...]


def curves(found: Mapping[Edge, Crossing], shape: tuple[int, int], *, edge: bool) -> tuple[Curve, ...]:
    """Curves through crossings, one a connected chain of one kind.

    Args:
        found: Crossings by edge of the grid.
        shape: Number of grid values of the two variables.
        edge: Whether they are where the sheet ends.
    """
    by_edge = {_sorted(pair): crossing for pair, crossing in found.items()}
    result = []
    for chain, closed in _chains(_linked(by_edge, shape)):
        for piece, whole in _of_one_kind([by_edge[pair] for pair in chain], closed):
            points = np.array([crossing.values for crossing in piece])
            result.append(Curve(piece[0].kind, edge, points, whole, tuple(piece)))
    return tuple(result)


def outline(found: Mapping[Edge, Crossing], shape: tuple[int, int]) -> tuple[Matrix, ...]:
    """The edge of a sheet as closed loops of points; none where it runs out of the grid."""
    by_edge = {_sorted(pair): crossing for pair, crossing in found.items()}
    chains = _chains(_linked(by_edge, shape))
    if not all(closed for chain, closed in chains if len(chain) > 1):
        return ()
    return tuple(np.array([by_edge[pair].values for pair in chain]) for chain, closed in chains if closed)


def _linked(by_edge: Mapping[Edge, Crossing], shape: tuple[int, int]) -> dict[Edge, list[Edge]]:
    """For every crossing the crossings that come next to it on a curve."""
    links: dict[Edge, list[Edge]] = {pair: [] for pair in by_edge}
    for i in range(shape[0] - 1):
        for j in range(shape[1] - 1):
            for one, two in _pairs([pair for pair in _around(i, j) if pair in by_edge], by_edge):
                links[one].append(two)
                links[two].append(one)
    return links


def distances(places: NDArray[np.float64], found: Iterable[Curve], size: Vector) -> NDArray[np.float64]:
    """Distance of every place from the nearest curve, in units of `size` along the two variables.

    Args:
        places: (..., 2) values of the variables.
        found: The curves; none gives infinity.
        size: What one unit is, for each variable.
    """
    result = np.full(places.shape[:-1], np.inf)
    scaled = places / size
    for curve in found:
        points = curve.points / size
        ends = np.vstack([points, points[:1]]) if curve.closed else points
        if len(ends) == 1:
            ends = np.vstack([ends, ends])
        for begin, end in pairwise(ends):
            along = end - begin
            length = float(along @ along)
            share = np.clip((scaled - begin) @ along / length, 0.0, 1.0) if length else np.zeros(result.shape)
            away = scaled - begin - share[..., None] * along
            result = np.minimum(result, np.sqrt((away * away).sum(axis=-1)))
    return result


def _sorted(pair: Edge) -> Edge:
    return pair if pair[0] < pair[1] else (pair[1], pair[0])


def _around(i: int, j: int) -> list[Edge]:
    """The four edges of a cell."""
    a, b, c, d = (i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)
    return [_sorted(pair) for pair in ((a, b), (b, c), (c, d), (d, a))]


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


def _chains(links: Mapping[Edge, list[Edge]]) -> list[tuple[list[Edge], bool]]:
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
    """A chain cut where its kind changes; neighbours share the point between them."""
    kinds = [crossing.kind for crossing in chain]
    if len(set(kinds)) == 1:
        return [(chain, closed)]
    if closed:
        begin = next(k for k in range(len(kinds)) if kinds[k] != kinds[k - 1])
        chain = [*chain[begin:], *chain[: begin + 1]]
    pieces: list[list[Crossing]] = [[chain[0]]]
    for crossing in chain[1:]:
        if crossing.kind != pieces[-1][-1].kind:
            pieces.append([])
        pieces[-1].append(crossing)
    return [(piece, False) for piece in pieces]
