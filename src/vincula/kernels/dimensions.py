"""How the numbers of a mechanism change with its parameters, for one set of parameters at a time.

Where the arithmetic of a builder can be traced its rates are exact (`traced_rates`).  Otherwise they are
extrapolated central differences of what it draws (frames in their bodies, axes, leads, couplings, weights):
relative errors are 1e-12 where it is smooth over steps of `STEP`.  Everything that follows at a
configuration is analytic.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from vincula.analysis.ellipsoid import Kind
from vincula.analysis.recipes import motor_quantity, resolved_weights, task_quantity
from vincula.arrays import Matrix
from vincula.errors import ModelError, listing
from vincula.kernels.plans import model_without_numbers
from vincula.kernels.traced_rates import traced_rates
from vincula.mechanism.mechanism import Mechanism
from vincula.mechanism.placement_rates import Numbers, PlacementRates, Stencil
from vincula.weights import Weights

if TYPE_CHECKING:
    from vincula.kernels.variants import Variants

STEP: Final = 2e-4
"""Relative step of a parameter: the fourth power is rounding, and rounding over it is 1e-12."""
_WEIGHTS: Final = ((-2.0, 1.0), (-1.0, -8.0), (1.0, 8.0), (2.0, -1.0))
"""Steps and twelve times their weights: central differences, extrapolated once."""


@dataclass(frozen=True, slots=True, eq=False)
class Dimensions:
    """Rates of the numbers of one mechanism by parameters.

    Attributes:
        mechanism: The mechanism.
        names: Names of the parameters.
        placements: Rates of everything that is drawn.
        stencils: For every parameter mechanisms beside this one; empty where its rates are exact.
        weights: Weights of all evaluations; None for those of the mechanism, which may change too.
    """

    mechanism: Mechanism
    names: tuple[str, ...]
    placements: PlacementRates
    stencils: tuple[Stencil, ...]
    weights: Weights | None

    def metric_rates(self, kind: Kind) -> list[tuple[Matrix, Matrix]]:
        """Rates of the metrics of both sides of an ellipsoid by every parameter.

        Args:
            kind: The ellipsoid.

        Returns:
            Empty where weights are given: then they do not change.
        """
        if self.weights is not None or not any(self.stencils):
            return []
        found = []
        own = _metrics(self.mechanism, kind)
        for stencil in self.stencils:
            beside = [(weight, _metrics(mechanism, kind)) for weight, mechanism in stencil]
            task, motor = (
                sum((weight * (metrics[side] - own[side]) for weight, metrics in beside), 0.0 * own[side])
                for side in (0, 1)
            )
            found.append((task, motor))
        return found


def dimensions_at(
    variants: Variants,
    weights: Weights | None,
    names: Sequence[str],
    settings: Mapping[str, float],
) -> Dimensions:
    """Rates by some parameters at one set of their values.

    Args:
        variants: The mechanisms by parameter values.
        weights: Weights of all evaluations; None for those of the mechanism.
        names: Names of the parameters.
        settings: Values of parameters; the others are at their defaults.

    Raises:
        ModelError: A parameter without a value, values beside these that build no mechanism, or a
            parameter by which there is no derivative.
    """
    at = {**variants.defaults, **settings}
    missing = [name for name in names if name not in at]
    if missing:
        raise ModelError(f"parameters {listing(missing)} have no default: give their values in parameters")
    mechanism = variants.at(settings)
    if weights is not None or mechanism.weights is None:
        build = getattr(variants.build, "outline", variants.build)
        exact = None if build is None else traced_rates(mechanism, build, names, at)
        if exact is not None:
            nothing: tuple[Stencil, ...] = ((),) * len(names)
            placements = PlacementRates.of(mechanism, names, exact, nothing)
            return Dimensions(mechanism, tuple(names), placements, nothing, weights)
    stencils = tuple(_stencil(variants, mechanism, at, name) for name in names)
    rates = [Numbers.rates(stencil) for stencil in stencils]
    placements = PlacementRates.of(mechanism, names, rates, stencils)
    return Dimensions(mechanism, tuple(names), placements, stencils, weights)


def _stencil(variants: Variants, mechanism: Mechanism, at: Mapping[str, float], name: str) -> Stencil:
    size = STEP * max(abs(at[name]), min(1.0, mechanism.length))
    return [
        (weight / (12.0 * size), variants.at({**at, name: at[name] + step * size}))
        for step, weight in _WEIGHTS
    ]


def _metrics(mechanism: Mechanism, kind: Kind) -> tuple[Matrix, Matrix]:
    """Metrics of the task and of the motor side."""
    model = model_without_numbers(mechanism)
    weights = resolved_weights(model, None)
    return (
        weights.metric(task_quantity(kind), model).matrix,
        weights.metric(motor_quantity(kind), model).matrix,
    )
