"""The waist of the hourglass: J_a, J_p and G at one configuration, with names, units and scales.

Every source (a mechanism, a robot file, a live simulation, bare matrices) ends in a `LinearModel`;
every analysis starts from one.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from vincula.arrays import Matrix, Vector, checked, frozen
from vincula.errors import DuplicateNameError, ModelError, ShapeError, UnknownNameError
from vincula.labels import BodyMotions, Column, Cut, Row, ScaledMatrices, Uncertainty, _All, power_of_two
from vincula.numerics.evidence import NO_EVIDENCE, Evidence
from vincula.spatial.space import PLANAR, SPATIAL, Space

if TYPE_CHECKING:
    from vincula.numerics.evidence import NearestSingular
    from vincula.numerics.exact_blocks import ExactBlocks
    from vincula.numerics.ledger import MatrixName, RankLedger
    from vincula.weights import Weights


@dataclass(frozen=True, eq=False)
class LinearModel:
    """J_a, J_p and G of eqs. (1) and (15) at one configuration.

    Attributes:
        jacobian_active: J_a, m x n_a, rows m/s or rad/s per unit motor rate.
        jacobian_passive: J_p, m x n_p.
        grasp: G, d x m; G^T u is the velocity of the member side of every row.
        rows: Name, kind and unit of every row.
        motors: Names and units of the active columns.
        passives: Names and units of the passive columns.
        space: PLANAR or SPATIAL; None for bare matrices of another dimension.
        length: Characteristic length L [m], a power of two; None for bare matrices without one.
        uncertainty: Errors beyond rounding.
        mechanism: Name of the mechanism.
        reference: The reference member and point, in words.
        frame: Axes of twist and wrench, in words.
        cuts: How the graph was opened.
        notes: Facts that the reader of a result must know.
        weights: Weights declared with the model, None for the unit default.
        motions: Geometry for verdicts; None for bare matrices.
        evidence: What is known about doubtful ranks beside the matrices.
        exact: Gives the matrices exactly, for proofs; None where they are known as doubles only.
        nearest: Finds the singular configuration nearest to this one, given the doubtful ranks.
    """

    jacobian_active: Matrix
    jacobian_passive: Matrix
    grasp: Matrix
    rows: tuple[Row, ...]
    motors: tuple[Column, ...]
    passives: tuple[Column, ...]
    space: Space | None
    length: float | None = None
    uncertainty: Uncertainty = field(default_factory=Uncertainty)
    mechanism: str = "matrices"
    reference: str = "member"
    frame: str = "as given"
    cuts: tuple[Cut, ...] = ()
    notes: tuple[str, ...] = ()
    weights: Weights | None = None
    motions: BodyMotions | None = None
    evidence: Evidence = NO_EVIDENCE
    exact: Callable[[LinearModel], ExactBlocks] | None = None
    nearest: Callable[[tuple[MatrixName, ...]], NearestSingular | None] | None = None

    def __post_init__(self) -> None:
        m = len(self.rows)
        _refuse_bad_length(self.length)
        for name, matrix, shape in (
            ("jacobian_active", self.jacobian_active, (m, len(self.motors))),
            ("jacobian_passive", self.jacobian_passive, (m, len(self.passives))),
            ("grasp", self.grasp, (None, m)),
        ):
            object.__setattr__(self, name, checked(matrix, name, shape))
        if self.space is not None and self.grasp.shape[0] != self.space.dimension:
            raise ShapeError("grasp", self.grasp.shape, f"({self.space.dimension}, {m})")
        _refuse_duplicates("row", [row.name for row in self.rows])
        _refuse_duplicates("joint axis", [c.name for c in (*self.motors, *self.passives)])

    @staticmethod
    def from_matrices(
        J: ArrayLike,
        G: ArrayLike,
        active: Sequence[int | str] | Sequence[bool] | str | _All,
        *,
        columns: Sequence[str] | None = None,
        rows: Sequence[str] | None = None,
        linear_columns: Sequence[bool] | None = None,
        linear_rows: Sequence[bool] | None = None,
        length: float | None = None,
        name: str = "matrices",
    ) -> LinearModel:
        """A model from a bare Jacobian and grasp matrix.

        Args:
            J: m x n Jacobian, rows already selected.
            G: d x m grasp matrix, as in w = G f.
            active: Indices (or names in `columns`) of the active columns, or n booleans; `ALL` for
                every column.
            columns: Names of the n joints, `q1` ... by default.
            rows: Names of the m rows, `row1` ... by default.
            linear_columns: For every column, whether its rate is in m/s (default: rad/s).
            linear_rows: For every row, whether it is in m/s (default: m/s).
            length: Characteristic length [m], rounded to a power of two; without one nothing is scaled.
            name: Name of the mechanism in results.

        Raises:
            ShapeError: J and G do not fit together.
            NonFiniteError: NaN or infinity in J or G.
            UnknownNameError: An active column that does not exist.
            DuplicateNameError: A name, or an active column, given twice.
            ModelError: A length that is not positive, or an active column that is neither index nor name.
        """
        jacobian = checked(J, "J", (None, None))
        m, n = jacobian.shape
        grasp = checked(G, "G", (None, m))
        d = grasp.shape[0]
        names = _names(columns, n, "q", "columns")
        row_names = _names(rows, m, "row", "rows")
        _refuse_bad_length(length)
        col_linear = _flags(linear_columns, n, False, "linear_columns")
        row_linear = _flags(linear_rows, m, True, "linear_rows")
        chosen = _active_indices(active, names)
        rest = [i for i in range(n) if i not in set(chosen)]
        column = [Column(names[i], names[i], col_linear[i]) for i in range(n)]
        return LinearModel(
            jacobian_active=jacobian[:, chosen],
            jacobian_passive=jacobian[:, rest],
            grasp=grasp,
            rows=tuple(Row(r, "contact", r, lin) for r, lin in zip(row_names, row_linear, strict=True)),
            motors=tuple(column[i] for i in chosen),
            passives=tuple(column[i] for i in rest),
            space={3: PLANAR, 6: SPATIAL}.get(d),
            length=length if length is None else power_of_two(length),
            mechanism=name,
            exact=_exact_doubles,
        )

    @property
    def dimension(self) -> int:
        """Number of twist components d."""
        return int(self.grasp.shape[0])

    @property
    def twist_components(self) -> tuple[str, ...]:
        """Names of the twist components."""
        if self.space:
            return self.space.twist_components
        return tuple(f"u{i + 1}" for i in range(self.dimension))

    @property
    def wrench_components(self) -> tuple[str, ...]:
        """Names of the wrench components."""
        if self.space:
            return self.space.wrench_components
        return tuple(f"w{i + 1}" for i in range(self.dimension))

    @property
    def twist_units(self) -> tuple[str, ...]:
        """Units of the twist components."""
        return self.space.twist_units if self.space else ("",) * self.dimension

    @property
    def wrench_units(self) -> tuple[str, ...]:
        """Units of the wrench components."""
        return self.space.wrench_units if self.space else ("",) * self.dimension

    @property
    def twist_linear(self) -> tuple[bool, ...]:
        """Which twist components are linear velocities."""
        s = self.space.translations if self.space else self.dimension
        return tuple(i < s for i in range(self.dimension))

    @property
    def columns(self) -> tuple[Column, ...]:
        """Active, then passive columns."""
        return (*self.motors, *self.passives)

    @cached_property
    def scaled(self) -> ScaledMatrices:
        """The matrices in scaled units: numerics page, step 1.

        Linear rows are divided by L, linear columns (prismatic rates, linear twist components)
        multiplied by it; L is a power of two, so every scaling is exact.
        """
        size = 1.0 if self.length is None else self.length
        row = _factors([r.linear for r in self.rows], 1.0 / size)
        active = _factors([c.linear for c in self.motors], size)
        passive = _factors([c.linear for c in self.passives], size)
        twist = _factors(self.twist_linear, size)
        return ScaledMatrices(
            active=frozen(row[:, None] * self.jacobian_active * active),
            passive=frozen(row[:, None] * self.jacobian_passive * passive),
            member=frozen(row[:, None] * self.grasp.T * twist),
            row=row,
            active_column=active,
            passive_column=passive,
            twist=twist,
        )

    @cached_property
    def ledger(self) -> RankLedger:
        """The ranks of this model: one ledger, shared by every analysis, evaluated on demand."""
        from vincula.numerics.ledger import RankLedger

        return RankLedger.of_model(self)

    def with_weights(self, weights: Weights | None) -> LinearModel:
        """The same model with other default weights."""
        return replace(self, weights=weights)


def _exact_doubles(model: LinearModel) -> ExactBlocks:
    """Bare matrices as given: every double is the binary fraction that it is."""
    from vincula.numerics.exact_blocks import ExactBlocks

    return ExactBlocks.of_doubles(model.jacobian_active, model.jacobian_passive, model.grasp.T)


def _factors(linear: Sequence[bool], factor: float) -> Vector:
    return frozen(np.array([factor if flag else 1.0 for flag in linear], dtype=float))


def _refuse_duplicates(kind: str, names: Sequence[str]) -> None:
    seen: set[str] = set()
    for name in names:
        if name in seen:
            raise DuplicateNameError(kind, name)
        seen.add(name)


def _names(given: Sequence[str] | None, count: int, prefix: str, what: str) -> list[str]:
    if given is None:
        return [f"{prefix}{i + 1}" for i in range(count)]
    if len(given) != count:
        raise ShapeError(what, (len(given),), f"({count},)")
    return list(given)


def _flags(given: Sequence[bool] | None, count: int, default: bool, what: str) -> list[bool]:
    if given is None:
        return [default] * count
    if len(given) != count:
        raise ShapeError(what, (len(given),), f"({count},)")
    return [bool(value) for value in given]


def _refuse_bad_length(length: object) -> None:
    number = isinstance(length, (int, float, np.integer, np.floating)) and not isinstance(length, bool)
    if length is not None and not (number and math.isfinite(float(length)) and float(length) > 0.0):  # type: ignore[arg-type]
        raise ModelError(f"characteristic length is {length!r}: give a positive number of metres, or None")


def _active_indices(
    active: Sequence[int | str] | Sequence[bool] | str | _All, names: Sequence[str]
) -> list[int]:
    if isinstance(active, _All) or (isinstance(active, str) and active == "all" and "all" not in names):
        return list(range(len(names)))
    if isinstance(active, str):
        return [_active_index(active, names)]
    if not isinstance(active, Iterable):
        raise ModelError(f"active is {active!r}: give a list of indices or names, booleans, or ALL")
    given = list(active)
    if given and all(isinstance(a, (bool, np.bool_)) for a in given):
        if len(given) != len(names):
            raise ShapeError("active", (len(given),), f"({len(names)},) booleans")
        return [i for i, flag in enumerate(given) if flag]
    chosen = [_active_index(item, names) for item in given]
    for index in chosen:
        if chosen.count(index) > 1:
            raise DuplicateNameError("active column", names[index])
    return chosen


def _active_index(item: int | str | bool, names: Sequence[str]) -> int:
    if isinstance(item, str):
        if item not in names:
            raise UnknownNameError("column", item, names)
        return list(names).index(item)
    if not isinstance(item, (int, np.integer)) or isinstance(item, (bool, np.bool_)):
        raise ModelError(f"active column {item!r}: give an index, a name, or one boolean a column")
    if not 0 <= item < len(names):
        raise UnknownNameError("column", str(item), [str(i) for i in range(len(names))])
    return int(item)
