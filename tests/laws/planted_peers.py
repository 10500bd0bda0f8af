"""Plain numpy beside the library, and comparisons that say what is broken."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from tests.laws.planted import Matrix

from vincula.numerics.subspaces import projector_distance

TIGHT = 1e-9
"""Subspaces and efficiencies of mechanisms with singular values down to 1e-3, from 1e-15 data."""
UNITS = 1e-7
"""The same where motor units over six orders lower the smallest singular values."""


def compare(pairs: dict[str, tuple[object, object]]) -> Iterator[str]:
    for name, (got, expected) in pairs.items():
        if got != expected:
            yield f"{name}: {got}, expected {expected}"


def small(name: str, values: Matrix) -> Iterator[str]:
    worst = float(np.abs(values).max(initial=0.0))
    if worst > TIGHT:
        yield f"{name}: {worst:.2g}, expected 0"


def same_values(name: str, got: Matrix, expected: Matrix, tolerance: float = TIGHT) -> Iterator[str]:
    if len(got) != len(expected):
        yield f"{name}: {len(got)} values, expected {len(expected)}"
    elif len(got) and float(np.abs(got / expected - 1.0).max()) > tolerance:
        yield f"{name}: {got}, expected {expected}"


def no_larger(name: str, got: Matrix, bound: Matrix) -> Iterator[str]:
    for value, limit in zip(got, bound, strict=False):
        if value > limit * (1.0 + TIGHT):
            yield f"{name}: {value} above {limit}"


def same_space(name: str, got: Matrix, expected: Matrix) -> Iterator[str]:
    distance = projector_distance(orthonormal(got), orthonormal(expected))
    if got.shape[1] != expected.shape[1] or distance > TIGHT:
        yield f"{name}: {got.shape[1]} directions for {expected.shape[1]}, distance {distance:.2g}"


def orthonormal(columns: Matrix) -> Matrix:
    return np.linalg.qr(columns / np.maximum(np.linalg.norm(columns, axis=0), 1e-300))[0]


def null(matrix: Matrix) -> Matrix:
    """Kernel by plain numpy; the planted singular values are far above 1e-8."""
    if 0 in matrix.shape:
        return np.eye(matrix.shape[1])
    _, values, right = np.linalg.svd(matrix)
    return right[int(np.count_nonzero(values > 1e-8 * max(1.0, values[0]))) :].T


def without(block: Matrix, removed: Matrix) -> Matrix:
    if 0 in removed.shape:
        return block
    left, values, _ = np.linalg.svd(removed, full_matrices=False)
    basis = left[:, values > 1e-8 * max(1.0, values[0])]
    return block - basis @ (basis.T @ block)


def inverse(matrix: Matrix) -> Matrix:
    """Pseudo-inverse with an absolute cutoff: the planted singular values are far above 1e-8."""
    left, values, right = np.linalg.svd(matrix, full_matrices=False)
    kept = values > 1e-8
    return (right[kept].T / values[kept]) @ left[:, kept].T


def nonzero(efficiencies: Matrix) -> Matrix:
    return efficiencies[efficiencies > 0.0]


def random_matrix(size: int, rng: np.random.Generator) -> Matrix:
    root = gentle(size, rng)
    return root @ root.T


def gentle(size: int, rng: np.random.Generator) -> Matrix:
    left, right = (np.linalg.qr(rng.standard_normal((size, size)))[0] for _ in range(2))
    return left * 3.0 ** rng.uniform(-1.0, 1.0, size) @ right
