"""Gradients of a batch: configurations with the same ranks together, the others one by one.

The evaluation of a slab of configurations says which ranks they have, and gives efficiencies with their pairs
of directions.  What is certain and regular is computed together; what is open, doubtful or singular goes to
the path for one configuration, which knows the words for it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from vincula.analysis.indices import components_of_part
from vincula.analysis.recipes import ellipsoid_of_kind, resolved_weights
from vincula.arrays import Matrix
from vincula.errors import VinculaError
from vincula.kernels.dimensions import Dimensions, dimensions_at
from vincula.kernels.gradient_reasons import GradientReasons
from vincula.kernels.gradients_one_by_one import SMOOTH, gradient_at
from vincula.kernels.inputs import Batch
from vincula.kernels.many_derivatives import ManyDerivatives, Question
from vincula.kernels.plans import model_without_numbers
from vincula.kernels.quantities import Quantity

if TYPE_CHECKING:
    from vincula.kernels.compiled import CompiledMechanism
    from vincula.mechanism.mechanism import Mechanism

SLAB: Final = 1 << 25
"""Bytes that the numbers of one slab of configurations may take, about."""
MOST: Final = 2048
"""Most configurations of a slab."""


@dataclass(frozen=True, slots=True, eq=False)
class Gradients:
    """Derivatives of one quantity, lanes first.

    Attributes:
        values: The quantity, lanes x entries.
        slopes: Its derivatives, lanes x entries x names.
        smooth: Which exist, lanes x entries.
        reasons: Why one does not, by lane and entry.
    """

    values: NDArray[np.float64]
    slopes: NDArray[np.float64]
    smooth: NDArray[np.bool_]
    reasons: GradientReasons

    @staticmethod
    def none(lanes: int, entries: tuple[int, ...], names: int) -> Gradients:
        """Nothing known yet."""
        shape = (lanes, *entries)
        return Gradients(
            np.full(shape, np.nan),
            np.full((*shape, names), np.nan),
            np.zeros(shape, dtype=bool),
            GradientReasons(shape),
        )

    def refuse(self, lanes: Sequence[int] | NDArray[np.intp], words: str) -> None:
        """Give a reason for all entries of some lanes."""
        for lane in lanes:
            for entry in np.ndindex(*self.values.shape[1:]):
                self.reasons[int(lane), *entry] = words


def evaluate_gradients(
    compiled: CompiledMechanism,
    batch: Batch,
    asked: Quantity,
    wrt: str | Sequence[str],
    names: tuple[str, ...],
) -> Gradients:
    """Derivatives of a quantity at all configurations of a batch.

    Args:
        compiled: The mechanism.
        batch: Whole configurations.
        asked: The quantity.
        wrt: `motors`, `joints`, or names of parameters.
        names: What it is differentiated by.
    """
    found = Gradients.none(batch.lanes, asked.shape, len(names))
    for settings, lanes in _geometries(batch):
        mechanism = compiled.variants.tried(settings)
        if isinstance(mechanism, str):
            found.refuse(lanes, mechanism)
            continue
        try:
            _refuse_mixed_units(compiled, mechanism, asked)
            dimensions = (
                None
                if isinstance(wrt, str)
                else dimensions_at(compiled.variants, compiled.weights, names, settings)
            )
        except VinculaError as error:
            found.refuse(lanes, f"{type(error).__name__}: {error}")
            continue
        work = _OneGeometry(compiled, mechanism, batch, asked, wrt, names, dimensions)
        for slab in work.slabs(lanes):
            work.fill(found, slab)
    return found


def _geometries(batch: Batch) -> Iterator[tuple[dict[str, float], NDArray[np.intp]]]:
    """Sets of parameters with the lanes that have them."""
    if not batch.parameters or not batch.lanes:
        if batch.lanes:
            yield {}, np.arange(batch.lanes)
        return
    table = np.column_stack(list(batch.parameters.values()))
    _, first, which = np.unique(table, axis=0, return_index=True, return_inverse=True)
    order = np.argsort(which.ravel(), kind="stable")
    ends = np.cumsum(np.bincount(which.ravel()))
    for lane, lanes in zip(first, np.split(order, ends[:-1]), strict=True):
        yield batch.parameters_at(int(lane)), lanes


def _refuse_mixed_units(compiled: CompiledMechanism, mechanism: Mechanism, asked: Quantity) -> None:
    """Refuse an index that does not exist, by names, units and weights alone.

    Raises:
        MixedUnitsError: An index over metres and radians with weights that nobody chose.
        ModelError: An index of components that do not exist.
    """
    if asked.kind is not None and asked.part in SMOOTH:
        model = model_without_numbers(mechanism)
        probe = ellipsoid_of_kind(asked.kind, model, resolved_weights(model, compiled.weights))
        components_of_part(probe, asked.on)


class _OneGeometry:
    """Configurations of one mechanism with one set of dimensions."""

    def __init__(
        self,
        compiled: CompiledMechanism,
        mechanism: Mechanism,
        batch: Batch,
        asked: Quantity,
        wrt: str | Sequence[str],
        names: tuple[str, ...],
        dimensions: Dimensions | None,
    ) -> None:
        self.compiled, self.mechanism, self.batch = compiled, mechanism, batch
        self.asked, self.wrt, self.names, self.dimensions = asked, wrt, names, dimensions
        self.question = Question.of(compiled, mechanism, asked)

    def slabs(self, lanes: NDArray[np.intp]) -> Iterator[NDArray[np.intp]]:
        """The lanes in slabs that fit into memory."""
        layout, d = self.mechanism.layout, self.mechanism.space.dimension
        rows, columns = len(layout.rows), len(layout.columns) + d
        frames, entries = len(layout.frames.carrier), len(layout.active) + d
        numbers = 6 * rows * columns + 2 * columns * columns + 72 * entries * (rows + columns + frames)
        if self.dimensions is not None:
            numbers += 24 * len(self.names) * (frames + columns)
        size = int(np.clip(SLAB // (8 * numbers), 1, MOST))
        for first in range(0, len(lanes), size):
            yield lanes[first : first + size]

    def fill(self, found: Gradients, lanes: NDArray[np.intp]) -> None:
        """Derivatives of one slab."""
        home = self.mechanism.home.flat
        given = self.batch.values
        values: Matrix = np.tile(home, (len(lanes), 1)) if given is None else given[lanes]
        slab = replace(
            self.batch,
            shape=(len(lanes),),
            values=values,
            parameters={name: numbers[lanes] for name, numbers in self.batch.parameters.items()},
        )
        arrays = self.compiled.arrays(self.question.names, slab)
        derivatives = ManyDerivatives(self.mechanism, self.question, self.wrt, self.dimensions)
        done = np.zeros(len(lanes), dtype=bool)
        for group in self.question.groups(arrays):
            part = derivatives.of(values[group], {name: array[group] for name, array in arrays.items()})
            if part is None:
                continue
            kept = group[part.certain]
            done[kept] = True
            places = lanes[kept]
            found.values[places] = part.values[part.certain]
            found.slopes[places] = part.slopes[part.certain]
            found.smooth[places] = part.smooth[part.certain]
            for (place, *entry), words in part.reasons.items():
                if part.certain[place]:
                    found.reasons[int(lanes[group[place]]), *entry] = words
        for k in np.flatnonzero(~done):
            self._one(found, int(lanes[k]), None if given is None else values[k])

    def _one(self, found: Gradients, lane: int, flat: Matrix | None) -> None:
        one = gradient_at(
            self.compiled, self.mechanism, flat, self.asked, self.wrt, self.names, self.dimensions
        )
        if isinstance(one, str):
            found.refuse([lane], one)
            return
        for entry, (derivative, slope) in zip(np.ndindex(*self.asked.shape), one, strict=False):
            found.values[(lane, *entry)] = derivative.value
            found.slopes[(lane, *entry)] = slope.values
            found.smooth[(lane, *entry)] = not slope.reason
            if slope.reason:
                found.reasons[lane, *entry] = slope.reason
