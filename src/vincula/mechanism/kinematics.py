"""Where the bodies are: poses through the kinematic tree, joint frames, characteristic length."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

import numpy as np

from vincula.arrays import Vector
from vincula.labels import power_of_two
from vincula.mechanism.configuration import Configuration
from vincula.mechanism.joint_types import motion
from vincula.mechanism.parts import GROUND, ContactPart, Joint
from vincula.spatial.poses import Pose

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism


def grow_tree(mechanism: Mechanism) -> tuple[tuple[Joint, bool], ...]:
    """Joints from the ground outwards, each with whether it is walked from first to second body.

    Breadth first in the order of declaration, closures never: it reaches every body, because bodies
    held by contacts alone have an implicit free joint.
    """
    neighbours: dict[str, list[tuple[Joint, bool, str]]] = {}
    for joint in mechanism.all_joints:
        if not joint.closure:
            neighbours.setdefault(joint.first, []).append((joint, True, joint.second))
            neighbours.setdefault(joint.second, []).append((joint, False, joint.first))
    order: list[tuple[Joint, bool]] = []
    reached = {GROUND}
    queue = [GROUND]
    for name in queue:
        for joint, forward, other in neighbours.get(name, ()):
            if other not in reached:
                reached.add(other)
                queue.append(other)
                order.append((joint, forward))
    return tuple(order)


def body_poses(mechanism: Mechanism, q: Configuration) -> dict[str, Pose]:
    """Pose of every body in ground axes.  The home poses are returned as they were drawn, exactly."""
    if q is mechanism.home or q == mechanism.home:
        ground = {GROUND: Pose.identity(mechanism.space.translations)}
        return ground | {body.name: body.pose for body in mechanism.bodies}
    return tree_poses(
        mechanism,
        lambda joint: motion(mechanism.type_of(joint), q[joint.name], joint.lead, joint.second_axis),
    )


def tree_poses(mechanism: Mechanism, moved: Callable[[Joint], Pose]) -> dict[str, Pose]:
    """Pose of every body in ground axes, through the joints of the tree.

    Args:
        mechanism: The mechanism.
        moved: The second frame of a joint in its first one.
    """
    poses = {GROUND: Pose.identity(mechanism.space.translations)}
    for joint, forward in mechanism.tree:
        if forward:
            step = joint.frame_on_first @ moved(joint) @ joint.frame_on_second.inverse()
            poses[joint.second] = poses[joint.first] @ step
        else:
            step = joint.frame_on_second @ moved(joint).inverse() @ joint.frame_on_first.inverse()
            poses[joint.first] = poses[joint.second] @ step
    return poses


def part_frames(part: Joint | ContactPart, poses: Mapping[str, Pose]) -> tuple[Pose, Pose]:
    """Frames A and B of a joint or contact in ground axes."""
    return poses[part.first] @ part.frame_on_first, poses[part.second] @ part.frame_on_second


def reference_position(mechanism: Mechanism, poses: Mapping[str, Pose]) -> Vector:
    """The reference point in ground axes [m]; the ground's origin when no member is named."""
    reference = mechanism.reference
    if reference is None:
        return np.zeros(mechanism.space.translations)
    return poses[reference.body].apply(reference.origin)


def characteristic_length(mechanism: Mechanism) -> float:
    """rms distance of joint and contact points from the reference point at home [m].

    Rounded to a power of two, so that scaling by it is exact; 1 m if all points coincide.
    """
    from vincula.numerics.rank import negligible

    poses = body_poses(mechanism, mechanism.home)
    centre = reference_position(mechanism, poses)
    parts: tuple[Joint | ContactPart, ...] = (*mechanism.joints, *mechanism.contacts)
    points = [part_frames(part, poses)[0].position for part in parts if part.type not in ("free", "fixed")]
    if not points:
        return 1.0
    distance = math.sqrt(float(np.mean(np.sum((np.array(points) - centre) ** 2, axis=1))))
    farthest = float(np.abs([centre, *points]).max())
    if negligible(distance, farthest) or not math.isfinite(distance):
        return 1.0
    return power_of_two(distance)
