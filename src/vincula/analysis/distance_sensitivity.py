"""Derivatives of the distance from singularities: a smallest singular value over the largest of all.

With M one of the watched matrices, a block of columns of A, and u, v the singular vectors of its value s,
ds = u^T dM v; the distance s / S with S the largest singular value of A follows by the quotient rule.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from vincula.analysis.index_sensitivity import Derivative
from vincula.analysis.sensitivity import CLUSTER, Sensitivities, Sensitivity, Weighing
from vincula.arrays import Matrix, Vector
from vincula.numerics.lapack import svd
from vincula.numerics.ledger import MatrixName

NOTHING_TO_LOSE: Final = "the matrix has no rank to lose"
SINGULAR: Final = "singular here: the distance has a kink"
EQUAL_VALUES: Final = "the singular value is one of several equal ones: no derivative"


def distance_derivatives(
    found: Sensitivities, names: tuple[MatrixName, ...], ranks: tuple[int, ...]
) -> list[Derivative]:
    """Derivatives of the distances of a model from losing the ranks that it has in general.

    Args:
        found: The model's sensitivities.
        names: The matrices.
        ranks: Their ranks in general.
    """
    ledger, model = found.model.ledger, found.model
    whole = svd(ledger.matrix("all"))
    n_a, n_p = len(model.motors), len(model.passives)
    result = []
    for name, rank in zip(names, ranks, strict=True):
        columns = columns_of(name, n_a, n_p, whole[2].shape[0])
        parts = svd(ledger.matrix("all")[:, columns])
        if not 0 < rank <= len(parts[1]):
            result.append(Derivative(np.inf, None, NOTHING_TO_LOSE))
            continue
        value = float(parts[1][rank - 1] / whole[1][0])
        if ledger.rank(name) < rank:
            result.append(Derivative(value, None, SINGULAR))
        elif not (value_alone(parts[1], rank - 1) and value_alone(whole[1], 0)):
            result.append(Derivative(value, None, EQUAL_VALUES))
        else:
            result.append(Derivative(value, _quotient(found, columns, parts, whole, rank - 1)))
    return result


def columns_of(name: MatrixName, active: int, passive: int, columns: int) -> slice:
    """The columns of A that a watched matrix consists of.

    Args:
        name: `passive`, `active+passive`, `passive+member` or `all`.
        active: Number of active columns.
        passive: Number of passive ones.
        columns: Number of all columns.
    """
    return slice(
        0 if name in ("active+passive", "all") else active,
        columns if name in ("passive+member", "all") else active + passive,
    )


def value_alone(values: NDArray[np.float64], place: int) -> NDArray[np.bool_]:
    """Whether a singular value is apart from all others.

    Args:
        values: ... x values.
        place: Which one.
    """
    own = values[..., place, None]
    return np.asarray((np.abs(values - own) <= CLUSTER * own).sum(axis=-1) == 1)


def _quotient(
    found: Sensitivities,
    columns: slice,
    parts: tuple[Matrix, Vector, Matrix],
    whole: tuple[Matrix, Vector, Matrix],
    place: int,
) -> Sensitivity:
    scale = float(whole[1][0])
    value = float(parts[1][place]) / scale
    motion = np.zeros(whole[2].shape[0])
    motion[columns] = parts[2][:, place]
    forces = np.stack([-parts[0][:, place] / scale, value / scale * whole[0][:, 0]], axis=1)
    d, n_a = found.model.dimension, len(found.model.motors)
    nothing = Weighing(np.zeros((d, 0)), np.zeros((d, 0)), np.zeros((n_a, 0)), np.zeros(0), np.zeros(0))
    return Sensitivity(forces, np.stack([motion, whole[2][:, 0]], axis=1), nothing)
