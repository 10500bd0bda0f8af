"""Lines over two variables: singular curves by type, the edge of what is reached, borders of mobility."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import xarray

from vincula.arrays import Matrix, Vector
from vincula.maps.curve_styles import CURVES, CurveStyle
from vincula.sweep.zero_curves import zero_curves

MEASURES: Final = {"branch.assembly": "platform free", "branch.working": "motors without authority"}
"""Quantities whose zeros are singular curves, and of which kind."""
EDGE: Final = CurveStyle("edge of what is reached", "#666666", (), 0.9)
ELSEWHERE: Final = CurveStyle("another branch begins", "#8a8a8a", (1.0, 1.5), 0.9)
MOBILITY: Final = CurveStyle("counts of motions differ", "#b2182b", (), 1.2)

Cut = Callable[[xarray.DataArray], xarray.DataArray]
"""Takes an array over all points to the two variables that are drawn, rows upwards."""


@dataclass(frozen=True, slots=True, eq=False)
class Plane:
    """Two variables of a data set, and the values of the others.

    Attributes:
        data: The data set.
        known: Which of its points have numbers.
        cut: Takes an array over its points to the two variables; what else it has comes behind.
        across: Values to the right, as they are shown.
        up: Values upwards.
    """

    data: xarray.Dataset
    known: xarray.DataArray
    cut: Cut
    across: Vector
    up: Vector

    def measures(self) -> Mapping[str, Matrix]:
        """Signed measures by quantity, groups in front; NaN where nothing is known."""
        found = {}
        for array in self.data.data_vars.values():
            name = array.attrs.get("quantity")
            if name in MEASURES:
                found[str(name)] = np.moveaxis(self.cut(array.where(self.known)).values, -1, 0)
        return found

    @property
    def columns(self) -> Vector:
        """Borders of the cells around the values to the right."""
        return borders(self.across)

    @property
    def rows(self) -> Vector:
        """Borders of the cells around the values upwards."""
        return borders(self.up)


def draw_lines(plane: Plane, ax: Any) -> list[Any]:
    """Draw everything that is known of singularities into axes, and say what the lines are.

    Args:
        plane: What is drawn.
        ax: Axes of matplotlib.

    Returns:
        Handles for a legend.
    """
    measures = plane.measures()
    if not measures:
        regions = _regions(plane)
        lines = np.zeros((0, 2, 2)) if regions is None else _between(plane, regions)
        return _drawn(ax, lines, MOBILITY)
    handles = []
    jumps = []
    for name, groups in measures.items():
        look, drawn = CURVES[MEASURES[name]], False
        for measure in groups:
            found = zero_curves(measure)
            jumps.append(_shown(plane, found.jumps))
            for curve in found.curves:
                _draw_curve(ax, curve, plane, look)
                drawn = True
        if drawn:
            handles.append(_handle(look))
    handles += _drawn(ax, np.unique(np.concatenate(jumps), axis=0), ELSEWHERE)
    edge = _between(plane, np.asarray(plane.cut(plane.known).values))
    return handles + _drawn(ax, edge, EDGE)


def missing_measures(data: xarray.Dataset) -> str:
    """What must be asked for to see singular curves between the points; empty where it is there."""
    there = {array.attrs.get("quantity") for array in data.data_vars.values()}
    missing = [name for name in MEASURES if name not in there]
    if not missing:
        return ""
    return f"{' and '.join(missing)} not in the data: sweep them, too, to see singular curves between points"


def borders(values: Vector) -> Vector:
    """Borders of the cells around grid values."""
    if len(values) == 1:
        return np.array([values[0] - 0.5, values[0] + 0.5])
    middle = 0.5 * (values[1:] + values[:-1])
    ends = [1.5 * values[0] - 0.5 * values[1]], [1.5 * values[-1] - 0.5 * values[-2]]
    return np.concatenate([ends[0], middle, ends[1]])


def _draw_curve(ax: Any, places: Matrix, plane: Plane, look: CurveStyle) -> None:
    points = [
        np.interp(k, np.arange(len(v)), v) for k, v in zip(places.T, (plane.across, plane.up), strict=True)
    ]
    ax.plot(*points, color="white", linewidth=look.width + 1.2, zorder=3)
    ax.plot(*points, color=look.colour, linewidth=look.width, linestyle=_dashes(look), zorder=4)


def _dashes(look: CurveStyle) -> Any:
    return (0, look.dashes) if look.dashes else "solid"


def _handle(look: CurveStyle) -> Any:
    from matplotlib.lines import Line2D

    return Line2D([], [], color=look.colour, linewidth=look.width, linestyle=_dashes(look), label=look.label)


def _drawn(ax: Any, lines: Matrix, look: CurveStyle) -> list[Any]:
    """Draw straight pieces of one look; its handle, if there are any."""
    if not len(lines):
        return []
    from matplotlib.collections import LineCollection

    ax.add_collection(
        LineCollection(
            list(lines), colors=look.colour, linewidths=look.width, linestyles=_dashes(look), zorder=2.5
        )
    )
    return [_handle(look)]


def _shown(plane: Plane, sides: Matrix) -> Matrix:
    """Sides of cells, counted in grid points, as they are shown."""
    across, up = plane.columns, plane.rows
    return np.stack(
        [
            np.interp(sides[..., 0], np.arange(len(across)) - 0.5, across),
            np.interp(sides[..., 1], np.arange(len(up)) - 0.5, up),
        ],
        axis=-1,
    )


def _between(plane: Plane, regions: Matrix) -> Matrix:
    """Sides of cells between neighbours of different regions."""
    right = [
        [(j + 0.5, i - 0.5), (j + 0.5, i + 0.5)] for i, j in np.argwhere(regions[:, 1:] != regions[:, :-1])
    ]
    above = [
        [(j - 0.5, i + 0.5), (j + 0.5, i + 0.5)] for i, j in np.argwhere(regions[1:, :] != regions[:-1, :])
    ]
    return _shown(plane, np.array([*right, *above], dtype=float).reshape(-1, 2, 2))


def _regions(plane: Plane) -> Matrix | None:
    """One number for every combination of counts, reachable or not; None without counts."""
    for name in ("counts", "summary"):
        if name in plane.data:
            rows = plane.cut(plane.data[name]).values
            _, numbers = np.unique(rows.reshape(-1, rows.shape[-1]), axis=0, return_inverse=True)
            return np.asarray(numbers.reshape(rows.shape[:2]))
    return None
