"""A weight turned into what computations need: a factor L with W = L^T L, and its inverse.

Weights may be semidefinite: the factor is then rectangular.  The reciprocal of a zero weight is
infinite: those components are *required to be zero*.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from vincula.arrays import Matrix, Vector, frozen
from vincula.errors import WeightError
from vincula.numerics.lapack import identity, svd
from vincula.numerics.rank import decide_rank, negligible


@dataclass(frozen=True, slots=True, eq=False)
class Metric:
    """A positive semidefinite metric on n components.

    Attributes:
        matrix: W, n x n; zero on the components that are required to be zero.
        factor: L, r x n, of full row rank r.
        inverse: n x r with L @ inverse = 1; for r < n the pseudo-inverse.
        required_zero: n x k orthonormal basis of the components with infinite weight.
        unit: True for the identity.
    """

    matrix: Matrix
    factor: Matrix
    inverse: Matrix
    required_zero: Matrix
    unit: bool = False

    @property
    def size(self) -> int:
        """Number of components n."""
        return int(self.matrix.shape[0])

    @property
    def definite(self) -> bool:
        """True when every component has a finite weight above zero."""
        return int(self.factor.shape[0]) == self.size

    @property
    def diagonal(self) -> Vector | None:
        """The weights of the components if W is diagonal, else None; infinite where required zero."""
        weights = np.diag(self.matrix).copy()
        if np.count_nonzero(self.matrix) != np.count_nonzero(weights):
            return None
        if self.required_zero.shape[1]:
            held = np.abs(self.required_zero).max(axis=1) > 0.0
            if np.count_nonzero(held) != self.required_zero.shape[1]:
                return None
            weights[held] = np.inf
        return frozen(weights)

    def without_ignored(self, vector: Vector) -> Vector:
        """The vector without its part on components of weight zero."""
        if self.definite:
            return vector
        held = self.required_zero
        return np.asarray(self.inverse @ (self.factor @ vector) + held @ (held.T @ vector))

    def reciprocal(self) -> Metric:
        """The metric W^-1; components of weight zero become required to be zero, and back."""
        basis = self.inverse
        held = complement_rows(np.vstack([self.factor, self.required_zero.T]))
        return Metric(
            matrix=frozen(basis @ basis.T),
            factor=frozen(np.ascontiguousarray(basis.T)),
            inverse=frozen(np.ascontiguousarray(self.factor.T)),
            required_zero=frozen(held),
            unit=self.unit,
        )


@lru_cache(maxsize=64)
def identity_metric(size: int) -> Metric:
    """The identity on `size` components."""
    eye = identity(size)
    return Metric(eye, eye, eye, frozen(np.empty((size, 0))), unit=True)


def metric_of_diagonal(weights: Vector) -> Metric:
    """The metric of non-negative weights, one a component; zero means not weighted."""
    size = len(weights)
    if (weights == 1.0).all():
        return identity_metric(size)
    counted = np.flatnonzero(weights > 0.0)
    roots = np.sqrt(weights[counted])
    factor = np.zeros((len(counted), size))
    inverse = np.zeros((size, len(counted)))
    factor[np.arange(len(counted)), counted] = roots
    inverse[counted, np.arange(len(counted))] = 1.0 / roots
    return Metric(frozen(np.diag(weights)), frozen(factor), frozen(inverse), frozen(np.empty((size, 0))))


def metric_of_matrix(matrix: Matrix, name: str) -> Metric:
    """The metric of a symmetric positive semidefinite matrix.

    Raises:
        WeightError: Not symmetric, or with a negative eigenvalue.
    """
    gap = float(np.abs(matrix - matrix.T).max(initial=0.0))
    if not negligible(gap, float(np.abs(matrix).max(initial=0.0))):
        i, j = (int(k) for k in np.argwhere(np.abs(matrix - matrix.T) == gap)[0])
        raise WeightError(
            f"weight {name} is not symmetric: [{i}, {j}] is {matrix[i, j]:g}, [{j}, {i}] is "
            f"{matrix[j, i]:g}; give (W + W.T) / 2"
        )
    symmetric = (matrix + matrix.T) / 2.0
    if np.count_nonzero(symmetric) == np.count_nonzero(np.diag(symmetric)):
        _refuse_negative(np.diag(symmetric), name)
        return metric_of_diagonal(np.diag(symmetric).copy())
    return _metric_of_full(symmetric, name)


def complement_rows(rows: Matrix) -> Matrix:
    """Orthonormal basis (n x k) of what is orthogonal to the rows of a matrix of full row rank."""
    return svd(rows)[2][:, rows.shape[0] :]


def _metric_of_full(symmetric: Matrix, name: str) -> Metric:
    diagonal = np.diag(symmetric)
    _refuse_negative(diagonal, name)
    # Unit diagonal first: grading by units must not be mistaken for a lost rank.
    size = np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0))
    values, vectors = np.linalg.eigh(symmetric / np.outer(size, size))
    descending = np.abs(values)[::-1]
    decision = decide_rank(symmetric, name=f"weight {name}", values=np.sort(descending)[::-1])
    lowest = float(values[0])
    if lowest < 0.0 and not negligible(-lowest, float(values[-1])):
        direction = np.array2string(vectors[:, 0] / size, precision=3)
        raise WeightError(
            f"weight {name} is not positive: along {direction} it is {lowest:g} (relative); a weight must "
            "be zero or positive in every direction"
        )
    kept = slice(len(values) - decision.rank, None)
    if decision.rank == len(values):
        factor = np.linalg.cholesky(symmetric).T
        inverse = np.linalg.inv(factor)
    else:
        factor = (np.sqrt(values[kept])[:, None] * vectors[:, kept].T) * size
        inverse = np.linalg.pinv(factor)
    return Metric(
        frozen(symmetric), frozen(np.ascontiguousarray(factor)), frozen(inverse),
        frozen(np.empty((len(values), 0))),
    )  # fmt: skip


def _refuse_negative(weights: Vector, name: str) -> None:
    if len(weights) and float(weights.min()) < 0.0:
        worst = int(np.argmin(weights))
        raise WeightError(
            f"weight {name}[{worst}] is {weights[worst]:g}: weights are zero (ignored) or positive"
        )
