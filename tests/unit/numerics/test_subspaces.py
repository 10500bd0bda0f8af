"""Subspaces: kernels of decided rank, and bases transported along a path."""

from __future__ import annotations

import numpy as np
import pytest

from vincula.numerics.subspaces import complement, kernel, left_kernel, projector_distance, transported


def random_basis(rng: np.random.Generator, n: int, k: int) -> np.ndarray:
    return np.linalg.qr(rng.standard_normal((n, k)))[0]


def test_kernels_annihilate(rng: np.random.Generator) -> None:
    matrix = rng.standard_normal((7, 3)) @ rng.standard_normal((3, 5))
    right, left = kernel(matrix, 3), left_kernel(matrix, 3)
    assert right.shape == (5, 2)
    assert left.shape == (7, 4)
    assert np.abs(matrix @ right).max() < 1e-13
    assert np.abs(left.T @ matrix).max() < 1e-13
    full = left_kernel(matrix[:, :3], 3)
    assert projector_distance(full, left) < 1e-13


def test_complement_stays_in_the_space_and_away_from_the_other(rng: np.random.Generator) -> None:
    space = random_basis(rng, 6, 4)
    inside = space @ random_basis(rng, 4, 1)
    rest = complement(space, inside, 3)
    assert np.abs(rest.T @ inside).max() < 1e-14
    assert projector_distance(np.linalg.qr(np.hstack([inside, rest]))[0], space) < 1e-14


def test_transported_bases_do_not_jump_where_raw_ones_do() -> None:
    """A 2-D kernel that turns slowly; its singular vectors are arbitrary inside it."""
    rng = np.random.default_rng(5)
    start = random_basis(rng, 6, 6)
    previous, first, worst = None, None, 0.0
    steps = 200
    for step in range(steps + 1):
        angle = 0.5 * np.pi * step / steps
        turn = np.eye(6)
        turn[np.ix_([0, 2], [0, 2])] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
        basis = (start @ turn)[:, :2] @ random_basis(rng, 2, 2)
        if previous is None:
            previous = first = basis
            continue
        moved = transported(basis, previous)
        assert projector_distance(moved, basis) < 1e-14
        worst = max(worst, float(np.linalg.norm(moved - previous, 2)))
        previous = moved
    assert worst == pytest.approx(2.0 * np.sin(0.25 * np.pi / steps), rel=1e-6)
    assert first is not None
    assert float(np.linalg.norm(previous - first, 2)) == pytest.approx(2.0 * np.sin(np.pi / 4.0), rel=1e-9)


def test_projector_distance_of_different_dimensions_is_one(rng: np.random.Generator) -> None:
    assert projector_distance(random_basis(rng, 5, 2), random_basis(rng, 5, 3)) == 1.0
