"""Eigenvalues and directions along a path: the same one keeps its place, through crossings and clusters.

Spectra come sorted and with arbitrary signs; along a path the second largest may become the largest.
Here directions are matched by overlap, clusters of nearly equal values as subspaces, and inside a
cluster the basis is the one nearest to the step before.  Source: numerics page, step 8.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.optimize import linear_sum_assignment

from vincula.arrays import Matrix, Vector
from vincula.numerics.subspaces import transported

CLUSTER: Final = 1e-3
"""Neighbouring values that differ by less than this, relatively, are one cluster: their vectors turn fast."""


@dataclass(frozen=True, slots=True, eq=False)
class Tracked:
    """Values and unit vectors at one step, in the order of the first step.

    Attributes:
        values: k values; nan where a value of the first step has vanished.
        vectors: n x k unit vectors, columns zero where the value is nan.
    """

    values: Vector
    vectors: Matrix


def clusters(values: Vector) -> list[list[int]]:
    """Indices of values (in descending order), those within `CLUSTER` of their neighbour together."""
    groups: list[list[int]] = []
    for k, value in enumerate(values):
        before = values[k - 1] if k else np.inf
        finite = np.isfinite(value) and np.isfinite(before)
        close = value == before or (finite and abs(before - value) <= CLUSTER * max(abs(before), abs(value)))
        if groups and close:
            groups[-1].append(k)
        else:
            groups.append([k])
    return groups


def follow_spectrum(values: Vector, vectors: Matrix, before: Tracked | None) -> Tracked:
    """The spectrum of this step in the order, and with the signs, of the step before.

    Args:
        values: k values in descending order.
        vectors: n x k orthonormal vectors.
        before: What this function gave one step before; None at the first step.
    """
    if before is None:
        return Tracked(np.array(values), np.array(vectors))
    if len(values) != len(before.values):
        return _with_other_count(values, vectors, before)
    chosen = _matched(values, vectors, before)
    new_values, new_vectors = np.array(values)[chosen], np.array(vectors)[:, chosen]
    for group in clusters(values):
        places = [list(chosen).index(k) for k in group]
        basis, old = new_vectors[:, places], before.vectors[:, places]
        # One vector: the sign; several: the turn inside their subspace that moves them least.
        new_vectors[:, places] = transported(basis, old)
    return Tracked(new_values, new_vectors)


def follow_spectra(steps: Sequence[tuple[Vector, Matrix]]) -> list[Tracked]:
    """Spectra along a path, each (values in descending order, orthonormal vectors)."""
    found: list[Tracked] = []
    for values, vectors in steps:
        found.append(follow_spectrum(values, vectors, found[-1] if found else None))
    return found


def _matched(values: Vector, vectors: Matrix, before: Tracked) -> Vector:
    """For every place of the step before, which vector of this step continues it.

    Overlap with a cluster counts as a whole, so that the arbitrary basis inside it does not matter.
    """
    overlap = (before.vectors.T @ vectors) ** 2
    shared = np.empty_like(overlap)
    for group in clusters(values):
        shared[:, group] = overlap[:, group].sum(axis=1, keepdims=True)
    rows, columns = linear_sum_assignment(-shared)
    return np.asarray(columns[np.argsort(rows)])


def _with_other_count(values: Vector, vectors: Matrix, before: Tracked) -> Tracked:
    """A spectrum with more or fewer values: the best matches keep their places, the rest follow."""
    overlap = (before.vectors.T @ vectors) ** 2
    rows, columns = linear_sum_assignment(-overlap)
    size = max(len(before.values), len(values))
    new_values, new_vectors = np.full(size, np.nan), np.zeros((len(vectors), size))
    rest = iter([k for k in range(len(values)) if k not in set(columns.tolist())])
    place = dict(zip(rows.tolist(), columns.tolist(), strict=True))
    for k in range(size):
        index = place.get(k)
        if index is None and k >= len(before.values):
            index = next(rest, None)
        if index is not None:
            sign = -1.0 if k in place and float(before.vectors[:, k] @ vectors[:, index]) < 0.0 else 1.0
            new_values[k], new_vectors[:, k] = values[index], sign * vectors[:, index]
    return Tracked(new_values, new_vectors)
