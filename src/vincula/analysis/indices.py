"""Single numbers that users know from elsewhere, on the kinematic (or any) ellipsoid.

Metres and radians are never mixed silently: over translations and rotations together an index needs
weights that somebody chose.  Semi-axes are those of the set's shadow on the chosen components.
"""

from __future__ import annotations

import math
from typing import Literal

import numpy as np

from vincula.analysis.ellipsoid import Ellipsoid
from vincula.analysis.recipes import ellipsoid_of_kind, resolved_weights
from vincula.analysis.vectorset import VectorSet
from vincula.arrays import Matrix, Vector
from vincula.errors import MixedUnitsError, ModelError
from vincula.model import LinearModel
from vincula.numerics.lapack import singular_values
from vincula.numerics.rank import decide_rank
from vincula.numerics.subspaces import span
from vincula.weights import Weights

Part = Literal["translation", "rotation", "all"]


def yoshikawa_volume(
    source: Ellipsoid | LinearModel, on: Part = "all", weights: Weights | None = None
) -> float:
    """Product of the semi-axes: sqrt(det J J^T) for a serial arm (Yoshikawa 1985).

    0 when the set is flat in the chosen components, inf when it is unbounded.

    Args:
        source: An ellipsoid, or a model, whose kinematic ellipsoid is meant.
        on: translation, rotation or all components.
        weights: For a model.

    Raises:
        MixedUnitsError: `on="all"` over metres and radians with weights that nobody chose.
        ModelError: No such components.
    """
    axes = _semi_axes(source, on, weights)
    # A flat set has no volume, however long it is in another direction.
    return 0.0 if axes[-1] == 0.0 else float(np.prod(axes))


def smallest_singular_value(
    source: Ellipsoid | LinearModel, on: Part = "all", weights: Weights | None = None
) -> float:
    """Length of the shortest semi-axis; 0 for a flat set.  Arguments and errors as for the volume."""
    return float(_semi_axes(source, on, weights)[-1])


def condition_number(
    source: Ellipsoid | LinearModel, on: Part = "all", weights: Weights | None = None
) -> float:
    """Longest over shortest semi-axis, 1 for a sphere; inf for a flat or unbounded set, NaN for both.

    Arguments and errors as for `yoshikawa_volume`.
    """
    axes = _semi_axes(source, on, weights)
    if math.isinf(axes[0]) and (axes[-1] == 0.0 or math.isinf(axes[-1])):
        return float("nan")
    return float("inf") if axes[-1] == 0.0 else float(axes[0] / axes[-1])


def inverse_condition_number(
    source: Ellipsoid | LinearModel, on: Part = "all", weights: Weights | None = None
) -> float:
    """Shortest over longest semi-axis, from 0 (flat or unbounded) to 1.  Arguments as for the volume."""
    condition = condition_number(source, on, weights)
    return condition if math.isnan(condition) else 1.0 / condition


def isotropy(source: Ellipsoid | LinearModel, on: Part = "all", weights: Weights | None = None) -> float:
    """Geometric over arithmetic mean of the squared semi-axes, from 0 to 1 (a sphere).

    Arguments and errors as for `yoshikawa_volume`; NaN for an unbounded set.
    """
    squares = _semi_axes(source, on, weights) ** 2
    if math.isinf(squares[0]):
        return float("nan")
    if squares[-1] == 0.0:
        return 0.0
    return float(np.exp(np.mean(np.log(squares))) / np.mean(squares))


def _semi_axes(source: Ellipsoid | LinearModel, on: Part, weights: Weights | None) -> Vector:
    """Semi-axes on the chosen components in the task metric, descending; inf and 0 included."""
    if on not in ("translation", "rotation", "all"):
        raise ModelError(f"on is {on!r}: choose translation, rotation or all")
    if isinstance(source, LinearModel):
        source = ellipsoid_of_kind("kinematic", source, resolved_weights(source, weights))
    chosen = components_of_part(source, on)
    return _metric_lengths(source.set.project(chosen), source.task_weight.factor[:, chosen])


def components_of_part(ellipsoid: Ellipsoid, on: Part) -> list[int]:
    """Indices of the task components that a part stands for.

    Raises:
        MixedUnitsError: `on="all"` over metres and radians with weights that nobody chose.
        ModelError: No such components.
    """
    kinds = {"m/s": "translation", "N": "translation", "rad/s": "rotation", "N m": "rotation"}
    parts = [kinds.get(unit, "all") for unit in ellipsoid.units]
    if on == "all" and len(set(parts)) > 1 and not ellipsoid.weights_chosen:
        raise MixedUnitsError(
            "an index over translations and rotations depends on how metres compare with radians: "
            "choose on='translation' or on='rotation', or give weights, for example "
            "characteristic_length_weights(length, model)"
        )
    chosen = [i for i, part in enumerate(parts) if on in ("all", part)]
    if not chosen:
        raise ModelError(f"the {ellipsoid.kind} ellipsoid has no {on} components")
    return chosen


def _metric_lengths(shadow: VectorSet, factor: Matrix) -> Vector:
    """Semi-axes of a set in a metric: inf for lines, 0 for weighted directions it does not reach."""
    lines = span(factor @ shadow.lines, shadow.lines.shape[1])
    axes = factor @ shadow.axes
    lengths = singular_values(axes - lines @ (lines.T @ axes))
    size = decide_rank(factor, name="weights of the chosen components").rank
    if size == 0:
        raise ModelError("the weights ignore every chosen component: there is nothing to measure")
    unbounded = np.full(lines.shape[1], np.inf)
    return np.concatenate([unbounded, lengths, np.zeros(size)])[:size]
