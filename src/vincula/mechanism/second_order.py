"""How the constraint matrices change as the mechanism moves: the exact derivative of J and G.

Every entry of the matrices is made of joint axes, their centres, row points and blocked directions
(see `jacobians`).  All of them sit on frames, so the motion of the frames says everything:

    d axis = omega x axis,   d centre = v,   J' = (rows' @ twists + rows @ twists') * signs.

The products are taken at a point that stands still for the moment; only the member's twist refers to
a point that moves with the member.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from vincula.arrays import Matrix, Vector
from vincula.mechanism.configuration import Configuration
from vincula.mechanism.frames import Indices, PlacedFrames
from vincula.mechanism.jacobians import blocked_matrix, screw_matrix
from vincula.mechanism.kinematics import body_poses, reference_position
from vincula.mechanism.layout import Layout, RowArrays, ScrewArrays
from vincula.mechanism.residuals import axis_values
from vincula.spatial.poses import Pose
from vincula.spatial.twists import block_rotation

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism


@dataclass(frozen=True, slots=True, eq=False)
class FrameMotion:
    """Velocities of all frames of a layout, in ground axes.

    Attributes:
        turn: k x r angular velocities (r = 1 in the plane) [rad/s].
        velocity: k x s velocities of the frames' origins [m/s].
    """

    turn: Matrix
    velocity: Matrix


class MatrixDerivative:
    """Directional derivatives of [J_a J_p G^T] of a mechanism at one configuration.

    Attributes:
        layout: Rows and columns.
        origin: The reference point in ground axes [m].
        twists: d x columns, twist of every column at the reference point.
    """

    def __init__(self, mechanism: Mechanism, q: Configuration) -> None:
        self._mechanism, self._q = mechanism, q
        self.layout: Layout = mechanism.layout
        poses = body_poses(mechanism, q)
        self._frames = self.layout.frames.placed(poses)
        self.origin = reference_position(mechanism, poses)
        self.twists = screw_matrix(self.layout.screws, self._frames, self.origin)
        self._blocked = blocked_matrix(self.layout.blocked, self._frames, self.origin)
        self._member_pose = _member_pose(mechanism, poses)
        self._group_of_frame = groups_of_frames(mechanism, self.layout)

    def frame_motion(self, rates: Vector, twist: Vector) -> FrameMotion:
        """Velocities of the frames for rates of the columns (layout order) and a twist of the member.

        Args:
            rates: Rate of every column, in the order of `layout.columns` [rad/s, m/s].
            twist: Twist of the member at the reference point, ground axes [m/s, rad/s].
        """
        order = np.concatenate([self.layout.active, self.layout.passive])
        carried = np.array(self.layout.group_carried, dtype=float)
        of_group = self.twists[:, order] @ (self.layout.path * rates[order]).T + np.outer(twist, carried)
        at_origin = of_group[:, self._group_of_frame].T
        s = len(self.origin)
        turn = at_origin[:, s:]
        return FrameMotion(turn, at_origin[:, :s] + _turned(turn, self._frames.position - self.origin))

    def along(self, rates: Vector, twist: Vector) -> tuple[Matrix, Matrix]:
        """Rates of J (layout's columns) and of G^T as the mechanism moves.

        Args:
            rates: Rate of every column, in the order of `layout.columns`.
            twist: Twist of the member at the reference point, ground axes.

        Returns:
            J' (m x columns) and the rate of G^T (m x d), in the axes that the reference member uses.
        """
        moving = self.frame_motion(rates, twist)
        s = len(self.origin)
        return self.of_frames(moving, twist[:s], twist[s:], rates)

    def of_frames(
        self, moving: FrameMotion, point_velocity: Vector, member_turn: Vector, rates: Vector
    ) -> tuple[Matrix, Matrix]:
        """Rates of J and G^T for any motion of the frames, consistent with the joints or not.

        Args:
            moving: Velocities of all frames.
            point_velocity: Velocity of the reference point [m/s].
            member_turn: Angular velocity of the reference member [rad/s].
            rates: Rates of the columns, for couplings that are not linear.
        """
        layout, s = self.layout, len(self.origin)
        twists = _screw_rates(layout.screws, self._frames, moving, self.origin)
        rows = _blocked_rates(layout.blocked, self._frames, moving, self.origin)
        jacobian = np.vstack(
            [(rows @ self.twists + self._blocked @ twists) * layout.signs, np.zeros_like(layout.constant)]
        )
        self._polynomial_rates(jacobian[len(rows) :], rates)
        # The twist of the member is that of a point which moves: its rows carry the arm along.
        around = _moment(np.broadcast_to(-point_velocity, (len(rows), s)), self._blocked[:, :s])
        moved = np.hstack([rows[:, :s], rows[:, s:] + around])
        member = np.zeros((len(jacobian), self._mechanism.space.dimension))
        member[: len(rows)] = layout.carried[:, None] * moved
        return jacobian, self._in_member_axes(member, member_turn)

    def _in_member_axes(self, member: Matrix, turn: Vector) -> Matrix:
        if self._member_pose is None:
            return member
        rotation = self._member_pose.rotation
        turned = np.stack([_turned(turn[None, :], axis[None, :])[0] for axis in rotation.T], axis=1)
        still = np.zeros_like(member)
        still[: len(self._blocked)] = self.layout.carried[:, None] * self._blocked
        rate = block_rotation(turned)
        if len(self.origin) == 2:
            rate[2, 2] = 0.0
        return member @ block_rotation(rotation) + still @ rate

    def _polynomial_rates(self, constant: Matrix, rates: Vector) -> None:
        layout, mechanism = self.layout, self._mechanism
        if not layout.polynomials:
            return
        values, home = axis_values(mechanism, self._q), axis_values(mechanism, mechanism.home)
        index = layout.index
        for k, coupling in layout.polynomials:
            terms = coupling.driver.items()
            inner = sum(c * (values[a] - coupling.references.get(a, home[a])) for a, c in terms)
            speed = sum(c * rates[index[a]] for a, c in terms if a in index)
            second = np.polynomial.polynomial.polyder(list(coupling.polynomial) or [0.0], 2)
            bend = float(np.polynomial.polynomial.polyval(inner, second)) * speed
            for axis, coefficient in terms:
                if axis in index:
                    constant[k, index[axis]] -= bend * coefficient


def _member_pose(mechanism: Mechanism, poses: dict[str, Pose]) -> Pose | None:
    """Pose of the member where twists are told in its axes, else None."""
    reference = mechanism.reference
    return poses[reference.body] if reference is not None and reference.axes == "body" else None


def groups_of_frames(mechanism: Mechanism, layout: Layout) -> Indices:
    """For every frame, the index of the rigid group of bodies that carries it."""
    group = {body: k for k, bodies in enumerate(mechanism.reduction.clusters.values()) for body in bodies}
    of_body = np.array([group[name] for name in layout.frames.bodies], dtype=np.intp)
    return np.asarray(of_body[layout.frames.carrier])


def _turned(turn: Matrix, offset: Matrix) -> Matrix:
    """omega x offset, row by row; in the plane omega is one number."""
    if offset.shape[1] == 2:
        return np.stack([-turn[:, 0] * offset[:, 1], turn[:, 0] * offset[:, 0]], axis=1)
    return np.cross(turn, offset)


def _moment(arm: Matrix, push: Matrix) -> Matrix:
    """arm x push, row by row: one number in the plane."""
    if arm.shape[1] == 2:
        return arm[:, :1] * push[:, 1:] - arm[:, 1:] * push[:, :1]
    return np.cross(arm, push)


def _screw_rates(screws: ScrewArrays, frames: PlacedFrames, moving: FrameMotion, origin: Vector) -> Matrix:
    """d x columns: derivative of `jacobians.screw_matrix`, the point standing still."""
    axis = (frames.rotation[screws.frame] @ screws.axis[:, :, None])[:, :, 0]
    arm = origin - frames.position[screws.centre]
    axis_rate = _turned(moving.turn[screws.frame], axis)
    arm_rate = -moving.velocity[screws.centre]
    slid = screws.slide[:, None] * axis_rate
    if len(origin) == 2:
        around = _turned(screws.turn[:, None], arm_rate)
        return np.vstack([(slid + around).T, np.zeros_like(screws.turn)])
    turned, turned_rate = screws.turn[:, None] * axis, screws.turn[:, None] * axis_rate
    return np.vstack([(slid + np.cross(turned_rate, arm) + np.cross(turned, arm_rate)).T, turned_rate.T])


def _blocked_rates(rows: RowArrays, frames: PlacedFrames, moving: FrameMotion, origin: Vector) -> Matrix:
    """rows x d: derivative of `jacobians.blocked_matrix`, the point standing still."""
    rotation = frames.rotation[rows.frame]
    omega = moving.turn[rows.frame]
    arm, arm_rate = frames.position[rows.point] - origin, moving.velocity[rows.point]
    push = (rotation @ rows.push[:, :, None])[:, :, 0]
    push_rate = _turned(omega, push)
    moment_rate = _moment(arm_rate, push) + _moment(arm, push_rate)
    if len(origin) == 2:
        return np.hstack([push_rate, moment_rate])
    turn_rate = _turned(omega, (rotation @ rows.turn[:, :, None])[:, :, 0])
    for k, other, axis in rows.across:
        first, second = rotation[k, :, 2], frames.rotation[other] @ axis
        turn_rate[k] = _common_normal_rate(
            first, second, np.cross(omega[k], first), np.cross(moving.turn[other], second)
        )
    return np.hstack([push_rate, moment_rate + turn_rate])


def _common_normal_rate(first: Vector, second: Vector, first_rate: Vector, second_rate: Vector) -> Vector:
    """Rate of the unit vector along first x second."""
    across = np.cross(first, second)
    size = float(np.linalg.norm(across))
    rate = np.cross(first_rate, second) + np.cross(first, second_rate)
    normal = across / size
    return np.asarray((rate - normal * (normal @ rate)) / size)
