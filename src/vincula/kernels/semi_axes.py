"""Singular values of many small matrices: for indices that look at translation or rotation alone.

LAPACK takes one matrix a call and spends more on the call than on three columns.  Rotations of columns
(one-sided Jacobi) also keep small values to their own last digits (Demmel & Veselic 1992).

Imported late, and only where numba is installed.
"""

from __future__ import annotations

from typing import Any, Final

import numba
import numpy as np
from numpy.typing import NDArray

from vincula.arrays import Matrix

MOST_SWEEPS: Final = 30
"""Sweeps over all pairs of columns; matrices of three columns need three to six."""
ORTHOGONAL: Final = 4.0 * float(np.finfo(np.float64).eps)
"""Columns count as orthogonal when the cosine between them is below this."""


def singular_values(matrices: NDArray[np.float64]) -> Matrix:
    """Singular values of N small matrices, largest first; of those that are finite.

    What one matrix gives does not depend on the others, bit for bit.

    Args:
        matrices: N x rows x columns.

    Returns:
        N x min(rows, columns).
    """
    rows, columns = matrices.shape[1:]
    # The shorter side is rotated.  The copy is the function's own: it is overwritten.
    sides = np.array(matrices if rows <= columns else matrices.transpose(0, 2, 1), np.float64, order="C")
    found = np.empty(sides.shape[:2])
    _rotate_all(sides, found)
    return found


@numba.njit(error_model="numpy", nogil=True, cache=True)  # type: ignore[untyped-decorator]
def _rotate_all(sides: Any, found: Any) -> None:
    count, size, length = sides.shape
    for n in range(count):
        for _ in range(MOST_SWEEPS):
            turned = False
            for i in range(size):
                for j in range(i + 1, size):
                    one = two = both = 0.0
                    for k in range(length):
                        one += sides[n, i, k] * sides[n, i, k]
                        two += sides[n, j, k] * sides[n, j, k]
                        both += sides[n, i, k] * sides[n, j, k]
                    if not abs(both) > ORTHOGONAL * np.sqrt(one) * np.sqrt(two):
                        continue
                    turned = True
                    half = (two - one) / (2.0 * both)
                    tangent = 1.0 / (abs(half) + np.sqrt(1.0 + half * half))
                    tangent = -tangent if half < 0.0 else tangent
                    cosine = 1.0 / np.sqrt(1.0 + tangent * tangent)
                    sine = cosine * tangent
                    for k in range(length):
                        a, b = sides[n, i, k], sides[n, j, k]
                        sides[n, i, k] = cosine * a - sine * b
                        sides[n, j, k] = sine * a + cosine * b
            if not turned:
                break
        for i in range(size):
            total = 0.0
            for k in range(length):
                total += sides[n, i, k] * sides[n, i, k]
            place = i
            while place > 0 and found[n, place - 1] < np.sqrt(total):
                found[n, place] = found[n, place - 1]
                place -= 1
            found[n, place] = np.sqrt(total)
