"""From an ellipsoid to curves and patches around the reference point.

The set itself, its shadow and its cut come from the analysis; here they are only placed in the
picture: so many metres for 1 m/s or 1 N, and straight lines cut off where the picture ends.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from vincula.analysis.ellipsoid import Ellipsoid, Kind
from vincula.analysis.vectorset import VectorSet
from vincula.arrays import Matrix, Vector
from vincula.errors import ModelError
from vincula.spatial.space import Space
from vincula.view.drawables import ReferenceMark

View = Literal["projection", "section"]

VIEW_OF: dict[Kind, View] = {
    "kinematic": "projection",
    "active force": "projection",
    "passive force": "section",
    "dual force": "projection",
}
"""How each ellipsoid is brought to the drawn translations (theory page, section 5, "Figures")."""

ROUND = (1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0)
"""Round numbers of a scale, times a power of ten."""

RIM = 121
"""Points on a drawn ellipse, the last one being the first."""


@dataclass(frozen=True, slots=True, eq=False)
class Patch:
    """A filled piece of a boundary: one closed outline, one point a row [m]."""

    outline: Matrix


@dataclass(frozen=True, slots=True, eq=False)
class Curve:
    """A line through points, one a row [m].

    Attributes:
        points: n x s.
        open_ended: Whether the set goes on beyond both ends.
    """

    points: Matrix
    open_ended: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class EllipsoidShape:
    """An ellipsoid as drawables.

    Attributes:
        kind: Which of the five.
        view: Shadow on, or cut by, the drawn translations.
        drawn: The set of translations that is drawn, in m/s or N.
        unit: m/s or N.
        scale: Metres drawn for one unit.
        axes: s x r semi-axes of the bounded part as drawn, in ground axes [m].
        points: n x s points of the bounded part, which a picture must hold [m].
        patches: Filled pieces.
        curves: Outlines, principal ellipses, edges.
        unbounded: Lines through the reference point along which the drawn set is unbounded; for a
            bounded cut of a set with one line of its own, that line as seen in the picture.
        efficiencies: All efficiencies of the ellipsoid.
        infinite_direction: The direction of the one infinite efficiency; None for none or several.
        components: Names of all components of the ellipsoid.
    """

    kind: Kind
    view: View
    drawn: VectorSet
    unit: str
    scale: float
    axes: Matrix
    points: Matrix
    patches: tuple[Patch, ...]
    curves: tuple[Curve, ...]
    unbounded: tuple[Curve, ...]
    efficiencies: Vector
    infinite_direction: Vector | None
    components: tuple[str, ...]


def translations(ellipsoid: Ellipsoid, space: Space) -> VectorSet:
    """The set of linear velocities or forces that a figure shows.

    Raises:
        ModelError: The internal-force ellipsoid: contact forces have no place at the member.
    """
    view = VIEW_OF.get(ellipsoid.kind)
    if view is None:
        raise ModelError(
            f"the {ellipsoid.kind} ellipsoid lives in the space of contact forces and cannot be drawn at the "
            f"reference point; choose from {', '.join(VIEW_OF)}"
        )
    chosen = list(range(space.translations))
    return ellipsoid.project(chosen) if view == "projection" else ellipsoid.section(chosen)


def nice_scale(sets: Sequence[VectorSet], longest: float) -> float:
    """Metres for one unit so that no semi-axis is drawn longer than `longest`: a round number."""
    radii = [float(r) for one in sets for r in np.linalg.norm(one.axes, axis=0)]
    largest = max(radii, default=0.0)
    if largest <= 0.0:
        return 1.0
    wanted = longest / largest
    power = 10.0 ** math.floor(math.log10(wanted))
    return power * max(step for step in ROUND if step * power <= wanted * (1.0 + 1e-12))


def shape(
    ellipsoid: Ellipsoid, space: Space, reference: ReferenceMark, scale: float, reach: float
) -> EllipsoidShape:
    """The drawables of an ellipsoid at the reference point.

    Args:
        ellipsoid: Kinematic, active, passive or dual force.
        space: PLANAR or SPATIAL.
        reference: Reference point, and axes of the ellipsoid's components.
        scale: Metres drawn for 1 m/s or 1 N.
        reach: How far unbounded pieces are drawn from the reference point [m].

    Raises:
        ModelError: The internal-force ellipsoid.
    """
    drawn = translations(ellipsoid, space)
    rims = [scale * (rim @ reference.rotation.T) for rim in _rims(drawn)]
    patches, curves = _pieces(rims, reach * (reference.rotation @ drawn.lines))
    whole = ellipsoid.set.lines
    lines = _marked_lines(ellipsoid, drawn)
    return EllipsoidShape(
        kind=ellipsoid.kind,
        view=VIEW_OF[ellipsoid.kind],
        drawn=drawn,
        unit=drawn.units[0],
        scale=scale,
        axes=scale * (reference.rotation @ drawn.axes),
        points=reference.at + np.vstack(rims),
        patches=tuple(Patch(reference.at + p.outline) for p in patches),
        curves=tuple(Curve(reference.at + c.points, c.open_ended) for c in curves),
        unbounded=tuple(
            Curve(reference.at + reach * np.outer([-1.0, 1.0], reference.rotation @ column), open_ended=True)
            for column in lines.T
        ),
        efficiencies=ellipsoid.efficiencies,
        infinite_direction=whole[:, 0] if whole.shape[1] == 1 else None,
        components=ellipsoid.components,
    )


def silhouette(axes: Matrix, right: Vector, up: Vector) -> Matrix:
    """Outline of an ellipsoid as seen by a far eye: an ellipse in the picture plane, one point a row.

    Args:
        axes: 3 x 3 semi-axes in the columns.
        right: Unit vector to the right of the picture.
        up: Unit vector upwards in the picture.
    """
    frame = np.column_stack([right, up])
    left, values, _ = np.linalg.svd(frame.T @ axes, full_matrices=False)
    angle = np.linspace(0.0, 2.0 * np.pi, RIM)
    circle = np.column_stack([np.cos(angle), np.sin(angle)])
    return np.asarray(circle @ (frame @ (left * values)).T)


def _marked_lines(ellipsoid: Ellipsoid, drawn: VectorSet) -> Matrix:
    """Lines worth a dashed mark: unique ones.  A plane has no line of its own, two lines span one."""
    if not drawn.bounded:
        return drawn.lines if drawn.lines.shape[1] == 1 else drawn.lines[:, :0]
    shadow = ellipsoid.project(list(drawn.components)).lines
    return shadow if ellipsoid.set.lines.shape[1] == 1 else shadow[:, :0]


def _pieces(rims: Sequence[Matrix], lines: Matrix) -> tuple[list[Patch], list[Curve]]:
    """Patches and curves of the boundary: the rims of the bounded part, drawn out along the lines."""
    free = lines.shape[1]
    if free == 0:
        flat = [rim for rim in rims if len(rim) > 1]
        return [Patch(rim) for rim in flat if len(rim) > 2], [Curve(rim) for rim in flat]
    ends = np.array([lines @ np.array(signs) for signs in itertools.product((-1.0, 1.0), repeat=free)])
    rim = rims[0]
    if free == 1:
        return _tube(rim, ends[1]) if len(rim) > 1 else ([], [Curve(ends, open_ended=True)])
    if free == 2:
        return [Patch(point + ends[[0, 1, 3, 2, 0]]) for point in rim], []
    return [], []


def _rims(drawn: VectorSet) -> list[Matrix]:
    """Outlines of the bounded part, one point a row: a point, two ends, an ellipse, or three."""
    points = drawn.points(RIM).T
    return [points[i : i + RIM] for i in range(0, len(points), RIM)] if len(points) > 2 else [points]


def _tube(rim: Matrix, line: Vector) -> tuple[list[Patch], list[Curve]]:
    """A strip between two parallel lines, or a tube over an ellipse."""
    if len(rim) == 2:
        edges = [Curve(np.array([point - line, point + line]), open_ended=True) for point in rim]
        return [Patch(np.vstack([edges[0].points, edges[1].points[::-1]]))], edges
    posts = rim[:: (RIM - 1) // 24]
    faces = [Patch(np.array([a - line, b - line, b + line, a + line])) for a, b in itertools.pairwise(posts)]
    return faces, [Curve(rim + shift, open_ended=True) for shift in (-line, 0.0 * line, line)]
