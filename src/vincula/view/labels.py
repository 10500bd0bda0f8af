"""Where the names go: beside their joints, clear of links, symbols and each other."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np

from vincula.arrays import Matrix, Vector

ANGLES = (45, 135, -45, -135, 90, 0, 180, -90, 22, 158, -22, -158, 68, 112, -68, -112)
"""Directions of a label from its anchor, the preferred ones first [deg]."""
CHARACTER = 4.2
HEIGHT = 6.5
DISTANCES = (4.0, 9.0, 15.0)
"""Free space between an anchor and its label, tried one after the other [points]."""
ENOUGH = 1.5
"""Free space around a label beyond which more is no better [points]."""


def place_labels(anchors: Sequence[Vector], texts: Sequence[str], obstacles: Matrix) -> list[Vector]:
    """Centres of labels in points, one for every anchor in turn.

    Every label takes the first direction in which it is clear of everything drawn, labels placed
    before it included; if there is none, the clearest.

    Args:
        anchors: What is labelled [points].
        texts: The labels.
        obstacles: n x 2 points of everything drawn [points].
    """
    taken = obstacles
    centres: list[Vector] = []
    for anchor, text in zip(anchors, texts, strict=True):
        half = np.array([0.5 * CHARACTER * max(len(text), 2), 0.5 * HEIGHT])
        candidates = [
            anchor + direction * (distance + float(np.abs(direction) @ half))
            for distance in DISTANCES
            for direction in np.column_stack([np.cos(np.radians(ANGLES)), np.sin(np.radians(ANGLES))])
        ]
        best = max(candidates, key=lambda centre: _room(centre, half, taken))
        centres.append(best)
        taken = np.vstack([taken, best + _box(half)])
    return centres


def sampled(polyline: Matrix, step: float) -> Matrix:
    """Points along a polyline, at most `step` apart."""
    blocks = [polyline[:1]]
    for start, end in itertools.pairwise(polyline):
        count = max(1, int(np.ceil(float(np.linalg.norm(end - start)) / step)))
        blocks.append(start + (end - start) * np.linspace(0.0, 1.0, count + 1)[1:, None])
    return np.vstack(blocks)


def _room(centre: Vector, half: Vector, taken: Matrix) -> float:
    """Distance from a label's box to the nearest obstacle; negative inside; at most `ENOUGH`."""
    if not len(taken):
        return 0.0
    apart = np.abs(taken - centre) - half
    outside = np.linalg.norm(np.maximum(apart, 0.0), axis=1)
    inside = np.minimum(apart.max(axis=1), 0.0)
    return min(float((outside + inside).min()), ENOUGH)


def _box(half: Vector) -> Matrix:
    grid = np.array([[x, y] for x in (-1.0, -0.5, 0.0, 0.5, 1.0) for y in (-1.0, 0.0, 1.0)])
    return grid * half
