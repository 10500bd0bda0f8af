"""One configuration through one lane: everything that can be made before is made before.

A control loop asks for the same quantities thousands of times a second, so a call must not cost more
than its kernel: results stand in one block of memory that is copied once, arrays are views of the copy.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vincula.kernels.evaluation import Evaluation
from vincula.kernels.lane_block import LaneBlock
from vincula.kernels.lane_path import LaneWriters
from vincula.kernels.lane_poses import poses_in_lanes
from vincula.kernels.lanes.outputs import UNKNOWN
from vincula.kernels.one_by_one import Reasons
from vincula.kernels.plans import Plan
from vincula.kernels.quantities import quaternion_places

_NO_REASONS = Reasons()


@dataclass(frozen=True, slots=True, eq=False)
class _Room:
    """Memory for one call at a time.

    Attributes:
        values: 1 x coordinates.
        numbers: What kernels write, all quantities one after the other.
        raw: What other quantities are computed from, 1 x outputs.
        table: What goes where.
        status: One status.
    """

    values: NDArray[np.float64]
    numbers: NDArray[np.float64]
    raw: NDArray[np.float64]
    table: NDArray[np.int64]
    status: NDArray[np.uint8]


class Single:
    """A list of quantities at one configuration at a time.

    Several threads may use it: a call takes a room that no other uses, or makes one.

    Args:
        writers: The quantities in lanes.
        plan: What is asked for.
    """

    def __init__(self, writers: LaneWriters, plan: Plan) -> None:
        program = writers.path.program
        self._program, self._writers, self._plan = program, writers, plan
        self._size = len(program.mechanism.home.flat)
        self._quaternions = quaternion_places(program.mechanism)
        self._length = 1.0 / program.constants[0]
        self._rooms: list[_Room] = []
        self._views: list[tuple[str, int, int, tuple[int, ...], Any]] = []
        at = 0
        for q in plan.quantities:
            size = int(np.prod(q.shape, dtype=np.int64)) if q.dtype is np.float64 else 0
            self._views.append((q.name, at, at + size, q.shape, q.dtype))
            at += size
        self._count = at
        names = {quantity.name for quantity in plan.quantities}
        self._placed = bool(names & {"closure.residual", "reference.pose", "configuration"})
        self._run = program.one_lane(writers.want, writers.widest)

    def at(self, values: NDArray[np.float64]) -> Evaluation | None:
        """The quantities at one configuration; None where the reference path must look at it.

        Args:
            values: One vector of coordinates.
        """
        if values.shape != (self._size,):
            return None
        room = self._rooms.pop() if self._rooms else self._room()
        room.values[0] = values
        self._run(room.values, room.table, room.status)
        if room.status[0]:
            self._rooms.append(room)
            return None
        numbers = room.numbers.copy()
        arrays: dict[str, NDArray[Any]] = {}
        for name, first, last, shape, kind in self._views:
            if last > first:
                arrays[name] = numbers[first:last].reshape(shape)
            else:
                arrays[name] = np.zeros(shape, kind)
        for name, row in self._writers.same:
            arrays[name][...] = row
        if self._writers.derived and not self._derived(room, arrays):
            self._rooms.append(room)
            return None
        if self._placed:
            self._places(room.values, arrays)
        self._rooms.append(room)
        return Evaluation((), self._plan.by_name, arrays, _NO_REASONS)

    def _room(self) -> _Room:
        """New memory, and the table that says what goes where in it."""
        program, want = self._program, self._writers.want
        numbers = np.empty(self._count)
        raw = np.empty((1, program.outputs(want)))
        arrays = {
            name: numbers[first:last].reshape(1, *shape)
            for name, first, last, shape, _ in self._views
            if last > first
        }
        table = self._writers.parts(arrays)
        if self._writers.derived:
            table += program.raw_parts(want, raw)
        status = np.full(1, UNKNOWN, dtype=np.uint8)
        return _Room(np.empty((1, self._size)), numbers, raw, np.array(table, dtype=np.int64), status)

    def _derived(self, room: _Room, arrays: dict[str, NDArray[Any]]) -> bool:
        """Write quantities that are computed from others; whether these are certain."""
        given = self._program.named(room.raw, room.status, self._writers.want)
        block = LaneBlock(self._program, given, room.values, None)
        self._writers.derive(block, {name: arrays[name][None] for name, _ in self._writers.derived})
        return bool(block.sure[0])

    def _places(self, rows: NDArray[np.float64], arrays: dict[str, NDArray[Any]]) -> None:
        """Gaps, poses and values, which need more than the kernel's results."""
        if "closure.residual" in arrays:
            arrays["closure.residual"] *= self._length
        if "reference.pose" in arrays:
            arrays["reference.pose"][...] = poses_in_lanes(self._program, rows, None)[0]
        if "configuration" in arrays:
            found = arrays["configuration"]
            found[...] = rows[0]
            for place in self._quaternions:
                part = found[place : place + 4]
                size = float(np.sqrt(part @ part))
                if abs(size - 1.0) >= 1e-14:
                    part /= size
