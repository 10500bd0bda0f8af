"""Batches of motor positions or poses: closed in lanes, evaluated in lanes, and the rest one by one.

A lane that was followed on its branch counts.  One that closes only beyond a jump, or almost, is closed again
by `Mechanism.close` from the last configuration before it; one that is clearly open has no closure.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from vincula.arrays import Matrix, Vector
from vincula.errors import ClosureError, VinculaError
from vincula.kernels.evaluation import NO_CLOSURE
from vincula.kernels.inputs import Batch, Given
from vincula.kernels.lane_batch import evaluate_in_lanes
from vincula.kernels.lane_grids import closed_grid
from vincula.kernels.lane_path import LaneWriters, numba_is_installed
from vincula.kernels.one_by_one import MOST_REASONS, Reasons, evaluate_one_by_one
from vincula.kernels.plans import Plan
from vincula.kernels.reference_path import Arrays, Outcome
from vincula.kernels.variants import Variants
from vincula.mechanism.configuration import Configuration
from vincula.mechanism.mechanism import Mechanism

if TYPE_CHECKING:
    from vincula.kernels.lanes.closing import ClosedLanes, LaneClosing

_Room = tuple[Matrix, Matrix, NDArray[np.int32], Vector, NDArray[np.uint8]]

OPEN: Final = 1e-6
"""A gap that stays above this, times the characteristic length, does not close."""


def lane_closing(mechanism: Mechanism, given: Given, *, general: bool = False) -> LaneClosing | str:
    """The closing of a mechanism in lanes; or why only the reference path closes it.

    Args:
        mechanism: The mechanism.
        given: What is given.
        general: Whether dimensions are going to differ from design to design.
    """
    if not numba_is_installed():
        return "numba is not installed"
    if given == "configuration":
        return "whole configurations are given"
    from vincula.kernels.lanes.closing import LaneClosing

    try:
        return LaneClosing.prepare(mechanism, given, general=general)
    except VinculaError as error:
        return str(error)


def closed_start(closing: LaneClosing, batch: Batch) -> Configuration | str:
    """Where the first lane starts, closed; or why there is no such configuration."""
    home = closing.mechanism.home
    start = home if batch.first is None else home.from_flat(batch.first)
    if (start is home and closing.home_is_closed) or closing.starts_at(start):
        return start
    try:
        return closing.closed_near(start)
    except ClosureError as error:
        return str(error)


def evaluate_closed(
    closing: LaneClosing,
    start: Configuration,
    writers: LaneWriters,
    variants: Variants,
    plan: Plan,
    batch: Batch,
    arrays: Arrays,
    reasons: Reasons,
    threads: int,
) -> None:
    """Close and evaluate a batch of motor positions or poses of one geometry.

    Args:
        closing: The closing in lanes.
        start: Where the first lane starts, closed.
        writers: The quantities in lanes.
        variants: The mechanisms by parameter values.
        plan: The quantities in the reference path.
        batch: The batch.
        arrays: One array a quantity, with anything in it.
        reasons: Where reasons go.
        threads: Threads to use.
    """
    if batch.values is None:
        return
    closed = _closed(closing, start, batch, batch.values, threads)
    _evaluate_reached(closed, writers, variants, plan, batch, arrays, reasons, threads)
    if "closure.iterations" in arrays:
        arrays["closure.iterations"][...] = closed.steps
    lost = np.flatnonzero(~closed.closed)
    if not len(lost):
        return
    for quantity in plan.quantities:
        arrays[quantity.name][lost] = quantity.fill
    arrays["status"][lost] = NO_CLOSURE
    gaps = closed.residual[lost]
    # Not certain either where the gap is not a number.
    certain = (gaps > OPEN * closing.length) & ~closed.jumped[lost]
    for lane in lost[certain][:MOST_REASONS].tolist():
        left = f"{closed.residual[lane]:.3g} m of its gaps stay open, angles times the characteristic length"
        reasons.add(lane, Outcome(NO_CLOSURE, f"it does not close from the configuration before it: {left}"))
    again = replace(batch, starts=closed.values)
    evaluate_one_by_one(variants, plan, again, arrays, lost[~certain].tolist(), reasons)


def _evaluate_reached(
    closed: ClosedLanes,
    writers: LaneWriters,
    variants: Variants,
    plan: Plan,
    batch: Batch,
    arrays: Arrays,
    reasons: Reasons,
    threads: int,
) -> None:
    """Evaluate the lanes that closed.

    The others hold the last configuration before them, which is singular more often than not: each would
    go through the reference path, for nothing.
    """
    whole = replace(batch, given="configuration", values=closed.values, starts=None, first=None)
    if closed.closed.all():
        evaluate_in_lanes(writers, variants, plan, whole, arrays, reasons, threads)
        return
    lanes = np.flatnonzero(closed.closed)
    settings = {name: values[lanes] for name, values in batch.parameters.items()}
    part = replace(whole, shape=(len(lanes),), values=closed.values[lanes], parameters=settings)
    found = {name: np.empty((len(lanes), *array.shape[1:]), array.dtype) for name, array in arrays.items()}
    evaluate_in_lanes(writers, variants, plan, part, found, _Placed(reasons, lanes), threads)
    for name, array in arrays.items():
        array[lanes] = found[name]


class _Placed(Reasons):
    """Reasons of some lanes, kept with those of the whole batch."""

    def __init__(self, whole: Reasons, lanes: NDArray[np.intp]) -> None:
        super().__init__()
        self._whole, self._lanes = whole, lanes

    def add(self, lane: int, outcome: Outcome) -> None:
        self._whole.add(int(self._lanes[lane]), outcome)


def _closed(
    closing: LaneClosing, start: Configuration, batch: Batch, values: Matrix, threads: int
) -> ClosedLanes:
    if batch.starts is not None:
        return closing.run_each(values, batch.starts, threads)
    return closed_grid(closing, values, batch.shape, start, threads)


class SingleClosing:
    """One closing from home at a time: a call costs little more than its kernel.

    Several threads may use it: a call takes memory that no other uses, or makes some.

    Args:
        closing: The closing in lanes; home must be closed.
    """

    def __init__(self, closing: LaneClosing) -> None:
        from vincula.kernels.lanes.closing_entries import closing_entry

        self._run = closing_entry(1)
        a = closing.arrays
        one, none = np.ones(1, dtype=np.int64), np.zeros(1, dtype=np.int64)
        self._before = (
            np.array(closing.mechanism.home.flat, ndmin=2),
            np.array(closing.at_home, ndmin=2),
            none,
            one,
        )
        self._behind = a.code, a.plan, a.constants, a.value_scale, a.input_scale, 0, 1
        self._shape = self._before[1].shape[1:]
        self._rooms: list[_Room] = []

    def closed(self, inputs: Vector) -> tuple[Vector, int] | None:
        """The closed configuration and the Jacobians evaluated; None where lanes do not close it.

        Args:
            inputs: Motor values, or one pose.
        """
        if inputs.shape != self._shape:
            return None
        room = self._rooms.pop() if self._rooms else self._room()
        given, values, steps, gaps, closed = room
        given[0] = inputs
        self._run(*self._before, given, *self._behind, values, steps, gaps, closed)
        found = (values[0].copy(), int(steps[0])) if closed[0] == 1 else None
        self._rooms.append(room)
        return found

    def _room(self) -> _Room:
        """Memory for one call: what is given, values, steps, gaps, whether it closed."""
        start, given = self._before[:2]
        return (np.empty_like(given), np.empty_like(start), np.zeros(1, dtype=np.int32), np.zeros(1),
                np.zeros(1, dtype=np.uint8))  # fmt: skip
