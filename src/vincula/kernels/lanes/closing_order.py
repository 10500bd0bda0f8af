"""The order in which unknowns are eliminated, and what fills in: made once, from the pattern alone.

The normal matrix of closure has an entry where two unknowns move one gap.  Eliminating the unknown with
the fewest neighbours first takes limbs and inner loops one after the other, leaves first, and the
member last: cost grows with the number of loops, not with its cube.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Elimination:
    """A sparse factor's pattern.

    Attributes:
        order: Unknowns in the order of elimination.
        below: For every place in that order, the later places that its column of the factor has entries at.
        entry: Index of every entry by (row, column), places, row >= column; column after column.
    """

    order: tuple[int, ...]
    below: tuple[tuple[int, ...], ...]
    entry: dict[tuple[int, int], int]


def elimination(count: int, groups: Sequence[Sequence[int]]) -> Elimination:
    """Minimum degree on the graph in which every group of unknowns is a clique.

    Args:
        count: Number of unknowns.
        groups: Unknowns that share equations.
    """
    near: list[set[int]] = [set() for _ in range(count)]
    for group in groups:
        for one in group:
            near[one].update(other for other in group if other != one)
    left = set(range(count))
    order: list[int] = []
    later: list[set[int]] = []
    while left:
        pivot = min(left, key=lambda unknown: (len(near[unknown]), unknown))
        neighbours = near[pivot]
        for one in neighbours:
            near[one] |= neighbours
            near[one] -= {one, pivot}
        left.remove(pivot)
        order.append(pivot)
        later.append(set(neighbours))
    place = {unknown: k for k, unknown in enumerate(order)}
    below = tuple(tuple(sorted(place[one] for one in group)) for group in later)
    entry: dict[tuple[int, int], int] = {}
    for column, rows in enumerate(below):
        for row in (column, *rows):
            entry[row, column] = len(entry)
    return Elimination(tuple(order), below, entry)


def pair_entries(columns: Sequence[int], pattern: Elimination) -> list[int]:
    """Entry of the normal matrix for every pair of unknowns (each with itself and those after it)."""
    return [pattern.entry[two, one] for k, one in enumerate(columns) for two in columns[k:]]
