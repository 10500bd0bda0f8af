"""Closing one configuration after the other, each from its neighbour, through `Mechanism.close`."""

from __future__ import annotations

import numpy as np

from vincula.arrays import Vector
from vincula.errors import ClosureError, ModelError, NonFiniteError, VinculaError
from vincula.kernels.evaluation import FAILED, NO_CLOSURE
from vincula.kernels.inputs import Batch
from vincula.kernels.reference_path import Outcome
from vincula.mechanism.closed import ClosedConfiguration
from vincula.mechanism.configuration import Configuration
from vincula.mechanism.mechanism import Mechanism
from vincula.spatial.poses import Pose


class Chain:
    """The starts of a batch: fixed by the batch alone, whatever computes it.

    With one start (or none: home) a lane starts where the lane before it along the last axis closed, the
    first of every stretch at the start.  A lane that did not close is passed over.  With a start a lane
    every lane is on its own.

    Args:
        batch: The batch.
    """

    def __init__(self, batch: Batch) -> None:
        self._batch = batch
        self._last: Configuration | None = None

    def closed(self, mechanism: Mechanism, lane: int) -> ClosedConfiguration | Outcome:
        """The closed configuration of the next lane, or why there is none; lanes come in order."""
        batch = self._batch
        if lane % max(batch.stretch, 1) == 0:
            self._last = None
        if batch.values is None:
            return Outcome(FAILED, "nothing is given to close for")
        try:
            found = closed_for(mechanism, batch.given, batch.values[lane], self._near(mechanism, lane))
        except ClosureError as error:
            return Outcome(NO_CLOSURE, str(error))
        except VinculaError as error:
            return Outcome(FAILED, str(error))
        self._last = found
        return found

    def _near(self, mechanism: Mechanism, lane: int) -> Configuration:
        batch = self._batch
        if batch.starts is not None:
            return mechanism.home.from_flat(batch.starts[lane])
        if self._last is not None:
            return self._last
        return mechanism.home if batch.first is None else mechanism.home.from_flat(batch.first)


def closed_for(mechanism: Mechanism, given: str, values: Vector, near: Configuration) -> ClosedConfiguration:
    """The configuration closed for motor values or a pose, from one start only: the branch is kept.

    Raises:
        ClosureError: It does not close from there.
        NonFiniteError: NaN or infinity.
        ModelError: A quaternion of length zero.
    """
    bad = np.flatnonzero(~np.isfinite(values))
    if len(bad):
        raise NonFiniteError(given, (int(bad[0]),), float(values[bad[0]]))
    if given == "motors":
        motors = dict(zip(mechanism.active, map(float, values), strict=True))
        return mechanism.close(near, motors=motors, attempts=1)
    return mechanism.close(near, pose=pose_from(values), attempts=1)


def pose_from(values: Vector) -> Pose:
    """The pose x y angle, or x y z qw qx qy qz.

    Raises:
        ModelError: A quaternion of length zero.
    """
    if len(values) == 3:
        return Pose.from_angle(float(values[2]), values[:2])
    if float(np.linalg.norm(values[3:])) < 1e-6:
        raise ModelError(f"the quaternion (w, x, y, z) {values[3:].tolist()} has length zero")
    return Pose.from_quaternion_wxyz(values[3:], values[:3])
