"""Gradients of indices along the closed manifold: by motors, by all joints, by declared dimensions."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vincula.analysis.ellipsoid import Ellipsoid
from vincula.analysis.index_sensitivity import Derivative, efficiency_derivative, index_derivative
from vincula.analysis.recipes import (
    ellipsoid_of_kind,
    motor_quantity,
    resolved_weights,
    task_quantity,
)
from vincula.analysis.sensitivity import Sensitivities
from vincula.arrays import Matrix, Vector
from vincula.errors import ClosureError, ModelError, UnknownNameError, VinculaError, listing
from vincula.kernels.dimensions import Dimensions, dimensions_at
from vincula.kernels.inputs import batch_of
from vincula.kernels.quantities import Quantity
from vincula.kernels.tangents import Direction, Tangents
from vincula.mechanism.mechanism import Mechanism
from vincula.numerics.lapack import svd
from vincula.numerics.rank import decide_rank

if TYPE_CHECKING:
    from vincula.kernels.compiled import CompiledMechanism

SMOOTH: Final = {
    "yoshikawa_volume": "yoshikawa_volume",
    "condition": "condition_number",
    "condition_number": "condition_number",
    "inverse_condition_number": "inverse_condition_number",
    "isotropy": "isotropy",
    "smallest_singular_value": "smallest_singular_value",
}
"""Indices with a derivative, by their names in quantities."""


@dataclass(frozen=True, slots=True, eq=False)
class Gradient:
    """Derivatives of one quantity over a batch of configurations.

    Attributes:
        quantity: Its name.
        names: What it is differentiated by: motors, joint axes, parameters.
        values: The quantity, batch (x entries).
        gradient: Its derivatives, batch (x entries) x names; NaN where there is none.
        smooth: For every value, whether all its derivatives exist.
        reasons: Why one does not, by place in `smooth`.
    """

    quantity: str
    names: tuple[str, ...]
    values: NDArray[np.float64]
    gradient: NDArray[np.float64]
    smooth: NDArray[np.bool_]
    reasons: Mapping[tuple[int, ...], str] = field(repr=False)

    def reason(self, *index: int) -> str:
        """Why a value has no derivative; empty where it has one."""
        return self.reasons.get(tuple(index), "")


def gradient(
    compiled: CompiledMechanism,
    configurations: ArrayLike | Mapping[str, object] | None,
    quantity: str,
    *,
    wrt: str | Sequence[str] = "motors",
    parameters: Mapping[str, ArrayLike] | None = None,
) -> Gradient:
    """Exact derivatives of an index or of efficiencies at closed configurations.

    By the motors: the derivative along the closed manifold, one motor moving and the passive joints
    following.  By all joints: the covector g with d(index) = g . (joint rates) for every motion that the
    loops allow, the shortest one.  By parameters: motors stay where they are, the loops close again.

    A symmetric function of equal efficiencies (volume, isotropy) is smooth; one of several equal
    efficiencies, or an extreme among them, is not, and says so.  The matrices' derivative is analytic
    for motions; dimensions enter through differences of the matrices, extrapolated to about 1e-10.

    Args:
        compiled: The mechanism.
        configurations: (..., numbers) joint values in the order of `coordinates`; None for home.
        quantity: `<ellipsoid>.efficiencies`, `.smallest`, `.largest`, or an index of it, such as
            `kinematic.condition:translation`.
        wrt: `motors`, `joints`, or names of parameters.
        parameters: Values of parameters, one a lane.

    Raises:
        ModelError: A quantity that has no derivatives.
        UnknownNameError: A quantity or parameter that does not exist.
        ShapeError: Arrays that do not fit.
    """
    asked = _asked(compiled, quantity)
    names = _names(compiled, wrt)
    settings = dict(parameters or {})
    compiled.variants.names_checked({**settings, **({} if isinstance(wrt, str) else dict.fromkeys(names))})
    batch = batch_of(compiled.mechanism, "configuration", configurations, None, settings)
    entries = asked.shape
    values = np.full((batch.lanes, *entries), np.nan)
    slopes = np.full((batch.lanes, *entries, len(names)), np.nan)
    smooth = np.zeros((batch.lanes, *entries), dtype=bool)
    reasons: dict[tuple[int, ...], str] = {}
    for lane in range(batch.lanes):
        flat = None if batch.values is None else batch.values[lane]
        found = _at(compiled, flat, asked, wrt, names, batch.parameters_at(lane))
        place = tuple(int(k) for k in np.unravel_index(lane, batch.shape)) if batch.shape else ()
        if isinstance(found, str):
            reasons.update({(*place, *entry): found for entry in np.ndindex(*entries)})
            continue
        for entry, (derivative, slope) in zip(np.ndindex(*entries), found, strict=False):
            values[(lane, *entry)] = derivative.value
            slopes[(lane, *entry)] = slope.values
            smooth[(lane, *entry)] = not slope.reason
            if slope.reason:
                reasons[*place, *entry] = slope.reason
    shape = batch.shape
    return Gradient(
        quantity,
        names,
        values.reshape((*shape, *entries)),
        slopes.reshape((*shape, *entries, len(names))),
        smooth.reshape((*shape, *entries)),
        reasons,
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Slope:
    """Derivatives by all names; NaN and a reason where there is none."""

    values: Vector
    reason: str = ""


def _at(
    compiled: CompiledMechanism,
    flat: Vector | None,
    asked: Quantity,
    wrt: str | Sequence[str],
    names: tuple[str, ...],
    settings: Mapping[str, float],
) -> list[tuple[Derivative, _Slope]] | str:
    """Every entry of the quantity with its derivatives at one configuration, or why there is nothing."""
    mechanism = compiled.variants.at(settings)
    if isinstance(mechanism, str):
        return mechanism
    try:
        q = mechanism.home if flat is None else mechanism.home.from_flat(flat)
        model = mechanism.linearize(q)
        found = Sensitivities(model)
        derivatives = _derivatives(found, compiled, asked)
        tangents = Tangents(mechanism, q, model, found)
        if model.ledger.status == "doubtful":
            return [(d, _Slope(np.full(len(names), np.nan), "a rank is doubtful here")) for d in derivatives]
        if wrt == "joints":
            return [(d, _by_joints(mechanism, tangents, d, names)) for d in derivatives]
        if wrt == "motors":
            directions = tangents.of_motors()
            return [(d, _by_directions(d, directions)) for d in derivatives]
        dimensions = dimensions_at(compiled.variants, compiled.weights, names, settings)
        directions = tangents.of_parameters(dimensions.placements)
        weights = _weight_rates(dimensions, asked)
        return [(d, _with_weights(_by_directions(d, directions), d, weights)) for d in derivatives]
    except ClosureError as error:
        return str(error)
    except VinculaError as error:
        return f"{type(error).__name__}: {error}"


def _derivatives(found: Sensitivities, compiled: CompiledMechanism, asked: Quantity) -> list[Derivative]:
    weights = resolved_weights(found.model, compiled.weights)
    if asked.kind is None:
        raise ModelError(f"{asked.name} has no derivative")
    ellipsoid = ellipsoid_of_kind(asked.kind, found.model, weights)
    if asked.part == "efficiencies":
        return [efficiency_derivative(found, ellipsoid, k) for k in range(len(ellipsoid.efficiencies))]
    if asked.part in ("smallest", "largest"):
        return [_extreme(found, ellipsoid, asked.part)]
    return [index_derivative(found, ellipsoid, SMOOTH[asked.part], asked.on)]


def _extreme(found: Sensitivities, ellipsoid: Ellipsoid, part: str) -> Derivative:
    finite = [k for k, kind in enumerate(ellipsoid.classes) if kind == "finite"]
    if not finite:
        return Derivative(math.nan, None, "there is no finite efficiency")
    return efficiency_derivative(found, ellipsoid, finite[-1] if part == "smallest" else finite[0])


def _by_directions(derivative: Derivative, directions: Sequence[Direction]) -> _Slope:
    """Derivatives along given directions."""
    slopes = np.full(len(directions), np.nan)
    if derivative.sensitivity is None:
        return _Slope(slopes, derivative.reason)
    reasons = []
    for k, direction in enumerate(directions):
        if direction.rate is None:
            reasons.append(direction.reason)
        else:
            slopes[k] = derivative.sensitivity.along(direction.rate)
    return _Slope(slopes, reasons[0] if reasons else "")


def _weight_rates(dimensions: Dimensions, asked: Quantity) -> list[tuple[Matrix, Matrix]]:
    """Rates of the metrics of both sides by every parameter; empty where the weights stay."""
    if asked.kind is None:
        return []
    sides = [dimensions.weight_rates(q) for q in (task_quantity(asked.kind), motor_quantity(asked.kind))]
    return [] if sides[0] is None or sides[1] is None else list(zip(sides[0], sides[1], strict=True))


def _with_weights(slope: _Slope, derivative: Derivative, rates: Sequence[tuple[Matrix, Matrix]]) -> _Slope:
    """Derivatives by parameters that weights depend on too."""
    if derivative.sensitivity is None or not rates:
        return slope
    weighing = derivative.sensitivity.weighing
    return _Slope(slope.values + [weighing.along(*rate) for rate in rates], slope.reason)


def _by_joints(
    mechanism: Mechanism, tangents: Tangents, derivative: Derivative, names: Sequence[str]
) -> _Slope:
    """The shortest covector on all joint rates that gives the derivative along every motion."""
    slope = _by_directions(derivative, tangents.of_motions())
    if slope.reason:
        return _Slope(np.full(len(names), np.nan), slope.reason)
    count = len(names)
    order = [c.name for c in (*tangents.model.motors, *tangents.model.passives)]
    rates: Matrix = tangents.motions[:count][[order.index(name) for name in names]]
    left, values, right = svd(rates)
    rank = decide_rank(rates, name="joint rates that are possible").rank
    unseen = right[:, rank:].T @ slope.values
    if unseen.size and float(np.abs(unseen).max()) > 1e-9 * max(1.0, float(np.abs(slope.values).max())):
        words = "the member moves while all joints stand: joint positions do not say where it goes"
        return _Slope(np.full(count, np.nan), words)
    return _Slope(left[:, :rank] @ ((right[:, :rank].T @ slope.values) / values[:rank]))


def _asked(compiled: CompiledMechanism, name: str) -> Quantity:
    known = compiled.quantities
    if name not in known:
        raise UnknownNameError("quantity", str(name), known)
    found = known[name]
    of_efficiencies = found.part in ("efficiencies", "smallest", "largest")
    if found.kind is None or not (of_efficiencies or found.part in SMOOTH):
        able = ["<ellipsoid>.efficiencies", "<ellipsoid>.smallest", "<ellipsoid>.largest"]
        able += [f"<ellipsoid>.{index}" for index in SMOOTH]
        raise ModelError(f"{name} has no derivatives here: choose {listing(able)}")
    return found


def _names(compiled: CompiledMechanism, wrt: str | Sequence[str]) -> tuple[str, ...]:
    layout = compiled.mechanism.layout
    if wrt == "motors":
        return tuple(layout.columns[k].name for k in layout.active)
    if wrt == "joints":
        return tuple(column.name for column in layout.columns)
    if isinstance(wrt, str):
        raise ModelError(f"wrt is {wrt!r}: choose motors, joints, or a list of parameters")
    return tuple(wrt)
