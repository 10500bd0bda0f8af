"""One configuration through one lane: everything that can be made before is made before.

A control loop asks for the same quantities thousands of times a second, so a call must not cost more
than its kernel: no copies, no broadcasting, outputs of the final size.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from vincula.kernels.evaluation import Evaluation
from vincula.kernels.lane_path import LaneWriters
from vincula.kernels.lane_poses import poses_in_lanes
from vincula.kernels.one_by_one import Reasons
from vincula.kernels.plans import Plan
from vincula.kernels.quantities import quaternion_places

_NO_REASONS = Reasons()


class Single:
    """A list of quantities at one configuration at a time.

    It keeps nothing between calls, so several threads may use it.

    Args:
        writers: The quantities in lanes.
        plan: What is asked for.
    """

    def __init__(self, writers: LaneWriters, plan: Plan) -> None:
        program = writers.path.program
        self._program, self._writers, self._plan = program, writers, plan
        self._size = len(program.mechanism.home.flat)
        self._shapes = [(q.name, (1, *q.shape), q.dtype) for q in plan.quantities]
        self._quaternions = quaternion_places(program.mechanism)
        self._length = program.mechanism.length

    def at(self, values: NDArray[np.float64]) -> Evaluation | None:
        """The quantities at one configuration; None where the reference path must look at it.

        Args:
            values: One vector of coordinates.
        """
        if values.shape != (self._size,):
            return None
        rows = np.array(values, dtype=np.float64, ndmin=2)
        raw = self._program.run(rows, want=self._writers.want, threads=1)
        if not raw.certain[0]:
            return None
        arrays: dict[str, NDArray[Any]] = {
            name: np.empty(shape, dtype) for name, shape, dtype in self._shapes
        }
        for name, writer in self._writers.writers:
            writer(raw, arrays[name])
        self._places(rows, raw.residual, arrays)
        single = {name: array.reshape(array.shape[1:]) for name, array in arrays.items()}
        return Evaluation((), self._plan.by_name, single, _NO_REASONS)

    def _places(
        self, rows: NDArray[np.float64], residual: NDArray[np.float64], arrays: dict[str, NDArray[Any]]
    ) -> None:
        if "closure.residual" in arrays:
            arrays["closure.residual"][...] = residual * self._length
        if "reference.pose" in arrays:
            arrays["reference.pose"][...] = poses_in_lanes(self._program, rows, None)
        if "configuration" in arrays:
            found = arrays["configuration"]
            found[...] = rows
            for place in self._quaternions:
                part = found[0, place : place + 4]
                size = float(np.sqrt(part @ part))
                if abs(size - 1.0) >= 1e-14:
                    part /= size
