"""Numbers for a layout at a configuration: J_a, J_p and G with named rows and columns.

Every joint axis is written once, as a twist at the reference point in ground axes, every blocked
direction once, as a row on such twists.  Their products, with the layout's signs, are the Jacobian:

    J = (rows @ twists) * signs,    G^T = carried * rows.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from vincula.arrays import Matrix, Vector, frozen
from vincula.errors import ClosureError, MissingReferenceError
from vincula.labels import BodyMotions, Uncertainty
from vincula.mechanism.blocked import common_normal
from vincula.mechanism.configuration import Configuration
from vincula.mechanism.exact import exact_blocks
from vincula.mechanism.frames import PlacedFrames
from vincula.mechanism.kinematics import body_poses, reference_position
from vincula.mechanism.layout import Layout, RowArrays, ScrewArrays
from vincula.mechanism.motor_weights import weights_of_motors
from vincula.mechanism.residuals import CLOSED, axis_values, residuals_of_frames
from vincula.model import LinearModel
from vincula.spatial.twists import block_rotation, cross_rows

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism
    from vincula.numerics.evidence import NearestSingular
    from vincula.numerics.ledger import MatrixName


def linearize(mechanism: Mechanism, q: Configuration) -> LinearModel:
    """The linear model of a mechanism at a closed configuration: eqs. (1) and (15).

    Raises:
        MissingReferenceError: No reference member is named.
        ClosureError: A loop or contact is open.
    """
    reference = mechanism.reference
    if reference is None:
        raise MissingReferenceError(body.name for body in mechanism.bodies)
    layout = mechanism.layout
    poses = body_poses(mechanism, q)
    frames = layout.frames.placed(poses)
    residual = _closed(mechanism, q, frames)
    origin = reference_position(mechanism, poses)
    twists = screw_matrix(layout.screws, frames, origin)
    jacobian, member = _matrices(mechanism, layout, q, blocked_matrix(layout.blocked, frames, origin), twists)
    if reference.axes == "body":
        member = member @ block_rotation(poses[reference.body].rotation)
    precision = mechanism.precision
    return LinearModel(
        jacobian_active=jacobian[:, layout.active],
        jacobian_passive=jacobian[:, layout.passive],
        grasp=member.T,
        rows=layout.rows,
        motors=tuple(layout.columns[k] for k in layout.active),
        passives=tuple(layout.columns[k] for k in layout.passive),
        space=mechanism.space,
        length=mechanism.length,
        uncertainty=Uncertainty(
            residual,
            precision.digits_length,
            precision.digits_angle,
            precision.tolerance_length,
            precision.tolerance_angle,
            _curvature(mechanism, layout, frames, origin),
        ),
        mechanism=mechanism.name,
        reference=reference.label or reference.body,
        frame="ground axes" if reference.axes == "ground" else f"axes of {reference.body}",
        cuts=layout.labels(frames.position),
        notes=(*mechanism.notes, *mechanism.reduction.notes),
        weights=weights_of_motors(mechanism),
        motions=BodyMotions(
            names=layout.groups,
            screws=frozen(twists[:, np.concatenate([layout.active, layout.passive])]),
            path=layout.path,
            carried=layout.group_carried,
            origin=frozen(np.array(origin)),
        ),
        exact=partial(exact_blocks, mechanism, q),
        nearest=partial(_nearest, mechanism, q),
    )


def _nearest(
    mechanism: Mechanism, q: Configuration, doubtful: tuple[MatrixName, ...]
) -> NearestSingular | None:
    """The singular configuration near a doubtful one; imported where it is used."""
    from vincula.mechanism.nearest import nearest_singular

    return nearest_singular(mechanism, q, doubtful)


def _closed(mechanism: Mechanism, q: Configuration, frames: PlacedFrames) -> float:
    """Largest residual, refusing open loops."""
    residuals = residuals_of_frames(mechanism, q, frames)
    if not residuals:
        return 0.0
    worst = max(residuals, key=lambda r: r.gap)
    if not worst.gap <= CLOSED * mechanism.length:
        others = sum(1 for r in residuals if r.gap > CLOSED * mechanism.length) - 1
        more = f" ({others} more open)" if others else ""
        raise ClosureError(
            f"{worst}{more}: the configuration does not satisfy the mechanism, and nothing was moved. "
            "Give values for all joints of the loop that close it, or close it with `Mechanism.close`.",
            loop=worst.name,
            gap=worst.gap,
            residuals=residuals,
        )
    return worst.gap


def screw_matrix(screws: ScrewArrays, frames: PlacedFrames, origin: Vector) -> Matrix:
    """d x columns: twist of every column at `origin`, in ground axes, for a unit of its rate."""
    axis = (frames.rotation[screws.frame] @ screws.axis[:, :, None])[:, :, 0]
    arm = origin - frames.position[screws.centre]
    turned = screws.turn[:, None] * axis
    slid = screws.slide[:, None] * axis
    if len(origin) == 2:
        around = np.stack([-arm[:, 1], arm[:, 0]], axis=1) * screws.turn[:, None]
        return np.vstack([(slid + around).T, screws.turn])
    return np.vstack([(slid + cross_rows(turned, arm)).T, turned.T])


def blocked_matrix(rows: RowArrays, frames: PlacedFrames, origin: Vector) -> Matrix:
    """rows x d: the blocked directions, as rows on twists at `origin` in ground axes."""
    rotation = frames.rotation[rows.frame]
    arm = frames.position[rows.point] - origin
    push = (rotation @ rows.push[:, :, None])[:, :, 0]
    if len(origin) == 2:
        around = arm[:, :1] * push[:, 1:] - arm[:, 1:] * push[:, :1]
        return np.hstack([push, around + rows.turn])
    turn = (rotation @ rows.turn[:, :, None])[:, :, 0]
    for k, other, axis in rows.across:
        turn[k] = common_normal(rotation[k, :, 2], frames.rotation[other] @ axis)
    return np.hstack([push, cross_rows(arm, push) + turn])


def _matrices(
    mechanism: Mechanism, layout: Layout, q: Configuration, blocked: Matrix, twists: Matrix
) -> tuple[Matrix, Matrix]:
    """J over all columns, and G^T in ground axes; adding 0.0 turns -0.0 into 0.0."""
    jacobian = np.vstack([(blocked @ twists) * layout.signs, layout.constant]) + 0.0
    member = np.zeros((len(jacobian), mechanism.space.dimension))
    member[: len(blocked)] = layout.carried[:, None] * blocked + 0.0
    if layout.polynomials:
        values, home = axis_values(mechanism, q), axis_values(mechanism, mechanism.home)
        index = layout.index
        for k, coupling in layout.polynomials:
            for axis, coefficient in coupling.coefficients(values, home).items():
                if axis in index:
                    jacobian[len(blocked) + k, index[axis]] = coefficient
    return jacobian, member


def _curvature(mechanism: Mechanism, layout: Layout, frames: PlacedFrames, origin: Vector) -> float:
    """Bound K on the second derivatives of the loop equations in scaled units.

    Along a chain of n axes |f''(v, v)| <= (sum |v_i|)^2 r <= n r |v|^2 with r the largest distance
    of its joints from the cut; the member's own motion counts as one more chain.
    """
    joints = frames.position[1 : 1 + 2 * len(mechanism.joints) : 2] - origin
    reach = float(np.sqrt((joints * joints).sum(axis=1).max(initial=0.0)))
    return max(1, layout.longest) * max(1.0, reach / mechanism.length)
