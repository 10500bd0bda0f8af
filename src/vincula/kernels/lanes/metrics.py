"""Weights and doubts of a mechanism as constants of kernels."""

from __future__ import annotations

import numpy as np

from vincula.arrays import Vector
from vincula.kernels.lanes.flatten import Unsupported
from vincula.model import LinearModel
from vincula.numerics.metric import Metric
from vincula.numerics.rank import EPS, rounding_unit

APART = 1e4
"""Weights whose roots differ by more than this lose more than four digits when they are applied early: beyond
it the reference path weighs in another order, or in long arithmetic."""


def metric_constants(model: LinearModel, twist: Metric, rate: Metric) -> Vector:
    """3 (n_a + d) factors: lengths in the metrics to scaled rates and twists; results; efforts.

    Raises:
        Unsupported: Weights that are not diagonal, zero, infinite, or of very different size.
    """
    weights = [_weights(metric, side) for metric, side in ((rate, "rates"), (twist, "twists"))]
    factors = model.scaled.active_column, model.scaled.twist
    sizes = [np.sqrt(w) * factor for w, factor in zip(weights, factors, strict=True)]
    together = np.concatenate(sizes)
    if together.max() > APART * together.min():
        raise Unsupported(f"weights differ by more than {APART**2:g} in units of the characteristic length")
    roots = np.sqrt(np.concatenate(weights))
    return np.concatenate([1.0 / together, 1.0 / roots, roots])


def _weights(metric: Metric, side: str) -> Vector:
    diagonal = metric.diagonal
    if diagonal is None or not metric.definite or metric.required_zero.shape[1]:
        raise Unsupported(f"weights of {side} are not positive numbers, one a component")
    return np.asarray(diagonal)


def doubt_constants(model: LinearModel) -> Vector:
    """Relative uncertainty, half of what counts as certainly zero, and the bound on curvature.

    The first is that of the ordinary rule without closure; the second is relative to the Frobenius norm,
    of which the largest singular value is at least the min(m, n)-th part's root.
    """
    rows = len(model.rows)
    columns = len(model.columns) + model.dimension
    ledger = model.ledger
    relative = rounding_unit(rows, columns) + ledger.digits + ledger.tolerance
    zero = 0.5 * max(rows, columns) * EPS / np.sqrt(max(1, min(rows, columns)))
    return np.array([relative, zero])
