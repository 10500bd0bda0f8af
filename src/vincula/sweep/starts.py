"""Where the closing of every chunk starts, fixed before the run: a coarse path followed once, in order.

In lanes where they carry a closed configuration along its branch, else by `Mechanism.follow`.  Where neither
arrives (a first point out of reach), the chunk starts from the configuration before: a search for one that
closes might find another branch, and the chunk with it.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Final

import numpy as np

from vincula.arrays import Matrix, Vector
from vincula.errors import ClosureError, VinculaError
from vincula.kernels.closing import pose_from
from vincula.mechanism.configuration import Configuration
from vincula.mechanism.mechanism import Mechanism
from vincula.mechanism.paths import Path
from vincula.sweep.chunks import near_walk

if TYPE_CHECKING:
    from vincula.kernels.lanes.closing import LaneClosing
    from vincula.sweep.sweep import Sweep

THROUGH: Final = ("platform free", "motors without authority", "internal")
"""Singularities that are passed where a path goes on beyond them and arrives: a start may be singular."""


def coarse_path(sweep: Sweep, last: Vector | None, chunks: range) -> Iterator[tuple[int, Vector]]:
    """A configuration near the first point of each chunk, one after the other.

    From the one before it the path to the next first point is followed; where the geometry changes as well,
    the loops are closed at the first point.  A chunk whose first point is not reached so starts from the last
    configuration there was.  Each is found by itself: it does not matter which are asked for together.

    Args:
        sweep: The sweep.
        last: Configuration of the chunk before the first one; None for the sweep's own start.
        chunks: Chunks to find starts for, in order.
    """
    mechanism, inputs = sweep.mechanism, sweep.inputs
    current = inputs.start if last is None else mechanism.home.from_flat(last)
    rows, parameters = inputs.rows(np.concatenate([_first(sweep, chunk) for chunk in chunks]))
    for k, chunk in enumerate(chunks):
        values = {name: float(column[k]) for name, column in parameters.items()}
        current = _next(sweep, mechanism, chunk, rows[k], values, current)
        yield chunk, current.flat


def all_starts(sweep: Sweep, upto: int) -> dict[int, Vector]:
    """Starts of the chunks up to one of them."""
    return dict(coarse_path(sweep, None, range(upto + 1)))


def _first(sweep: Sweep, chunk: int) -> Matrix:
    """The point of a chunk that is visited first."""
    if not sweep.work.scattered:
        return sweep.points.at(sweep.chunking.indices(chunk)[:1])
    values = sweep.values(chunk)
    return values[near_walk(values)[:1]]


def _next(
    sweep: Sweep,
    mechanism: Mechanism,
    chunk: int,
    row: Vector,
    parameters: dict[str, float],
    current: Configuration,
) -> Configuration:
    if parameters and sweep.compiled.build is not None:
        return _closed(sweep.compiled.build(**parameters), sweep, row, current) or current
    if not isinstance(sweep.closing, str) and sweep.closing.starts_at(current):
        reached = _in_lanes(sweep.closing, row, current)
        if reached is not None or chunk:  # lanes do not leave a singular start: the first path may have to
            return reached or current
    try:
        path = _followed(mechanism, sweep, row, current)
    except VinculaError:
        return _closed(mechanism, sweep, row, current) or current
    return path.end if path.complete else current


def _in_lanes(closing: LaneClosing, row: Vector, current: Configuration) -> Configuration | None:
    """The configuration on the branch of the present one; None where lanes do not get there."""
    found = closing.run(row[np.newaxis], current, 1, 1)
    return closing.mechanism.home.from_flat(found.values[0]) if found.closed[0] else None


def _followed(mechanism: Mechanism, sweep: Sweep, row: Vector, current: Configuration) -> Path:
    if sweep.inputs.given == "reference":
        return mechanism.follow([pose_from(row)], start=current, limits=False, through=THROUGH)
    motors = dict(zip(mechanism.active, map(float, row), strict=True))
    return mechanism.follow([motors], start=current, limits=False, through=THROUGH)


def _closed(mechanism: Mechanism, sweep: Sweep, row: Vector, near: Configuration) -> Configuration | None:
    try:
        if sweep.inputs.given == "reference":
            return mechanism.close(near, pose=pose_from(row), attempts=1)
        motors = dict(zip(mechanism.active, map(float, row), strict=True))
        return mechanism.close(near, motors=motors, attempts=1)
    except ClosureError:
        return None
