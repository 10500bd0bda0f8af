"""Named configurations of a mechanism as MJCF keyframes: a `qpos` in the order of the written joints."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING
from xml.sax.saxutils import quoteattr

import numpy as np

from vincula.arrays import Matrix, Vector
from vincula.files.written import numbers
from vincula.files.written_tree import Branch, Motion
from vincula.mechanism.configuration import Configuration
from vincula.mechanism.joint_types import motion, values_between
from vincula.mechanism.parts import Joint
from vincula.spatial.poses import Pose

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism


def keyframes(mechanism: Mechanism, joints: Sequence[tuple[Branch, str, Motion | None]]) -> list[str]:
    """A `<key>` for every named configuration.

    Args:
        mechanism: The mechanism.
        joints: The written joints in their order: branch, what they are in MJCF, motion.
    """
    found = []
    for name, values in mechanism.keyframes.items():
        q = mechanism.configuration(dict(values))
        poses = mechanism.body_poses(q)
        qpos = [value for entry in joints for value in _values(mechanism, q, poses, *entry)]
        found.append(f'<key name={quoteattr(name)} qpos="{numbers(qpos)}"/>')
    return found


def _values(
    mechanism: Mechanism,
    q: Configuration,
    poses: Mapping[str, Pose],
    branch: Branch,
    kind: str,
    step: Motion | None,
) -> list[float]:
    if kind == "free" or step is None:
        pose = poses[branch.link]
        return [*map(float, pose.position), *map(float, pose.as_quaternion_wxyz())]
    joint = branch.joint
    now = _joint_values(mechanism, q, poses, joint)
    if kind == "advance":
        return [step.lead / (2.0 * np.pi) * (float(now[step.index]) - step.home)]
    if mechanism.type_of(joint).steps[-1] != "S" or step.kind == "slide":
        return [float(now[step.index])]
    if kind == "ball":
        turned = _turn(mechanism, joint, now, forward=branch.forward)
        frame = np.eye(3) if branch.link not in mechanism.body else _frame(joint, forward=branch.forward)
        return [*map(float, Pose.at(np.zeros(3), frame @ turned @ frame.T).as_quaternion_wxyz())]
    return [_angles(_turn(mechanism, joint, now, forward=True))[_axis(mechanism, joint, step)]]


def _joint_values(mechanism: Mechanism, q: Configuration, poses: Mapping[str, Pose], joint: Joint) -> Vector:
    """Values of a joint; a closure has none, so they are read from where its frames are."""
    if joint.name in q:
        return np.asarray(q[joint.name], dtype=float)
    ends = poses[joint.first] @ joint.frame_on_first, poses[joint.second] @ joint.frame_on_second
    return values_between(mechanism.type_of(joint), *ends, joint.second_axis)


def _frame(joint: Joint, *, forward: bool) -> Matrix:
    return (joint.frame_on_second if forward else joint.frame_on_first).rotation


def _turn(mechanism: Mechanism, joint: Joint, now: Vector, *, forward: bool) -> Matrix:
    """How a ball has turned since home, in the axes of the frame on the link that it places."""
    kind = mechanism.type_of(joint)
    home = _joint_values(mechanism, mechanism.home, mechanism.body_poses(), joint)
    before, after = (motion(kind, value, joint.lead, joint.second_axis).rotation for value in (home, now))
    return before.T @ after if forward else before @ after.T


def _angles(turned: Matrix) -> tuple[float, float, float]:
    """Angles a, b, c with R = Rx(a) Ry(b) Rz(c) [rad]."""
    b = math.atan2(turned[0, 2], math.hypot(turned[0, 0], turned[0, 1]))
    a = math.atan2(-turned[1, 2], turned[2, 2])
    left = math.cos(a) * turned[1] + math.sin(a) * turned[2]
    return a, b, math.atan2(left[0], left[1])


def _axis(mechanism: Mechanism, joint: Joint, step: Motion) -> int:
    """Which of the three turns of a ball a motion is."""
    names = mechanism.type_of(joint).axis_names(joint.name)
    return names.index(step.name) - (len(names) - 3)
