"""Closing a batch in lanes: `LaneClosing`.

Configurations follow each other: each is closed from the one before.  A long batch is cut into stretches of
`STRETCH` configurations, one a lane.  Their first configurations are closed from the start of the batch, all
at once; afterwards each is closed again from the end of the stretch before, and where the two differ (the
straight way from the start led to another branch) the stretch is done again from there.  So results are those
of following configuration by configuration, and depend on the batch alone, never on lanes or threads.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from vincula.arrays import Matrix, Vector
from vincula.errors import VinculaError
from vincula.kernels.closing import pose_from
from vincula.kernels.lanes.closing_flat import ClosingArrays, closing_arrays
from vincula.kernels.lanes.closing_forest import Given
from vincula.kernels.lanes.threads import in_shares
from vincula.kernels.memory import doubles
from vincula.kernels.reference_path import pose_of_reference
from vincula.mechanism.closed import ClosedConfiguration
from vincula.mechanism.configuration import Configuration
from vincula.mechanism.residuals import axis_values

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism

STRETCH: Final = 256
"""Configurations that one lane closes one after the other."""
SAME: Final = 1e-7
"""Two closed configurations nearer than this are one [rad, lengths L]."""
OPEN_START: Final = 1e-9
"""A start whose gaps are above this, times the characteristic length, is no start for lanes."""

Indices = NDArray[np.int64]


@dataclass(frozen=True, slots=True, eq=False)
class ClosedLanes:
    """Configurations closed in lanes.

    Attributes:
        values: N x coordinates; where a lane did not close, the last configuration before that did.
        closed: Whether what was asked for was reached on the branch of the start.
        jumped: Whether it closes, but was not reached that way.
        steps: Jacobians evaluated.
        residual: Norm of all gaps, angles times the characteristic length [m].
    """

    values: Matrix
    closed: NDArray[np.bool_]
    jumped: NDArray[np.bool_]
    steps: NDArray[np.int32]
    residual: Vector


@dataclass(frozen=True, slots=True, eq=False)
class LaneClosing:
    """The closing of one mechanism for motor positions, or for poses of its reference member.

    Attributes:
        mechanism: The mechanism.
        given: What is given.
        arrays: Its flat arrays.
        determined: Whether what is given determines the configuration, up to branches.
        home_is_closed: Whether lanes can start at home.
        at_home: What is given at home.
    """

    mechanism: Mechanism
    given: Given
    arrays: ClosingArrays
    determined: bool
    home_is_closed: bool
    at_home: Vector

    @staticmethod
    def prepare(mechanism: Mechanism, given: Given, *, general: bool = False) -> LaneClosing:
        """The closing of a mechanism with a reference member.

        Args:
            mechanism: The mechanism.
            given: What is given.
            general: Whether variants of other dimensions are to have the same tables.

        Raises:
            Unsupported: Something that the reference path alone closes.
        """
        home = mechanism.home
        return LaneClosing(
            mechanism,
            given,
            closing_arrays(mechanism, given, general=general),
            _determined(mechanism, given, home),
            _gap(mechanism, home) <= OPEN_START * mechanism.length,
            given_at(mechanism, given, home),
        )

    @property
    def length(self) -> float:
        """Characteristic length of the dimensions that are closed [m]: the first constant is one over it."""
        return float(1.0 / self.arrays.constants[0])

    def given_at(self, q: Configuration) -> Vector:
        """What is given at a configuration: motor positions, or the pose of the reference member."""
        return given_at(self.mechanism, self.given, q)

    def starts_at(self, q: Configuration) -> bool:
        """Whether lanes can start at a configuration: whether it is closed."""
        return _gap(self.mechanism, q) <= OPEN_START * self.mechanism.length

    def closed_near(self, q: Configuration) -> Configuration:
        """The configuration closed for what is given there.

        Raises:
            ClosureError: There is none.
        """
        return _close(self.mechanism, self.given, q)

    def run(
        self, inputs: Matrix, start: Configuration, stretch: int, threads: int | None = None
    ) -> ClosedLanes:
        """Close configurations one from the other.

        Args:
            inputs: N x (motors, or 7 or 3 numbers of a pose).
            start: A closed configuration, from which the first of every `stretch` configurations is closed.
            stretch: How many configurations follow each other.
            threads: Threads; None for one a core.
        """
        rows = -(-len(inputs) // max(stretch, 1))
        given = self.at_home if start is self.mechanism.home else self.given_at(start)
        return self.run_rows(inputs, _repeated(start.flat, rows), _repeated(given, rows), stretch, threads)

    def run_rows(
        self, inputs: Matrix, starts: Matrix, given: Matrix, stretch: int, threads: int | None = None
    ) -> ClosedLanes:
        """Close rows of configurations, each row from a closed configuration of its own.

        Args:
            inputs: As in `run`.
            starts: One a row x coordinates.
            given: What is given there, one a row x inputs.
            stretch: Configurations of a row.
            threads: As in `run`.
        """
        run = _Run(self, np.require(inputs, np.float64, ["C", "W"]), threads)
        run.follow(np.require(starts, np.float64, ["C", "W"]), np.require(given, np.float64, ["C", "W"]),
                   max(stretch, 1))  # fmt: skip
        return run.result()

    def run_each(self, inputs: Matrix, starts: Matrix, threads: int | None = None) -> ClosedLanes:
        """Close every configuration from a closed one of its own.

        Args:
            inputs: As in `run`.
            starts: N x coordinates.
            threads: As in `run`.
        """
        return self.run_rows(inputs, starts, self.given_rows(starts), 1, threads)

    def given_rows(self, configurations: Matrix) -> Matrix:
        """What is given at closed configurations, N x inputs."""
        home = self.mechanism.home
        found = [given_at(self.mechanism, self.given, home.from_flat(flat)) for flat in configurations]
        return np.array(found, dtype=np.float64).reshape(len(found), len(self.at_home))


class _Run:
    """One call: its arrays, filled stretch by stretch."""

    def __init__(self, closing: LaneClosing, inputs: Matrix, threads: int | None) -> None:
        self.closing, self.inputs, self.threads = closing, inputs, threads
        count = len(inputs)
        self.values = doubles((count, len(closing.arrays.value_scale)))
        self.steps = np.empty(count, dtype=np.int32)
        self.gaps = doubles((count,))
        self.closed = np.empty(count, dtype=np.uint8)

    def result(self) -> ClosedLanes:
        """What was found."""
        residual = np.sqrt(self.gaps) * self.closing.length
        return ClosedLanes(self.values, self.closed == 1, self.closed == 2, self.steps, residual)

    def follow(self, starts: Matrix, given: Matrix, stretch: int) -> None:
        """All configurations, along every stretch from its own start."""
        count = len(self.inputs)
        if count == 0:
            return
        most = min(stretch, STRETCH) if self.closing.determined else stretch
        heads = (np.arange(0, count, stretch)[:, None] + np.arange(0, stretch, most)).ravel()
        heads = heads[heads < count]
        lengths = np.minimum(np.minimum(most, count - heads), stretch - heads % stretch)
        starts, at_start = starts[heads // stretch], given[heads // stretch]
        later = heads % stretch != 0
        if later.any():
            self.close(starts[later], at_start[later], heads[later], np.ones(later.sum(), dtype=np.int64))
            reached = later & (self.closed[heads] == 1)
            starts[reached] = self.values[heads[reached]]
            at_start[reached] = self.inputs[heads[reached]]
        first_steps = self.steps[heads]
        self.close(starts, at_start, heads, lengths)
        if later.any():
            self.steps[heads[later]] += first_steps[later]
            self._mend(heads, lengths, np.flatnonzero(later))

    def close(self, starts: Matrix, given: Matrix, first: Indices, count: Indices) -> None:
        """Close stretches, each from its own start."""
        self._close_into(starts, given, first, count, self.inputs,
                         (self.values, self.steps, self.gaps, self.closed))  # fmt: skip

    def _close_into(
        self, starts: Matrix, given: Matrix, first: Indices, count: Indices, inputs: Matrix,
        out: tuple[Any, Any, Any, Any],
    ) -> None:  # fmt: skip
        from vincula.kernels.lanes.closing_entries import closing_entry
        from vincula.kernels.lanes.entries import lanes_of_this_machine

        arrays = self.closing.arrays
        wide = lanes_of_this_machine()
        # One lane alone takes about a quarter of the time of all lanes together.
        width = 1 if len(first) * 4 <= wide else wide
        run = closing_entry(width)
        groups = -(-len(first) // width)

        def part(begin: int, end: int) -> None:
            run(starts, given, first, count, inputs, arrays.code, arrays.plan, arrays.constants,
                arrays.value_scale, arrays.input_scale, begin, end, *out)  # fmt: skip

        in_shares(part, groups, self.threads)

    def _mend(self, heads: Indices, lengths: Indices, later: Indices) -> None:
        """Do stretches again that do not continue the one before."""
        ends = heads[later - 1] + lengths[later - 1] - 1
        for lost in np.flatnonzero(self.closed[ends] == 0):
            before = later[lost] - 1
            ends[lost] = self._last_closed(heads[before], lengths[before])
        joins = self._joins(ends, heads[later])
        redone = -1
        for place, k in enumerate(later):
            if joins[place] and redone != k - 1:
                continue
            end = np.array([self._last_closed(heads[k - 1], lengths[k - 1])], dtype=np.int64)
            if redone == k - 1 and self._joins(end, heads[k : k + 1])[0]:
                continue
            if end[0] >= 0:
                self.close(self.values[end], self.inputs[end], heads[k : k + 1], lengths[k : k + 1])
                redone = int(k)

    def _last_closed(self, head: int, length: int) -> int:
        """The last configuration of a stretch that closed, or the last one of all before it; -1 for none."""
        found = np.flatnonzero(self.closed[head : head + length])
        if len(found):
            return int(head + found[-1])
        before = np.flatnonzero(self.closed[:head])
        return int(before[-1]) if len(before) else -1

    def _joins(self, ends: Indices, heads: Indices) -> NDArray[np.bool_]:
        """Whether closing from the ends gives what stands at the heads."""
        known = ends >= 0
        inputs = np.ascontiguousarray(self.inputs[heads])
        count = len(heads)
        values = np.zeros((count, self.values.shape[1]))
        closed = np.zeros(count, dtype=np.uint8)
        out = values, np.zeros(count, dtype=np.int32), np.zeros(count), closed
        ends = np.maximum(ends, 0)
        one_by_one = np.arange(count, dtype=np.int64)
        self._close_into(
            self.values[ends], self.inputs[ends], one_by_one, np.ones_like(one_by_one), inputs, out
        )
        scaled = np.abs(values - self.values[heads]) * self.closing.arrays.value_scale
        near = np.asarray(scaled.max(axis=1, initial=0.0) <= SAME)
        return np.asarray(known & (closed == 1) & (self.closed[heads] == 1) & near)


def _repeated(row: Vector, count: int) -> Matrix:
    return np.tile(np.asarray(row, dtype=np.float64), (count, 1))


def given_at(mechanism: Mechanism, given: Given, q: Configuration) -> Vector:
    """What is given at a configuration: motor positions, or the pose of the reference member."""
    if given == "reference":
        return pose_of_reference(mechanism, q)
    values = axis_values(mechanism, q)
    drives = {drive.name: drive.drives for drive in mechanism.drives}
    found = []
    for motor in mechanism.active:
        if motor in drives:
            found.append(sum(k * values[axis] for axis, k in drives[motor].items()))
        else:
            found.append(values[motor])
    return np.array(found, dtype=np.float64)


def _gap(mechanism: Mechanism, q: Configuration) -> float:
    """Largest gap [m]."""
    return max((residual.gap for residual in mechanism.residuals(q)), default=0.0)


def _close(mechanism: Mechanism, given: Given, q: Configuration) -> ClosedConfiguration:
    here = given_at(mechanism, given, q)
    if given == "motors":
        motors = dict(zip(mechanism.active, map(float, here), strict=True))
        return mechanism.close(q, motors=motors, attempts=1)
    return mechanism.close(q, pose=pose_from(here), attempts=1)


def _determined(mechanism: Mechanism, given: Given, q: Configuration) -> bool:
    """Whether closing leaves no motion free: else neighbours alone say where free motions stand."""
    try:
        return _close(mechanism, given, q).free_motions == 0
    except VinculaError:
        return False
