"""How y^T A k changes as a mechanism moves or is drawn differently: forces on its frames.

With contact forces y and a motion k held, y^T A k with A = [J_a J_p -G^T] depends on where the frames are.
Its rate is a virtual work: that of some forces on the frames, for every velocity of theirs.  So one pair
(y, k) is read once, and what it says for any number of motions and dimensions is one product each; for
many rates of A itself see `second_order`, which says the same the other way round.

With t a screw, b a blocked direction, w = sum of y b the wrench that a column feels and x = sum of k t the
twist that a row sees, all at the reference point (f, m the halves of a wrench, v, o of a twist):

    y^T A k = sum over columns k t . w,     d t:  slide x f + turn x (arm x f + m)  on the axis,
                                                  turn x f                          at its centre;
            = sum over rows    y b . x,     d b:  push x (v + o x lever) + spin x o on the axes,
                                                  push x o                          at the point.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from vincula.arrays import Matrix
from vincula.mechanism.many_frames import Stack, crossed
from vincula.mechanism.many_matrices import ManyMatrices, ordered
from vincula.mechanism.redrawn import Redrawn
from vincula.mechanism.second_order import groups_of_frames


@dataclass(frozen=True, slots=True, eq=False)
class Pairs:
    """Contact forces and motions, e pairs at each of N configurations.

    Attributes:
        forces: N x e x m, one number a row of A, in N and N m.
        rates: N x e x columns, in the order of `layout.columns` [rad/s, m/s].
        twists: N x e x 6 twists of the member, ground axes [m/s, rad/s].
    """

    forces: Stack
    rates: Stack
    twists: Stack


class FrameForces:
    """The forces whose virtual work is the rate of y^T A k.

    Args:
        many: The configurations.
        pairs: y and k.

    Attributes:
        felt: N x e x columns x 6, the wrench that every column feels, at the reference point.
        seen: N x e x rows x 6, the twist that every row from geometry sees there.
        on_point: N x e x 3, force on the reference point as a point of the member.
        on_turn: N x e x 3, torque on the axes in which the member's twist is told.
        on_rates: N x e x columns, force on the columns by themselves: couplings that are not linear.
    """

    def __init__(self, many: ManyMatrices, pairs: Pairs) -> None:
        self.many, self.pairs = many, pairs
        layout = many.layout
        held = pairs.forces[:, :, : len(layout.signs), None] * many.blocked[:, None]
        moved = pairs.rates[..., None] * many.screws[:, None]
        self.felt: Stack = layout.signs.T @ held
        self.seen: Stack = layout.signs @ moved - layout.carried[:, None] * pairs.twists[:, :, None]
        on_member = layout.carried @ held
        push, twist = on_member[..., :3], pairs.twists
        self.on_point: Stack = crossed(push, twist[..., 3:])
        self.on_turn: Stack = np.zeros_like(push)
        if many.in_member_axes:
            self.on_turn = crossed(push, twist[..., :3]) + crossed(on_member[..., 3:], twist[..., 3:])
        self.on_rates = self._on_bent_couplings()

    def on_frames(self, onto: Matrix | None = None) -> Stack:
        """Wrenches on frames at the reference point, N x e x frames x 6.

        Args:
            onto: targets x frames, to add up the wrenches of several frames; None for every frame.
        """
        layout, frames = self.many.layout, len(self.many.layout.frames.carrier)
        gather = np.eye(frames) if onto is None else onto
        turning, forcing = self._on_columns()
        tilting, pulling = self._on_rows()
        screws, rows = layout.screws, layout.blocked
        # One in front of every configuration: sums do not depend on how many there are.
        found = (
            gather[:, screws.frame] @ _torques(turning)
            + gather[:, screws.centre] @ _forces(forcing, -self.many.arm[:, None])
            + gather[:, rows.frame] @ _torques(tilting)
            + gather[:, rows.point] @ _forces(pulling, self.many.lever[:, None])
        )
        for frame, torque in self._on_second_axes():
            found = found + gather[:, frame][:, None] * _torques(torque)[:, :, None]
        return np.asarray(found)

    def on_motions(self) -> Stack:
        """The rate of y^T A k for a unit of every rate and of every component of the member's twist.

        Returns:
            N x e x (n_a + n_p + d), in the order (q_a, q_p, u).
        """
        many, layout = self.many, self.many.layout
        group = groups_of_frames(many.mechanism, layout)
        of_groups = self.on_frames((group == np.arange(len(layout.groups))[:, None]).astype(float))
        order = ordered(layout)
        along = layout.path.T @ of_groups
        rates = (along * many.screws[:, None, order]).sum(axis=-1) + self.on_rates[..., order]
        carried = np.array(layout.group_carried, dtype=float) @ of_groups
        carried = carried + np.concatenate([self.on_point, self.on_turn], axis=-1)
        return np.concatenate([rates, many.in_own_axes(carried)], axis=-1)

    def of(self, redrawn: Redrawn) -> Stack:
        """The rate of y^T A k by every dimension, joints and member at rest.

        Args:
            redrawn: The same configurations while dimensions change.

        Returns:
            N x e x p.
        """
        found = _products(self.on_frames(), redrawn.frames)
        found = found + self.on_point @ np.swapaxes(redrawn.point, 1, 2)
        geometric, y, k = len(self.many.layout.signs), self.pairs.forces, self.pairs.rates
        for rate, mate in (
            (redrawn.screws, k[..., None] * self.felt),
            (redrawn.blocked, y[..., :geometric, None] * self.seen),
            (redrawn.constant, y[..., geometric:, None] * k[..., None, :]),
        ):
            if rate is not None:
                found = found + _products(mate, rate)
        return np.asarray(found)

    def _on_columns(self) -> tuple[Stack, Stack]:
        """Torques on the frames of axes, and forces on those of their centres."""
        many, rates = self.many, self.pairs.rates[..., None]
        slide, turn, arm = many.slide[:, None], many.turn[:, None], many.arm[:, None]
        force, moment = self.felt[..., :3], self.felt[..., 3:]
        torque = crossed(slide, force) + crossed(turn, crossed(arm, force) + moment)
        return rates * torque, rates * crossed(turn, force)

    def _on_rows(self) -> tuple[Stack, Stack]:
        """Torques on the frames of rows, and forces on those of their points."""
        many, layout = self.many, self.many.layout
        forces = self.pairs.forces[:, :, : len(layout.signs), None]
        push, lever = many.push[:, None], many.lever[:, None]
        speed, spin = self.seen[..., :3], self.seen[..., 3:]
        about = np.array(many.about[:, None])
        for k, _, _ in layout.blocked.across:
            about[:, :, k] = 0.0
        torque = crossed(push, speed + crossed(spin, lever)) + crossed(about, spin)
        for k, first, _, normal in self._normals():
            torque[:, :, k] += crossed(first, crossed(normal[1], normal[0]))
        return forces * torque, forces * crossed(push, spin)

    def _on_second_axes(self) -> list[tuple[int, Stack]]:
        """Torques on the frames that carry second axes of rows about a common normal."""
        forces = self.pairs.forces
        return [
            (other, forces[:, :, k, None] * crossed(normal[1], crossed(normal[0], first)))
            for k, first, other, normal in self._normals()
        ]

    def _normals(self) -> list[tuple[int, Stack, int, tuple[Stack, Stack]]]:
        """Rows about a common normal: row, z of A, frame B, and (what turns the normal, axis of B)."""
        many, found = self.many, []
        for k, other, axis in many.layout.blocked.across:
            first = many.frames.rotation[:, many.layout.blocked.frame[k], :, 2][:, None]
            second = (many.frames.rotation[:, other] @ axis[:, None])[..., 0][:, None]
            across = crossed(first, second)
            size = np.linalg.norm(across, axis=-1, keepdims=True)
            normal, spin = across / size, self.seen[:, :, k, 3:]
            beside = (spin - normal * (normal * spin).sum(axis=-1, keepdims=True)) / size
            found.append((k, first, other, (beside, second)))
        return found

    def _on_bent_couplings(self) -> Stack:
        """Second derivatives of couplings that are not linear."""
        layout, rates = self.many.layout, self.pairs.rates
        found: Stack = np.zeros_like(rates)
        index = layout.index
        for k, coupling in layout.polynomials:
            terms = {index[axis]: c for axis, c in coupling.driver.items() if axis in index}
            speed = sum((c * rates[..., column] for column, c in terms.items()), np.zeros(rates.shape[:2]))
            bend = self.many.bent(coupling)[:, None] * speed * self.pairs.forces[..., len(layout.signs) + k]
            for column, c in terms.items():
                found[..., column] -= c * bend
        return found


def _torques(torque: Stack) -> Stack:
    """Pure torques as wrenches."""
    return np.concatenate([np.zeros_like(torque), torque], axis=-1)


def _forces(force: Stack, lever: Stack) -> Stack:
    """Forces at the end of levers as wrenches."""
    return np.concatenate([force, crossed(np.broadcast_to(lever, force.shape), force)], axis=-1)


def _products(one: Stack, two: Stack) -> Stack:
    """Sums of products of N x e x ... and N x p x ... numbers: N x e x p."""
    size = math.prod(one.shape[2:])
    return one.reshape(*one.shape[:2], size) @ np.swapaxes(two.reshape(*two.shape[:2], size), 1, 2)
