"""Poses of the reference member in lanes, written as x y angle or x y z qw qx qy qz."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vincula.arrays import Matrix

if TYPE_CHECKING:
    from vincula.kernels.lanes.program import LaneProgram


def poses_in_lanes(program: LaneProgram, values: Matrix, constants: Matrix | None) -> Matrix:
    """N x 3 or N x 7 poses of the reference point and body axes in ground axes [m, rad].

    Args:
        program: The mechanism in lanes.
        values: N x coordinates.
        constants: N x constants where dimensions differ from lane to lane.
    """
    from vincula.kernels.lanes.entries import lanes_of_this_machine
    from vincula.kernels.lanes.pose_entry import pose_entry

    frames = np.empty((len(values), 12))
    given = program.constants if constants is None else np.ascontiguousarray(constants)
    base = 0 if constants is None else constants.shape[1]
    if len(values):
        width = 1 if len(values) == 1 else lanes_of_this_machine()
        rows = np.require(values, dtype=np.float64, requirements=["C", "W"])
        pose_entry(width)(rows, program.code, given, base, frames)
    length = program.mechanism.length
    turns, points = frames[:, :9].reshape(-1, 3, 3), frames[:, 9:] * length
    if program.mechanism.space.translations == 2:
        return np.column_stack([points[:, :2], np.arctan2(turns[:, 1, 0], turns[:, 0, 0])])
    return np.concatenate([points, quaternions(turns)], axis=1)


def quaternions(turns: NDArray[np.float64]) -> Matrix:
    """N x 4 unit quaternions (w, x, y, z), w >= 0, of N rotation matrices (Shepperd 1978)."""
    diagonal = np.einsum("nii->ni", turns)
    squares = np.column_stack([diagonal.sum(axis=1), diagonal])  # the largest is never below 1/3 of the sum
    largest = np.where(np.isfinite(squares), squares, -1.0).argmax(axis=1)
    found = np.empty((len(turns), 4))
    for k in range(4):
        lanes = np.flatnonzero(largest == k)
        found[lanes] = _from_largest(turns[lanes], k)
    found /= np.sqrt(np.einsum("ni,ni->n", found, found))[:, None]
    found[found[:, 0] < 0.0] *= -1.0
    return found


def _from_largest(turns: NDArray[np.float64], k: int) -> Matrix:
    """Quaternions up to a factor, from the component (0 for w, 1 to 3 for x, y, z) that is largest."""
    skew = [turns[:, 2, 1] - turns[:, 1, 2], turns[:, 0, 2] - turns[:, 2, 0], turns[:, 1, 0] - turns[:, 0, 1]]
    trace = np.einsum("nii->n", turns)
    if k == 0:
        return np.column_stack([1.0 + trace, *skew])
    i = k - 1
    sums = [turns[:, i, j] + turns[:, j, i] for j in range(3)]
    sums[i] = 1.0 - trace + 2.0 * turns[:, i, i]
    return np.column_stack([skew[i], *sums])
