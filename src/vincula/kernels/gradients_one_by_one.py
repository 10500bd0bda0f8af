"""Gradients at one configuration: what all others are compared with, and what is said where there is none."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from vincula.analysis.distance_sensitivity import distance_derivatives
from vincula.analysis.ellipsoid import Ellipsoid
from vincula.analysis.index_sensitivity import (
    NO_FINITE,
    Derivative,
    efficiency_derivative,
    index_derivative,
)
from vincula.analysis.recipes import (
    ellipsoid_of_kind,
    resolved_weights,
)
from vincula.analysis.sensitivity import Sensitivities
from vincula.arrays import Matrix, Vector
from vincula.errors import ClosureError, ModelError, VinculaError
from vincula.kernels.dimensions import Dimensions
from vincula.kernels.quantities import WATCHED, Quantity
from vincula.kernels.tangents import SEEN, Direction, Tangents
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
DISTANCE: Final = "singularity.distance"
SPINS: Final = "passive joints can move by themselves, and the distance with them: ask for wrt='joints'"


@dataclass(frozen=True, slots=True, eq=False)
class Slope:
    """Derivatives by all names; NaN and a reason where there is none."""

    values: Vector
    reason: str = ""


def gradient_at(
    compiled: CompiledMechanism,
    mechanism: Mechanism,
    flat: Vector | None,
    asked: Quantity,
    wrt: str | Sequence[str],
    names: tuple[str, ...],
    dimensions: Dimensions | None,
) -> list[tuple[Derivative, Slope]] | str:
    """Every entry of the quantity with its derivatives at one configuration, or why there is nothing.

    Args:
        compiled: The mechanism.
        mechanism: It, with the dimensions of this configuration.
        flat: The configuration; None for home.
        asked: The quantity.
        wrt: `motors`, `joints`, or names of parameters.
        names: What it is differentiated by.
        dimensions: How the mechanism changes with parameters, where these are asked for.
    """
    try:
        q = mechanism.home if flat is None else mechanism.home.from_flat(flat)
        model = mechanism.linearize(q)
        found = Sensitivities(model)
        derivatives = _derivatives(found, compiled, asked)
        tangents = Tangents(mechanism, q, model, found)
        if model.ledger.status == "doubtful":
            return [(d, Slope(np.full(len(names), np.nan), "a rank is doubtful here")) for d in derivatives]
        if wrt != "joints" and asked.part == DISTANCE and model.ledger.summary.passive_redundancy > 0:
            return [(d, Slope(np.full(len(names), np.nan), d.reason or SPINS)) for d in derivatives]
        if wrt == "joints":
            return [(d, _by_joints(mechanism, tangents, d, names)) for d in derivatives]
        if dimensions is None:
            directions = tangents.of_motors()
            return [(d, _by_directions(d, directions)) for d in derivatives]
        directions = tangents.of_parameters(dimensions.placements)
        weights = [] if asked.kind is None else dimensions.metric_rates(asked.kind)
        return [(d, _with_weights(_by_directions(d, directions), d, weights)) for d in derivatives]
    except ClosureError as error:
        return str(error)
    except VinculaError as error:
        return f"{type(error).__name__}: {error}"


def _derivatives(found: Sensitivities, compiled: CompiledMechanism, asked: Quantity) -> list[Derivative]:
    if asked.part == DISTANCE:
        return distance_derivatives(found, WATCHED, compiled.general_ranks)
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
        return Derivative(math.nan, None, NO_FINITE)
    return efficiency_derivative(found, ellipsoid, finite[-1] if part == "smallest" else finite[0])


def _by_directions(derivative: Derivative, directions: Sequence[Direction]) -> Slope:
    """Derivatives along given directions."""
    slopes = np.full(len(directions), np.nan)
    if derivative.sensitivity is None:
        return Slope(slopes, derivative.reason)
    reasons = []
    for k, direction in enumerate(directions):
        if direction.rate is None:
            reasons.append(direction.reason)
        else:
            slopes[k] = derivative.sensitivity.along(direction.rate)
    return Slope(slopes, reasons[0] if reasons else "")


def _with_weights(slope: Slope, derivative: Derivative, rates: Sequence[tuple[Matrix, Matrix]]) -> Slope:
    """Derivatives by parameters that weights depend on too."""
    if derivative.sensitivity is None or not rates:
        return slope
    weighing = derivative.sensitivity.weighing
    return Slope(slope.values + [weighing.along(*rate) for rate in rates], slope.reason)


def _by_joints(
    mechanism: Mechanism, tangents: Tangents, derivative: Derivative, names: Sequence[str]
) -> Slope:
    """The shortest covector on all joint rates that gives the derivative along every motion."""
    slope = _by_directions(derivative, tangents.of_motions())
    if slope.reason:
        return Slope(np.full(len(names), np.nan), slope.reason)
    count = len(names)
    order = [c.name for c in (*tangents.model.motors, *tangents.model.passives)]
    rates: Matrix = tangents.motions[:count][[order.index(name) for name in names]]
    left, values, right = svd(rates)
    rank = decide_rank(rates, name="joint rates that are possible").rank
    unseen = right[:, rank:].T @ slope.values
    if unseen.size and float(np.abs(unseen).max()) > SEEN * max(1.0, float(np.abs(slope.values).max())):
        words = "the member moves while all joints stand: joint positions do not say where it goes"
        return Slope(np.full(count, np.nan), words)
    return Slope(left[:, :rank] @ ((right[:, :rank].T @ slope.values) / values[:rank]))
