"""One panel of a planar figure: the linkage, and at most one ellipsoid at its reference point."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vincula.arrays import Matrix, Vector
from vincula.view import style, symbols
from vincula.view.drawables import ContactMark, JointMark, Scene
from vincula.view.labels import place_labels, sampled
from vincula.view.shapes import Curve, EllipsoidShape
from vincula.view.symbols import Stroke

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MARKER = {"motor": 6.0, "driven": 5.4, "passive": 5.4, "locked": 5.4}
"""Diameter of a joint symbol [points]."""


class PlanarPanel:
    """Draws on axes whose limits and size on paper are already fixed.

    Args:
        axes: Where to draw; the limits are set here.
        low: Lower left corner of what is shown [m].
        high: Upper right corner [m].
        points_per_metre: Scale of the axes on paper.
    """

    def __init__(self, axes: Axes, low: Vector, high: Vector, points_per_metre: float) -> None:
        self.axes, self.low, self.high, self.scale = axes, low, high, points_per_metre
        axes.set_xlim(low[0], high[0])
        axes.set_ylim(low[1], high[1])
        axes.set_aspect("equal")

    def draw(self, scene: Scene, shape: EllipsoidShape | None, *, names: bool) -> None:
        """The mechanism, then the ellipsoid, then what must stay legible above it."""
        (left, bottom), (right, top) = self.low * self.scale, self.high * self.scale
        frame = np.array([[left, bottom], [right, bottom], [right, top], [left, top], [left, bottom]])
        lines = [self._draw_links(scene), self._draw_grounds(scene)]
        if shape is not None:
            lines.append(self._draw_shape(shape))
        signs = [sampled(frame, 4.0), self._draw_joints(scene), self._draw_contacts(scene)]
        if scene.reference is not None:
            self.axes.plot(*scene.reference.at[:, None], "+", color="black", ms=6, mew=1.1, zorder=9)
            signs.append(scene.reference.at[None, :] * self.scale)
        if names:
            self._draw_names(scene, np.vstack(signs), np.vstack(lines))

    def _draw_links(self, scene: Scene) -> Matrix:
        drawn = []
        for link in scene.links:
            if not len(link.points):
                continue
            colour = style.MEMBER if link.member else style.LINK
            width = 2.6 if link.member else 1.8
            outline = link.points
            if len(outline) > 2:
                outline = np.vstack([outline, outline[:1]])
                fill = style.MEMBER_PLATE if link.member else style.PLATE
                self.axes.fill(*outline.T, color=fill, lw=0, zorder=2)
            self.axes.plot(*outline.T, color=colour, lw=width, zorder=3)
            drawn.append(sampled(outline * self.scale, 4.0))
        return np.vstack(drawn) if drawn else np.zeros((0, 2))

    def _draw_grounds(self, scene: Scene) -> Matrix:
        contacts = {tuple(mark.at) for mark in scene.contacts if mark.ground_side}
        drawn = [np.zeros((0, 2))]
        for ground in scene.grounds:
            if ground.rail:
                strokes = symbols.guide(ground.towards)
            elif tuple(ground.at) in contacts:
                strokes = symbols.surface(ground.towards)
            else:
                strokes = symbols.support(ground.towards)
            self._strokes(ground.at, strokes, fill="white", colour=style.HATCH, zorder=2.5)
            drawn += [sampled(ground.at * self.scale + stroke.points, 4.0) for stroke in strokes]
        return np.vstack(drawn)

    def _draw_joints(self, scene: Scene) -> Matrix:
        for mark in scene.joints:
            if mark.slides and mark.axis is not None:
                fill = style.FILL[mark.role]
                box = symbols.box(mark.axis)
                below = any(_same_place(mark, other) for other in scene.joints if other is not mark)
                self._strokes(mark.at, box, fill=fill, colour=style.INK, zorder=5 if below else 6)
                if mark.role == "locked":
                    self._cross(mark.at)
            else:
                self._pin(mark)
        circle = 3.2 * np.column_stack([np.cos(np.arange(8.0)), np.sin(np.arange(8.0))])
        return np.vstack([np.zeros((0, 2)), *(mark.at * self.scale + circle for mark in scene.joints)])

    def _pin(self, mark: JointMark) -> None:
        small = mark.type == "fixed"
        self.axes.plot(
            *mark.at[:, None],
            linestyle="none",
            marker=style.JOINT_MARKERS[mark.type],
            ms=3.0 if small else MARKER[mark.role],
            mfc=style.LINK if small else style.FILL[mark.role],
            mec=style.LINK if small else style.INK,
            mew=0.9,
            zorder=7,
        )
        if mark.role == "locked" and not small:
            self._cross(mark.at)

    def _cross(self, at: Vector) -> None:
        self.axes.plot(*at[:, None], linestyle="none", marker="x", ms=4.0, mew=0.8, color=style.INK, zorder=8)

    def _draw_contacts(self, scene: Scene) -> Matrix:
        drawn = [np.zeros((0, 2))]
        for mark in scene.contacts:
            strokes = symbols.contact(mark.normal)
            self._strokes(mark.at, strokes, fill="white", colour=style.INK, zorder=6)
            drawn += [sampled(mark.at * self.scale + stroke.points, 2.0) for stroke in strokes]
        return np.vstack(drawn)

    def _draw_shape(self, shape: EllipsoidShape) -> Matrix:
        colour = style.KINDS[shape.kind].colour
        for patch in shape.patches:
            self.axes.fill(*patch.outline.T, color=colour, alpha=0.16, lw=0, zorder=4)
        for curve in shape.curves:
            self.axes.plot(*curve.points.T, color=colour, lw=1.4, zorder=4.5, clip_on=True)
        for line in shape.unbounded:
            self._draw_unbounded(line, colour)
        drawn = [sampled(c.points * self.scale, 4.0) for c in (*shape.curves, *shape.unbounded)]
        return np.vstack(drawn) if drawn else np.zeros((0, 2))

    def _draw_unbounded(self, line: Curve, colour: str) -> None:
        """A dashed line from one side of the panel to the other, with arrowheads that say: and on."""
        start, end = self._clipped(line.points)
        self.axes.plot(*np.array([start, end]).T, color=colour, lw=1.0, ls=(0, (4, 2.2)), zorder=4.4)
        for tip, tail in ((end, start), (start, end)):
            along = (tip - tail) / np.linalg.norm(tip - tail)
            across = np.array([-along[1], along[0]])
            head = np.array([0 * along, -6 * along + 2.2 * across, -6 * along - 2.2 * across])
            self._strokes(tip, [Stroke(head, filled=True)], fill=colour, colour=colour, zorder=4.6)

    def _clipped(self, line: Matrix) -> tuple[Vector, Vector]:
        """The part of a line through the panel's inside that the frame does not cut off."""
        middle = line.mean(axis=0)
        direction = (line[1] - line[0]) / np.linalg.norm(line[1] - line[0])
        inset = 3.0 / self.scale
        with np.errstate(divide="ignore", invalid="ignore"):
            bounds = np.array([self.low + inset - middle, self.high - inset - middle]) / direction
        bounds = np.where(np.isfinite(bounds), bounds, [[-np.inf], [np.inf]])
        back, forth = bounds.min(axis=0).max(), bounds.max(axis=0).min()
        return middle + back * direction, middle + forth * direction

    def _draw_names(self, scene: Scene, signs: Matrix, lines: Matrix) -> None:
        from matplotlib.patheffects import withStroke

        marks: list[JointMark | ContactMark] = [*scene.joints, *scene.contacts]
        anchors = [mark.at * self.scale for mark in marks]
        texts = [mark.name for mark in marks]
        for centre, text in zip(place_labels(anchors, texts, signs, lines), texts, strict=True):
            x, y = centre / self.scale
            label = self.axes.text(
                x, y, text, ha="center", va="center", fontsize=6.5, color=style.INK, zorder=10
            )
            label.set_path_effects([withStroke(linewidth=1.6, foreground="white")])

    def _strokes(self, at: Vector, strokes: list[Stroke], *, fill: str, colour: str, zorder: float) -> None:
        for stroke in strokes:
            points = at + stroke.points / self.scale
            if stroke.filled:
                self.axes.fill(*points.T, facecolor=fill, edgecolor=colour, lw=0.9, zorder=zorder)
            else:
                self.axes.plot(*points.T, color=colour, lw=0.5 if stroke.thin else 0.9, zorder=zorder)


def _same_place(one: JointMark, other: JointMark) -> bool:
    return bool(np.allclose(one.at, other.at))
