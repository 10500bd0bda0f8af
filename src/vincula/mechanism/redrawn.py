"""What changing dimensions does at closed configurations: motions of frames, gaps that open, matrices.

A frame that moves in its body is a joint that is not there and moves all the same.  With all joints and the
reference member at rest these motions are carried along the two trees of the reduction, and where the trees
meet, at the rows of A, gaps open at the rate `opening`.  A motion k of the mechanism with A k = -opening
closes them again; both together are how the frames move.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from vincula.arrays import Matrix
from vincula.mechanism.many_frames import Stack, crossed
from vincula.mechanism.many_matrices import ManyMatrices
from vincula.mechanism.parts import GROUND, Joint
from vincula.mechanism.placement_rates import PlacementRates
from vincula.mechanism.reduction import merges

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism


class Redrawn:
    """N configurations of a mechanism while p dimensions change, joints and member at rest.

    Args:
        many: The configurations.
        rates: The rates of its numbers.

    Attributes:
        frames: N x p x k x 6, twists of the frames at the reference point, ground axes.
        point: N x p x 3 velocities of the reference point [m].
        opening: N x p x m, rates at which the rows of A open [m, rad].
        rigid: N x p x j x 6, rates at which loops of fixed joints alone open: nothing closes them.
        screws: N x p x columns x 6, rates of the screws beside what the frames do; None where there are none.
        blocked: The same for the blocked directions, N x p x rows x 6.
        constant: The same for the rows of couplings and drives, N x p x rows x columns.
    """

    def __init__(self, many: ManyMatrices, rates: PlacementRates) -> None:
        self.many, self._rates = many, rates
        layout, frames = many.layout, many.frames
        table, trees = layout.frames, _Trees(many.mechanism)
        bodies = np.stack([frames.bodies[name][0] for name in table.bodies], axis=1)[:, None, table.carrier]
        turn = (bodies @ rates.turn[..., None])[..., 0]
        shift = (bodies @ rates.shift[..., None])[..., 0]
        arm = (frames.origin[:, None] - frames.position)[:, None]
        own = np.concatenate([shift + crossed(turn, np.broadcast_to(arm, turn.shape)), turn], axis=-1)
        joints, between = self._between_frames()
        carried = trees.of_frames[table.carrier] + np.eye(len(table.carrier))
        beside = trees.of_joints[table.carrier][:, joints]
        sides, at_cuts = _sides(many.mechanism)
        self.frames: Stack = carried @ own + beside @ between
        across = sides @ self.frames + at_cuts[:, joints] @ between
        self.rigid: Stack = trees.loops @ self.frames
        self.point: Stack = (frames.member[:, None] @ rates.origin[..., None])[..., 0]
        scalar = len(layout.constant)
        self.opening: Stack = np.zeros((many.lanes, len(rates.turn), len(layout.rows)))
        self.opening[..., : len(layout.signs)] = (many.blocked[:, None] * across).sum(axis=-1)
        self.screws, self.blocked = self._of_screws(), self._of_rows()
        self.constant: Stack | None = None
        if any(rates.scalars):
            self.constant = np.zeros((many.lanes, len(rates.turn), scalar, len(layout.columns)))
            for k, stencil in enumerate(rates.scalars):
                for weight, mechanism in stencil:
                    coefficients, gaps = many.scalar_rows(mechanism)
                    self.constant[:, k] += weight * coefficients
                    self.opening[:, k, len(layout.signs) :] += weight * gaps

    def _between_frames(self) -> tuple[list[int], Stack]:
        """Joints whose own motion changes, and twists of B against A, N x p x joints x 6."""
        many, rates = self.many, self._rates
        joints = many.mechanism.all_joints
        turning = np.abs(rates.lead).max(axis=0, initial=0.0) > 0.0
        turning |= np.abs(rates.second_axis).max(axis=(0, 2), initial=0.0) > 0.0
        places = [int(k) for k in np.flatnonzero(turning)]
        twists = [self._of_joint(joints[k], k) for k in places]
        shape = (many.lanes, len(rates.turn), 6)
        return places, np.stack(twists, axis=2) if twists else np.zeros((*shape[:2], 0, 6))

    def _of_joint(self, joint: Joint, place: int) -> Stack:
        """Twist of frame B against A at the reference point, by lead or second axis, the values held."""
        many, frames = self.many, self.many.frames
        frame = many.layout.frames.of_joint[joint.name]
        first = frames.rotation[:, None, frame]
        arm = (frames.origin - frames.position[:, frame + 1])[:, None]
        if joint.type == "screw":
            turns = many.axis_values[joint.name] / (2.0 * math.pi)
            along = first[..., 2] * (turns[:, None] * self._rates.lead[:, place])[..., None]
            return np.concatenate([along, np.zeros_like(along)], axis=-1)
        rate = self._rates.second_axis[:, place]
        if joint.closure or _cut_as_contact(many.mechanism, joint):
            spin = self._about_normal(joint, frame, rate)
        else:
            # Of a rotation by q about an axis b: sin q b' + (1 - cos q) b x b'.
            names = many.mechanism.type_of(joint).axis_names(joint.name)
            one, two = (many.axis_values[axis] for axis in names)
            axis = np.broadcast_to(joint.second_axis, rate.shape)
            inner = np.sin(two)[:, None, None] * rate
            inner = inner + (1.0 - np.cos(two))[:, None, None] * crossed(axis, rate)
            x, y, z = np.moveaxis(inner, -1, 0)
            c, s = np.cos(one)[:, None], np.sin(one)[:, None]
            spin = (first @ np.stack([c * x - s * y, s * x + c * y, z], axis=-1)[..., None])[..., 0]
        return np.concatenate([crossed(spin, np.broadcast_to(arm, spin.shape)), spin], axis=-1)

    def _about_normal(self, joint: Joint, frame: int, rate: Matrix) -> Stack:
        """For a universal joint without values: what keeps the angle between its axes the drawn one."""
        rotation = self.many.frames.rotation
        first = rotation[:, None, frame, :, 2]
        second = (rotation[:, frame + 1] @ joint.second_axis)[:, None]
        moved = (rotation[:, None, frame + 1] @ rate[..., None])[..., 0]
        across = crossed(first, second)
        size = np.linalg.norm(across, axis=-1, keepdims=True)
        opened = (rate[:, 2] - (first * moved).sum(axis=-1))[..., None] / size
        return np.asarray(-opened * across / size)

    def _of_screws(self) -> Stack | None:
        """Rates of screws by leads and second axes."""
        many, rates, layout = self.many, self._rates, self.many.layout
        if not (rates.lead.any() or rates.second_axis.any()):
            return None
        found = np.zeros((many.lanes, len(rates.turn), len(layout.columns), 6))
        index = {joint.name: k for k, joint in enumerate(many.mechanism.all_joints)}
        for column, label in enumerate(layout.columns):
            place = index.get(label.joint)
            if place is None:
                continue
            joint = many.mechanism.all_joints[place]
            if joint.type == "screw":
                pitch = rates.lead[:, place] / (2.0 * math.pi)
                found[:, :, column, :3] = many.turn[:, None, column] * pitch[:, None]
            elif joint.type == "universal" and layout.screws.frame[column] == _second_frame(many, joint):
                rotation = many.frames.rotation[:, None, layout.screws.frame[column]]
                turn = (rotation @ rates.second_axis[:, place, :, None])[..., 0]
                arm = np.broadcast_to(many.arm[:, None, column], turn.shape)
                found[:, :, column] = np.concatenate([crossed(turn, arm), turn], axis=-1)
        return found

    def _of_rows(self) -> Stack | None:
        """Rates of rows about a common normal, by second axes."""
        many, rates, layout = self.many, self._rates, self.many.layout
        if not (rates.second_axis.any() and layout.blocked.across):
            return None
        found = np.zeros((many.lanes, len(rates.turn), len(layout.signs), 6))
        for k, other, axis in layout.blocked.across:
            place = (other - 1) // 2
            if place >= len(many.mechanism.all_joints):
                continue  # a line of contact is an axis of its frame
            first = many.frames.rotation[:, None, layout.blocked.frame[k], :, 2]
            second = (many.frames.rotation[:, other] @ axis)[:, None]
            rotation = many.frames.rotation[:, None, other]
            moved = (rotation @ rates.second_axis[:, place, :, None])[..., 0]
            across = crossed(first, second)
            size = np.linalg.norm(across, axis=-1, keepdims=True)
            normal, rate = across / size, crossed(np.broadcast_to(first, moved.shape), moved) / size
            found[:, :, k, 3:] = rate - normal * (normal * rate).sum(axis=-1, keepdims=True)
        return found


class _Trees:
    """What every body gets of the motions of frames in their bodies, and of joints' own motions.

    Attributes:
        of_frames: bodies x frames: +1, -1, 0.
        of_joints: bodies x joints, for twists of B against A.
        loops: loops of fixed joints alone x frames, one side against the other.
    """

    def __init__(self, mechanism: Mechanism) -> None:
        layout, reduction = mechanism.layout, mechanism.reduction
        table, joints = layout.frames, mechanism.all_joints
        forest = {name for path in reduction.paths.values() for name, _ in path}
        usable = [(k, j) for k, j in enumerate(joints) if j.name in forest or merges(mechanism, j)]
        index = {name: k for k, name in enumerate(table.bodies)}
        self.of_frames = np.zeros((len(index), len(table.carrier)))
        self.of_joints = np.zeros((len(index), len(joints)))
        member = mechanism.reference.body if mechanism.reference else GROUND
        reached, queue, walked = {GROUND, member}, [GROUND, member], set()
        for body in queue:  # grows while it is walked
            for place, joint in usable:
                if body not in (joint.first, joint.second):
                    continue
                sign = 1.0 if body == joint.first else -1.0
                other = joint.second if sign > 0.0 else joint.first
                if other in reached:
                    continue
                here, there, frame = index[body], index[other], table.of_joint[joint.name]
                for arrays in (self.of_frames, self.of_joints):
                    arrays[there] = arrays[here]
                self.of_frames[there, frame] += sign
                self.of_frames[there, frame + 1] -= sign
                self.of_joints[there, place] += sign
                reached.add(other)
                queue.append(other)
                walked.add(joint.name)
        left = [joint for _, joint in usable if joint.name not in walked]
        self.loops = np.zeros((len(left), len(table.carrier)))
        for k, joint in enumerate(left):
            frame = table.of_joint[joint.name]
            self.loops[k, frame], self.loops[k, frame + 1] = 1.0, -1.0


def _sides(mechanism: Mechanism) -> tuple[Matrix, Matrix]:
    """For every row from geometry its two frames (+1, -1), and its joint's own motion with its sign."""
    layout = mechanism.layout
    table = layout.frames
    index = {joint.name: k for k, joint in enumerate(mechanism.all_joints)}
    signs = {cut.joint.name: float(cut.limb_sign) for cut in mechanism.reduction.cuts}
    sides = np.zeros((len(layout.signs), len(table.carrier)))
    own = np.zeros((len(layout.signs), len(index)))
    for k, row in enumerate(layout.rows[: len(layout.signs)]):
        contact = row.kind == "contact"
        sign = 1.0 if contact else signs[row.source]
        frame = table.of_contact[row.source] if contact else table.of_joint[row.source]
        sides[k, frame], sides[k, frame + 1] = sign, -sign
        if not contact:
            own[k, index[row.source]] = sign
    return sides, own


def _cut_as_contact(mechanism: Mechanism, joint: Joint) -> bool:
    return any(cut.joint.name == joint.name and cut.kind == "contact" for cut in mechanism.reduction.cuts)


def _second_frame(many: ManyMatrices, joint: Joint) -> int:
    return many.layout.frames.of_joint[joint.name] + 1
