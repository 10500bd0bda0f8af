"""The paper's two mechanisms as bare matrices, written down from reference/paper.toml alone."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vincula.model import LinearModel

Matrix = NDArray[np.float64]


def five_bar(paper: dict[str, Any], motors: Sequence[int]) -> LinearModel:
    """J and G of the five-bar; `motors` counts from 1 as the paper does."""
    data = paper["five_bar"]
    joints, contacts, at = data["joints"], data["contacts"], data["reference_point"]
    jacobian, grasp = np.zeros((6, 5)), np.zeros((3, 6))
    for limb, (contact, chain) in enumerate(zip(contacts, ((0, 1), (4, 3, 2)), strict=True)):
        rows = slice(3 * limb, 3 * limb + 3)
        for joint in chain:
            arm = np.subtract(contact, joints[joint])
            jacobian[rows, joint] = -arm[1], arm[0], 1.0
        arm = np.subtract(contact, at)
        grasp[:, rows] = np.array([[1, 0, -arm[1]], [0, 1, arm[0]], [0, 0, 1]]).T
    return LinearModel.from_matrices(
        jacobian,
        grasp,
        active=[k - 1 for k in motors],
        columns=[f"o{k}" for k in range(1, 6)],
        linear_rows=[True, True, False] * 2,
        length=1.0,
        name="five-bar",
    )


def stewart(paper: dict[str, Any], alpha: float, beta: float) -> LinearModel:
    """J and G of the Stewart platform: spherical (passive), prismatic motor, soft finger; degrees."""
    data = paper["stewart"]
    z = np.array([0.0, 0.0, data["height"]])
    jacobian, grasp = np.zeros((24, 24)), np.zeros((6, 24))
    for k in range(6):
        turn = np.radians(120.0 * (k // 2))
        offset = np.radians(alpha if k % 2 == 0 else beta)
        top = z + data["upper_radius"] * np.array([np.cos(turn), np.sin(turn), 0.0])
        foot = data["lower_radius"] * np.array([np.cos(turn + offset), np.sin(turn + offset), 0.0])
        leg = (top - foot) / np.linalg.norm(top - foot)
        rows, columns = slice(4 * k, 4 * k + 4), slice(4 * k, 4 * k + 4)
        select = np.zeros((4, 6))
        select[:3, :3] = np.eye(3)
        select[3, 3:] = leg
        joint = np.zeros((6, 4))
        joint[:3, 0] = leg
        joint[:3, 1:] = -_cross(top - foot)
        joint[3:, 1:] = np.eye(3)
        jacobian[rows, columns] = select @ joint
        object_side = np.eye(6)
        object_side[:3, 3:] = -_cross(top - z)
        grasp[:, rows] = (select @ object_side).T
    names = [f"{axis}{k}" for k in range(1, 7) for axis in ("p", "bx", "by", "bz")]
    return LinearModel.from_matrices(
        jacobian,
        grasp,
        active=[4 * k for k in range(6)],
        columns=names,
        linear_columns=[name.startswith("p") for name in names],
        linear_rows=[True, True, True, False] * 6,
        length=2.0,
        name="stewart",
    )


def _cross(v: Matrix) -> Matrix:
    x, y, z = v
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
