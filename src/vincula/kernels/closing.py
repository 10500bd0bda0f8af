"""Closing one configuration after the other, each from its neighbour, as `Mechanism.close` does.

One start only is tried, so that the assembly branch is kept.
"""

from __future__ import annotations

import numpy as np

from vincula.arrays import Vector
from vincula.errors import ClosureError, ModelError, NonFiniteError, VinculaError
from vincula.kernels.evaluation import FAILED, NO_CLOSURE
from vincula.kernels.inputs import Batch
from vincula.kernels.reference_path import Outcome
from vincula.mechanism.closure import Found, closed_with
from vincula.mechanism.closure_problem import ClosureProblem
from vincula.mechanism.configuration import Configuration
from vincula.mechanism.holding import Holding, holding, problem_for
from vincula.mechanism.mechanism import Mechanism
from vincula.spatial.poses import Pose


class Chain:
    """The starts of a batch: fixed by the batch alone, whatever computes it.

    With one start (or none: home) a lane starts where the lane before it along the last axis closed, the
    first of every row where the first of the row before did, and so on; where dimensions of the mechanism
    differ from lane to lane and no start is given, every row at home.  A lane that did not close is passed
    over.  With a start a lane every lane is on its own.

    Args:
        batch: The batch.
    """

    def __init__(self, batch: Batch) -> None:
        self._batch = batch
        self._last: dict[int, Configuration] = {}
        self._problem: ClosureProblem | None = None

    def closed(self, mechanism: Mechanism, lane: int) -> Found | Outcome:
        """The closed configuration of the next lane, or why there is none; lanes come in order."""
        batch, level = self._batch, self._level(lane)
        if level:
            self._begin_row(level)
        if batch.values is None:
            return Outcome(FAILED, "nothing is given to close for")
        try:
            held = held_for(mechanism, batch.given, batch.values[lane])
            found = closed_with(
                self._equations(mechanism, held), held, self._near(mechanism, lane, level), attempts=1
            )
        except ClosureError as error:
            return Outcome(NO_CLOSURE, str(error))
        except VinculaError as error:
            return Outcome(FAILED, str(error))
        self._last.update(dict.fromkeys(range(level + 1), found.values))
        return found

    def _begin_row(self, level: int) -> None:
        """Forget the end of the row before: this one begins where the row before began."""
        batch = self._batch
        near = None if batch.parameters and batch.first is None else self._last.get(level)
        self._last = {} if near is None else {**self._last, **dict.fromkeys(range(level), near)}

    def _level(self, lane: int) -> int:
        """Along how many of the last axes a lane is the first: it begins a row, a plane, and so on."""
        level = 0
        for size in reversed(self._batch.shape):
            lane, place = divmod(lane, size)
            if place:
                break
            level += 1
        return level

    def _equations(self, mechanism: Mechanism, held: Holding) -> ClosureProblem:
        """The equations, made once a mechanism: what is held is the same in every lane."""
        if self._problem is None or self._problem.mechanism is not mechanism:
            self._problem = problem_for(mechanism, held)
        return self._problem

    def _near(self, mechanism: Mechanism, lane: int, level: int) -> Configuration:
        batch = self._batch
        if batch.starts is not None:
            return mechanism.home.from_flat(batch.starts[lane])
        if level in self._last:
            return self._last[level]
        return mechanism.home if batch.first is None else mechanism.home.from_flat(batch.first)


def held_for(mechanism: Mechanism, given: str, values: Vector) -> Holding:
    """What is held: motor values or a pose.

    Raises:
        NonFiniteError: NaN or infinity.
        ModelError: A quaternion of length zero.
    """
    bad = np.flatnonzero(~np.isfinite(values))
    if len(bad):
        raise NonFiniteError(given, (int(bad[0]),), float(values[bad[0]]))
    if given == "motors":
        return holding(mechanism, dict(zip(mechanism.active, map(float, values), strict=True)))
    return holding(mechanism, None, pose_from(values))


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
