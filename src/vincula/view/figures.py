"""Whole figures: panels, titles, legend and notes on a sheet of fixed size."""

from __future__ import annotations

import string
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from vincula.arrays import Matrix
from vincula.spatial.space import PLANAR
from vincula.view import layout, style
from vincula.view.drawables import Role
from vincula.view.layout import Grid, Window
from vincula.view.planar import PlanarPanel
from vincula.view.sheet import Panel, Sheet
from vincula.view.spatial import SpatialPanel

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from mpl_toolkits.mplot3d.axes3d import Axes3D

FLATTEST = 0.35
"""Smallest side of a spatial box over its largest, so that ticks have room."""

SPATIAL_HEIGHT = 0.86
"""Height of a spatial panel over its width."""


def figure_of(panels: Sequence[Panel], sheet: Sheet, around: Matrix | None = None) -> Figure:
    """The figure of some panels, row by row; all of them show the same window at the same scale.

    Args:
        panels: The panels.
        sheet: How they are laid out.
        around: Points that the window must hold as well: of the other frames of an animation.
    """
    planar = panels[0].scene.space is PLANAR
    shapes = [panel.shape for panel in panels if panel.shape is not None]
    seen_points = [block for p in panels for block in _points(p)]
    points = layout.stacked(seen_points if around is None else [*seen_points, around])
    left = layout.LEFT if planar else layout.RIGHT
    panel_width = layout.panel_width(sheet.width, sheet.columns, left)
    seen = layout.window(points, panel_width) if planar else None
    handles = _handles(panels)
    foot_notes = layout.wrapped(f"{style.note(shapes, planar)} {sheet.remark}".strip(), sheet.width - 0.2)
    legend_rows = -(-len(handles) // _legend_columns(handles, sheet.width))
    grid = Grid(
        columns=sheet.columns,
        width=sheet.width,
        panel=panel_width,
        height=seen.height if seen is not None else SPATIAL_HEIGHT * panel_width,
        titles=tuple(
            _title_room(panels[i : i + sheet.columns]) for i in range(0, len(panels), sheet.columns)
        ),
        left=left,
        below=layout.BELOW_PANELS if planar else 0.12,
        between=layout.GAP,
        head=0.04,
        foot=0.06 + layout.LEGEND_LINE * legend_rows + layout.NOTE_LINE * len(foot_notes),
    )
    figure = Figure(figsize=grid.size)
    for index in range(len(panels)):
        _draw_panel(figure, grid, index, panels, seen, points, sheet)
    _draw_foot(figure, grid, handles, foot_notes)
    return figure


def _title_room(row: Sequence[Panel]) -> float:
    """Room above a row of panels [inch]: a header, names and scales, efficiencies, unbounded lines."""
    lines = max((panel.shape is not None) + len(panel.title) for panel in row)
    return 0.05 + layout.TITLE_LINE * (lines + 1.3 * any(panel.header for panel in row))


def _points(panel: Panel) -> list[Matrix]:
    return [panel.scene.points] + ([panel.shape.points] if panel.shape is not None else [])


def _draw_panel(
    figure: Figure,
    grid: Grid,
    index: int,
    panels: Sequence[Panel],
    seen: Window | None,
    points: Matrix,
    sheet: Sheet,
) -> None:
    panel, count = panels[index], len(panels)
    named = sheet.names and (index == 0 or bool(panel.header))
    row, column = divmod(index, grid.columns)
    box = grid.box(row, column)
    if seen is not None:
        axes = figure.add_axes(box)
        PlanarPanel(axes, seen.low, seen.high, seen.points_per_metre).draw(
            panel.scene, panel.shape, names=named
        )
        _planar_axes(axes, first_column=column == 0, last_row=index + grid.columns >= count)
    else:
        axes = figure.add_axes(box, projection="3d", proj_type="ortho")
        centre = 0.5 * (points.min(axis=0) + points.max(axis=0))
        half = 0.5 * np.ptp(points, axis=0) + 0.04 * panel.scene.size
        half = np.maximum(half, FLATTEST * half.max())
        SpatialPanel(axes, centre - half, centre + half, panel.scene.size, sheet.direction).draw(
            panel.scene, panel.shape, names=named
        )
        _spatial_axes(axes)
    letter = string.ascii_lowercase[index % 26] if count > 1 else ""
    peers = panels[row * grid.columns : (row + 1) * grid.columns]
    _draw_title(figure, grid.size[1], box, panel, letter, peers)


def _planar_axes(axes: Axes, first_column: bool, last_row: bool) -> None:
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(MaxNLocator(4, steps=[1, 2, 5, 10]))
    axes.tick_params(labelbottom=last_row, labelleft=first_column, pad=2)
    if last_row:
        axes.set_xlabel("x [m]", labelpad=1)
    if first_column:
        axes.set_ylabel("y [m]", labelpad=1)


def _spatial_axes(axes: Axes3D) -> None:
    axes.set_xlabel("x [m]", labelpad=-7.5)
    axes.set_ylabel("y [m]", labelpad=-7.5)
    axes.set_zlabel("z [m]", labelpad=-7.5)
    for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
        prune = "lower" if axis is axes.yaxis else None
        axis.set_major_locator(MaxNLocator(3, steps=[1, 2, 5, 10], prune=prune))
        axis.set_pane_color((1.0, 1.0, 1.0, 0.0))
    axes.tick_params(pad=-4, labelsize=6)
    axes.tick_params(axis="z", pad=-1)


def _draw_title(
    figure: Figure,
    height: float,
    box: tuple[float, float, float, float],
    panel: Panel,
    letter: str,
    row: Sequence[Panel],
) -> None:
    """Up to four lines above a panel: header, name with scale, efficiencies, unbounded direction."""
    lines = max(len(peer.title) for peer in row)
    x, top = box[0], box[1] + box[3] + 0.04 / height
    step = layout.TITLE_LINE / height
    for k, line in enumerate(panel.title):
        figure.text(x, top + (lines - 1 - k) * step, line, fontsize=6.5, va="bottom")
    if panel.shape is not None:
        y = top + lines * step
        kind = style.KINDS[panel.shape.kind]
        name = f"({letter}) {kind.short}" if letter else kind.short
        figure.text(x, y, name, fontsize=7, fontweight="bold", color=kind.colour, va="bottom")
        figure.text(x + box[2], y, style.scale_text(panel.shape), fontsize=6.5, ha="right", va="bottom")
    if panel.header:
        y = box[1] + box[3] + (_title_room(row) - 1.15 * layout.TITLE_LINE) / height
        figure.text(x, y, panel.header, fontsize=7.5, fontweight="bold", va="bottom")


def _draw_foot(figure: Figure, grid: Grid, handles: Sequence[Line2D], notes: Sequence[str]) -> None:
    height = grid.size[1]
    figure.legend(
        handles=list(handles),
        loc="lower center",
        bbox_to_anchor=(0.5, (0.04 + layout.NOTE_LINE * len(notes)) / height),
        ncols=_legend_columns(handles, grid.width),
        frameon=False,
        fontsize=6.5,
        handletextpad=0.5,
        handlelength=1.6,
        columnspacing=1.2,
        borderpad=0.0,
        borderaxespad=0.0,
        labelspacing=0.35,
    )
    for k, line in enumerate(reversed(notes)):
        y = (0.04 + layout.NOTE_LINE * k) / height
        figure.text(0.1 / grid.width, y, line, fontsize=6, color="#444444")


def _legend_columns(handles: Sequence[Line2D], width: float) -> int:
    """Columns of the legend that fit the width, counted by the longest text."""
    longest = max((len(str(handle.get_label())) for handle in handles), default=1)
    return max(1, min(len(handles), int(72.0 * width / (3.7 * longest + 26.0))))


def _handles(panels: Sequence[Panel]) -> list[Line2D]:
    """One legend entry for every symbol that appears."""
    joints: dict[tuple[str, Role], None] = {}
    for panel in panels:
        joints |= dict.fromkeys((m.type, m.role) for m in panel.scene.joints if m.type != "fixed")
    ordered = sorted(joints, key=lambda key: (list(style.ROLE_WORDS).index(key[1]), key[0]))
    handles = [
        _handle(
            f"{kind}, {style.ROLE_WORDS[role]}",
            marker=style.JOINT_MARKERS[kind],
            markersize=5.4,
            markerfacecolor=style.FILL[role],
            markeredgecolor=style.INK,
        )
        for kind, role in ordered
    ]
    types = dict.fromkeys(mark.type for panel in panels for mark in panel.scene.contacts)
    if types:
        handles.append(
            _handle(
                f"contact ({', '.join(types)})",
                marker="^",
                markersize=5.0,
                markerfacecolor="white",
                markeredgecolor=style.INK,
            )
        )
    reference = panels[0].scene.reference
    if reference is not None:
        handles.append(Line2D([], [], color=style.MEMBER, lw=2.6, label=f"member: {reference.body}"))
        handles.append(_handle("reference point", marker="+", markersize=6.0, markeredgecolor="black"))
    if any(panel.shape is not None and panel.shape.unbounded for panel in panels):
        handles.append(Line2D([], [], color=style.INK, lw=1.0, ls=(0, (4, 2.2)), label="unbounded line"))
    return handles


def _handle(label: str, **marker: object) -> Line2D:
    return Line2D([], [], linestyle="none", markeredgewidth=0.9, label=label, **marker)  # type: ignore[arg-type]
