"""Frames of many configurations at once: what `kinematics` and `frames` do for one, an axis in front.

Mechanisms in the plane are lifted into space (z up), so that what is built on these frames has one set of
formulas.  Nothing here checks whether loops are closed.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vincula.arrays import Matrix, Vector
from vincula.mechanism.joint_types import JointType
from vincula.mechanism.parts import GROUND
from vincula.spatial.poses import Pose

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism

Stack = NDArray[np.float64]
"""Numbers of N configurations: N x ..."""
_Z = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, slots=True, eq=False)
class ManyFrames:
    """All frames of a mechanism's layout at N configurations, in ground axes.

    Attributes:
        rotation: N x k x 3 x 3 rotation matrices.
        position: N x k x 3 positions [m].
        member: N x 3 x 3 rotations of the reference member.
        origin: N x 3 reference points [m].
        bodies: Poses of all bodies by name: rotations and positions.
    """

    rotation: Stack
    position: Stack
    member: Stack
    origin: Stack
    bodies: dict[str, tuple[Stack, Stack]]


def many_frames(mechanism: Mechanism, values: Matrix) -> ManyFrames:
    """The frames of a mechanism with a reference member at many configurations.

    Args:
        mechanism: The mechanism.
        values: N x coordinates, one configuration a row [m, rad, quaternions w x y z].
    """
    count = len(values)
    places, start = {}, 0
    for name, home in mechanism.home.items():
        places[name] = slice(start, start + len(home))
        start += len(home)
    identity = np.broadcast_to(np.eye(3), (count, 3, 3)), np.zeros((count, 3))
    bodies = {GROUND: identity}
    for joint, forward in mechanism.tree:
        own = values[:, places[joint.name]] if joint.name in places else values[:, :0]
        moved = motions(mechanism.type_of(joint), own, joint.lead, joint.second_axis)
        first, second = lifted(joint.frame_on_first), lifted(joint.frame_on_second)
        if forward:
            bodies[joint.second] = _on(bodies[joint.first], first, moved, _inverse(second))
        else:
            bodies[joint.first] = _on(bodies[joint.second], second, _inverse(moved), _inverse(first))
    table = mechanism.layout.frames
    rotation = np.stack([bodies[name][0] for name in table.bodies], axis=1)[:, table.carrier]
    position = np.stack([bodies[name][1] for name in table.bodies], axis=1)[:, table.carrier]
    own_turn, own_place = lifted_frames(table.rotation, table.position)
    reference = mechanism.reference
    member, origin = bodies[reference.body] if reference else identity
    if reference:
        origin = origin + member @ lifted_vectors(reference.origin)
    return ManyFrames(
        rotation @ own_turn, position + (rotation @ own_place[:, :, None])[..., 0], member, origin, bodies
    )


def motions(kind: JointType, values: Matrix, lead: float, second_axis: Vector) -> tuple[Stack, Stack]:
    """Poses of frame B in frame A at many values: `joint_types.motion`, lifted.

    Args:
        kind: The joint type.
        values: N x values of the joint.
        lead: Advance of a screw a turn [m].
        second_axis: Second axis of a universal joint in the joint frame.
    """
    count, index = len(values), 0
    rotation: Stack = np.broadcast_to(np.eye(3), (count, 3, 3))
    position: Stack = np.zeros((count, 3))
    for step in kind.steps:
        if step == "S":
            rotation = rotation @ _of_quaternions(values[:, index : index + 4])
            index += 4
            continue
        value = values[:, index]
        index += 1
        if step[0] == "T":
            position = position + rotation[:, :, "xyz".index(step[1])] * value[:, None]
            continue
        if step == "H":
            position = position + rotation[:, :, 2] * (lead / (2 * math.pi) * value)[:, None]
        rotation = rotation @ _about(second_axis if step == "R2" else _Z, value)
    return rotation, position


def lifted(pose: Pose) -> tuple[Stack, Stack]:
    """A pose in space: rotation and position."""
    rotation, position = lifted_frames(pose.rotation[None], pose.position[None])
    return rotation[0], position[0]


def lifted_frames(rotation: Stack, position: Stack) -> tuple[Stack, Stack]:
    """Frames in the plane as frames in space; those in space as they are."""
    if position.shape[-1] == 3:
        return rotation, position
    turned = np.zeros((*rotation.shape[:-2], 3, 3))
    turned[..., :2, :2], turned[..., 2, 2] = rotation, 1.0
    return turned, lifted_vectors(position)


def lifted_vectors(vectors: Stack) -> Stack:
    """Vectors in the plane as vectors in space; those in space as they are."""
    if vectors.shape[-1] == 3:
        return vectors
    return np.concatenate([vectors, np.zeros((*vectors.shape[:-1], 1))], axis=-1)


def crossed(one: Stack, two: Stack) -> Stack:
    """Cross products along the last axis (numpy's own copies more)."""
    ax, ay, az = one[..., 0], one[..., 1], one[..., 2]
    x, y, z = two[..., 0], two[..., 1], two[..., 2]
    return np.stack([ay * z - az * y, az * x - ax * z, ax * y - ay * x], axis=-1)


def _on(start: tuple[Stack, Stack], *steps: tuple[Stack, Stack]) -> tuple[Stack, Stack]:
    """Poses one after the other."""
    rotation, position = start
    for turn, way in steps:
        position = position + (rotation @ way[..., None])[..., 0]
        rotation = rotation @ turn
    return rotation, position


def _inverse(pose: tuple[Stack, Stack]) -> tuple[Stack, Stack]:
    back = np.swapaxes(pose[0], -1, -2)
    return back, -(back @ pose[1][..., None])[..., 0]


def _about(axis: Vector, angle: Vector) -> Stack:
    """Rotations about one unit vector, as `rotation_about` gives them."""
    x, y, z = map(float, axis)
    c, s = np.cos(angle), np.sin(angle)
    t = 1.0 - c
    rows = [
        [c + t * x * x, t * x * y - s * z, t * x * z + s * y],
        [t * x * y + s * z, c + t * y * y, t * y * z - s * x],
        [t * x * z - s * y, t * y * z + s * x, c + t * z * z],
    ]
    return _rotations(rows)


def _of_quaternions(quaternion: Matrix) -> Stack:
    """Rotations of quaternions (w, x, y, z) of any length, as `rotation_from_quaternion_wxyz` gives them."""
    w, x, y, z = quaternion.T
    s = 2.0 / (w * w + x * x + y * y + z * z)
    rows = [
        [1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y)],
        [s * (x * y + w * z), 1 - s * (x * x + z * z), s * (y * z - w * x)],
        [s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y)],
    ]
    return _rotations(rows)


def _rotations(rows: Sequence[Sequence[Vector]]) -> Stack:
    """Matrices from their entries; one behind the other in memory, so that every product takes one way."""
    return np.ascontiguousarray(np.moveaxis(np.array(rows), 2, 0))
