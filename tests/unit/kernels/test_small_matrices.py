"""Decompositions in compiled loops against LAPACK: random, graded, rank-deficient, and passed over."""

from __future__ import annotations

import numpy as np
import pytest

from vincula.numerics.csd import angles_of_pair
from vincula.numerics.subspaces import settled

pytest.importorskip("numba")

from vincula.kernels.small_matrices import decomposed, lengths, paired_angles, products
from vincula.kernels.small_subspaces import cleared, complements, orthonormal, settled_bases


def sure(count: int) -> np.ndarray:
    return np.ones(count, dtype=bool)


@pytest.mark.parametrize(
    ("k", "p", "rank"), [(1, 3, 1), (4, 7, 4), (6, 3, 3), (6, 9, 4), (5, 5, 0), (0, 4, 0)]
)
def test_singular_values_and_kernels(k: int, p: int, rank: int, rng: np.random.Generator) -> None:
    vectors = rng.normal(size=(20, k, rank)) @ rng.normal(size=(20, rank, p))
    values, turn = decomposed(vectors, sure(20))
    for n in range(20):
        expected = np.zeros(k)
        expected[: min(k, p)] = np.linalg.svd(vectors[n], compute_uv=False)[:k]
        np.testing.assert_allclose(values[n], expected, rtol=0, atol=1e-13)
        np.testing.assert_allclose(turn[n] @ turn[n].T, np.eye(k), rtol=0, atol=1e-14)
        made = turn[n] @ vectors[n]
        np.testing.assert_allclose(made @ made.T, np.diag(values[n] ** 2), rtol=0, atol=1e-12)


def test_graded_values_keep_their_digits(rng: np.random.Generator) -> None:
    """Lengths over 12 orders: each is accurate relative to itself (Demmel and Veselic 1992)."""
    sizes = np.array([1.0, 1e-4, 1e-8, 1e-12])
    basis = np.linalg.qr(rng.normal(size=(6, 6)))[0][:, :4].T
    values, _ = decomposed((sizes[:, None] * basis)[None], sure(1))
    np.testing.assert_allclose(values[0], sizes, rtol=1e-13)


@pytest.mark.parametrize(("k", "p", "r"), [(1, 1, 1), (2, 3, 2), (3, 3, 6), (5, 6, 8)])
def test_angles(k: int, p: int, r: int, rng: np.random.Generator) -> None:
    tasks, motors = rng.normal(size=(20, k, p)), rng.normal(size=(20, k, r))
    tasks[:, 0] *= 1e-6
    joined = orthonormal(np.concatenate([tasks, motors], axis=2), sure(20))
    ratios, of_task, of_motor = paired_angles(joined, p, sure(20))
    for n in range(20):
        expected = angles_of_pair(tasks[n].T, motors[n].T)
        np.testing.assert_allclose(ratios[n], expected.ratios, rtol=1e-13, atol=1e-14)
        np.testing.assert_allclose(of_task[n] @ of_task[n].T, np.eye(k), rtol=0, atol=1e-9)
        np.testing.assert_allclose(of_motor[n] @ of_motor[n].T, np.eye(k), rtol=0, atol=1e-9)
        pairs = np.concatenate([of_task[n] * ratios[n][:, None], of_motor[n]], axis=1)
        inside = pairs - (pairs @ joined[n].T) @ joined[n]
        np.testing.assert_allclose(inside, 0.0, atol=1e-12 * max(1.0, ratios[n].max()))


def test_subspaces(rng: np.random.Generator) -> None:
    vectors = rng.normal(size=(10, 5, 3)) @ rng.normal(size=(10, 3, 7))
    basis = orthonormal(vectors, sure(10), 3)
    rest = complements(basis, sure(10))
    assert rest.shape == (10, 4, 7)
    for n in range(10):
        whole = np.concatenate([basis[n], rest[n]])
        np.testing.assert_allclose(whole @ whole.T, np.eye(7), rtol=0, atol=1e-14)
        np.testing.assert_allclose(vectors[n] @ rest[n].T, 0.0, atol=1e-13)
    apart = cleared(vectors, basis, sure(10))
    np.testing.assert_allclose(apart, 0.0, atol=1e-13)
    np.testing.assert_allclose(lengths(basis), 1.0, rtol=1e-14)


@pytest.mark.parametrize(("k", "p"), [(1, 3), (2, 6), (4, 6), (3, 3)])
def test_settled_bases_are_those_of_one_configuration(k: int, p: int, rng: np.random.Generator) -> None:
    basis = orthonormal(rng.normal(size=(20, k, p)), sure(20))
    found = settled_bases(basis, sure(20))
    for n in range(20):
        expected = settled(basis[n].T).T
        signs = np.sign((expected * found[n]).sum(axis=1, keepdims=True))
        np.testing.assert_allclose(found[n] * signs, expected, rtol=0, atol=1e-13)


def test_what_is_not_sure_is_passed_over(rng: np.random.Generator) -> None:
    """Lanes of NaN beside others neither stop anything nor change a bit."""
    vectors = rng.normal(size=(3, 4, 5))
    whole, _ = decomposed(vectors, sure(3))
    vectors[1] = np.nan
    values, _ = decomposed(vectors, np.array([True, False, True]))
    np.testing.assert_array_equal(values[[0, 2]], whole[[0, 2]])
    np.testing.assert_array_equal(decomposed(vectors[2:], sure(1))[0], whole[2:])


def test_products_share_a_matrix(rng: np.random.Generator) -> None:
    left, right = rng.normal(size=(4, 2, 3)), rng.normal(size=(3, 5))
    right.setflags(write=False)
    np.testing.assert_allclose(products(left, right[None], sure(4)), left @ right, rtol=1e-14)
