"""No jumps along paths, through crossings and where values coincide."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from numpy.typing import NDArray

from vincula.numerics.tracking import Tracked, clusters, follow_spectra, follow_spectrum

Steps = list[tuple[NDArray[np.float64], NDArray[np.float64]]]


def spectrum(
    matrix: NDArray[np.float64], rng: np.random.Generator
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Descending eigenvalues, vectors with random signs."""
    values, vectors = np.linalg.eigh(matrix)
    return values[::-1].copy(), vectors[:, ::-1] * rng.choice([-1.0, 1.0], len(values))


def turning(seed: int, count: int) -> tuple[Steps, list[NDArray[np.float64]], NDArray[np.float64]]:
    """Eigenvalues that cross on straight lines, eigenvectors that turn smoothly."""
    rng = np.random.default_rng(seed)
    skew = rng.standard_normal((5, 5))
    skew = skew - skew.T
    start, end = rng.uniform(1, 3, 5), rng.uniform(1, 3, 5)
    steps, true, lines = [], [], []
    for t in np.linspace(0.0, 1.0, count):
        angle = 0.5 * t * skew
        basis = np.linalg.solve(np.eye(5) + angle, np.eye(5) - angle)  # Cayley
        values = start + t * (end - start)
        steps.append(spectrum(basis @ np.diag(values) @ basis.T, rng))
        true.append(basis)
        lines.append(values)
    return steps, true, np.array(lines)


@pytest.mark.parametrize("seed", range(20))
def test_values_go_on_through_crossings(seed: int) -> None:
    steps, true, lines = turning(seed, 401)
    found = follow_spectra(steps)
    order = np.argsort(-lines[0])
    # Values may be off by what belongs together as a cluster.
    off = max(float(np.abs(one.values - line[order]).max()) for one, line in zip(found, lines, strict=True))
    assert off < 0.02
    jumps = [
        float(np.abs(after.vectors - before.vectors).max())
        for before, after in itertools.pairwise(found)
    ]
    raw = [float(np.abs(after[1] - before[1]).max()) for before, after in itertools.pairwise(steps)]
    smooth = max(float(np.abs(b - a).max()) for a, b in itertools.pairwise(true))
    assert max(raw) > 0.3
    assert max(jumps) < 20 * smooth
    for one in found[::50]:
        assert np.abs(one.vectors.T @ one.vectors - np.eye(5)).max() < 1e-12


def test_equal_values_have_the_basis_nearest_to_the_one_before() -> None:
    rng = np.random.default_rng(2)
    first = follow_spectrum(np.array([2.0, 2.0, 1.0]), np.eye(3), None)
    turn = np.linalg.qr(rng.standard_normal((2, 2)))[0]
    mixed = np.eye(3)
    mixed[:2, :2] = turn
    again = follow_spectrum(np.array([2.0, 2.0, 1.0]), mixed, first)
    assert np.abs(again.vectors - np.eye(3)).max() < 1e-12


def test_clusters() -> None:
    assert clusters(np.array([3.0, 3.0 - 1e-6, 2.0, 0.0, 0.0])) == [[0, 1], [2], [3, 4]]
    assert clusters(np.array([np.inf, np.inf, 1.0])) == [[0, 1], [2]]


def test_a_value_that_vanishes_leaves_its_place_empty() -> None:
    first = follow_spectrum(np.array([3.0, 2.0, 1.0]), np.eye(3), None)
    fewer = follow_spectrum(np.array([3.1, 0.9]), np.eye(3)[:, [0, 2]], first)
    assert fewer.values[0] == 3.1
    assert np.isnan(fewer.values[1])
    assert fewer.values[2] == 0.9
    more = follow_spectrum(
        np.array([3.1, 2.5, 0.9]), np.eye(3), Tracked(np.array([3.0, 1.0]), np.eye(3)[:, [0, 2]])
    )
    assert more.values.tolist() == [3.1, 0.9, 2.5]
