"""Batches of motor positions or poses for many designs: every design is closed and evaluated in lanes.

The dimensions are the same along the last axis of the batch: a row is one design at many places.  Rows are
closed with tables of their own constants; what lanes do not know of a row is done one by one.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from vincula.arrays import Matrix, Vector
from vincula.kernels.evaluation import FAILED
from vincula.kernels.inputs import Batch
from vincula.kernels.lane_closing import evaluate_closed
from vincula.kernels.lane_path import LaneWriters
from vincula.kernels.lane_poses import poses_in_lanes
from vincula.kernels.layouts import closing_layout, spectra_layout
from vincula.kernels.one_by_one import Reasons, evaluate_one_by_one
from vincula.kernels.plans import Plan
from vincula.kernels.reference_path import Arrays, Outcome
from vincula.kernels.traced_geometry import KNOWN, REFUSED, UNKNOWN
from vincula.kernels.variants import Variants
from vincula.mechanism.mechanism import Mechanism

if TYPE_CHECKING:
    from vincula.kernels.lanes.closing import LaneClosing

START_GAP: Final = 1e-9
"""Largest gap of a start, in units of the characteristic length."""
LONG: Final = 2048
"""Rows of so many places are shared among threads; shorter ones take a thread each."""


class OneVariant(Variants):
    """The mechanism of one row, whatever parameters are asked for; built when it is needed."""

    def __init__(self, variants: Variants, values: Mapping[str, float]) -> None:
        self.nominal, self.build = variants.nominal, variants.build
        self._variants, self._values = variants, values

    def tried(self, values: Mapping[str, float]) -> Mechanism | str:
        """The mechanism of the row, or why it cannot be built."""
        return self._variants.tried(self._values)


class _RowReasons(Reasons):
    """Reasons of one row, kept with those of the batch."""

    def __init__(self, whole: Reasons, first: int) -> None:
        super().__init__()
        self._whole, self._first = whole, first

    def add(self, lane: int, outcome: Outcome) -> None:
        """Keep the reason of a lane of the row."""
        self._whole.add(self._first + lane, outcome)


@dataclass(frozen=True, slots=True, eq=False)
class Rows:
    """The designs of a batch.

    Attributes:
        parameters: Values by name, one a row.
        places: Lanes of a row.
        spectra: Constants of the spectra, one row each.
        closing: Constants of closing, then scales of values and inputs.
        at_home: What is given at home.
        known: What is known of a row, see `traced_geometry`.
    """

    parameters: Mapping[str, Vector]
    places: int
    spectra: Matrix
    closing: Matrix
    at_home: Matrix
    known: np.ndarray[Any, np.dtype[np.uint8]]

    def values(self, row: int) -> dict[str, float]:
        """Parameter values of one row."""
        return {name: float(column[row]) for name, column in self.parameters.items()}


def rows_of(
    closing: LaneClosing, writers: LaneWriters, variants: Variants, batch: Batch, threads: int
) -> Rows | str:
    """The designs of a batch with their constants; or why lanes do not close it.

    Args:
        closing: The closing of the nominal mechanism.
        writers: The quantities in lanes, of a general program.
        variants: The mechanisms by parameter values.
        batch: The batch.
        threads: Threads to use.
    """
    if batch.first is not None or batch.starts is not None:
        return "lanes close designs from home only"
    places = max(batch.shape[-1], 1) if batch.shape else 1
    tables = {name: column.reshape(-1, places) for name, column in batch.parameters.items()}
    if any((table != table[:, :1]).any() for table in tables.values()):
        return "dimensions differ from place to place"
    parameters = {name: np.ascontiguousarray(table[:, 0]) for name, table in tables.items()}
    lay_out = closing_layout(closing.given)
    walked, known = variants.constants(f"closing {closing.given}", lay_out, parameters, threads)
    numbers, also = variants.constants("spectra", spectra_layout(writers.path), parameters, threads)
    known = np.where(known == KNOWN, also, known)
    home = np.tile(variants.nominal.home.flat, (len(numbers), 1))
    program = writers.path.program
    with np.errstate(all="ignore"):
        open_at_home = ~(program.run(home, numbers, threads=1).residual <= START_GAP)
        if closing.given == "reference":
            at_home = poses_in_lanes(program, home, numbers)
        else:
            at_home = np.tile(closing.at_home, (len(numbers), 1))
    known[(known == KNOWN) & open_at_home] = UNKNOWN
    return Rows(parameters, places, numbers, walked, at_home, known)


def evaluate_rows(
    rows: Rows,
    closing: LaneClosing,
    writers: LaneWriters,
    variants: Variants,
    plan: Plan,
    batch: Batch,
    arrays: Arrays,
    reasons: Reasons,
    threads: int,
) -> None:
    """Close and evaluate all designs of a batch; arguments as in `lane_closing.evaluate_closed`."""
    from vincula.kernels.lanes.threads import in_shares

    count = len(rows.known)
    shared = threads if rows.places >= LONG else 1

    def row(k: int) -> None:
        _evaluate_row(rows, k, closing, writers, variants, plan, batch, arrays, reasons, shared)

    def share(first: int, last: int) -> None:
        for k in range(first, last):
            row(k)

    in_shares(share, count, 1 if shared > 1 else threads)


def _evaluate_row(
    rows: Rows, k: int, closing: LaneClosing, writers: LaneWriters, variants: Variants, plan: Plan,
    batch: Batch, arrays: Arrays, reasons: Reasons, threads: int,
) -> None:  # fmt: skip
    """One design at all its places."""
    part = slice(k * rows.places, (k + 1) * rows.places)
    own: Arrays = {name: array[part] for name, array in arrays.items()}
    told = _RowReasons(reasons, part.start)
    values = None if batch.values is None else batch.values[part]
    inner = replace(batch, shape=(rows.places,), values=values, parameters={})
    if rows.known[k] == KNOWN:
        evaluate_closed(
            _closing_of(rows, k, closing), closing.mechanism.home, _writers_of(rows, k, writers),
            OneVariant(variants, rows.values(k)), plan, inner, own, told, threads,
        )  # fmt: skip
        return
    for quantity in plan.quantities:
        own[quantity.name][...] = quantity.fill
    if rows.known[k] == REFUSED:
        own["status"][...] = FAILED
        found = variants.tried(rows.values(k))
        for lane in range(rows.places if isinstance(found, str) else 0):
            told.add(lane, Outcome(FAILED, str(found)))
        return
    one = OneVariant(variants, rows.values(k))
    evaluate_one_by_one(one, plan, inner, own, range(rows.places), told)


def _closing_of(rows: Rows, k: int, closing: LaneClosing) -> LaneClosing:
    """The closing of one design."""
    arrays, numbers = closing.arrays, rows.closing[k]
    ends = np.cumsum(
        [len(numbers) - len(arrays.value_scale) - len(arrays.input_scale), len(arrays.value_scale)]
    )
    constants, values, inputs = (np.ascontiguousarray(part) for part in np.split(numbers, ends))
    own = replace(arrays, constants=constants, value_scale=values, input_scale=inputs)
    return replace(closing, arrays=own, at_home=rows.at_home[k], home_is_closed=True)


def _writers_of(rows: Rows, k: int, writers: LaneWriters) -> LaneWriters:
    """The quantities of one design."""
    program = replace(writers.path.program, constants=np.ascontiguousarray(rows.spectra[k]))
    return replace(writers, path=replace(writers.path, program=program))
