"""Where the names go: beside their joints, clear of links, symbols and each other."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np

from vincula.arrays import Matrix, Vector

ANGLES = (45, 135, -45, -135, 90, 0, 180, -90, 22, 158, -22, -158, 68, 112, -68, -112)
"""Directions of a label from its anchor, the preferred ones first [deg]."""
CHARACTER = 4.2
HEIGHT = 7.5
DISTANCES = (4.0, 9.0, 15.0)
"""Free space between an anchor and its label, tried one after the other [points]."""
ENOUGH = 0.8
"""Free space around a label beyond which more is no better [points]."""


def place_labels(
    anchors: Sequence[Vector], texts: Sequence[str], symbols: Matrix, lines: Matrix
) -> list[Vector]:
    """Centres of labels in points, one for every anchor in turn.

    A label stays off symbols and other labels, off lines where it can, and nearer to its own anchor
    than to any other; a place close by is better than a free one far away.

    Args:
        anchors: What is labelled [points].
        texts: The labels.
        symbols: n x 2 points of what must stay visible [points].
        lines: n x 2 points of what may be crossed if need be [points].
    """
    taken = symbols
    centres: list[Vector] = []
    for index, (anchor, text) in enumerate(zip(anchors, texts, strict=True)):
        half = np.array([0.5 * CHARACTER * max(len(text), 2), 0.5 * HEIGHT])
        others = np.array([a for k, a in enumerate(anchors) if k != index]).reshape(-1, 2)
        best, best_score = anchor, -np.inf
        for distance in DISTANCES:
            for angle in np.radians(ANGLES):
                direction = np.array([np.cos(angle), np.sin(angle)])
                centre = anchor + direction * (distance + float(np.abs(direction) @ half))
                score = 3.0 * _room(centre, half, taken) + 0.6 * _room(centre, half, lines) - 0.12 * distance
                score -= 6.0 * _strays(centre, anchor, others)
                if score > best_score + 1e-9:
                    best, best_score = centre, score
        centres.append(best)
        taken = np.vstack([taken, best + _box(half)])
    return centres


def _strays(centre: Vector, anchor: Vector, others: Matrix) -> bool:
    """Whether a label would be read as the name of another anchor (one at the same place is no other)."""
    own = float(np.linalg.norm(centre - anchor))
    apart = others[np.linalg.norm(others - anchor, axis=1) > 1.0]
    return bool(len(apart)) and float(np.linalg.norm(apart - centre, axis=1).min()) < own


def sampled(polyline: Matrix, step: float) -> Matrix:
    """Points along a polyline, at most `step` apart."""
    blocks = [polyline[:1]]
    for start, end in itertools.pairwise(polyline):
        count = max(1, int(np.ceil(float(np.linalg.norm(end - start)) / step)))
        blocks.append(start + (end - start) * np.linspace(0.0, 1.0, count + 1)[1:, None])
    return np.vstack(blocks)


def _room(centre: Vector, half: Vector, taken: Matrix) -> float:
    """Distance from a label's box to the nearest obstacle; negative inside; from -3 to `ENOUGH`."""
    if not len(taken):
        return ENOUGH
    apart = np.abs(taken - centre) - half
    outside = np.linalg.norm(np.maximum(apart, 0.0), axis=1)
    inside = np.minimum(apart.max(axis=1), 0.0)
    return max(-3.0, min(float((outside + inside).min()), ENOUGH))


def _box(half: Vector) -> Matrix:
    grid = np.array([[x, y] for x in (-1.0, -0.5, 0.0, 0.5, 1.0) for y in (-1.0, 0.0, 1.0)])
    return grid * half
