"""The structure that elimination follows: limbs, and in a limb fronts, leaves first.

A limb is a connected piece of the mechanism when the reference member is taken away.  Inside it passive
joints are eliminated front by front: a front gathers the rows of a few blocks, eliminates the passive
joints that occur nowhere else, and hands what is left on, so a chain of loops costs in proportion to its
length.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from vincula.mechanism.layout import Layout


@dataclass(slots=True, eq=False)
class Group:
    """Rows that are eliminated together: blocks, or what a front handed on.

    Attributes:
        columns: Joint columns that occur in them.
        blocks: Row blocks.
        children: Fronts whose rows are among them.
        rows: Number of rows.
        member: Whether the member's twist occurs.
    """

    columns: set[int]
    blocks: list[int] = field(default_factory=list)
    children: list[int] = field(default_factory=list)
    rows: int = 0
    member: bool = False

    @staticmethod
    def merged(groups: Iterable[Group]) -> Group:
        """All rows of several groups."""
        whole = Group(set())
        for group in groups:
            whole.columns |= group.columns
            whole.blocks += group.blocks
            whole.children += group.children
            whole.rows += group.rows
            whole.member |= group.member
        return whole


@dataclass(frozen=True, slots=True, eq=False)
class Structure:
    """Row blocks of a mechanism and the limbs that they form.

    Attributes:
        first: First row of every block.
        rows: Number of rows of every block.
        occurs: Blocks x columns (q_a, q_p): whether a column occurs in a block.
        member: For every block, whether the member's twist occurs.
        motors: Number of motors.
        limbs: For every limb its blocks, in the order of the first of them, and its columns.
    """

    first: list[int]
    rows: list[int]
    occurs: NDArray[np.bool_]
    member: list[bool]
    motors: int
    limbs: list[tuple[list[int], list[int]]]

    @staticmethod
    def of(layout: Layout) -> Structure:
        """The structure of a layout."""
        order = [*layout.active, *layout.passive]
        pattern = np.vstack([layout.signs[:, order] != 0.0, _scalar_pattern(layout)[:, order]])
        blocks = _blocks(layout)
        first = [start for start, _, _ in blocks]
        rows = [count for _, count, _ in blocks]
        occurs = np.array([pattern[start] for start in first]).reshape(len(first), len(order))
        return Structure(
            first, rows, occurs, [carried for _, _, carried in blocks], len(layout.active), _limbs(occurs)
        )

    def group(self, block: int) -> Group:
        """The rows of one block."""
        columns = {int(c) for c in np.flatnonzero(self.occurs[block])}
        return Group(columns, [block], [], self.rows[block], self.member[block])


def _blocks(layout: Layout) -> list[tuple[int, int, bool]]:
    """First row, rows and whether carried, as `flat_rows` makes them."""
    found: list[tuple[int, int, bool]] = []
    start, count = 0, len(layout.blocked.frame)
    for row in range(count):
        here = layout.rows[row]
        after = layout.rows[row + 1] if row + 1 < count else None
        if after is None or (after.source, after.kind) != (here.source, here.kind):
            found.append((start, row + 1 - start, bool(layout.carried[row])))
            start = row + 1
    return found + [(row, 1, False) for row in range(count, len(layout.rows))]


def _scalar_pattern(layout: Layout) -> NDArray[np.bool_]:
    """Where coefficients of couplings and drives may differ from zero."""
    pattern = layout.constant != 0.0
    index = layout.index
    for k, coupling in layout.polynomials:
        pattern[k, [index[axis] for axis in coupling.axes if axis in index]] = True
    return np.asarray(pattern)


def _limbs(occurs: NDArray[np.bool_]) -> list[tuple[list[int], list[int]]]:
    """Connected components of blocks and columns; a block or column by itself is one too."""
    blocks, columns = occurs.shape
    label = list(range(blocks + columns))

    def root(k: int) -> int:
        while label[k] != k:
            label[k] = label[label[k]]
            k = label[k]
        return k

    for block, column in np.argwhere(occurs):
        one, two = root(int(block)), root(blocks + int(column))
        label[max(one, two)] = min(one, two)
    found: dict[int, tuple[list[int], list[int]]] = {}
    for k in range(blocks + columns):
        own = found.setdefault(root(k), ([], []))
        own[0 if k < blocks else 1].append(k if k < blocks else k - blocks)
    return list(found.values())


def next_front(groups: list[Group], passive: set[int]) -> tuple[list[Group], list[int]]:
    """The groups to merge and the columns to eliminate next: the smallest front there is.

    Args:
        groups: Groups of a limb.
        passive: Passive columns not yet eliminated that occur in them.
    """
    where: dict[int, tuple[int, ...]] = {
        column: tuple(k for k, group in enumerate(groups) if column in group.columns) for column in passive
    }
    best: tuple[int, int, tuple[int, ...]] | None = None
    for places in dict.fromkeys(where[column] for column in sorted(passive)):
        whole = Group.merged(groups[k] for k in places)
        size = (len(whole.columns), whole.rows, places)
        if best is None or size < best:
            best = size
    chosen = set(best[2]) if best is not None else set()
    pivots = [column for column in sorted(passive) if set(where[column]) <= chosen]
    return [groups[k] for k in sorted(chosen)], pivots
