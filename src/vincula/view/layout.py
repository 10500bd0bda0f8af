"""Where panels, titles and notes go on paper, in inches: fixed, so that figures are reproducible."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vincula.arrays import Matrix, Vector

COLUMN = 3.5
"""Width of a column of a journal [inch]."""
PAGE = 7.16
"""Width of a page of a journal [inch]."""

LEFT, RIGHT, GAP = 0.46, 0.06, 0.12
BELOW_PANELS = 0.35
TITLE_LINE = 0.125
NOTE_LINE = 0.118
LEGEND_LINE = 0.135
MARGIN = 15.0
"""Free space between what is drawn and the frame [points]."""
TALLEST, LOWEST = 1.35, 0.5
"""Height of a panel over its width."""


@dataclass(frozen=True, slots=True, eq=False)
class Window:
    """What a planar panel shows.

    Attributes:
        low: Lower left corner [m].
        high: Upper right corner [m].
        points_per_metre: Scale on paper.
        height: Height of the panel [inch].
    """

    low: Vector
    high: Vector
    points_per_metre: float
    height: float


def window(points: Matrix, width: float) -> Window:
    """The window of a panel of given width [inch] that shows all the points [m] with a margin."""
    paper = 72.0 * width
    low, high = points.min(axis=0), points.max(axis=0)
    span = np.maximum(high - low, 1e-9 * max(1.0, float(np.abs(points).max())))
    if not (high - low).any():
        span = np.ones(2)
    scale = min((paper - 2 * MARGIN) / span[0], (TALLEST * paper - 2 * MARGIN) / span[1])
    # Rounded, so that the last bits of an ellipsoid change nothing else on the sheet.
    height = 0.1 * round(10.0 * max(LOWEST * paper, span[1] * scale + 2 * MARGIN))
    half = 0.5 * np.array([paper, height]) / scale
    middle = 0.5 * (low + high)
    return Window(middle - half, middle + half, float(scale), height / 72.0)


@dataclass(frozen=True, slots=True)
class Grid:
    """Rows and columns of equal panels with room for titles above each, legend and notes at the foot.

    Attributes:
        columns: Number of columns.
        width: Width of the figure [inch].
        panel: Width of a panel [inch].
        height: Height of a panel [inch].
        titles: Room above the panels of each row [inch].
        left: Room left of the first column [inch].
        below: Room below the last row [inch].
        between: Room between columns, and between rows [inch].
        head: Room above all [inch].
        foot: Room below all [inch].
    """

    columns: int
    width: float
    panel: float
    height: float
    titles: tuple[float, ...]
    left: float
    below: float
    between: float
    head: float
    foot: float

    @property
    def rows(self) -> int:
        """Number of rows."""
        return len(self.titles)

    @property
    def size(self) -> tuple[float, float]:
        """Width and height of the figure [inch]."""
        panels = sum(self.titles) + self.rows * self.height + (self.rows - 1) * self.between
        return self.width, self.head + panels + self.below + self.foot

    def box(self, row: int, column: int) -> tuple[float, float, float, float]:
        """A panel as left, bottom, width, height in fractions of the figure."""
        width, height = self.size
        x = self.left + column * (self.panel + self.between)
        top = self.head + sum(self.titles[: row + 1]) + row * (self.height + self.between)
        return x / width, 1.0 - (top + self.height) / height, self.panel / width, self.height / height


def panel_width(width: float, columns: int, left: float = LEFT) -> float:
    """Width of one of several panels side by side [inch]."""
    return (width - left - RIGHT - (columns - 1) * GAP) / columns


def wrapped(text: str, width: float, size: float = 6.5) -> list[str]:
    """Lines of a text of a font size [points] that fit a width [inch]."""
    import textwrap

    return textwrap.wrap(text, max(20, int(72.0 * width / (0.52 * size)))) if text else []


def columns_for(count: int, most: int) -> int:
    """How many panels stand side by side: all in a row, or two by two."""
    return min(count, most) if count != 4 or most >= 4 else 2


def stacked(blocks: Sequence[Matrix]) -> Matrix:
    """Points of several drawables together."""
    filled = [block for block in blocks if len(block)]
    return np.vstack(filled) if filled else np.zeros((1, 2))
