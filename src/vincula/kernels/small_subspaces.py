"""Subspaces of many small spaces: orthonormal bases, complements, the settled basis; in compiled loops.

Stacks and masks are those of `small_matrices`.  Imported late, and only where numba is installed.
"""

from __future__ import annotations

from typing import Any, Final

import numba
import numpy as np

from vincula.kernels.small_matrices import OPTIONS, Mask, Stack, exchange, inner_product
from vincula.numerics.subspaces import TIE

_compiled: Final = numba.njit(**OPTIONS)


def orthonormal(vectors: Stack, sure: Mask, rank: int | None = None) -> Stack:
    """Orthonormal bases of the spans of vectors, of which `rank` are independent; all by default."""
    found = np.array(vectors, order="C")
    count = found.shape[1] if rank is None else rank
    _orthonormal(found, count, sure)
    return found[:, :count]


def cleared(vectors: Stack, basis: Stack, sure: Mask) -> Stack:
    """The parts of vectors orthogonal to orthonormal ones."""
    found = np.array(vectors, order="C")
    _apart(found, np.require(basis, None, ["C", "W"]), sure)
    return found


def complements(basis: Stack, sure: Mask) -> Stack:
    """Orthonormal bases of what is orthogonal to orthonormal vectors: N x (p - j) x p for N x j x p."""
    count, j, p = basis.shape
    found = np.empty((count, p - j, p))
    _complements(np.require(basis, None, ["C", "W"]), sure, found)
    return found


def settled_bases(basis: Stack, sure: Mask) -> Stack:
    """Orthonormal vectors of the same subspaces, triangular on their leading components.

    The choice of `numerics.subspaces.settled`, which depends on the subspace only.
    """
    k, p = basis.shape[1:]
    if k < 2:
        return basis
    if k == p:
        return np.array(np.broadcast_to(np.eye(p), basis.shape))
    found = np.empty(basis.shape)
    _settled(np.array(basis, order="C"), sure, found)
    return found


@_compiled  # type: ignore[untyped-decorator]
def _clear(vectors: Any, i: int, basis: Any, count: int) -> float:
    """Take from a vector its parts along orthonormal ones, twice; what length is left."""
    p = vectors.shape[1]
    for _ in range(2):
        for j in range(count):
            along = inner_product(vectors, i, basis, j, 0, p)
            for c in range(p):
                vectors[i, c] -= along * basis[j, c]
    return float(np.sqrt(inner_product(vectors, i, vectors, i, 0, p)))


@_compiled  # type: ignore[untyped-decorator]
def _orthonormal(vectors: Any, rank: int, sure: Any) -> None:
    """Gram and Schmidt's process, the longest vector that is left first."""
    count, k, p = vectors.shape
    for n in range(count):
        if not sure[n]:
            continue
        a = vectors[n]
        for i in range(rank):
            best, longest = i, -1.0
            for j in range(i, k):
                square = inner_product(a, j, a, j, 0, p)
                if square > longest:
                    best, longest = j, square
            if best != i:
                exchange(a, i, best)
            length = _clear(a, i, a, i)
            for c in range(p):
                a[i, c] /= length
            for j in range(i + 1, k):
                along = inner_product(a, j, a, i, 0, p)
                for c in range(p):
                    a[j, c] -= along * a[i, c]


@_compiled  # type: ignore[untyped-decorator]
def _apart(vectors: Any, basis: Any, sure: Any) -> None:
    for n in range(len(vectors)):
        if sure[n]:
            for i in range(vectors.shape[1]):
                _clear(vectors[n], i, basis[n], basis.shape[1])


@_compiled  # type: ignore[untyped-decorator]
def _complements(basis: Any, sure: Any, found: Any) -> None:
    count, j, p = basis.shape
    whole = np.empty((p, p))
    left = np.empty(p)
    for n in range(count):
        if not sure[n]:
            continue
        whole[:j] = basis[n]
        for c in range(p):
            left[c] = 1.0
            for i in range(j):
                left[c] -= whole[i, c] * whole[i, c]
        for i in range(j, p):
            best = 0
            for c in range(p):
                if left[c] > left[best]:
                    best = c
            for c in range(p):
                whole[i, c] = 1.0 if c == best else 0.0
            length = _clear(whole, i, whole, i)
            for c in range(p):
                whole[i, c] /= length
                left[c] -= whole[i, c] * whole[i, c]
            left[best] = -1.0
        found[n] = whole[j:]


@_compiled  # type: ignore[untyped-decorator]
def _settled(left: Any, sure: Any, found: Any) -> None:
    count, k, p = left.shape
    along, lengths = np.empty(k), np.empty(p)
    for n in range(count):
        if not sure[n]:
            continue
        a, out = left[n], found[n]
        lengths[:] = 0.0
        for step in range(k):
            leading = _leading(a, lengths)
            for i in range(k):
                along[i] = a[i, leading] / lengths[leading]
            lengths[leading] = -1.0
            for c in range(p):
                out[step, c] = 0.0
                for i in range(k):
                    out[step, c] += along[i] * a[i, c]
            length = _clear(out, step, out, step)
            for c in range(p):
                out[step, c] /= length
                for i in range(k):
                    a[i, c] -= along[i] * out[step, c]


@_compiled  # type: ignore[untyped-decorator]
def _leading(a: Any, lengths: Any) -> int:
    """The first component that sticks out most; lengths of those taken before are negative and stay."""
    k, p = a.shape
    longest = 0.0
    for c in range(p):
        if lengths[c] >= 0.0:
            square = 0.0
            for i in range(k):
                square += a[i, c] * a[i, c]
            lengths[c] = np.sqrt(square)
            longest = max(longest, lengths[c])
    leading = 0
    while leading < p - 1 and not lengths[leading] >= (1.0 - TIE) * longest:
        leading += 1
    return leading
