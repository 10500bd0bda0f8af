"""The LAPACK drivers that vincula uses, with their options stated once.

Called directly: for the 6 x 8 to 60 x 80 matrices of mechanisms the usual wrappers cost more than the
arithmetic.  Empty matrices, which LAPACK refuses, are legal here.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dgejsv, dgeqp3, dgeqrf, dgesvd, dorgqr, dormqr, dtrtri

from vincula.arrays import Matrix, Vector, frozen
from vincula.errors import VinculaError

_COLUMN_SCALED_JACOBI = {"joba": 0, "jobu": 0, "jobv": 0, "jobt": 1, "jobp": 0}


@lru_cache(maxsize=256)
def identity(size: int) -> Matrix:
    """The identity, read-only, made once a size."""
    return frozen(np.eye(size))


def singular_values(matrix: Matrix) -> Vector:
    """Singular values, largest first (driver gesvd: gesdd loses small ones and may not converge)."""
    if 0 in matrix.shape:
        return np.empty(0)
    _, values, _, info = dgesvd(matrix, compute_uv=0)
    _refuse_failure("gesvd", info)
    return np.asarray(values)


def svd(matrix: Matrix) -> tuple[Matrix, Vector, Matrix]:
    """Full decomposition U (m x m), singular values, V (n x n) with matrix = U diag V^T."""
    m, n = matrix.shape
    if 0 in matrix.shape:
        return np.eye(m), np.empty(0), np.eye(n)
    left, values, right, info = dgesvd(matrix)
    _refuse_failure("gesvd", info)
    return left, values, right.T


def jacobi_svd(matrix: Matrix) -> tuple[Matrix, Vector, Matrix]:
    """Thin decomposition U (m x n), singular values, V (n x n) of a matrix with m >= n.

    One-sided Jacobi after row and column pivoting (gejsv): the error of every row is small against that row,
    so graded matrices D1 B D2 keep the relative accuracy of small singular values.  Rows are put in order
    here (job 'C'): gejsv does the same (job 'F') through laswp, for which OpenBLAS wakes all its threads, and
    where cores are busy a matrix of six numbers then waits for milliseconds.
    """
    n = matrix.shape[1]
    if n == 0:
        return np.empty((matrix.shape[0], 0)), np.empty(0), np.empty((0, 0))
    order = np.argsort(-np.abs(matrix).max(axis=1), kind="stable")
    values, turned, right, work, _, info = dgejsv(matrix[order], **_COLUMN_SCALED_JACOBI)
    _refuse_failure("gejsv", info)
    left = np.empty((len(matrix), n))
    left[order] = turned[:, :n]
    return left, values * (work[0] / work[1]), right


def qr_full(matrix: Matrix) -> Matrix:
    """The m x m orthogonal factor of a QR decomposition; its last columns are orthogonal to the range."""
    m = matrix.shape[0]
    if 0 in matrix.shape:
        return np.eye(m)
    packed, tau, _, info = dgeqrf(matrix)
    _refuse_failure("geqrf", info)
    return _explicit(packed, tau, m)


def qr_applied(matrix: Matrix, block: Matrix) -> tuple[Matrix, Matrix]:
    """R (n x n, upper) and Q^T block (m x k) of the QR factorisation of an m x n matrix, m >= n > 0."""
    packed, tau, _, info = dgeqrf(matrix)
    _refuse_failure("geqrf", info)
    turned = block
    if 0 not in block.shape:
        turned, _, info = dormqr("L", "T", packed, tau, block, 64 * block.shape[1])
        _refuse_failure("ormqr", info)
    return np.triu(packed[: matrix.shape[1]]), turned


def inverse_of_triangle(triangle: Matrix) -> Matrix | None:
    """Inverse of an upper triangle; None if its diagonal has an exact zero."""
    inverse, info = dtrtri(triangle)
    return None if info > 0 else np.asarray(inverse)


def qr_rows_pivoted(matrix: Matrix, columns: int) -> Matrix:
    """First `columns` columns of the orthogonal factor, rows sorted by size and columns pivoted.

    Householder QR with both pivotings is stable row by row: rows of very different size keep their
    relative accuracy (Powell and Reid; Cox and Higham).
    """
    m = matrix.shape[0]
    if 0 in matrix.shape or columns == 0:
        return np.eye(m)[:, :columns]
    order = np.argsort(-np.abs(matrix).max(axis=1), kind="stable")
    packed, _, tau, _, info = dgeqp3(matrix[order])
    _refuse_failure("geqp3", info)
    unsorted = np.empty((m, columns))
    unsorted[order] = _explicit(packed, tau, columns)
    return unsorted


def pivots(matrix: Matrix) -> NDArray[np.intp]:
    """Column indices in the order of pivoted QR: the first ones are the most independent."""
    if 0 in matrix.shape:
        return np.arange(matrix.shape[1])
    _, order, _, _, info = dgeqp3(matrix)
    _refuse_failure("geqp3", info)
    return np.asarray(order - 1, dtype=np.intp)


def eliminated(fixed: Matrix, block: Matrix) -> tuple[Matrix, Matrix]:
    """Q^T block and Q (p x p), Q from the row-sorted, column-pivoted QR of `fixed` (p x j, p >= j > 0).

    Reflections are applied to `block` one by one, so light rows keep their accuracy beside heavy ones.
    """
    p = fixed.shape[0]
    order = np.argsort(-np.abs(fixed).max(axis=1), kind="stable")
    packed, _, tau, _, info = dgeqp3(fixed[order])
    _refuse_failure("geqp3", info)
    columns = block.shape[1]
    turned = block[order]
    if columns:
        turned, _, info = dormqr("L", "T", packed, tau, block[order], 64 * columns)
        _refuse_failure("ormqr", info)
    unsorted = np.empty((p, p))
    unsorted[order] = _explicit(packed, tau, p)
    return np.asarray(turned), unsorted


def _explicit(packed: Matrix, tau: Vector, columns: int) -> Matrix:
    m, n = packed.shape
    if columns <= n:
        factor, _, info = dorgqr(packed[:, :columns], tau[:columns])
    else:
        wide = np.eye(m, columns, order="F")
        factor, _, info = dormqr("L", "N", packed[:, : len(tau)], tau, wide, max(64 * columns, 1))
    _refuse_failure("orgqr", info)
    return np.asarray(factor)


def _refuse_failure(driver: str, info: int) -> None:
    if info != 0:
        raise VinculaError(f"LAPACK {driver} did not converge (info = {info})")
