"""Figures of a design: the landscape, the front of compromises, the ellipsoids before and after."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from vincula.arrays import Matrix, Vector
from vincula.design.front import Front
from vincula.design.landscape import Landscape
from vincula.design.measures import SphereDistance
from vincula.design.optimum import Optimum
from vincula.errors import DesignError, ModelError
from vincula.view import layout
from vincula.view.plot import drawing_settings, need_matplotlib

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

BLUE, ORANGE, GREY = "#0072B2", "#D55E00", "#bbbbbb"
"""Colours: what is feasible or best, what it is compared with, the rest."""


def plot_design(found: Optimum | Landscape | Front, *, width: float | None = None) -> Figure:
    """The figure of a design study.

    Args:
        found: A landscape: the objective over one or two variables (the paper's Fig. 10 shows 1/cost, as
            here), best design and start marked.  A front: the first two objectives.  An optimum: kinematic
            efficiencies of the start and of the best design, and the objective around it.
        width: Width of the figure [inch].

    Raises:
        MissingExtraError: matplotlib is not installed.
        ModelError: Something else.
        DesignError: A landscape without a feasible design.
    """
    need_matplotlib()
    paper = width or layout.COLUMN
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
    one, two = found.problem.objectives[:2]
    figure, axes = _figure(paper, 0.8 * paper)
    able = found.everything.part(np.flatnonzero(found.everything.feasible)).objectives
    axes.plot(able[:, 0], able[:, 1], ".", color=GREY, markersize=2.0, label="evaluated")
    values = found.members.objectives
    axes.plot(values[:, 0], values[:, 1], "o", color=BLUE, markersize=3.0, label="not beaten")
    axes.set_xlabel(f"{one.name} ({one.better} is better)")
    axes.set_ylabel(f"{two.name} ({two.better} is better)")
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2, frameon=False)
    return figure


def _optimum(found: Optimum, paper: float) -> Figure:
    """Efficiencies of both designs, at the first configuration, as bars on a logarithmic axis."""
    problem = found.problem
    figure, axes = _figure(paper, 0.7 * paper)
    for k, (design, label, colour) in enumerate(
        ((found.start, "start", ORANGE), (found.design, "best", BLUE))
    ):
        values = _efficiencies(found, design)
        places = np.arange(len(values)) + 0.4 * k - 0.2
        axes.bar(places, values, 0.38, color=colour, label=label)
    axes.axhline(1.0, color="black", linewidth=0.5)
    axes.set_yscale("log")
    axes.set_ylabel("kinematic efficiencies")
    axes.set_xlabel(f"{problem.name}: {problem.objectives[0].name}")
    axes.set_xticks([])
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2, frameon=False)
    return figure


def _efficiencies(found: Optimum, design: Vector) -> Vector:
    """Finite kinematic efficiencies of one design; none where it cannot be built or is open."""
    problem = found.problem
    compiled = problem.compiled_for(problem.objectives[0].weights)
    parameters: dict[str, Any] = problem.space.parameters(design[None, :])
    places = None if problem.configurations is None else problem.configurations[:1]
    result = compiled.evaluate(
        places, ("kinematic.efficiencies",), given=problem.given, start=problem.start,
        parameters=parameters, path=problem.path,
    )  # fmt: skip
    values = result["kinematic.efficiencies"][0]
    return np.asarray(values[np.isfinite(values) & (values > 0.0)])


def _scale(found: Landscape, k: int) -> float:
    variables = found.problem.space.variables
    return next(v.scale for v in variables if v.name == found.names[k])


def _axis(found: Landscape, k: int) -> tuple[Vector, str]:
    variable = next(v for v in found.problem.space.variables if v.name == found.names[k])
    label = f"{variable.name} [{variable.unit}]" if variable.unit else variable.name
    return found.axes[k] / variable.scale, label
