"""Figures of a design: the landscape, the front of compromises, the ellipsoids before and after."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vincula.arrays import Matrix, Vector
from vincula.design.front import Front
from vincula.design.landscape import Landscape
from vincula.design.measures import SphereDistance
from vincula.design.optimum import Optimum
from vincula.errors import DesignError, ModelError
from vincula.view import layout, style
from vincula.view.design_ellipsoids import Sight, draw_sets, sight, views_of
from vincula.view.plot import drawing_settings, need_matplotlib

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

BLUE, ORANGE, GREEN, GREY = "#0072B2", "#D55E00", "#009E73", "#bbbbbb"
"""Colours: what is feasible or best, what it is compared with, another one, the rest."""


def plot_design(found: Optimum | Landscape | Front, *, width: float | None = None) -> Figure:
    """The figure of a design study.

    Args:
        found: A landscape: the objective over one or two variables (the paper's Fig. 10 shows 1/cost, as
            here), best design and start marked.  A front: the first two objectives, and the ellipsoids of
            the start and of both ends.  An optimum: ellipsoids and kinematic efficiencies of the start and of
            the best design.  Ellipsoids are those at the middle configuration of the problem.
        width: Width of the figure [inch].

    Raises:
        MissingExtraError: matplotlib is not installed.
        ModelError: Something else.
        DesignError: A landscape without a feasible design.
    """
    need_matplotlib()
    paper = width or (layout.COLUMN if isinstance(found, Landscape) else layout.PAGE)
    with drawing_settings():
        if isinstance(found, Landscape):
            return _landscape(found, paper)
        if isinstance(found, Front):
            return _front(found, paper)
        if isinstance(found, Optimum):
            return _optimum(found, paper)
    raise ModelError(f"got {type(found).__name__}, expected an Optimum, a Landscape or a Front")


def _figure(paper: float, tall: float) -> tuple[Figure, Axes]:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(paper, tall))
    axes = figure.add_axes((0.58 / paper, 0.48 / tall, 1.0 - 1.35 / paper, 1.0 - 0.8 / tall))
    return figure, axes


def _landscape(found: Landscape, paper: float) -> Figure:
    problem = found.problem
    inverse = isinstance(problem.objectives[0], SphereDistance)
    with np.errstate(divide="ignore"):
        field: Matrix = 1.0 / found.values[..., 0] if inverse else found.values[..., 0]
    if not np.isfinite(field).any():
        raise DesignError("no feasible design: there is nothing to draw", counts=found.counts)
    words = problem.objectives[0].name + (", 1/cost" if inverse else "")
    scaled = [_axis(found, k) for k in range(len(found.names))]
    best = found.best()[0]
    start = problem.space.named(problem.space.start)
    figure, axes = _figure(paper, 0.86 * paper)
    labels = [label for _, label in scaled]
    axes.set_xlabel(labels[0])
    points = [
        (start, "start", "s", ORANGE),
        (best, "best of the grid", "*", "white" if len(labels) == 2 else BLUE),
    ]
    if len(labels) == 1:
        axes.plot(scaled[0][0], field, color=BLUE, linewidth=1.0)
        axes.set_ylabel(words)
        for point, label, _, colour in points:
            axes.axvline(point[found.names[0]] / _scale(found, 0), color=colour, linewidth=0.8, label=label)
    else:
        image = axes.pcolormesh(
            scaled[0][0], scaled[1][0], field.T, cmap="viridis", shading="nearest", rasterized=True
        )
        axes.set_facecolor(GREY)
        axes.set_ylabel(labels[1])
        box = (1.0 - 0.7 / paper, 0.48 / (0.86 * paper), 0.09 / paper, 1.0 - 0.8 / (0.86 * paper))
        figure.colorbar(image, cax=figure.add_axes(box)).set_label(words)
        for point, label, mark, colour in points:
            at = (point[name] / _scale(found, k) for k, name in enumerate(found.names))
            axes.plot(*at, mark, color=colour, markeredgecolor="black", markeredgewidth=0.5, label=label)
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2, frameon=False)
    return figure


def _front(found: Front, paper: float) -> Figure:
    """The first two objectives of all designs, and the ellipsoids of both ends of the front."""
    problem = found.problem
    one, two = problem.objectives[:2]
    figure, (cloud, ellipses) = _panels(paper, 2)
    able = found.everything.part(np.flatnonzero(found.everything.feasible)).objectives
    cloud.plot(able[:, 0], able[:, 1], ".", color=GREY, markersize=2.0, label="evaluated")
    values = found.members.objectives
    cloud.plot(values[:, 0], values[:, 1], "o", color=BLUE, markersize=3.0, label="not beaten")
    _zoom(cloud, values[:, :2])
    cloud.set_xlabel(f"{one.name} ({one.better} is better)")
    cloud.set_ylabel(f"{two.name} ({two.better} is better)")
    last = len(found.members) - 1
    sights = [
        sight(problem, problem.space.start, "start", ORANGE, "--"),
        sight(problem, found.members.designs[0], "compromise 1", BLUE, "-"),
        sight(problem, found.members.designs[last], f"compromise {last + 1}", GREEN, "-.") if last else None,
    ]
    _ellipses([ellipses], sights)
    _legends(cloud, ellipses)
    return figure


def _zoom(axes: Axes, values: Matrix) -> None:
    """Show the front and what lies near it; far worse designs would squeeze it into a corner."""
    known = values[np.isfinite(values).all(axis=1)]
    if len(known) < 2:
        return
    low, high = known.min(axis=0), known.max(axis=0)
    span = np.where(high > low, high - low, np.maximum(np.abs(high), 1e-12))
    axes.set_xlim(low[0] - 0.5 * span[0], high[0] + 0.5 * span[0])
    axes.set_ylim(low[1] - 0.5 * span[1], high[1] + 0.5 * span[1])


def _optimum(found: Optimum, paper: float) -> Figure:
    """Ellipsoids of the start and of the best design at one configuration, and all their efficiencies."""
    from matplotlib.ticker import LogLocator

    problem = found.problem
    figure, (first, second, bars) = _panels(paper, 3)
    sights = [
        sight(problem, found.start, "start", ORANGE, "--"),
        sight(problem, found.design, "best", BLUE, "-"),
    ]
    _ellipses([first, second], sights)
    known = [one for one in sights if one is not None]
    for k, one in enumerate(known):
        values = np.asarray(one.kinematic.finite)
        places = np.arange(len(values)) + 0.4 * k - 0.2
        bars.bar(places, values, 0.38, color=one.colour, label=one.label)
    smallest = min((float(v) for one in known for v in one.kinematic.finite), default=1.0)
    if isinstance(problem.objectives[0], SphereDistance):
        bars.axhline(1.0, color="black", linewidth=0.5)
    bars.set_yscale("log")
    bars.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    bars.yaxis.set_major_formatter(lambda value, _: style.power_text(value))
    bars.yaxis.set_minor_formatter(lambda value, _: "")
    bars.set_ylim(bottom=0.5 * smallest)
    bars.set_xticks([])
    bars.set_xlabel("finite ones, largest first")
    bars.set_title("kinematic efficiencies", pad=4)
    _legends(first)
    return figure


def _ellipses(panels: list[Axes], sights: list[Sight | None]) -> None:
    """Fill panels with ellipsoids; a panel says so where there is nothing to draw."""
    known = [one for one in sights if one is not None]
    if not known:
        for axes in panels:
            axes.text(0.5, 0.5, "does not close here", ha="center", transform=axes.transAxes)
        return
    for axes, components in zip(panels, views_of(known), strict=False):
        draw_sets(axes, known, components)


def _panels(paper: float, count: int) -> tuple[Figure, list[Axes]]:
    """Square panels side by side, with room for labels and a legend."""
    from matplotlib.figure import Figure

    side = (paper - 0.1) / count - 0.62
    tall = side + 0.95
    figure = Figure(figsize=(paper, tall))
    boxes = ((0.52 + k * (side + 0.62), 0.42, side, side) for k in range(count))
    return figure, [figure.add_axes((x / paper, y / tall, w / paper, h / tall)) for x, y, w, h in boxes]


def _legends(*panels: Axes) -> None:
    for axes in panels:
        if axes.get_legend_handles_labels()[0]:
            axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.07), ncols=3, frameon=False)


def _scale(found: Landscape, k: int) -> float:
    variables = found.problem.space.variables
    return next(v.scale for v in variables if v.name == found.names[k])


def _axis(found: Landscape, k: int) -> tuple[Vector, str]:
    variable = next(v for v in found.problem.space.variables if v.name == found.names[k])
    label = f"{variable.name} [{variable.unit}]" if variable.unit else variable.name
    return found.axes[k] / variable.scale, label
