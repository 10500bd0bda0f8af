"""Plane geometry that several examples are drawn with: points on circles, elbows of two links."""

from __future__ import annotations

import math

import numpy as np

from vincula.arrays import Vector
from vincula.elementary import cos, larger, sin, sqrt
from vincula.errors import ModelError

THIRD = 2 * math.pi / 3
"""A third of a turn [rad]."""


def on_circle(radius: float, angle: float, height: float | None = None) -> Vector:
    """Point of a circle about the origin, with a height in space [m]."""
    point = [radius * cos(angle), radius * sin(angle)]
    return np.array(point if height is None else [*point, height])


def elbow(start: Vector, end: Vector, near: float, far: float) -> Vector:
    """Where two links in the plane meet, to the left of the way from `start` to `end`.

    Args:
        start: First end of the first link [m].
        end: Last end of the second link [m].
        near: Length of the first link [m].
        far: Length of the second link [m].

    Raises:
        ModelError: The links cannot reach.
    """
    way = end - start
    distance = np.hypot(way[0], way[1])
    if not abs(near - far) <= distance <= near + far or distance == 0.0:
        raise ModelError(
            f"links of {near:g} m and {far:g} m do not meet over a distance of {distance:g} m: "
            f"it must be between {abs(near - far):g} m and {near + far:g} m"
        )
    along = (near**2 - far**2 + distance**2) / (2 * distance)
    aside = sqrt(larger(near**2 - along**2, 0.0))
    left = np.array([-way[1], way[0]])
    return np.asarray(start + (along * way + aside * left) / distance)
