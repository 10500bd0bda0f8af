"""The figure of a map: the index in colour, singular curves and edges by type, the mechanism in its place."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from vincula.arrays import Matrix
from vincula.errors import ModelError
from vincula.kernels.quantities import in_words
from vincula.maps.curve_styles import CURVES, CurveStyle
from vincula.maps.curves import Curve
from vincula.maps.map_data import MapSheet, SingularityMap
from vincula.spatial.space import PLANAR
from vincula.view import layout
from vincula.view.plot import drawing_settings, motors_text, need_matplotlib

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

REGION: Final = "#eef1f6"
"""Colour of what is reached where no index is drawn."""
FAINT: Final = 0.45
"""How much of the mechanism is seen over the map."""
DISTANCE: Final = "distance"
"""What a map can show without any index."""
MOST_PANELS: Final = 8


def plot_map(
    found: SingularityMap,
    quantity: str | None = None,
    *,
    linkage: bool = True,
    width: float | None = None,
) -> Figure:
    """A map as a figure for print, one panel a branch.

    Args:
        found: The map.
        quantity: Which of its indices is shown in colour, or `distance` to the nearest singular curve; the
            first index by default, none if it has none.
        linkage: Whether the mechanism at its start is drawn where the variables are the x and y of a planar
            mechanism's reference point.
        width: Width of the figure [inch].

    Raises:
        MissingExtraError: matplotlib is not installed.
        ModelError: An index that the map does not have.
    """
    need_matplotlib()
    known = list(found.sheets[0].quantities)
    if quantity is not None and quantity not in (*known, DISTANCE):
        raise ModelError(f"the map has no {quantity!r}; it has {', '.join(known) or 'no index'}")
    chosen = quantity or (known[0] if known else None)
    with drawing_settings():
        return _figure(found, chosen, linkage, width)


def _figure(found: SingularityMap, quantity: str | None, linkage: bool, width: float | None) -> Figure:
    from matplotlib.figure import Figure

    sheets = found.sheets[:MOST_PANELS]
    columns = min(len(sheets), 2)
    rows = -(-len(sheets) // columns)
    paper = width or (layout.COLUMN if columns == 1 else layout.PAGE)
    first, second = found.variables
    equal = found.units[0] == found.units[1] == "m"
    side = (paper - 0.65 - 0.55 * (columns - 1) - (0.85 if quantity else 0.15)) / columns
    tall = side * ((second.high - second.low) / (first.high - first.low) if equal else 0.9)
    kinds = [
        kind for kind in CURVES
        if any(curve.kind == kind for s in sheets for curve in s.curves)
        or any(kind in s.everywhere for s in sheets)
    ]  # fmt: skip
    labels = list(dict.fromkeys(CURVES[kind].label for kind in kinds))
    foot = 0.5 + 0.16 * len(labels)
    gap = 0.32 if rows == 1 else 0.62
    size = (paper, foot + rows * (tall + gap) - gap + 0.32)
    figure = Figure(figsize=size)
    field = [_field(sheet, quantity) for sheet in sheets]
    scale = _scale(field)
    image = None
    for k, sheet in enumerate(sheets):
        row, column = divmod(k, columns)
        left, bottom = 0.55 + column * (side + 0.55), foot + (rows - 1 - row) * (tall + gap)
        axes = figure.add_axes((left / size[0], bottom / size[1], side / size[0], tall / size[1]))
        image = _panel(axes, found, sheet, field[k], scale, linkage) or image
        title = motors_text(found.mechanism) if len(sheets) == 1 else f"branch {k + 1}"
        axes.set_title(title, pad=4)
    if image is not None and quantity is not None:
        box = ((paper - 0.72) / size[0], foot / size[1], 0.09 / size[0], tall / size[1])
        bar = figure.colorbar(image, cax=figure.add_axes(box))
        unit = f"distance to the nearest\nsingular curve [{found.distance_unit}]"
        bar.set_label(unit if quantity == DISTANCE else in_words(quantity))
        bar.outline.set_linewidth(0.4)
    everywhere = {kind for s in sheets for kind in s.everywhere}
    _legend(figure, kinds, everywhere, size)
    return figure


def _field(sheet: MapSheet, quantity: str | None) -> Matrix | None:
    if quantity is None:
        return None
    values = sheet.distance if quantity == DISTANCE else sheet.quantities[quantity]
    return np.where(np.isfinite(values), values, np.nan)


def _scale(fields: Sequence[Matrix | None]) -> tuple[float, float]:
    known = [field[np.isfinite(field)] for field in fields if field is not None]
    values = np.concatenate(known) if known else np.zeros(0)
    if not values.size:
        return 0.0, 1.0
    # Indices run away near singular curves: the scale shows the bulk.
    return float(np.percentile(values, 1.0)), float(np.percentile(values, 97.0))


def _panel(
    axes: Axes,
    found: SingularityMap,
    sheet: MapSheet,
    field: Matrix | None,
    scale: tuple[float, float],
    linkage: bool,
) -> Any:
    from matplotlib.colors import ListedColormap

    first, second = found.grid
    region = sheet.reached.astype(float) if field is None else field
    if sheet.outline:
        region = _spread(region, sheet.reached)
    shown = np.ma.masked_invalid(np.where(region == 0.0, np.nan, region).T if field is None else region.T)
    look: dict[str, Any] = {"cmap": "cividis", "vmin": scale[0], "vmax": scale[1]}
    if field is None:
        look = {"cmap": ListedColormap([REGION])}
    image = axes.pcolormesh(first, second, shown, shading="nearest", rasterized=True, linewidth=0.0, **look)
    if sheet.outline:
        image.set_clip_path(_loops(sheet.outline), axes.transData)
        for kind in sheet.everywhere:
            axes.add_patch(_hatched(sheet.outline, CURVES[kind]))
    for kind in reversed(CURVES):
        for curve in sheet.curves:
            if curve.kind == kind:
                _line(axes, curve)
    if linkage:
        _linkage(axes, found, sheet)
    names = [f"{v.name} [{unit}]" for v, unit in zip(found.variables, found.units, strict=True)]
    axes.set_xlabel(names[0], labelpad=2)
    axes.set_ylabel(names[1], labelpad=2)
    axes.set_xlim(found.variables[0].low, found.variables[0].high)
    axes.set_ylim(found.variables[1].low, found.variables[1].high)
    if found.units == ("m", "m"):
        axes.set_aspect("equal")
    return None if field is None else image


def _loops(outline: Sequence[Matrix]) -> Any:
    """The edge of a sheet as one path; holes wind the other way round."""
    from matplotlib.path import Path

    vertices, codes = [], []
    areas = [
        float(np.sum(np.roll(loop[:, 0], -1) * loop[:, 1] - loop[:, 0] * np.roll(loop[:, 1], -1)))
        for loop in outline
    ]
    largest = int(np.argmax(np.abs(areas)))
    for k, loop in enumerate(outline):
        outer = k == largest or not Path(outline[largest]).contains_point(loop[0])
        ordered = loop if (areas[k] > 0.0) == outer else loop[::-1]
        vertices.append(np.vstack([ordered, ordered[:1]]))
        codes += [Path.MOVETO, *[Path.LINETO] * (len(loop) - 1), Path.CLOSEPOLY]
    return Path(np.vstack(vertices), codes)


def _hatched(outline: Sequence[Matrix], look: CurveStyle) -> Any:
    """A region that is singular at every point."""
    from matplotlib.patches import PathPatch

    return PathPatch(
        _loops(outline), facecolor="none", edgecolor=look.colour, hatch="////", linewidth=0.0, zorder=2
    )


def _spread(field: Matrix, reached: NDArray[np.bool_]) -> Matrix:
    """The field carried on one grid step beyond what is reached, so that colour goes up to the edge."""
    known = np.where(reached, field, np.nan)
    padded = np.pad(known, 1, constant_values=np.nan)
    rows, columns = field.shape
    shifts = [padded[1 + i : 1 + i + rows, 1 + j : 1 + j + columns] for i in (-1, 0, 1) for j in (-1, 0, 1)]
    stack = np.array(shifts)
    count = np.isfinite(stack).sum(axis=0)
    mean = np.where(count > 0, np.nansum(stack, axis=0) / np.maximum(count, 1), np.nan)
    return np.where(reached, known, mean)


def _line(axes: Axes, curve: Curve) -> None:
    """A curve on white; a point where a measure only touches zero as a dot."""
    look = CURVES[curve.kind]
    dashes: Any = (0, look.dashes) if look.dashes else "solid"
    points = np.vstack([curve.points, curve.points[:1]]) if curve.closed else curve.points
    if len(points) == 1:
        axes.plot(*points.T, "o", color=look.colour, markersize=3.5, markeredgecolor="white", zorder=4)
        return
    axes.plot(points[:, 0], points[:, 1], color="white", linewidth=look.width + 1.2, zorder=3)
    axes.plot(points[:, 0], points[:, 1], color=look.colour, linewidth=look.width, linestyle=dashes, zorder=4)


def _linkage(axes: Axes, found: SingularityMap, sheet: MapSheet) -> None:
    """The mechanism at the start of the branch, where the map is its own plane."""
    mechanism = found.mechanism
    if mechanism.space is not PLANAR or [v.name for v in found.variables] != ["x", "y"]:
        return
    from matplotlib.patches import Polygon

    from vincula.view.planar import PlanarPanel
    from vincula.view.scene import scene

    drawn = scene(mechanism, sheet.start)
    low = np.array([v.low for v in found.variables])
    high = np.array([v.high for v in found.variables])
    inch = axes.get_position().width * axes.get_figure().get_size_inches()[0]  # type: ignore[union-attr]
    before = set(axes.get_children())
    PlanarPanel(axes, low, high, 72.0 * inch / float(high[0] - low[0])).draw(drawn, None, names=False)
    for artist in set(axes.get_children()) - before:
        artist.set_alpha(0.5 * FAINT if isinstance(artist, Polygon) else FAINT)


def _legend(
    figure: Figure, kinds: Sequence[str], everywhere: Collection[str], size: tuple[float, float]
) -> None:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    handles: list[Any] = []
    seen = set()
    for kind in kinds:
        look = CURVES[kind]
        if look.label not in seen:
            seen.add(look.label)
            if kind in everywhere:
                words = f"{look.label}, at every point"
                handles.append(
                    Patch(facecolor="none", edgecolor=look.colour, hatch="////", linewidth=0.0, label=words)
                )
                continue
            dashes: Any = (0, look.dashes) if look.dashes else "solid"
            handles.append(
                Line2D([], [], color=look.colour, linewidth=look.width, linestyle=dashes, label=look.label)
            )
    if handles:
        figure.legend(
            handles=handles, loc="lower left", bbox_to_anchor=(0.45 / size[0], 0.0), frameon=False,
            fontsize=6.5, handlelength=3.0, borderaxespad=0.2, labelspacing=0.25,
        )  # fmt: skip
