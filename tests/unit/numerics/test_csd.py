"""Cosines and sines: orthonormal and paired directions, clusters, graded pairs, exact products."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from vincula.numerics.csd import angles_of_pair, deflated
from vincula.numerics.csd_graded import angles_of_graded_pair
from vincula.numerics.echelon import exact_product, graded_pivots, refined_kernel


def orthonormal(columns: np.ndarray) -> float:
    return float(np.abs(columns.T @ columns - np.eye(columns.shape[1])).max(initial=0.0))


RATIOS = {
    "six times one": [1.0] * 6,
    "spread": [1e8, 30.0, 1.0, 1.0, 0.2, 1e-9],
    "large": [1e12, 1e7, 5.0],
    "small": [0.5, 0.5, 1e-7],
}


@pytest.mark.parametrize("ratios", RATIOS.values(), ids=RATIOS.keys())
@pytest.mark.parametrize("decompose", [angles_of_pair, angles_of_graded_pair])
def test_directions_are_orthonormal_and_paired(ratios: list[float], decompose, rng) -> None:
    k = len(ratios)
    sines = 1.0 / np.sqrt(1.0 + np.square(ratios))
    task = np.linalg.qr(rng.standard_normal((k + 2, k)))[0] * (sines * ratios)
    motor = np.linalg.qr(rng.standard_normal((k + 1, k)))[0] * sines
    mix = rng.standard_normal((k, k)) + 3.0 * np.eye(k)
    angles = decompose(task @ mix, motor @ mix)
    assert orthonormal(angles.task) < 1e-14
    assert orthonormal(angles.motor) < 1e-14
    assert angles.cosines**2 + angles.sines**2 == pytest.approx(1.0, abs=1e-14)
    assert angles.ratios[: k // 2] == pytest.approx(ratios[: k // 2], rel=1e-3)
    assert (np.diff(angles.ratios) <= 1e-12 * angles.ratios[1:]).all()
    # Every column of the pair is a motion: it lies in the range of the stack.
    stack = np.linalg.qr(np.vstack([task @ mix, motor @ mix]))[0]
    pairs = np.vstack([angles.task * angles.cosines, angles.motor * angles.sines])
    assert np.abs(pairs - stack @ (stack.T @ pairs)).max() < 1e-13


def test_ratios_are_generalised_singular_values(rng: np.random.Generator) -> None:
    task, motor = rng.standard_normal((5, 3)), rng.standard_normal((4, 3))
    expected = np.sqrt(np.sort(np.linalg.eigvals(np.linalg.solve(motor.T @ motor, task.T @ task)).real)[::-1])
    assert angles_of_pair(task, motor).ratios == pytest.approx(expected, rel=1e-12)
    assert angles_of_graded_pair(task, motor).ratios == pytest.approx(expected, rel=1e-12)


def test_small_blocks_are_legal() -> None:
    assert len(angles_of_pair(np.empty((3, 0)), np.empty((2, 0))).ratios) == 0
    one = angles_of_pair(np.array([[3.0], [4.0]]), np.array([[2.0]]))
    assert one.ratios == pytest.approx([2.5])


def test_deflation_removes_heavy_rows_exactly() -> None:
    fixed = np.array([[1e8], [1.0], [0.0]])
    block = np.array([[3e8], [5.0], [1e-8]])
    coordinates, basis, rest = deflated(block, fixed)
    assert np.abs(rest.T @ basis).max() < 1e-15
    assert np.sort(np.abs(coordinates[:, 0])) == pytest.approx([1e-8, 2.0], rel=1e-12)


def test_exact_product_is_rounded_once(rng: np.random.Generator) -> None:
    a = rng.standard_normal((3, 7)) * 10.0 ** rng.uniform(-8, 8, (3, 7))
    x = rng.standard_normal((7, 2)) * 10.0 ** rng.uniform(-8, 8, (7, 2))
    found = exact_product(a, x)
    for i in range(3):
        for j in range(2):
            exact = sum(Fraction(float(p)) * Fraction(float(q)) for p, q in zip(a[i], x[:, j], strict=True))
            assert found[i, j] == pytest.approx(float(exact), rel=4e-16)


def test_refined_kernel_has_accurate_small_entries() -> None:
    """One third cannot be typed: the exact kernel entry 1e-17 is what rounding left, to all digits."""
    third = 1.0 / 3.0
    matrix = np.array([[3.0, 1.0, -1.0, 0.0], [1.0, third, 0.0, -third]])
    found = refined_kernel(matrix, 2, [0, 1], [])
    exact = [float(-(Fraction(third) * 0 - 1) / Fraction(third)), 1.0]
    assert found[2] == pytest.approx([3.0, 1.0], rel=1e-16)
    assert found[3] == pytest.approx([exact[0], 1.0], rel=1e-16)


def test_pivots_follow_sizes_but_not_into_dependence() -> None:
    basis = np.array([[1.0, 0.0], [2.0, 1e-14], [0.0, 1.0]])
    sizes = np.array([1e8, 1e8, 1e-8])
    assert sorted(graded_pivots(basis, sizes, 2)) == [1, 2]
    assert graded_pivots(basis, sizes, 1, taken=[2]) == [1]
