"""Which way a batch takes: in lanes where they can, one by one where they cannot."""

from __future__ import annotations

from threading import Lock
from typing import TYPE_CHECKING, Any, Literal

from numpy.typing import NDArray

from vincula.errors import ModelError
from vincula.kernels.evaluation import Evaluation
from vincula.kernels.inputs import Batch, Given
from vincula.kernels.lane_batch import evaluate_in_lanes
from vincula.kernels.lane_branches import asks_for_branches
from vincula.kernels.lane_closing import SingleClosing, closed_start, evaluate_closed, lane_closing
from vincula.kernels.lane_designs import evaluate_rows, rows_of
from vincula.kernels.lane_path import (
    LanePath,
    LaneWriters,
    empty_arrays,
    lane_path,
    refuse_without_numba,
)
from vincula.kernels.lanes.threads import cores
from vincula.kernels.one_by_one import Reasons, evaluate_one_by_one, reasons_for
from vincula.kernels.plans import Plan
from vincula.kernels.single import Single
from vincula.kernels.variants import Variants
from vincula.mechanism.mechanism import Mechanism
from vincula.weights import Weights

if TYPE_CHECKING:
    from vincula.kernels.lanes.closing import LaneClosing

Arrays = dict[str, NDArray[Any]]


class Runner:
    """A mechanism with everything that is prepared for it, once each and when first needed.

    Args:
        mechanism: The mechanism.
        weights: Weights of all evaluations; None for those of the mechanism.
        variants: The mechanisms by parameter values.
    """

    def __init__(self, mechanism: Mechanism, weights: Weights | None, variants: Variants) -> None:
        self.mechanism, self.weights, self.variants = mechanism, weights, variants
        self._paths: dict[bool, LanePath | str] = {}
        self._writers: dict[tuple[Plan, bool], LaneWriters | str] = {}
        self._closings: dict[str, LaneClosing | str] = {}
        self._singles: dict[Plan, Single | Literal[False]] = {}
        self._single_closings: dict[str, SingleClosing] = {}
        self._preparing = Lock()

    def run(self, plan: Plan, batch: Batch, path: str, threads: int | None) -> tuple[Arrays, Reasons]:
        """Evaluate a batch.

        Args:
            plan: What is asked for.
            batch: The batch.
            path: `auto`, `lanes` or `reference`.
            threads: Threads to use; None for one a core.

        Raises:
            MissingExtraError: Lanes are asked for and numba is not installed.
            ModelError: Lanes are asked for and cannot do this.
        """
        reasons = reasons_for(self.variants, plan, batch)
        why = "" if path == "reference" else self._in_lanes(plan, batch, reasons, threads or cores())
        if not isinstance(why, str):
            return why, reasons
        if path == "lanes":
            refuse_without_numba()
            raise ModelError(f"path='lanes': {why}")
        arrays = {quantity.name: quantity.empty(batch.lanes) for quantity in plan.quantities}
        evaluate_one_by_one(self.variants, plan, batch, arrays, range(batch.lanes), reasons)
        return arrays, reasons

    def single(self, plan: Plan, values: Any) -> Evaluation | None:
        """One whole configuration in lanes, quickly; None where that takes the longer way."""
        found = self._singles.get(plan)
        if found is None:
            writers = self.writers(plan, False)
            if isinstance(writers, str) or asks_for_branches(plan.by_name):
                found = False
            else:
                found = Single(writers, plan)
            self._singles[plan] = found
        return found.at(values) if found else None

    def single_closed(self, plan: Plan, given: Given, values: Any) -> Evaluation | None:
        """One configuration closed from home and evaluated, quickly; None where that takes the longer way.

        The first one always does: it checks what is given.
        """
        closing = self._closings.get(given)
        if closing is None or isinstance(closing, str) or not closing.home_is_closed:
            return None
        if given not in self._single_closings:
            self._single_closings[given] = SingleClosing(closing)
        closed = self._single_closings[given].closed(values)
        found = None if closed is None else self.single(plan, closed[0])
        if closed is not None and found is not None and "closure.iterations" in found:
            found["closure.iterations"][...] = closed[1]
        return found

    def writers(self, plan: Plan, general: bool) -> LaneWriters | str:
        """A plan in lanes, or why the reference path must do it.

        Args:
            plan: What is asked for.
            general: Whether dimensions differ from lane to lane.
        """
        key = plan, general
        if general and asks_for_branches(plan.by_name):
            return "signs of branches are told against the home of every design"
        if key not in self._writers:
            with self._preparing:
                if general not in self._paths:
                    self._paths[general] = lane_path(self.mechanism, self.weights, general=general)
                path = self._paths[general]
                self._writers[key] = path if isinstance(path, str) else path.writers(plan.quantities)
        return self._writers[key]

    def closing(self, given: Given) -> LaneClosing | str:
        """Closing in lanes, or why the reference path must do it."""
        if given not in self._closings:
            with self._preparing:
                if given not in self._closings:
                    self._closings[given] = lane_closing(self.mechanism, given)
        return self._closings[given]

    def _designs_in_lanes(
        self, writers: LaneWriters, plan: Plan, batch: Batch, arrays: Arrays, reasons: Reasons, threads: int
    ) -> Arrays | str:
        """Designs that are closed at every place, in lanes; or why that cannot be."""
        key = f"{batch.given} of designs"
        with self._preparing:
            if key not in self._closings:
                self._closings[key] = lane_closing(self.mechanism, batch.given, general=True)
        closing = self._closings[key]
        if isinstance(closing, str):
            return closing
        rows = rows_of(closing, writers, self.variants, batch, threads)
        if isinstance(rows, str):
            return rows
        evaluate_rows(rows, closing, writers, self.variants, plan, batch, arrays, reasons, threads)
        return arrays

    def _in_lanes(self, plan: Plan, batch: Batch, reasons: Reasons, threads: int) -> Arrays | str:
        """The batch in lanes, or why that cannot be."""
        writers = self.writers(plan, bool(batch.parameters))
        if isinstance(writers, str):
            return writers
        arrays = empty_arrays(plan.quantities, batch.lanes)
        if batch.given == "configuration":
            evaluate_in_lanes(writers, self.variants, plan, batch, arrays, reasons, threads)
            return arrays
        if batch.parameters:
            return self._designs_in_lanes(writers, plan, batch, arrays, reasons, threads)
        closing = self.closing(batch.given)
        if isinstance(closing, str):
            return closing
        start = closed_start(closing, batch)
        if isinstance(start, str):
            return start
        evaluate_closed(closing, start, writers, self.variants, plan, batch, arrays, reasons, threads)
        return arrays
