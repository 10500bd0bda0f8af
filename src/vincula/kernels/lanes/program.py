"""A mechanism made ready for lanes, and what comes out of them.

    program = LaneProgram.prepare(mechanism, weights, samples)
    raw = program.run(values)

What lanes cannot do, or cannot do with certainty, is not done: `prepare` raises `Unsupported` with the
reason, and `run` marks the configurations that the reference path must look at.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from vincula.analysis.recipes import resolved_weights
from vincula.arrays import Matrix, Vector
from vincula.kernels.lanes import tables as t
from vincula.kernels.lanes.flatten import Flat, Unsupported, flatten
from vincula.kernels.lanes.metrics import doubt_constants, metric_constants
from vincula.kernels.lanes.plan import Plan, make_plan, output_size
from vincula.kernels.lanes.threads import cores, pool
from vincula.model import LinearModel
from vincula.numerics.counts import SummaryCounts, TwelveCounts
from vincula.weights import Weights

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism

MOTIONS = 1
"""Wanted: directions of the kinematic ellipsoid."""
EFFORTS = 2
"""Wanted: directions of the force ellipsoids."""
COUNTS = 8
"""Wanted: lanes that are certain of all twelve counts."""
REST = 4
"""Wanted: twists that no motor drives, rates that leave the member at rest."""
SMALLEST_SHARE = 32
"""A thread gets at least so many blocks, so that starting it pays."""


@dataclass(frozen=True, slots=True, eq=False)
class RawLanes:
    """What lanes give, one row a configuration.

    Attributes:
        certain: Whether everything else in the row holds, and the counts of the program; other rows are for
            the reference path.
        residual: Largest gap of a loop in units of the characteristic length.
        angle: Uncertainty of the motions as an angle [rad].
        efficiencies: N x f finite kinematic efficiencies, largest first.  The finite efficiencies of the
            force ellipsoids under the reciprocal metrics are their reciprocals in the opposite order.
        bounds: N x f bounds on the errors of the efficiencies.
        twists: N x f x d unit directions paired with the efficiencies; None unless wanted.
        rates: N x f x n_a their motor side.
        wrenches: N x f x d unit directions of the finite force efficiencies, largest first; or None.
        torques: N x f x n_a their motor side.
        free: N x free x d orthonormal twists, in lengths of the metric; None unless wanted.
        idle: N x idle x n_a orthonormal rates, in lengths of the metric.
    """

    certain: NDArray[np.bool_]
    residual: Vector
    angle: Vector
    efficiencies: Matrix
    bounds: Matrix
    twists: NDArray[np.float64] | None
    rates: NDArray[np.float64] | None
    wrenches: NDArray[np.float64] | None
    torques: NDArray[np.float64] | None
    free: NDArray[np.float64] | None
    idle: NDArray[np.float64] | None


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
        samples: Iterable[Mapping[str, Any]] = (),
        *,
        general: bool = False,
    ) -> LaneProgram:
        """A program for a mechanism with a reference member.

        The ranks that most configurations have are taken from the samples: of those whose ranks are
        certain the ones with the largest ranks count.

        Args:
            mechanism: The mechanism, with its motors.
            weights: Weights; by default those of the mechanism, else the identity.
            samples: Closed configurations.  The home configuration is always one of them.
            general: Whether dimensions are going to differ from lane to lane.

        Raises:
            Unsupported: Something that the reference path alone does.
        """
        flat = flatten(mechanism, general=general)
        models = _generic([mechanism.linearize(q) for q in (mechanism.home, *samples)])
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
        out = np.empty((len(values), self.outputs(want)))
        if len(values):
            self._run(values, constants, want, threads, out)
        return self.named(out, want)

    @property
    def roots(self) -> tuple[Vector, Vector]:
        """Roots of the weights of the motor rates and of the twist components."""
        size, n_a = int(self.code[t.MOTORS] + self.code[t.TWIST]), int(self.code[t.MOTORS])
        roots = self.constants[int(self.code[t.METRIC]) + 2 * size :][:size]
        return roots[:n_a], roots[n_a:]

    def outputs(self, want: int) -> int:
        """Numbers that a kernel writes for one configuration."""
        return output_size(self.counts, int(self.code[t.MOTORS]), int(self.code[t.TWIST]), want)

    def named(self, out: Matrix, want: int) -> RawLanes:
        """What a kernel wrote, N x `outputs(want)`, by name; views, no copies."""
        return _raw(out, self.counts, int(self.code[t.MOTORS]), int(self.code[t.TWIST]), want)

    def _run(
        self, values: Matrix, constants: Matrix | None, want: int, threads: int | None, out: Matrix
    ) -> None:
        from vincula.kernels.lanes.entries import lanes_of_this_machine, spectra_entry

        width = 1 if len(values) == 1 else lanes_of_this_machine()
        run = spectra_entry(width)
        base, given = self._geometry(constants)
        blocks = -(-len(values) // width)
        count = max(1, min(threads or cores(), blocks // SMALLEST_SHARE))
        rows = _rows(values)
        if count == 1:
            run(rows, self.code, given, base, want, 0, blocks, out)
            return
        ends = [blocks * k // count for k in range(count + 1)]
        futures = [
            pool(count).submit(run, rows, self.code, given, base, want, one, two, out)
            for one, two in pairwise(ends)
        ]
        for future in futures:
            future.result()

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


def _generic(models: list[LinearModel]) -> list[LinearModel]:
    """The samples with the largest ranks, of those whose ranks are certain."""
    known = [m for m in models if m.ledger.summary and m.ledger.status == "certain"]
    if not known:
        raise Unsupported("no sample configuration has certain ranks")
    least = min(m.ledger.summary.mobility + m.ledger.summary.indeterminacy for m in known)
    chosen = [m for m in known if m.ledger.summary.mobility + m.ledger.summary.indeterminacy == least]
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


def _raw(out: Matrix, counts: SummaryCounts, n_a: int, d: int, want: int) -> RawLanes:
    """Named parts of the results."""
    f = counts.coordinated
    shapes = [
        (want & MOTIONS, f, d), (want & MOTIONS, f, n_a), (want & EFFORTS, f, d), (want & EFFORTS, f, n_a),
        (want & REST, counts.indeterminacy, d), (want & REST, counts.redundancy, n_a),
    ]  # fmt: skip
    at = 3 + 2 * f
    sides: list[NDArray[np.float64] | None] = []
    for wanted, count, size in shapes:
        sides.append(out[:, at : at + count * size].reshape(len(out), count, size) if wanted else None)
        at += count * size if wanted else 0
    return RawLanes(
        out[:, 0] == 1.0, out[:, 1], out[:, 2], out[:, 3 : 3 + f], out[:, 3 + f : 3 + 2 * f], *sides
    )


def _rows(array: Matrix) -> Any:
    """Contiguous and writable, as the kernels are compiled for."""
    return np.require(array, dtype=np.float64, requirements=["C", "W"])
