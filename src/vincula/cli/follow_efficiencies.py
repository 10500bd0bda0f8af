"""Kinematic efficiencies along a path with their directions, each in a place of its own through crossings."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from vincula.arrays import Matrix, Vector

if TYPE_CHECKING:
    from vincula.cli.subject import Subject
    from vincula.mechanism.paths import Path
    from vincula.numerics.tracking import Tracked

_ZERO = 1e-15
"""Components of unit vectors below this are rounding."""


@dataclass(frozen=True, slots=True, eq=False)
class Axis:
    """One axis of the kinematic ellipsoid at one point of a path.

    Attributes:
        efficiency: Its efficiency; None where it is not finite there, and so has no directions.
        motors: Unit vector of motor rates.
        task: The twist that they make, as a unit vector; components as in `analyze`.
    """

    efficiency: float | None
    motors: list[float] | None = None
    task: list[float] | None = None


def axes_along(subject: Subject, path: Path) -> list[list[Axis]]:
    """Finite axes of the kinematic ellipsoid at every point, unit weights, in the order of the first point.

    Empty lists where there is no reference member or no motor.  The axes are followed by their motor
    directions, not sorted anew; their signs and the bases of equal efficiencies are carried along.
    """
    from vincula.analysis.manipulability import kinematic_ellipsoid
    from vincula.numerics.tracking import follow_spectra
    from vincula.weights import Weights

    mechanism = subject.mechanism
    if mechanism.reference is None or not mechanism.active:
        return [[] for _ in path.points]
    steps, tasks = [], []
    with warnings.catch_warnings():
        # The path tells its singularities itself.
        warnings.simplefilter("ignore")
        for point in path.points:
            found = kinematic_ellipsoid(mechanism.linearize(point.configuration), Weights())
            finite = [
                (float(value), motors, task)
                for value, kind, motors, task in zip(
                    found.efficiencies, found.classes, found.motor_directions, found.task_directions,
                    strict=True,
                )
                if kind == "finite" and motors is not None and task is not None
            ]  # fmt: skip
            values, motors, task = zip(*finite, strict=True) if finite else ((), (), ())
            steps.append((np.array(values, float), _columns(motors, len(mechanism.active))))
            tasks.append(_columns(task, mechanism.space.dimension))
    tracked = follow_spectra(steps)
    most = max(len(one.values) for one in tracked)
    return [
        [*_axes(one, vectors, task), *([Axis(None)] * (most - len(one.values)))]
        for one, (_, vectors), task in zip(tracked, steps, tasks, strict=True)
    ]


def _columns(vectors: tuple[object, ...], height: int) -> Matrix:
    return np.array(vectors, float).reshape(len(vectors), -1).T if vectors else np.zeros((height, 0))


def _axes(tracked: Tracked, motors: Matrix, task: Matrix) -> list[Axis]:
    """Axes in their followed places; twists are combined as the motor directions were."""
    combined = task @ np.linalg.lstsq(motors, tracked.vectors, rcond=None)[0] if motors.size else task
    found = []
    for k, value in enumerate(tracked.values):
        if np.isnan(value):
            found.append(Axis(None))
        else:
            twist = combined[:, k] / float(np.linalg.norm(combined[:, k]))
            found.append(Axis(float(value), _plain(tracked.vectors[:, k]), _plain(twist)))
    return found


def _plain(vector: Vector) -> list[float]:
    return [0.0 if abs(x) < _ZERO else float(x) for x in vector]
