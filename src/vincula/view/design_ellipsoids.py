"""Ellipsoids of several designs over each other: what a search changed, in the units of the mechanism."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from vincula.analysis.manipulability import kinematic_ellipsoid, passive_force_ellipsoid
from vincula.analysis.vectorset import VectorSet
from vincula.arrays import Vector
from vincula.errors import VinculaError

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from vincula.analysis.ellipsoid import Ellipsoid
    from vincula.design.problem import DesignProblem

PAIRS: Final = {
    "planar": (("vx", "vy"), ("fx", "fy")),
    "translation": (("vx", "vy"), ("vx", "vz")),
    "rotation": (("wx", "wy"), ("wx", "wz")),
}
"""Components of the two panels: in the plane a velocity and a force, in space two views of the velocity."""
ROOM: Final = 1.15
"""Half the width of a panel over the largest component drawn."""


@dataclass(frozen=True, slots=True, eq=False)
class Sight:
    """A design as it is drawn.

    Attributes:
        label: What it is called in the legend.
        colour: Its colour.
        line: Its line style.
        kinematic: Its kinematic ellipsoid.
        force: Its passive force ellipsoid: the loads that motor torques of norm one resist.
    """

    label: str
    colour: str
    line: str
    kinematic: Ellipsoid
    force: Ellipsoid

    def on(self, components: tuple[str, str]) -> VectorSet:
        """What is drawn: the shadow of the velocities, the cut of the forces (the other loads being zero)."""
        if components[0].startswith("f"):
            return self.force.set.section(components)
        return self.kinematic.set.project(components)


def middle_place(problem: DesignProblem) -> int:
    """The configuration that is drawn: the middle one of those that designs are judged at."""
    return problem.places // 2


def sight(problem: DesignProblem, design: Vector, label: str, colour: str, line: str) -> Sight | None:
    """A design at the configuration that is drawn; None where it cannot be built or does not close."""
    at = middle_place(problem)
    places = None if problem.configurations is None else problem.configurations[at : at + 1]
    weights = problem.objectives[0].weights
    compiled = problem.compiled_for(weights)
    parameters: dict[str, Any] = problem.space.parameters(design[None, :])
    found = compiled.evaluate(
        places, ("configuration",), given=problem.given, start=problem.start, parameters=parameters,
        path="reference",
    )  # fmt: skip
    values = found["configuration"].reshape(-1)
    if not np.isfinite(values).all():
        return None
    try:
        mechanism = problem.mechanism(design)
        model = mechanism.linearize(mechanism.home.from_flat(values))
        own = compiled.weights
        return Sight(
            label, colour, line, kinematic_ellipsoid(model, own), passive_force_ellipsoid(model, own)
        )
    except VinculaError:
        return None


def views_of(sights: Sequence[Sight]) -> tuple[tuple[str, str], tuple[str, str]]:
    """Which components the two panels show: rotations where no design translates its member."""
    first = sights[0].kinematic.components
    if "vz" not in first:
        return PAIRS["planar"]
    shadows = [one.kinematic.set.project(("vx", "vy", "vz")) for one in sights]
    moving = any(shadow.axes.shape[1] + shadow.lines.shape[1] for shadow in shadows)
    return PAIRS["translation" if moving else "rotation"]


def draw_sets(axes: Axes, sights: Sequence[Sight], components: tuple[str, str]) -> None:
    """One panel: the ellipsoids of all designs on two components, unbounded directions dotted.

    Args:
        axes: Where to draw.
        sights: The designs.
        components: Two twist or two wrench components.
    """
    sets = [one.on(components) for one in sights]
    size = max((float(np.abs(one.points(181)).max(initial=0.0)) for one in sets), default=0.0) or 1.0
    for order, (one, found) in enumerate(zip(sights, sets, strict=True)):
        x, y = found.points(181)
        look: Any = {"color": one.colour, "zorder": 3.0 - 0.1 * order}  # what is compared with lies on top
        axes.plot(x, y, linestyle=one.line, linewidth=1.2, label=one.label, **look)
        for line in found.lines.T:
            ends = 3.0 * ROOM * size * np.outer(line, (-1.0, 1.0))
            axes.plot(*ends, linestyle=(0, (1, 1.5)), linewidth=0.8, **look)
    axes.set_xlim(-ROOM * size, ROOM * size)
    axes.set_ylim(-ROOM * size, ROOM * size)
    axes.set_aspect("equal")
    axes.locator_params(nbins=5)
    unit = sets[0].units[0]
    axes.set_xlabel(f"{components[0]} [{unit}]", labelpad=2)
    axes.set_ylabel(f"{components[1]} [{unit}]", labelpad=2)
    force = components[0].startswith("f")
    axes.set_title("load held by unit motor torques" if force else "velocity at unit motor rates", pad=4)
