"""Joint frames moved a little: of a drawn mechanism both frames of a joint, of others one end at a time."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from vincula.arrays import Matrix, Vector
from vincula.mechanism.joint_types import motion
from vincula.mechanism.kinematics import tree_poses
from vincula.mechanism.mechanism import Mechanism
from vincula.mechanism.parts import Joint
from vincula.spatial.poses import Pose

Node = tuple[str, str]
"""A joint, and the end of it (`first`, `second`); `first` alone where both ends move together."""


@dataclass(frozen=True, slots=True, eq=False)
class Move:
    """A small motion of a joint frame: a turn about its origin, and a shift [m]."""

    turn: Matrix
    shift: Vector

    @property
    def is_none(self) -> bool:
        """Whether nothing moves."""
        return not np.any(self.shift) and not np.any(self.turn != np.eye(3))

    def applied(self, frame: Pose, place: Pose) -> Pose:
        """A frame on a body, moved in the axes in which the body has a pose."""
        here = place @ frame
        return place.inverse() @ Pose(self.turn @ here.rotation, here.position + self.shift)


def ends(joint: Joint) -> Iterator[tuple[str, str, Pose]]:
    """Both ends of a joint: name of the end, body, frame on the body."""
    yield "first", joint.first, joint.frame_on_first
    yield "second", joint.second, joint.frame_on_second


def moved_joints(mechanism: Mechanism, moves: Mapping[Node, Move], poses: Mapping[str, Pose]) -> Mechanism:
    """A mechanism whose joints move, while its bodies stay at home: what is closed there stays closed.

    Args:
        mechanism: The mechanism.
        moves: What moves, in ground axes.
        poses: Home poses of the bodies.
    """

    def moved(joint: Joint) -> Joint:
        move = moves.get((joint.name, "first"))
        if move is None or move.is_none:
            return joint
        first = move.applied(joint.frame_on_first, poses[joint.first])
        second = move.applied(joint.frame_on_second, poses[joint.second])
        if not joint.closure:
            # Away from zero the second frame is elsewhere along the axis: it follows the first.
            second = poses[joint.second].inverse() @ poses[joint.first] @ first @ _motion(mechanism, joint)
        return replace(joint, frame_on_first=first, frame_on_second=second, written=None)

    return replace(mechanism, joints=tuple(map(moved, mechanism.joints)))


def moved_ends(mechanism: Mechanism, moves: Mapping[Node, Move], place: Mapping[str, Pose]) -> Mechanism:
    """A mechanism of which the ends of joints move on their bodies; the bodies after them follow.

    Args:
        mechanism: The mechanism.
        moves: What moves, in the axes in which the bodies are placed.
        place: A pose for every body.
    """
    joints = []
    for joint in mechanism.joints:
        frames = []
        for end, body, frame in ends(joint):
            move = moves.get((joint.name, end))
            frames.append(frame if move is None or move.is_none else move.applied(frame, place[body]))
        same = frames[0] is joint.frame_on_first and frames[1] is joint.frame_on_second
        joints.append(
            joint
            if same
            else replace(joint, frame_on_first=frames[0], frame_on_second=frames[1], written=None)
        )
    moved = replace(mechanism, joints=tuple(joints))
    poses = tree_poses(moved, lambda joint: _motion(moved, joint))
    return replace(moved, bodies=tuple(replace(b, pose=poses[b.name]) for b in moved.bodies))


def _motion(mechanism: Mechanism, joint: Joint) -> Pose:
    """The second frame of a joint in its first one at the home configuration."""
    kind = mechanism.type_of(joint)
    return motion(kind, np.array(joint.home, float), joint.lead, joint.second_axis)
