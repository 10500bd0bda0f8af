"""One panel of a spatial figure: the mechanism in an orthographic view, with at most one ellipsoid."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING

import numpy as np

from vincula.arrays import Matrix, Vector
from vincula.view import style
from vincula.view.drawables import JointMark, Scene
from vincula.view.labels import place_labels, sampled
from vincula.view.shapes import EllipsoidShape, silhouette

if TYPE_CHECKING:
    from mpl_toolkits.mplot3d.axes3d import Axes3D

FILLED = np.array([0.92, 0.90])
"""Share of the square in the middle of a panel that the box fills, in width and height."""

MARKER = {"motor": 5.0, "driven": 4.4, "passive": 4.4, "locked": 4.4}
"""Diameter of a joint symbol [points]."""


class SpatialPanel:
    """Draws on 3-D axes; what must stay visible is drawn last, whatever lies before it.

    Args:
        axes: Where to draw; limits and view are set here.
        low: Lower corner of the cube that is shown [m].
        high: Upper corner [m].
        size: Size of the mechanism, for symbols that have a length [m].
        direction: Elevation and azimuth of the eye [deg].
    """

    def __init__(
        self, axes: Axes3D, low: Vector, high: Vector, size: float, direction: tuple[float, float]
    ) -> None:
        self.axes, self.size, self.direction = axes, size, direction
        axes.view_init(elev=direction[0], azim=direction[1])
        axes.computed_zorder = False
        axes.set_xlim(low[0], high[0])
        axes.set_ylim(low[1], high[1])
        axes.set_zlim(low[2], high[2])
        axes.set_box_aspect(tuple(high - low))
        self._fit(low, high)

    def _fit(self, low: Vector, high: Vector) -> None:
        """Zoom so that the box fills the panel, with room for ticks and labels."""
        self.axes.apply_aspect()
        corners = np.array(list(itertools.product(*zip(low, high, strict=True))))
        pixels = self.axes.transData.transform(self._projected(corners))
        spread = np.ptp(self.axes.transAxes.inverted().transform(pixels), axis=0)
        self.axes.set_box_aspect(tuple(high - low), zoom=float((FILLED / spread).min()))

    def draw(self, scene: Scene, shape: EllipsoidShape | None, *, names: bool) -> None:
        """Ground, mechanism, ellipsoid, and the reference point above them all."""
        self._draw_grounds(scene)
        self._draw_links(scene)
        self._draw_joints(scene)
        self._draw_contacts(scene)
        if shape is not None and scene.reference is not None:
            self._draw_shape(shape, scene.reference.at)
        if scene.reference is not None:
            self.axes.plot(*scene.reference.at[:, None], "+", color="black", ms=7, mew=1.1, zorder=20)
        if names:
            self._draw_names(scene)

    def _draw_names(self, scene: Scene) -> None:
        """Names of the joints, placed on paper: beside their symbols, clear of links and each other."""
        self.axes.apply_aspect()
        marks = [mark for mark in scene.joints if mark.type != "fixed"]
        anchors = self._on_paper(np.array([mark.at for mark in marks]).reshape(-1, 3))
        outlines = [sampled(self._on_paper(link.points), 4.0) for link in scene.links if len(link.points)]
        circle = 2.5 * np.column_stack([np.cos(np.arange(8.0)), np.sin(np.arange(8.0))])
        signs = np.vstack([np.zeros((0, 2)), *(anchor + circle for anchor in anchors)])
        lines = np.vstack([np.zeros((0, 2)), *outlines])
        centres = place_labels(list(anchors), [mark.name for mark in marks], signs, lines)
        for mark, anchor, centre in zip(marks, anchors, centres, strict=True):
            self._write(mark.name, mark.at, centre - anchor)

    def _on_paper(self, points: Matrix) -> Matrix:
        """Where points of space are on paper, one a row [points]."""
        pixels = self.axes.transData.transform(self._projected(points))
        return np.asarray(pixels * 72.0 / self.axes.figure.dpi)

    def _projected(self, points: Matrix) -> Matrix:
        """Points of space in the coordinates of the picture plane, one a row."""
        from mpl_toolkits.mplot3d.proj3d import proj_transform

        x, y, _ = proj_transform(*points.T, self.axes.get_proj())
        return np.column_stack([x, y])

    def _write(self, text: str, at: Vector, offset: Vector) -> None:
        """A text beside a place in space, `offset` in points away from it."""
        from matplotlib.patheffects import withStroke

        self.axes.annotate(
            text,
            xy=tuple(self._projected(at[None, :])[0]),
            xytext=tuple(offset),
            textcoords="offset points",
            ha="center",
            va="center",
            fontsize=6,
            color=style.INK,
            path_effects=[withStroke(linewidth=1.6, foreground="white")],
            zorder=21,
        )

    def _draw_grounds(self, scene: Scene) -> None:
        feet = np.array([ground.at for ground in scene.grounds]).reshape(-1, 3)
        for foot in feet:
            self._ground_patch(foot)

    def _ground_patch(self, foot: Vector) -> None:
        """A small hatched square below a foot."""
        half = 0.045 * self.size
        square = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]) * half + foot
        self._polygon(square, style.PLATE, 1.0, zorder=1, edge=style.HATCH)
        for level in (-0.5, 0.0, 0.5):
            hatch = foot + half * np.array([[-1.0, level - 0.5, 0.0], [1.0, level + 0.5, 0.0]])
            self.axes.plot(*hatch.T, color=style.HATCH, lw=0.4, zorder=1.5)

    def _draw_links(self, scene: Scene) -> None:
        for link in scene.links:
            if not len(link.points):
                continue
            colour = style.MEMBER if link.member else style.LINK
            outline = link.points
            if len(outline) > 2:
                fill = style.MEMBER_PLATE if link.member else style.PLATE
                self._polygon(outline, fill, 0.75, zorder=3)
                outline = np.vstack([outline, outline[:1]])
            self.axes.plot(*outline.T, color=colour, lw=2.0 if link.member else 1.5, zorder=3.5)

    def _draw_joints(self, scene: Scene) -> None:
        for mark in scene.joints:
            if mark.type == "fixed":
                continue
            if mark.axis is not None:
                self._draw_axis(mark, mark.axis)
            if mark.type != "prismatic":
                marker = style.JOINT_MARKERS[mark.type]
                self._marker(mark.at, marker, MARKER[mark.role], style.FILL[mark.role], zorder=7)
            if mark.role == "locked":
                self.axes.plot(*mark.at[:, None], "x", ms=3.5, mew=0.8, color=style.INK, zorder=8)

    def _draw_axis(self, mark: JointMark, axis: Vector) -> None:
        """The axis of a joint: a short line, for sliders a thick bar."""
        half = 0.05 * self.size
        ends = mark.at + half * np.outer([-1.0, 1.0], axis)
        if not mark.slides:
            self.axes.plot(*ends.T, color=style.INK, lw=0.8, zorder=6)
            return
        self.axes.plot(*ends.T, color=style.INK, lw=4.6, solid_capstyle="butt", zorder=6)
        if style.FILL[mark.role] != style.INK:
            inside = mark.at + 0.85 * (ends - mark.at)
            self.axes.plot(*inside.T, color=style.FILL[mark.role], lw=3.2, solid_capstyle="butt", zorder=6.1)

    def _draw_contacts(self, scene: Scene) -> None:
        for mark in scene.contacts:
            shaft = mark.at - 0.09 * self.size * np.outer([1.0, 0.0], mark.normal)
            self.axes.plot(*shaft.T, color=style.INK, lw=0.8, zorder=7)
            self._marker(mark.at, "^", 4.4, "white", zorder=8)

    def _draw_shape(self, shape: EllipsoidShape, centre: Vector) -> None:
        colour = style.KINDS[shape.kind].colour
        solid = shape.drawn.bounded and shape.axes.shape[1] == 3
        if solid:
            outline = centre + silhouette(shape.axes, *self._picture_plane())
            self._polygon(outline, colour, 0.22, zorder=10)
            self.axes.plot(*outline.T, color=colour, lw=1.3, zorder=11)
        for patch in () if solid else shape.patches:
            self._polygon(patch.outline, colour, 0.16, zorder=10)
        for curve in shape.curves:
            self.axes.plot(*curve.points.T, color=colour, lw=0.6 if solid else 1.1, zorder=11)
        for line in shape.unbounded:
            self.axes.plot(*line.points.T, color=colour, lw=1.0, ls=(0, (4, 2.2)), zorder=12)
            for end in line.points:
                self.axes.plot(*end[:, None], "o", color=colour, ms=2.5, zorder=12)

    def _picture_plane(self) -> tuple[Vector, Vector]:
        """Right and up of the picture as unit vectors."""
        elevation, azimuth = np.radians(self.direction)
        right = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])
        towards = np.array(
            [np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)]
        )
        return right, np.cross(towards, right)

    def _marker(self, at: Vector, marker: str, size: float, fill: str, zorder: float) -> None:
        self.axes.plot(
            *at[:, None],
            linestyle="none",
            marker=marker,
            ms=size,
            mfc=fill,
            mec=style.INK,
            mew=0.8,
            zorder=zorder,
        )

    def _polygon(self, outline: Matrix, colour: str, alpha: float, zorder: float, edge: str = "none") -> None:
        from mpl_toolkits.mplot3d.art3d import Poly3DCollection

        piece = Poly3DCollection([outline], facecolors=colour, edgecolors=edge, linewidths=0.5, alpha=alpha)
        piece.set_zorder(zorder)
        self.axes.add_collection3d(piece)
