"""The number of BLAS threads while small matrices are decomposed."""

from __future__ import annotations

import numpy as np
import pytest

from vincula.numerics import blas
from vincula.numerics.lapack import jacobi_svd


def numbers() -> list[int]:
    return [get() for get, _ in blas._switches()]


def test_one_thread_within_and_the_number_before_after() -> None:
    before = numbers()
    with blas.one_blas_thread():
        assert numbers() == [1] * len(before)
        values = jacobi_svd(np.diag([3.0, 2.0, 1.0]))[1]
    np.testing.assert_allclose(values, [3.0, 2.0, 1.0])
    assert numbers() == before


def test_the_number_comes_back_after_an_error() -> None:
    before = numbers()
    with pytest.raises(ZeroDivisionError), blas.one_blas_thread():
        raise ZeroDivisionError
    assert numbers() == before


def test_libraries_without_a_switch_are_left_alone(monkeypatch) -> None:
    monkeypatch.setattr(blas, "NAMES", ("no_such_{}_function",))
    blas._switches.cache_clear()
    try:
        with blas.one_blas_thread():
            assert blas._switches() == ()
    finally:
        blas._switches.cache_clear()
