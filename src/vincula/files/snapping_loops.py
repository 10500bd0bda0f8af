"""Loops whose axes are all parallel, and that rounded numbers hold open along them: no motion closes them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Final

import numpy as np

from vincula.arrays import Vector
from vincula.mechanism.mechanism import Mechanism
from vincula.mechanism.parts import GROUND, Joint
from vincula.spatial.poses import Pose

_PARALLEL: Final = 1e-13
_HOLDING: Final = frozenset({"revolute", "fixed", "spherical", "universal"})
"""Joints that let nothing slide along an axis."""
_TURNING: Final = frozenset({"revolute", "fixed", "prismatic"})
"""Joints of a chain that can keep its bodies in parallel planes: hinges across them, slides inside."""


def loop_joints(mechanism: Mechanism) -> Iterator[Joint]:
    """The joints that close loops: those that place no body."""
    placing = {joint.name for joint, _ in mechanism.tree}
    return (joint for joint in mechanism.joints if joint.name not in placing)


def closed_along(mechanism: Mechanism, joint: Joint, bound: float) -> tuple[Joint, float] | None:
    """A loop joint shifted along the axes of its loop, and the gap [m] that this closes.

    Args:
        mechanism: The mechanism.
        joint: One of its loop joints.
        bound: The largest gap that is rounding of typed numbers [m].

    Returns:
        None where the axes of the loop are not all parallel, where nothing is to be closed, and where
        the gap is too large.
    """
    poses = mechanism.body_poses()
    chain = _chain(mechanism, joint)
    axis = _common_axis(chain, poses)
    if axis is None or joint.type not in _HOLDING:
        return None
    first = poses[joint.first] @ joint.frame_on_first
    second = poses[joint.second] @ joint.frame_on_second
    gap = float(axis @ (second.position - first.position))
    if not 1e-15 * mechanism.length < abs(gap) <= bound * max(1, len(chain)):
        return None
    shift = Pose(second.rotation, second.position - gap * axis)
    moved = replace(joint, frame_on_second=poses[joint.second].inverse() @ shift, written=None)
    return moved, gap


def _chain(mechanism: Mechanism, joint: Joint) -> list[Joint]:
    """The joints of the tree between the two bodies of a joint."""
    above: dict[str, tuple[Joint, str]] = {}
    for placing, forward in mechanism.tree:
        inner, outer = (placing.first, placing.second) if forward else (placing.second, placing.first)
        above[outer] = (placing, inner)
    ways = []
    for end in (joint.first, joint.second):
        body, way = end, dict[str, Joint]()
        while body != GROUND:
            way[above[body][0].name], body = above[body]
        ways.append(way)
    return [one for way, other in (ways, ways[::-1]) for name, one in way.items() if name not in other]


def _common_axis(chain: list[Joint], poses: dict[str, Pose]) -> Vector | None:
    """The direction of all hinges of a chain whose slides are across it."""
    axes: dict[str, list[Vector]] = {"revolute": [], "prismatic": [], "fixed": []}
    for joint in chain:
        if joint.type not in _TURNING:
            return None
        axes[joint.type].append((poses[joint.first] @ joint.frame_on_first).rotation[:, 2])
    if not axes["revolute"]:
        return None
    common = axes["revolute"][0]
    if any(float(np.linalg.norm(np.cross(common, axis))) > _PARALLEL for axis in axes["revolute"]):
        return None
    return None if any(abs(float(common @ axis)) > _PARALLEL for axis in axes["prismatic"]) else common
