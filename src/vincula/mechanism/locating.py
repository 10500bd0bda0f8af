"""Locating where a signed measure vanishes between two points of a track, to about 1e-12.

Points in between are found on the chord: a cubic through both ends with their tangents, corrected at
right angles to the chord.  That works at folds, where the held values turn back, and at crossings.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from vincula.mechanism.tracks import Track, TrackPoint

Measuring = Callable[[TrackPoint], float]

COARSE: Final = 1e-5
"""Accuracy of the first search, as a share of the chord; the second starts from a chord around it."""
FINE: Final = 1e-10
AROUND: Final = 1e-3


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
