"""Products and rotations of many small matrices, one after the other in compiled loops.

Stacks hold vectors as rows: N x vectors x components.  LAPACK takes one matrix a call and spends more on the
call than on six columns; and here sums are taken in one order, so what one matrix gives does not depend on
the others, bit for bit.  Matrices that are not `sure` are passed over: what comes out of them is anything.

Imported late, and only where numba is installed.
"""

from __future__ import annotations

from typing import Any, Final

import numba
import numpy as np
from numpy.typing import NDArray

from vincula.arrays import Matrix

Stack = NDArray[np.float64]
"""N x vectors x components."""
Mask = NDArray[np.bool_]

MOST_SWEEPS: Final = 30
"""Sweeps over all pairs of vectors; three to eight are usual."""
ORTHOGONAL: Final = 4.0 * float(np.finfo(np.float64).eps)
"""Vectors count as orthogonal when the cosine between them is below this."""
NOTHING: Final = 1e-34
"""Square of the length, relative to the longest vector, below which a vector is rounding and not turned."""
OPTIONS: Final = {"error_model": "numpy", "nogil": True, "cache": True}
"""How these loops are compiled: no fast arithmetic, which would take sums in any order."""
_compiled: Final = numba.njit(**OPTIONS)


def products(left: Stack, right: Stack, sure: Mask) -> Stack:
    """N x i x p: every i x k matrix times the k x p matrix of its lane.

    Args:
        left: N x i x k, or 1 x i x k for all lanes.
        right: N x k x p, or 1 x k x p for all lanes.
        sure: N.
    """
    found = np.empty((len(sure), left.shape[1], right.shape[2]))
    # Writable ones, for which the loop is compiled.
    _products(np.require(left, None, ["C", "W"]), np.require(right, None, ["C", "W"]), sure, found)
    return found


def decomposed(vectors: Stack, sure: Mask) -> tuple[Matrix, Stack]:
    """Singular values of N sets of k vectors, largest first, and k combinations that belong to them.

    Returns:
        N x k values, N x k x k orthonormal combinations: combination i of the vectors has length value i,
        and all are mutually orthogonal; where there are more vectors than components the last ones are zero.
    """
    count, k, _ = vectors.shape
    values, right = np.empty((count, k)), np.empty((count, k, k))
    _decomposed(np.array(vectors, order="C"), sure, values, right)
    return values, right


def lengths(vectors: Stack) -> Matrix:
    """Lengths of vectors, N x k."""
    found = np.empty(vectors.shape[:2])
    _lengths(np.require(vectors, None, ["C", "W"]), found)
    return found


def paired_angles(joined: Stack, p: int, sure: Mask) -> tuple[Matrix, Stack, Stack]:
    """The cosine-sine decomposition of pairs of blocks, largest ratio first.

    The vectors (task; motor) are rotated until both parts are orthogonal, every rotation computed from the
    shorter parts, so that tiny cosines and tiny sines are as accurate as they come.

    Args:
        joined: N x k x (p + r) orthonormal vectors (task; motor), both parts of rank k.
        p: Components of the task side.
        sure: N.

    Returns:
        N x k ratios task / motor; unit vectors of both sides, paired.
    """
    turned, ratios = np.array(joined, order="C"), np.empty(joined.shape[:2])
    _paired(turned, p, sure, ratios)
    return ratios, turned[:, :, :p], turned[:, :, p:]


@_compiled  # type: ignore[untyped-decorator]
def _products(left: Any, right: Any, sure: Any, found: Any) -> None:
    rows, inner, columns = left.shape[1], left.shape[2], right.shape[2]
    for n in range(len(sure)):
        if not sure[n]:
            continue
        a, b = min(n, len(left) - 1), min(n, len(right) - 1)
        for i in range(rows):
            for c in range(columns):
                found[n, i, c] = 0.0
            for k in range(inner):
                x = left[a, i, k]
                for c in range(columns):
                    found[n, i, c] += x * right[b, k, c]


@_compiled  # type: ignore[untyped-decorator]
def inner_product(one: Any, i: int, two: Any, j: int, first: int, last: int) -> float:
    """Of vector i of one set and vector j of another, components first ... last - 1 in this order."""
    total = 0.0
    for c in range(first, last):
        total += one[i, c] * two[j, c]
    return total


@_compiled  # type: ignore[untyped-decorator]
def _lengths(vectors: Any, found: Any) -> None:
    p = vectors.shape[2]
    for n in range(vectors.shape[0]):
        for i in range(vectors.shape[1]):
            found[n, i] = np.sqrt(inner_product(vectors[n], i, vectors[n], i, 0, p))


@_compiled  # type: ignore[untyped-decorator]
def _turn(vectors: Any, i: int, j: int, cosine: float, sine: float) -> None:
    for c in range(vectors.shape[1]):
        a, b = vectors[i, c], vectors[j, c]
        vectors[i, c] = cosine * a - sine * b
        vectors[j, c] = sine * a + cosine * b


@_compiled  # type: ignore[untyped-decorator]
def exchange(vectors: Any, i: int, j: int) -> None:
    """Exchange two vectors of a set."""
    for c in range(vectors.shape[1]):
        vectors[i, c], vectors[j, c] = vectors[j, c], vectors[i, c]


@_compiled  # type: ignore[untyped-decorator]
def _rotation(one: float, two: float, both: float) -> tuple[float, float]:
    """Cosine and sine that make two vectors of squared lengths one, two and product both orthogonal."""
    half = (two - one) / (2.0 * both)
    tangent = 1.0 / (abs(half) + np.sqrt(1.0 + half * half))
    tangent = -tangent if half < 0.0 else tangent
    cosine = 1.0 / np.sqrt(1.0 + tangent * tangent)
    return cosine, cosine * tangent


@_compiled  # type: ignore[untyped-decorator]
def _decomposed(vectors: Any, sure: Any, values: Any, right: Any) -> None:
    count, k, p = vectors.shape
    for n in range(count):
        if not sure[n]:
            continue
        a, v = vectors[n], right[n]
        largest = 0.0
        for i in range(k):
            largest = max(largest, inner_product(a, i, a, i, 0, p))
            for j in range(k):
                v[i, j] = 1.0 if i == j else 0.0
        for _ in range(MOST_SWEEPS):
            if not _swept(a, v, NOTHING * largest):
                break
        for i in range(k):
            values[n, i] = np.sqrt(inner_product(a, i, a, i, 0, p))
        _sorted(values[n], v)


@_compiled  # type: ignore[untyped-decorator]
def _swept(a: Any, v: Any, nothing: float) -> bool:
    """One round over all pairs of vectors of which none is nothing; whether any pair was turned."""
    turned, (k, p) = False, a.shape
    for i in range(k):
        for j in range(i + 1, k):
            one, two = inner_product(a, i, a, i, 0, p), inner_product(a, j, a, j, 0, p)
            if min(one, two) <= nothing:
                continue
            both = inner_product(a, i, a, j, 0, p)
            if abs(both) > ORTHOGONAL * np.sqrt(one) * np.sqrt(two):
                turned = True
                cosine, sine = _rotation(one, two, both)
                _turn(a, i, j, cosine, sine)
                _turn(v, i, j, cosine, sine)
    return turned


@_compiled  # type: ignore[untyped-decorator]
def _sorted(values: Any, vectors: Any) -> None:
    """Put the largest values first, with their vectors."""
    for i in range(len(values)):
        best = i
        for j in range(i + 1, len(values)):
            if values[j] > values[best]:
                best = j
        if best != i:
            exchange(vectors, i, best)
            values[i], values[best] = values[best], values[i]


@_compiled  # type: ignore[untyped-decorator]
def _paired(joined: Any, p: int, sure: Any, ratios: Any) -> None:
    count, k, size = joined.shape
    for n in range(count):
        if not sure[n]:
            continue
        a = joined[n]
        for _ in range(MOST_SWEEPS):
            turned = False
            for i in range(k):
                for j in range(i + 1, k):
                    turned |= _turned(a, i, j, p)
            if not turned:
                break
        for i in range(k):
            one = np.sqrt(inner_product(a, i, a, i, 0, p))
            two = np.sqrt(inner_product(a, i, a, i, p, size))
            ratios[n, i] = one / two
            for c in range(size):
                a[i, c] /= one if c < p else two
        _sorted(ratios[n], a)


@_compiled  # type: ignore[untyped-decorator]
def _turned(a: Any, i: int, j: int, p: int) -> bool:
    """Rotate two of the orthonormal vectors so that their parts are orthogonal; whether they were not."""
    first, last = 0, p
    one, two = inner_product(a, i, a, i, first, last), inner_product(a, j, a, j, first, last)
    if one + two > 1.0:  # the other parts are shorter
        first, last = p, a.shape[1]
        one, two = inner_product(a, i, a, i, first, last), inner_product(a, j, a, j, first, last)
    both = inner_product(a, i, a, j, first, last)
    if not abs(both) > ORTHOGONAL * np.sqrt(one) * np.sqrt(two):
        return False
    cosine, sine = _rotation(one, two, both)
    _turn(a, i, j, cosine, sine)
    return True
