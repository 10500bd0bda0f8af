"""Locating where a signed measure vanishes between two points of a track, to about 1e-12.

Points in between are found on the chord: a cubic through both ends with their tangents, corrected at
right angles to the chord.  That works at folds, where the held values turn back, and at crossings.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np

from vincula.arrays import Matrix, Vector
from vincula.mechanism.closure_values import Mask
from vincula.mechanism.tracks import Track, TrackPoint
from vincula.mechanism.watching import decided, measured_block

Measuring = Callable[[TrackPoint], float]

COARSE: Final = 1e-5
"""Accuracy of the first search, as a share of the chord; the second starts from a chord around it."""
FINE: Final = 1e-10
AROUND: Final = 1e-3
BESIDE: Final = 2e-4
"""Distance at which regular points beside a singular one are looked at [rad, or lengths L]."""
HIT: Final = 1e-9
"""A singularity nearer than this to the end of a step is at the end of the step."""


def root(track: Track, one: TrackPoint, two: TrackPoint, measure: Measuring) -> tuple[TrackPoint, float]:
    """The point where `measure` changes sign between two points, and its share of the chord.

    Args:
        track: The track.
        one: A point where the measure has one sign.
        two: A later point where it has the other.
        measure: A continuous function of the point.
    """
    share = _root_share(track, one, two, measure, COARSE)
    low, high = max(share - AROUND, 0.0), min(share + AROUND, 1.0)
    near, far = track.between(one, two, low), track.between(one, two, high)
    if measure(near) * measure(far) < 0.0:
        inner = _root_share(track, near, far, measure, FINE)
        return track.between(near, far, inner), low + inner * (high - low)
    share = _root_share(track, one, two, measure, FINE)
    return track.between(one, two, share), share


def _root_share(track: Track, one: TrackPoint, two: TrackPoint, measure: Measuring, accuracy: float) -> float:
    from scipy.optimize import brentq

    def value(share: float) -> float:
        point = one if share <= 0.0 else two if share >= 1.0 else track.between(one, two, share)
        return measure(point)

    return float(brentq(value, 0.0, 1.0, xtol=accuracy, rtol=1e-14))


def minimum(track: Track, one: TrackPoint, two: TrackPoint, measure: Measuring) -> TrackPoint:
    """The point between two where the size of a measure is smallest."""
    from scipy.optimize import minimize_scalar

    found = minimize_scalar(
        lambda share: abs(measure(track.between(one, two, float(share)))),
        bounds=(0.0, 1.0),
        method="bounded",
        options={"xatol": 1e-9},
    )
    return track.between(one, two, float(found.x))


def settled(
    track: Track,
    one: TrackPoint,
    two: TrackPoint,
    measure: Measuring,
    is_singular: Callable[[TrackPoint], bool],
) -> tuple[TrackPoint, float] | None:
    """Where a measure vanishes that at the end of a step cannot be told from zero.

    Within some 1e-7 of a singularity rounding decides no rank; the zero itself is known far better.
    A look beyond the end tells whether it lies in the step, at its end, or still ahead.

    Args:
        track: The track.
        one: Begin of the step.
        two: Its end.
        measure: The signed measure.
        is_singular: Whether the measure cannot be told from zero at a point.

    Returns:
        The point and its share of the step; None where the zero is still ahead.
    """
    chord = track.step_between(one, two)
    size = float(np.linalg.norm(chord))
    unit = chord / size
    ahead, _ = track.corrected(track.moved(two, BESIDE * unit), normal=unit)
    if is_singular(ahead) or is_singular(one):
        return two, 1.0
    if measure(one) * measure(ahead) < 0.0:
        point, _ = root(track, one, ahead, measure)
    else:
        point = minimum(track, one, ahead, measure)
        if not is_singular(point):
            return two, 1.0
    past = float(track.step_between(two, point) @ unit)
    if abs(past) <= HIT:
        return two, 1.0
    return None if past > 0.0 else (point, 1.0 + past / size)


def kernels_beside(track: Track, point: TrackPoint, unit: Vector, columns: Mask, rank: int) -> list[Matrix]:
    """Kernels of a block on both sides of a singular point, where the block has its generic rank.

    Args:
        track: The track.
        point: The singular point.
        unit: Direction of the track there, about (free rates, then s).
        columns: The block.
        rank: Its generic rank.
    """
    found = []
    for way in (BESIDE, -BESIDE):
        beside, _ = track.corrected(track.moved(point, way * unit), normal=unit)
        block = measured_block(beside.equations, columns, rank)
        if decided(block.jacobian, beside.residual, block.values).rank == rank:
            found.append(block.right[:, rank:])
    return found
