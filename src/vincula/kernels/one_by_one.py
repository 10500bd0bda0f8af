"""Lanes of a batch through the reference path, all of them or those that nothing else could decide."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Final

from vincula.kernels.closing import Chain
from vincula.kernels.evaluation import FAILED, OK, STATUS_NAMES
from vincula.kernels.inputs import Batch
from vincula.kernels.plans import Plan
from vincula.kernels.reference_path import Arrays, Outcome
from vincula.kernels.variants import Variants

MOST_REASONS: Final = 10_000
"""Reasons that are kept in words; a batch may have millions of configurations."""


class Reasons:
    """Why lanes are not ok, in words: the first `MOST_REASONS` of them, or found out when asked for.

    Args:
        explain: Finds out the reason of a lane, where it does not depend on other lanes.
    """

    def __init__(self, explain: Callable[[int], str] | None = None) -> None:
        self._found: dict[int, str] = {}
        self._explain = explain

    def add(self, lane: int, outcome: Outcome) -> None:
        """Keep the reason of a lane."""
        if len(self._found) < MOST_REASONS:
            self._found[lane] = outcome.reason or STATUS_NAMES[outcome.status]

    def __call__(self, lane: int) -> str:
        """The reason of a lane that is not ok."""
        if lane in self._found:
            return self._found[lane]
        if self._explain is not None:
            return self._explain(lane)
        return f"only the first {MOST_REASONS} reasons of a batch are kept: evaluate this one alone"


def reasons_for(variants: Variants, plan: Plan, batch: Batch) -> Reasons:
    """Reasons of a batch; those of whole configurations can be found out later."""
    if batch.given != "configuration":
        return Reasons()

    def explain(lane: int) -> str:
        one = batch.one(lane)
        scratch = {quantity.name: quantity.empty(1) for quantity in plan.quantities}
        return _one(variants, plan, one, scratch, None, 0).reason

    return Reasons(explain)


def evaluate_one_by_one(
    variants: Variants, plan: Plan, batch: Batch, arrays: Arrays, lanes: Iterable[int], reasons: Reasons
) -> None:
    """Evaluate lanes in order and write status and quantities at their places.

    Args:
        variants: The mechanisms by parameter values.
        plan: What is asked for.
        batch: The batch.
        arrays: One array a quantity, holding fill values in these lanes.
        lanes: Which ones; all of them where lanes follow each other.
        reasons: Where reasons go.
    """
    chain = Chain(batch) if batch.given != "configuration" else None
    for lane in lanes:
        outcome = _one(variants, plan, batch, arrays, chain, lane)
        arrays["status"][lane] = outcome.status
        if outcome.status != OK:
            reasons.add(lane, outcome)


def _one(
    variants: Variants, plan: Plan, batch: Batch, arrays: Arrays, chain: Chain | None, lane: int
) -> Outcome:
    mechanism = variants.tried(batch.parameters_at(lane))
    if isinstance(mechanism, str):
        return Outcome(FAILED, mechanism)
    if chain is None:
        flat = mechanism.home.flat if batch.values is None else batch.values[lane]
        return plan.reference.fill(mechanism, flat, arrays, lane)
    closed = chain.closed(mechanism, lane)
    if isinstance(closed, Outcome):
        return closed
    if "closure.iterations" in arrays:
        arrays["closure.iterations"][lane] = closed.iterations
    return plan.reference.fill(mechanism, closed.values.flat, arrays, lane)
