"""Symbols of the plane as outlines in points: sliders, supports, guides, contacts.

A symbol keeps its size on paper whatever the size of the mechanism, so it is given in points (1/72
inch) about the place where it stands.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vincula.arrays import Matrix, Vector

DOWN = np.array([0.0, -1.0])


@dataclass(frozen=True, slots=True, eq=False)
class Stroke:
    """One line of a symbol.

    Attributes:
        points: n x 2 [points] about the place of the symbol.
        filled: Whether the outline is closed and filled.
        thin: Whether it is drawn with a hair line.
    """

    points: Matrix
    filled: bool = False
    thin: bool = False


def support(towards: Vector, size: float = 6.5) -> list[Stroke]:
    """A pin's support: a triangle standing on a hatched line, the ground lying in direction `towards`."""
    turn = _turn(towards)
    triangle = np.array([[0.0, 0.0], [-0.6, -1.0], [0.6, -1.0], [0.0, 0.0]]) * size
    return [Stroke(triangle @ turn.T, filled=True), *_hatched_line(1.0 * size, -size, turn)]


def guide(towards: Vector, size: float = 13.0, gap: float = 4.5) -> list[Stroke]:
    """A slider's guide: a hatched line at `gap` beside it."""
    return _hatched_line(size, -gap, _turn(towards))


def surface(towards: Vector, size: float = 9.0) -> list[Stroke]:
    """The ground at a contact: a hatched line through it."""
    return _hatched_line(size, 0.0, _turn(towards))


def box(axis: Vector, length: float = 10.0, width: float = 7.0) -> list[Stroke]:
    """A slider: a box along its axis."""
    along, across = axis * length / 2, np.array([-axis[1], axis[0]]) * width / 2
    corners = [along + across, along - across, -along - across, -along + across, along + across]
    return [Stroke(np.array(corners), filled=True)]


def contact(normal: Vector, size: float = 7.0) -> list[Stroke]:
    """A contact: a wedge of the limb, its tip on the object, and the tangent line."""
    tangent = np.array([normal[1], -normal[0]])
    back, side = -size * normal, 0.45 * size * tangent
    wedge = np.array([0 * normal, back + side, back - side])
    return [
        Stroke(np.vstack([wedge, wedge[:1]]), filled=True),
        Stroke(np.array([-0.6 * size * tangent, 0.6 * size * tangent])),
    ]


def _hatched_line(half: float, level: float, turn: Matrix) -> list[Stroke]:
    """A line at height `level` of half length `half` with hatching below, the ground being down."""
    line = np.array([[-half, level], [half, level]])
    starts = np.linspace(-half + 2.0, half, max(3, round(half / 2.0)))
    hatches = [np.array([[x, level], [x - 2.6, level - 2.6]]) for x in starts]
    return [Stroke(line @ turn.T), *(Stroke(h @ turn.T, thin=True) for h in hatches)]


def _turn(towards: Vector) -> Matrix:
    """The rotation that takes down to `towards`."""
    x, y = float(towards[0]), float(towards[1])
    return np.array([[-y, -x], [x, -y]])
