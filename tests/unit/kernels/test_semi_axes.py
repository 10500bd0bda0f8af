"""Singular values of many small matrices: LAPACK's, the same bits whatever stands beside them."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest

pytest.importorskip("numba", reason="extra fast")
from vincula.kernels.semi_axes import singular_values


@pytest.mark.parametrize("shape", [(6, 3), (3, 3), (2, 3), (6, 2), (2, 2), (1, 3), (5, 6), (6, 1), (0, 3)])
def test_as_lapack(shape: tuple[int, int], rng: np.random.Generator) -> None:
    rows = rng.normal(size=(200, *shape)) * 10.0 ** rng.uniform(-5.0, 5.0, (200, shape[0], 1))
    expected = np.linalg.svd(rows, compute_uv=False)
    largest = expected[:, :1] if min(shape) else 1.0
    assert (np.abs(singular_values(rows) - expected) <= 4e-15 * largest).all()


def test_small_values_keep_their_own_digits(rng: np.random.Generator) -> None:
    """Rows of very different size: LAPACK loses what is small, 50 digits do not."""
    rows = rng.normal(size=(20, 3, 3)) * np.array([1.0, 1e-6, 1e-12])[:, None]
    with mpmath.workdps(50):
        exact = np.array([[float(s) for s in mpmath.svd_r(mpmath.matrix(m), compute_uv=False)] for m in rows])
    np.testing.assert_allclose(singular_values(rows), np.sort(exact)[:, ::-1], rtol=1e-13)


def test_equal_zero_and_parallel_columns() -> None:
    one = np.array([[3.0, 0.0, 4.0], [0.0, 5.0, 0.0]])
    np.testing.assert_array_equal(singular_values(one[None]), [[5.0, 5.0]])
    np.testing.assert_array_equal(singular_values(np.zeros((2, 6, 3))), np.zeros((2, 3)))
    found = singular_values(np.tile(np.array([[1.0], [2.0], [2.0]]), (1, 1, 3)).reshape(1, 3, 3))[0]
    assert found[0] == pytest.approx(3.0 * np.sqrt(3.0), rel=1e-15)
    assert (found[1:] < 1e-15).all()


def test_bits_do_not_depend_on_the_others(rng: np.random.Generator) -> None:
    rows = rng.normal(size=(40, 6, 3)) * 10.0 ** rng.uniform(-9.0, 0.0, (40, 1, 3))
    whole = singular_values(rows)
    rows[::2] = np.nan
    np.testing.assert_array_equal(singular_values(rows)[1::2], whole[1::2])
    for k in (1, 7, 39):
        np.testing.assert_array_equal(singular_values(rows[k : k + 1])[0], whole[k])
