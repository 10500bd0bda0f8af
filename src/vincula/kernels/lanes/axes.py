"""Directions that belong to no finite efficiency, for many configurations: free, idle, structural, internal.

Inside each of these subspaces directions are a choice; it is the one of the ordinary functions
(`numerics.subspaces.settled`): orthonormal in the metric and triangular on leading rows.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vincula.arrays import Vector
from vincula.numerics.subspaces import TIE

Stack = NDArray[np.float64]
"""N x vectors x components."""


def infinite_twists(free: Stack, roots: Vector) -> Stack:
    """Twists of the infinite kinematic efficiencies.

    Args:
        free: N x count x d orthonormal twists in lengths of the metric.
        roots: Roots of the d weights.
    """
    return _oriented(settled_stack(free) / roots)


def zero_rates(idle: Stack, roots: Vector) -> Stack:
    """Rates of the kinematic efficiencies that are zero; arguments as `infinite_twists`."""
    return _oriented(settled_stack(idle) / roots)


def infinite_wrenches(free: Stack, twists: Stack, roots: Vector) -> Stack:
    """Wrenches carried without torque: what no motion of the member feels.

    Args:
        free: N x count x d orthonormal twists in lengths of the metric.
        twists: N x finite x d twists of length one in the metric.
        roots: Roots of the d weights of twists; wrenches are measured by the reciprocals.
    """
    return _oriented(settled_stack(_complement(np.concatenate([free, twists * roots], axis=1))) * roots)


def zero_torques(idle: Stack, rates: Stack, roots: Vector) -> Stack:
    """Torques balanced without a wrench: what no allowed rate feels; arguments as `infinite_wrenches`."""
    return _oriented(settled_stack(_complement(np.concatenate([idle, rates * roots], axis=1))) * roots)


def settled_stack(basis: Stack) -> Stack:
    """Orthonormal vectors of the same subspaces, triangular on their leading rows."""
    lanes, count, size = basis.shape
    if count < 2 or lanes == 0:
        return basis
    if count == size:
        return np.broadcast_to(np.eye(size), basis.shape)
    rows = _leading(basis, count)
    leading = np.take_along_axis(basis, rows[:, None, :], axis=2)
    turn = np.linalg.qr(leading)[0]
    return np.asarray(turn.transpose(0, 2, 1) @ basis)


def _leading(basis: Stack, count: int) -> NDArray[np.intp]:
    """N x count components: each the first of those that stick out most beside the ones before."""
    left = np.array(basis)
    lanes = np.arange(len(basis))
    chosen = np.zeros((len(basis), count), dtype=np.intp)
    taken = np.zeros((len(basis), basis.shape[2]), dtype=bool)
    for k in range(count):
        lengths = np.sqrt(np.einsum("nci,nci->ni", left, left))
        lengths[taken] = -1.0
        enough = lengths >= (1.0 - TIE) * lengths.max(axis=1, keepdims=True)
        chosen[:, k] = enough.argmax(axis=1)
        taken[lanes, chosen[:, k]] = True
        longest = lengths[lanes, chosen[:, k]]
        direction = left[lanes, :, chosen[:, k]] / np.where(longest > 0.0, longest, 1.0)[:, None]
        along = np.einsum("nci,nc->ni", left, direction)
        left = (
            left - np.where(longest > 0.0, 1.0, 0.0)[:, None, None] * direction[:, :, None] * along[:, None]
        )
    return chosen


def _complement(vectors: Stack) -> Stack:
    """Orthonormal basis of what is orthogonal to orthonormal vectors."""
    lanes, count, size = vectors.shape
    if count == size or lanes == 0:
        return np.empty((lanes, size - count, size))
    if count == 0:
        return np.broadcast_to(np.eye(size), (lanes, size, size))
    good = np.asarray(np.isfinite(vectors).all(axis=(1, 2)))
    safe = np.where(good.reshape(lanes, 1, 1), vectors, np.eye(size)[:count])
    return np.asarray(np.linalg.svd(safe)[2][:, count:])


def _oriented(vectors: Stack) -> Stack:
    """The largest component of every vector positive, the first among equals; no negative zeros."""
    if 0 in vectors.shape:
        return vectors
    size = np.abs(vectors)
    enough = np.asarray(size >= size.max(axis=2, keepdims=True, initial=0.0) * (1.0 - 1e-9))
    first = np.argmax(enough, axis=2)
    picked: Stack = np.take_along_axis(vectors, first[:, :, None], axis=2)
    signs = np.sign(picked) + (picked == 0.0)
    return np.asarray(vectors * signs + 0.0)
