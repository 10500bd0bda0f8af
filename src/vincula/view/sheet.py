"""What a figure is made of: panels, and the sheet that they go on."""

from __future__ import annotations

from dataclasses import dataclass

from vincula.view import style
from vincula.view.drawables import Scene
from vincula.view.shapes import EllipsoidShape


@dataclass(frozen=True, slots=True, eq=False)
class Panel:
    """One panel of a figure.

    Attributes:
        scene: The mechanism.
        shape: The ellipsoid at its reference point; None for the mechanism alone.
        header: A line above the panel's title that names its row; empty for none.
    """

    scene: Scene
    shape: EllipsoidShape | None
    header: str = ""

    @property
    def title(self) -> tuple[str, ...]:
        """Efficiencies and unbounded direction, a line each."""
        if self.shape is None:
            return ()
        lines = (style.efficiencies_text(self.shape), style.unbounded_text(self.shape))
        return tuple(line for line in lines if line)


@dataclass(frozen=True, slots=True)
class Sheet:
    """How a figure is laid out.

    Attributes:
        width: Width of the figure [inch].
        columns: Panels side by side.
        names: Whether joints are named.
        direction: Elevation and azimuth of the view of a spatial mechanism [deg].
        remark: A sentence for the foot of the figure; empty for none.
    """

    width: float
    columns: int
    names: bool
    direction: tuple[float, float]
    remark: str = ""
