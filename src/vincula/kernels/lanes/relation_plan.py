"""The order in which limbs enter the relation, and the ranks on the way."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vincula.arrays import Matrix
from vincula.kernels.lanes.elimination_plan import ordered
from vincula.numerics.lapack import qr_full


@dataclass(slots=True, eq=False)
class LimbPlan:
    """One limb in the relation.

    Attributes:
        limb: Index of the limb.
        motors: Its motors.
        rows: Its reduced rows.
        motor_rank: Rank of their motor columns.
        motor_order: Order of all their columns, independent motors first.
        rank: Rank of the rows beside those of the limbs before.
        row_order: Rows, independent ones first.
        before: Motions left before this limb.
    """

    limb: int
    motors: list[int]
    rows: int
    motor_rank: int
    motor_order: list[int]
    rank: int
    row_order: list[int]
    before: int


@dataclass(slots=True, eq=False)
class RelationPlan:
    """All limbs in order, and the ranks of the columns of the twist.

    Attributes:
        limbs: The limbs, those that take most freedom first.
        freedom: Number of motions k.
        object_rank: Rank of the twist columns of all reduced rows.
        object_order: Their order, independent ones first.
        rest_rows: Rows that motors leave.
        rest_rank: Rank of their twist columns.
        rest_order: Order of those.
    """

    limbs: list[LimbPlan]
    freedom: int
    object_rank: int
    object_order: list[int]
    rest_rows: int
    rest_rank: int
    rest_order: list[int]


def plan_relation(
    reduced: Sequence[Sequence[Matrix]],
    motors: Sequence[list[int]],
    twist: int,
    scales: Sequence[float],
) -> RelationPlan:
    """Orders and ranks of the relation.

    Args:
        reduced: For every limb its reduced rows at every sample, full width.
        motors: For every limb its motors.
        twist: Number of twist components d.
        scales: Sizes of the samples.
    """
    order = sorted(
        (limb for limb in range(len(reduced)) if motors[limb] or len(reduced[limb][0])),
        key=lambda limb: (len(motors[limb]) - len(reduced[limb][0]), limb),
    )
    bases = [np.eye(twist) for _ in scales]
    freedom, limbs = twist, []
    rest: list[list[Matrix]] = [[] for _ in scales]
    for limb in order:
        rows, own = reduced[limb], motors[limb]
        of_motors = [block[:, own] for block in rows]
        rank, columns = ordered(of_motors, scales)
        for k, block in enumerate(rows):
            turned = qr_full(of_motors[k][:, columns[:rank]]).T @ block[:, -twist:]
            rest[k].append(turned[rank:])
        joined = [np.hstack([of_motors[k], block[:, -twist:] @ bases[k]]) for k, block in enumerate(rows)]
        against, row_order = ordered([block.T for block in joined], scales)
        plan = LimbPlan(
            limb, own, len(rows[0]), rank, [*columns, *range(len(own), len(own) + twist)],
            against, row_order, freedom,
        )  # fmt: skip
        limbs.append(plan)
        for k, block in enumerate(joined):
            kernel = qr_full(block.T[:, row_order[:against]])[:, against:]
            bases[k] = bases[k] @ kernel[len(own) :]
        freedom += len(own) - against
    everything = [np.vstack([rows[k][:, -twist:] for rows in reduced]) for k in range(len(scales))]
    object_rank, object_order = ordered(everything, scales)
    left = [np.vstack([np.zeros((0, twist)), *parts]) for parts in rest]
    rest_rank, rest_order = ordered(left, scales)
    return RelationPlan(limbs, freedom, object_rank, object_order, len(left[0]), rest_rank, rest_order)
