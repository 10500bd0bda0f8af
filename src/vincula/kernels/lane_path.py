"""A batch in lanes: block after block on all threads, and what only the reference path can decide.

A lane counts when every rank is certainly the one that the mechanism has in general; all others, the
singular and the doubtful ones among them, are handed back.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any, Final, get_args

import numpy as np
from numpy.typing import NDArray

from vincula.analysis.ellipsoid import Kind
from vincula.analysis.recipes import motor_quantity, resolved_weights, task_quantity
from vincula.arrays import Matrix
from vincula.errors import MissingExtraError, VinculaError
from vincula.kernels.lane_quantities import Listing, Writer, writer_of
from vincula.kernels.lanes.threads import pool
from vincula.kernels.plans import model_without_numbers
from vincula.kernels.quantities import Quantity
from vincula.kernels.reference_path import Arrays
from vincula.kernels.samples import sample_configurations
from vincula.mechanism.mechanism import Mechanism
from vincula.mechanism.residuals import CLOSED
from vincula.weights import Quantity as Weighed
from vincula.weights import Weights

if TYPE_CHECKING:
    from vincula.kernels.lanes.program import LaneProgram, RawLanes

BLOCK: Final = 1024
"""Lanes computed and written at a time: what comes out of the kernel stays in the cache."""

SMALL_GAP: Final = 1e-5
"""Gaps up to this, in units of the characteristic length, are the same in lanes to about 1e-10."""


@dataclass(frozen=True, eq=False)
class LanePath:
    """A mechanism ready for lanes.

    Attributes:
        program: Its program.
        weights: The weights of all lanes.
        given_weights: Weights given for all evaluations; None for those of the mechanism.
        mechanism: The mechanism.
    """

    program: LaneProgram
    weights: Weights
    given_weights: Weights | None
    mechanism: Mechanism

    def _listing(self, kind: Kind) -> Listing | str:
        """What an ellipsoid lists in lanes that are certain, or why lanes do not give it."""
        if kind == "internal force":
            return "internal forces are not computed in lanes"
        if kind != "kinematic" and not self.weights.dual:
            return "lanes give forces under reciprocal weights only"
        model = model_without_numbers(self.mechanism)
        sides = task_quantity(kind), motor_quantity(kind)
        diagonals = [self.weights.metric(side, model).diagonal for side in sides]
        if diagonals[0] is None or diagonals[1] is None:
            return "weights are not diagonal"
        return Listing.of(kind, self.program.counts, np.sqrt(diagonals[0]), np.sqrt(diagonals[1]))

    def same_weights(self, variant: Mechanism) -> bool:
        """Whether a variant is weighed like the mechanism; lanes share their weights."""
        if self.given_weights is not None:
            return True
        own = [self.weights, resolved_weights(model_without_numbers(variant), None)]
        model = model_without_numbers(self.mechanism)
        pairs = ([w.metric(quantity, model).matrix for w in own] for quantity in get_args(Weighed))
        return own[0].dual == own[1].dual and all(np.array_equal(one, two) for one, two in pairs)

    def writers(self, quantities: Iterable[Quantity]) -> LaneWriters | str:
        """How the quantities are written; or why only the reference path gives them."""
        found: list[tuple[str, Writer]] = []
        want = 0
        for quantity in quantities:
            if quantity.name in ("configuration", "closure.residual", "reference.pose"):
                continue
            listing = None if quantity.kind is None else self._listing(quantity.kind)
            if isinstance(listing, str):
                return f"{quantity.name}: {listing}"
            how = writer_of(quantity, self.program.counts, self.program.twelve, listing)
            if isinstance(how, str):
                return how
            found.append((quantity.name, how[0]))
            want |= how[1]
        return LaneWriters(self, tuple(found), want)


@dataclass(frozen=True, eq=False)
class LaneWriters:
    """A list of quantities as lanes write them.

    Attributes:
        path: The mechanism in lanes.
        writers: One a quantity, by name.
        want: Directions that the kernel must give.
    """

    path: LanePath
    writers: tuple[tuple[str, Writer], ...]
    want: int

    def evaluate(
        self, values: Matrix, constants: Matrix | None, arrays: Arrays, threads: int
    ) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Evaluate all lanes and write those that are certain.

        Args:
            values: N x coordinates.
            constants: N x constants where dimensions differ from lane to lane.
            arrays: One array a quantity; rows of lanes that are not certain are left with anything.
            threads: Threads to use.

        Returns:
            Lanes that must go to the reference path, and lanes whose loops are certainly open.
        """
        count = len(values)
        unknown = np.empty(count, dtype=bool)
        opened = np.empty(count, dtype=bool)
        # Lanes measure small gaps: for angles they take the sine.  A large one is measured one by one.
        widest = SMALL_GAP if "closure.residual" in arrays else np.inf

        def block(first: int) -> None:
            part = slice(first, min(first + BLOCK, count))
            raw = self.path.program.run(
                values[part], None if constants is None else constants[part], want=self.want, threads=1
            )
            self._write(raw, arrays, part, self._lengths(constants, part))
            opened[part] = ~raw.certain & (raw.residual > 2.0 * CLOSED) & (raw.residual < widest)
            unknown[part] = ~(raw.certain | opened[part])

        starts = range(0, count, BLOCK)
        if threads > 1 and len(starts) > 1:
            for _ in pool(threads).map(block, starts):
                pass
        else:
            for first in starts:
                block(first)
        return np.flatnonzero(unknown), np.flatnonzero(opened)

    def _lengths(self, constants: Matrix | None, part: slice) -> Any:
        """Characteristic lengths of lanes: the first constant is one over it."""
        return 1.0 / (self.path.program.constants[0] if constants is None else constants[part, 0])

    def _write(self, raw: RawLanes, arrays: Arrays, part: slice, lengths: Any) -> None:
        with np.errstate(all="ignore"):  # lanes that are not certain hold anything
            for name, writer in self.writers:
                writer(raw, arrays[name][part])
        if "closure.residual" in arrays:
            arrays["closure.residual"][part] = raw.residual * lengths


def lane_path(mechanism: Mechanism, weights: Weights | None, *, general: bool) -> LanePath | str:
    """A mechanism ready for lanes; or why only the reference path can compute it.

    Args:
        mechanism: The mechanism.
        weights: Weights of all evaluations; None for those of the mechanism.
        general: Whether dimensions are going to differ from lane to lane.
    """
    if not numba_is_installed():
        return "numba is not installed"
    from vincula.kernels.lanes.program import LaneProgram

    samples = sample_configurations(mechanism)
    if not samples:
        return "no closed configuration was found to prepare lanes with"
    try:
        program = LaneProgram.prepare(mechanism, weights, samples, general=general)
    except VinculaError as error:
        return str(error)
    used = resolved_weights(model_without_numbers(mechanism), weights)
    return LanePath(program, used, weights, mechanism)


@lru_cache(maxsize=1)
def numba_is_installed() -> bool:
    """Whether lanes can be compiled at all."""
    return find_spec("numba") is not None


def refuse_without_numba() -> None:
    """Refuse lanes that were asked for by name.

    Raises:
        MissingExtraError: numba is not installed.
    """
    if not numba_is_installed():
        raise MissingExtraError("numba", "fast", "path='lanes'")


def empty_arrays(quantities: Iterable[Quantity], lanes: int) -> dict[str, NDArray[Any]]:
    """Arrays that lanes write in full."""
    return {q.name: np.empty((lanes, *q.shape), dtype=q.dtype) for q in quantities}
