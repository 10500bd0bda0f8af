"""Kinematic efficiencies along a path, each in a column of its own through every crossing."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from vincula.cli.subject import Subject
    from vincula.mechanism.paths import Path


def efficiencies_along(subject: Subject, path: Path) -> list[list[float | None]]:
    """Finite kinematic efficiencies of every point, unit weights; None where one is not finite there.

    Empty lists where there is no reference member or no motor.  Their order is that of the first point:
    they are followed by their motor directions, not sorted anew.
    """
    from vincula.analysis.manipulability import kinematic_ellipsoid
    from vincula.numerics.tracking import follow_spectra
    from vincula.weights import Weights

    mechanism = subject.mechanism
    if mechanism.reference is None or not mechanism.active:
        return [[] for _ in path.points]
    steps = []
    with warnings.catch_warnings():
        # The path tells its singularities itself.
        warnings.simplefilter("ignore")
        for point in path.points:
            found = kinematic_ellipsoid(mechanism.linearize(point.configuration), Weights())
            pairs = [
                (float(value), motor)
                for value, kind, motor in zip(
                    found.efficiencies, found.classes, found.motor_directions, strict=True
                )
                if kind == "finite" and motor is not None
            ]
            vectors = np.array([motor for _, motor in pairs]).reshape(len(pairs), -1).T
            steps.append((np.array([value for value, _ in pairs]), vectors.reshape(-1, len(pairs))))
    width = len(mechanism.active)
    steps = [(v, m if len(v) else np.zeros((width, 0))) for v, m in steps]
    tracked = follow_spectra(steps)
    most = max(len(one.values) for one in tracked)
    rows = [[None if np.isnan(v) else float(v) for v in one.values] for one in tracked]
    return [[*row, *([None] * (most - len(row)))] for row in rows]
