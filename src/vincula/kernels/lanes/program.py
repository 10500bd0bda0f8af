"""A mechanism made ready for lanes, and what comes out of them.

    program = LaneProgram.prepare(mechanism, weights, samples)
    raw = program.run(values)

What lanes cannot do, or cannot do with certainty, is not done: `prepare` raises `Unsupported` with the
reason, and `run` marks the configurations that the reference path must look at.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from vincula.analysis.recipes import resolved_weights
from vincula.arrays import Matrix, Vector
from vincula.kernels.lanes import outputs as o
from vincula.kernels.lanes import tables as t
from vincula.kernels.lanes.flatten import Flat, Unsupported, flatten
from vincula.kernels.lanes.metrics import doubt_constants, metric_constants
from vincula.kernels.lanes.outputs import BOUNDS, COUNTS, EFFORTS, MOTIONS, REST, SHARED
from vincula.kernels.lanes.plan import Plan, make_plan
from vincula.kernels.lanes.raw_lanes import RawLanes, named, wanted
from vincula.kernels.lanes.targets import NOTHING, Tables, address
from vincula.kernels.lanes.threads import in_shares
from vincula.kernels.quantities import WATCHED
from vincula.model import LinearModel
from vincula.numerics.counts import SummaryCounts, TwelveCounts
from vincula.weights import Weights

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism

__all__ = ["BOUNDS", "COUNTS", "EFFORTS", "MOTIONS", "REST", "LaneProgram", "RawLanes", "dense_matrices"]

SMALLEST_SHARE = 32
"""A thread gets at least so many blocks, so that starting it pays."""


@dataclass(frozen=True, eq=False)
class LaneProgram:
    """A mechanism as flat arrays, with the order of its elimination.

    It may be used by several threads at once.

    Attributes:
        mechanism: The mechanism.
        flat: Its arrays.
        plan: Ranks, structure and orders.
        code: The tables of the plan.
        constants: Geometry, metrics and doubts; what a lane may have of its own.
        general: Whether constants may differ from lane to lane.
    """

    mechanism: Mechanism
    flat: Flat
    plan: Plan
    code: NDArray[np.int64]
    constants: Vector
    general: bool

    @staticmethod
    def prepare(
        mechanism: Mechanism,
        weights: Weights | None = None,
        samples: Iterable[Mapping[str, Any] | LinearModel] = (),
        *,
        general: bool = False,
    ) -> LaneProgram:
        """A program for a mechanism with a reference member.

        The ranks that most configurations have are taken from the samples: of those whose ranks are
        certain the ones with the largest ranks count.

        Args:
            mechanism: The mechanism, with its motors.
            weights: Weights; by default those of the mechanism, else the identity.
            samples: Closed configurations, or the matrices there; by default the home configuration.
            general: Whether dimensions are going to differ from lane to lane.

        Raises:
            Unsupported: Something that the reference path alone does.
        """
        flat = flatten(mechanism, general=general)
        given = tuple(samples) or (mechanism.home,)
        models = _generic([q if isinstance(q, LinearModel) else mechanism.linearize(q) for q in given])
        constants, where = _constants(mechanism, flat, models[0], weights)
        plan = make_plan(flat, mechanism.layout, [m.ledger for m in models], where)
        return LaneProgram(mechanism, flat, plan, plan.code, constants, general)

    @property
    def twelve(self) -> TwelveCounts | None:
        """The twelve counts of every configuration that is certain when `COUNTS` are wanted.

        None where no sample was certain of them: then they cannot be wanted.
        """
        return self.plan.twelve

    @property
    def counts(self) -> SummaryCounts:
        """The summary counts of every certain configuration."""
        return self.plan.counts

    def constants_of(self, variant: Mechanism, weights: Weights | None = None) -> Vector:
        """Constants of the same mechanism with other dimensions, for one lane.

        Raises:
            Unsupported: The program is not general, or the variant has another structure.
        """
        flat = flatten(variant, general=self.general)
        if not self.general or not np.array_equal(flat.code, self.flat.code):
            raise Unsupported("the variant has another structure")
        return _constants(variant, flat, variant.linearize(), weights)[0]

    def run(
        self,
        values: Matrix,
        constants: Matrix | None = None,
        *,
        want: int = 0,
        threads: int | None = None,
    ) -> RawLanes:
        """Spectra of many configurations.

        The bits of a row do not depend on the other rows, nor on the number of threads.

        Args:
            values: N x values, in the order of the configuration [m, rad, quaternions w x y z].
            constants: N x constants (`constants_of`) for dimensions that differ from lane to lane.
            want: `MOTIONS`, `EFFORTS`, `REST` and `COUNTS`, added up.
            threads: Threads to use; by default one a core.
        """
        lanes, want = len(values), want | BOUNDS
        raw, status = np.empty((lanes, self.outputs(want))), np.empty(lanes, dtype=np.uint8)
        tables = Tables(np.array(self.raw_parts(want, raw), dtype=np.int64))
        self.deliver(_rows(values), constants, want, np.inf, tables, status, threads)
        return self.named(raw, status, want)

    def deliver(
        self,
        values: Matrix,
        constants: Matrix | None,
        want: int,
        widest: float,
        tables: Tables,
        status: NDArray[np.uint8],
        threads: int | None = 1,
        span: tuple[int, int] | None = None,
    ) -> None:
        """Spectra of many configurations, written where a table says.

        Args:
            values: N x values, contiguous and writable.
            constants: As in `run`.
            want: What is wanted; see `outputs`.
            widest: Gaps up to this, in units of the length, are measured well enough to call a loop open.
            tables: What goes where; with copies in them for one thread only.
            status: N: 0 certain, `OPENED`, `UNKNOWN`.
            threads: Threads to use; None for one a core.
            span: First and last configuration, by default all: multiples of `BLOCK_LANES`, or the end.
        """
        from vincula.kernels.lanes.entries import spectra_entry

        first, last = span or (0, len(values))
        if last <= first:
            return
        width = self.width(len(values))
        run = spectra_entry(width)
        base, given = self._geometry(constants)
        want |= self.shared

        def blocks(one: int, two: int) -> None:
            run(values, self.code, given, base, want, widest, start + one, start + two, *where)

        start, where = first // width, (tables.parts, tables.copies, status)
        in_shares(blocks, -(-last // width) - start, threads, SMALLEST_SHARE)

    def width(self, lanes: int) -> int:
        """How many lanes run side by side."""
        from vincula.kernels.lanes.entries import lanes_of_this_machine

        return 1 if lanes == 1 else lanes_of_this_machine()

    def one_lane(
        self, want: int, widest: float
    ) -> Callable[[Matrix, NDArray[np.int64], NDArray[np.uint8]], None]:
        """`deliver` for one configuration, with everything looked up: takes values, table and status."""
        from vincula.kernels.lanes.entries import spectra_entry

        run, code, constants, flags = spectra_entry(1), self.code, self.constants, want | self.shared

        def one(values: Matrix, table: NDArray[np.int64], status: NDArray[np.uint8]) -> None:
            run(values, code, constants, 0, flags, widest, 0, 1, table, NOTHING, status)

        return one

    @cached_property
    def sections(self) -> dict[str, o.Section]:
        """Where results stand, by name."""
        return o.sections(self.counts, int(self.code[t.MOTORS]), int(self.code[t.TWIST]))

    def part(
        self, name: str, out: NDArray[np.float64], column: int, start: int = 0, count: int | None = None
    ) -> list[int]:
        """A part of a table: numbers of a section to a column of an array and those after it.

        Args:
            name: The section; `infinity`, `zero` and `nothing` are repeated.
            out: N x ... array, contiguous.
            column: First of the numbers of a row.
            start: First number of the section.
            count: How many; all that are left by default.
        """
        section = self.sections[name]
        stride = out.strides[0] // 8
        step = 0 if name in o.CONSTANT else 1
        length = section.size - start if count is None else count
        return [section.first + start, step, length, address(out) + 8 * column, stride]

    def raw_parts(self, want: int, raw: Matrix, first: int = 0) -> list[int]:
        """The table that writes everything wanted to the rows of one array, N x `outputs(want)`.

        Args:
            want: What is wanted.
            raw: The array.
            first: The configuration that its first row is for.
        """
        found: list[int] = []
        column = -first * raw.shape[1]
        for name in wanted(want):
            found += self.part(name, raw, column)
            column += self.sections[name].size
        return found

    @cached_property
    def shared(self) -> int:
        """`SHARED` where results of motions and efforts are weighed alike."""
        size = int(self.code[t.MOTORS] + self.code[t.TWIST])
        of_results = self.constants[int(self.code[t.METRIC]) + size :][: 2 * size]
        return SHARED if np.array_equal(of_results[:size], of_results[size:]) else 0

    @property
    def roots(self) -> tuple[Vector, Vector]:
        """Roots of the weights of the motor rates and of the twist components."""
        size, n_a = int(self.code[t.MOTORS] + self.code[t.TWIST]), int(self.code[t.MOTORS])
        roots = self.constants[int(self.code[t.METRIC]) + 2 * size :][:size]
        return roots[:n_a], roots[n_a:]

    def outputs(self, want: int) -> int:
        """Numbers that `run` writes for one configuration."""
        return sum(self.sections[name].size for name in wanted(want))

    def named(self, raw: Matrix, status: NDArray[np.uint8], want: int) -> RawLanes:
        """What `raw_parts(want, raw)` wrote, by name; views, no copies."""
        return named(self.sections, raw, status, want)

    def matrices(self, values: Matrix, constants: Matrix | None = None) -> NDArray[np.float64]:
        """A = [J_a J_p -G^T] in scaled units, N x m x (n_a + n_p + d), at any values, closed or not.

        Args:
            values: N x values, in the order of the configuration [m, rad].
            constants: N x constants for dimensions that differ from lane to lane.
        """
        base, given = self._geometry(constants)
        return dense_matrices(self.code, int(self.code[t.EVERY_COLUMN]), given, base, values)

    def _geometry(self, constants: Matrix | None) -> tuple[int, Any]:
        """First slot after constants, and the constants."""
        return (0, self.constants) if constants is None else (constants.shape[1], _rows(constants))


def dense_matrices(
    code: NDArray[np.int64], columns: int, constants: Any, base: int, values: Matrix
) -> NDArray[np.float64]:
    """Whole matrices in lanes: `LaneProgram.matrices`, without a plan.

    Args:
        code: Tables, with a list of all columns.
        columns: Where that list is.
        constants: Constants.
        base: First slot after constants that differ from lane to lane.
        values: N x values.
    """
    from vincula.kernels.lanes.entries import dense_entry, lanes_of_this_machine

    m, n = int(code[t.ROWS]), int(code[t.COLUMNS] + code[t.TWIST])
    out = np.zeros((len(values), m, n))
    if len(values):
        width = 1 if len(values) == 1 else lanes_of_this_machine()
        slots = base + int(code[t.SLOTS]) + m * n
        dense_entry(width)(_rows(values), code, constants, base, columns, slots, out)
    return out


def singular_values_of(
    program: LaneProgram, values: Matrix, constants: Matrix | None, matrices: NDArray[np.int64]
) -> Matrix:
    """Chosen singular values of parts of A = [J_a J_p -G^T] in scaled units, N x parts.

    Args:
        program: The mechanism.
        values: N x values.
        constants: N x constants for dimensions that differ from lane to lane.
        matrices: For every part first column, column after the last, and which value, 1 the largest.
    """
    from vincula.kernels.lanes.distance_entry import distance_entry

    base, given = (0, program.constants) if constants is None else (constants.shape[1], _rows(constants))
    out = np.empty((len(values), len(matrices)))
    if len(values):
        columns = int(program.code[t.EVERY_COLUMN])
        run = distance_entry(program.width(len(values)))
        run(_rows(values), program.code, given, base, columns, matrices.ravel(), out)
    return out


def _generic(models: list[LinearModel]) -> list[LinearModel]:
    """The samples with the largest ranks, of those whose ranks are certain."""
    known = [m for m in models if m.ledger.summary and m.ledger.status == "certain"]
    if not known:
        raise Unsupported("no sample configuration has certain ranks")
    sizes = [sum(m.ledger.rank(name) for name in WATCHED) for m in known]
    chosen = [m for m, size in zip(known, sizes, strict=True) if size == max(sizes)]
    return [m for m in chosen if m.ledger.summary == chosen[-1].ledger.summary]


def _constants(
    mechanism: Mechanism, flat: Flat, model: LinearModel, weights: Weights | None
) -> tuple[Vector, dict[str, int]]:
    """Geometry, then metrics, then doubts; and where the last two begin."""
    used = resolved_weights(model, weights)
    metric = metric_constants(model, used.metric("twist", model), used.metric("rate", model))
    curvature = float(max(1, mechanism.layout.longest))
    parts = [flat.constants, metric, doubt_constants(model), np.array([curvature])]
    where = {"metric": len(parts[0]), "doubt": len(parts[0]) + len(parts[1])}
    return np.concatenate(parts), where


def _rows(array: Matrix) -> Any:
    """Contiguous and writable, as the kernels are compiled for."""
    return np.require(array, dtype=np.float64, requirements=["C", "W"])
