"""Pictures of a followed path, one a configuration, all in one window at one scale."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from vincula.spatial.space import PLANAR
from vincula.view import layout
from vincula.view.plot import drawing_settings, need_matplotlib, wants_names
from vincula.view.scene import scene
from vincula.view.sheet import Panel, Sheet

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vincula.mechanism.paths import Path


def path_figures(
    path: Path, *, names: bool | None = None, direction: tuple[float, float] = (22.0, -62.0)
) -> Iterator[Figure]:
    """A figure a configuration of a path: frames of an animation.

    Args:
        path: The path.
        names: Whether joints are named; by default up to 12 joints.
        direction: Elevation and azimuth of the view of a spatial mechanism [deg].

    Raises:
        MissingExtraError: matplotlib is not installed.
    """
    need_matplotlib()
    from vincula.view.figures import figure_of

    mechanism = path.mechanism
    scenes = [scene(mechanism, configuration) for configuration in path]
    around = layout.stacked([one.points for one in scenes])
    width = layout.COLUMN if mechanism.space is PLANAR else layout.PAGE
    sheet = Sheet(width, 1, wants_names(mechanism, names), direction, "")
    for one in scenes:
        with drawing_settings():
            figure = figure_of([Panel(one, None)], sheet, around)
        yield figure
