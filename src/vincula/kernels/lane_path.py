"""A batch in lanes: chunk after chunk on all threads, and what only the reference path can decide.

A lane counts when every rank is certainly the one that the mechanism has in general; all others, the
singular and the doubtful ones among them, are handed back.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache, partial
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any, Final, get_args

import numpy as np
from numpy.typing import NDArray

from vincula.analysis.ellipsoid import Kind
from vincula.analysis.recipes import ellipsoid_of_kind, resolved_weights
from vincula.arrays import Matrix
from vincula.errors import MissingExtraError, VinculaError
from vincula.kernels.lane_block import LaneBlock
from vincula.kernels.lane_quantities import Listing, Writer, Written, written
from vincula.kernels.lanes.outputs import CONSTANT, OPENED, UNKNOWN
from vincula.kernels.lanes.targets import Tables, address
from vincula.kernels.lanes.threads import pool
from vincula.kernels.memory import aligned, doubles
from vincula.kernels.plans import model_without_numbers
from vincula.kernels.quantities import SIDE_OF, Quantity
from vincula.kernels.reference_path import Arrays
from vincula.kernels.samples import general_ranks
from vincula.mechanism.mechanism import Mechanism
from vincula.mechanism.samples import sample_configurations
from vincula.weights import Quantity as Weighed
from vincula.weights import Weights

if TYPE_CHECKING:
    from vincula.kernels.lane_spectra import LaneRelation, RelationName
    from vincula.kernels.lanes.program import LaneProgram
    from vincula.model import LinearModel

CHUNK: Final = 4096
"""Most lanes that a thread computes at a time: threads take chunks as they get ready."""
LEAST: Final = 512
"""Fewest lanes that are worth a thread's while; chunks are multiples of it."""
BLOCK: Final = 1024
"""The same where quantities are computed from others: what a kernel gives stays in the cache."""
PAST_CACHES: Final = 1 << 22
"""Bytes of results from which they are written past the caches: they would not stay there."""

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
        model: Its matrices at a configuration with the ranks of the program.
        program_weights: What the program is made with: `given_weights`, or others where kernels do not take
            these; everything is then computed from motions.
        replaced: Whether they are others.
    """

    program: LaneProgram
    weights: Weights
    given_weights: Weights | None
    mechanism: Mechanism
    model: LinearModel
    program_weights: Weights | None
    replaced: bool

    def _listing(self, kind: Kind) -> Listing:
        """What an ellipsoid lists in lanes that are certain; made once."""
        if kind not in self._listings:
            self._listings[kind] = self._listed(kind)
        return self._listings[kind]

    @cached_property
    def _listings(self) -> dict[Kind, Listing]:
        return {}

    def _listed(self, kind: Kind) -> Listing:
        from vincula.kernels.prepared_relations import relation_of

        sample = ellipsoid_of_kind(kind, self.model, self.weights)
        of_forces = kind != "internal force" and self.weights.dual
        direct = not self.replaced and (kind == "kinematic" or of_forces)
        return Listing(sample, direct, partial(self._relation, relation_of(kind)))

    def _relation(self, name: RelationName) -> LaneRelation | str:
        """One of the three relations ready for lanes, or why it is not; made once."""
        from vincula.kernels.prepared_relations import lane_relation

        if name not in self._relations:
            self._relations[name] = lane_relation(self.mechanism, self.model, self.weights, name)
        return self._relations[name]

    @cached_property
    def _distances(self) -> Writer:
        """What writes `singularity.distance`."""
        from vincula.kernels.lane_distances import distance_writer

        return distance_writer(self.program, general_ranks(self.mechanism))

    @cached_property
    def _relations(self) -> dict[RelationName, LaneRelation | str]:
        return {}

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
        found: list[tuple[str, Written]] = []
        for quantity in quantities:
            if quantity.name in ("status", "configuration", "reference.pose", *SIDE_OF):
                continue
            if quantity.name == "singularity.distance":
                found.append((quantity.name, Written(writer=self._distances)))
                continue
            listing = None if quantity.kind is None else self._listing(quantity.kind)
            how = written(quantity, self.program.counts, self.program.twelve, listing)
            if isinstance(how, str):
                return f"{quantity.name}: {how}"
            found.append((quantity.name, how))
        return LaneWriters(self, tuple(found))


@dataclass(frozen=True, eq=False)
class LaneWriters:
    """A list of quantities as lanes write them.

    Attributes:
        path: The mechanism in lanes.
        writers: How every quantity is written, by name.
    """

    path: LanePath
    writers: tuple[tuple[str, Written], ...]

    @cached_property
    def want(self) -> int:
        """What the kernel must compute."""
        want = 0
        for _, how in self.writers:
            want |= how.want
        return want

    @cached_property
    def same(self) -> tuple[tuple[str, Any], ...]:
        """Rows that are the same in all lanes, by quantity."""
        return tuple((name, how.same) for name, how in self.writers if how.same is not None)

    @cached_property
    def derived(self) -> tuple[tuple[str, Writer], ...]:
        """What is computed from other results, by quantity."""
        return tuple((name, how.writer) for name, how in self.writers if how.writer is not None)

    @cached_property
    def widest(self) -> float:
        """Lanes measure small gaps: for angles they take the sine.  A large one is measured one by one."""
        return SMALL_GAP if any(name == "closure.residual" for name, _ in self.writers) else np.inf

    def parts(self, arrays: Mapping[str, NDArray[np.float64]], varying: bool = False) -> list[int]:
        """The table by which a kernel writes rows of the arrays.

        Args:
            arrays: One array a quantity.
            varying: Whether to leave out what is the same in all rows.
        """
        found: list[int] = []
        for name, how in self.writers:
            for piece in how.pieces:
                if not (varying and piece.section in CONSTANT):
                    found += self.path.program.part(
                        piece.section, arrays[name], piece.column, piece.start, piece.count
                    )
        return found

    @cached_property
    def doubles(self) -> int:
        """Doubles that a kernel writes for one configuration."""
        return sum(piece.count for _, how in self.writers for piece in how.pieces)

    def staged(self, arrays: Arrays, lanes: int) -> Tables:
        """Tables by which a kernel writes rows past the caches, through small arrays of so many rows.

        What is the same in all rows is in these arrays already.

        Args:
            arrays: One array a quantity, each beginning at a line of the cache.
            lanes: Number of rows.
        """
        named = [name for name, how in self.writers if how.pieces]
        sizes = [math.prod(arrays[name].shape[1:]) for name in named]
        whole = aligned(lanes * sum(sizes))
        small: dict[str, NDArray[np.float64]] = {}
        copies: list[int] = []
        at = 0
        for name, size in zip(named, sizes, strict=True):
            small[name] = whole[at : at + lanes * size].reshape(lanes, size)
            at += lanes * size
            copies += [address(small[name]), address(arrays[name]), size]
        for name, how in self.writers:
            for piece in how.pieces:
                if piece.section in CONSTANT:
                    small[name][:, piece.column : piece.column + piece.count] = CONSTANT[piece.section]
        parts = np.array(self.parts(small, varying=True), dtype=np.int64)
        return Tables(parts, np.array(copies, dtype=np.int64), whole)

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
        count, status = len(values), arrays["status"]
        rows = np.require(values, dtype=np.float64, requirements=["C", "W"])
        numbers = None if constants is None else np.require(constants, np.float64, ["C", "W"])
        share = -(-count // (4 * threads * LEAST)) * LEAST
        size = min(BLOCK if self.derived else CHUNK, max(share, LEAST))

        def chunk(first: int) -> None:
            self._chunk(rows, numbers, arrays, first, min(first + size, count))

        starts = range(0, count, size)
        if threads > 1 and len(starts) > 1:
            for _ in pool(threads).map(chunk, starts):
                pass
        else:
            for first in starts:
                chunk(first)
        if "closure.residual" in arrays:
            # The first constant is one over the characteristic length.
            scales = self.path.program.constants[0] if constants is None else constants[:, 0]
            arrays["closure.residual"] *= 1.0 / scales
        found = np.flatnonzero(status)
        opened = status[found] == OPENED
        return found[~opened], found[opened]

    def _chunk(self, values: Matrix, constants: Matrix | None, arrays: Arrays, first: int, last: int) -> None:
        """Lanes first ... last - 1."""
        program, status = self.path.program, arrays["status"]
        for name, row in self.same:
            arrays[name][first:last] = row
        if self.derived:
            raw = np.empty((last - first, program.outputs(self.want)))
            parts = self.parts(arrays) + program.raw_parts(self.want, raw, first)
            tables = Tables(np.array(parts, dtype=np.int64))
        elif 8 * self.doubles * len(values) >= PAST_CACHES:
            tables = self.staged(arrays, program.width(len(values)))
        else:
            tables = Tables(np.array(self.parts(arrays), dtype=np.int64))
        program.deliver(values, constants, self.want, self.widest, tables, status, span=(first, last))
        if self.derived:
            own = None if constants is None else constants[first:last]
            given = program.named(raw, status[first:last], self.want)
            block = LaneBlock(program, given, values[first:last], own)
            self.derive(block, {name: arrays[name][first:last] for name, _ in self.derived})
            status[first:last][given.certain & ~block.sure] = UNKNOWN

    def derive(self, block: LaneBlock, arrays: Arrays) -> None:
        """Write what is computed from other results; lanes that turn out doubtful are marked in the block."""
        with np.errstate(all="ignore"):  # lanes that are not certain hold anything
            for name, writer in self.derived:
                writer(block, arrays[name])


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
    from vincula.kernels.prepared_relations import weights_for_kernels

    samples = sample_configurations(mechanism)
    if not samples:
        return "no closed configuration was found to prepare lanes with"
    nothing = model_without_numbers(mechanism)
    used = resolved_weights(nothing, weights)
    own, replaced = weights_for_kernels(nothing, weights, used)
    models = [mechanism.linearize(q) for q in samples]
    try:
        program = LaneProgram.prepare(mechanism, own, models, general=general)
    except VinculaError as error:
        return str(error)
    model = next(m for m in models if m.ledger.status == "certain" and m.ledger.summary == program.counts)
    return LanePath(program, used, weights, mechanism, model, own, replaced)


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
    return {
        q.name: doubles((lanes, *q.shape)) if q.dtype is np.float64 else np.empty((lanes, *q.shape), q.dtype)
        for q in quantities
    }
