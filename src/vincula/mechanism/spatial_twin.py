"""A planar mechanism drawn again in space, its plane being z = 0 and its axes along z."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np

from vincula.arrays import Vector
from vincula.mechanism.parts import Body, Cut, Frame, Joint
from vincula.spatial.poses import Pose
from vincula.spatial.space import PLANAR, SPATIAL

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism

_TYPES: Final = {"free": "planar"}
_ALONG_X: Final = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
"""A joint frame whose z is the planar frame's x, the sliding axis."""


def spatial_twin(mechanism: Mechanism) -> Mechanism:
    """The twin in space of a planar mechanism; a spatial one as it is.

    In the plane it moves as before.  Its joints also hold it against motions out of the plane, so its
    loops carry forces that the drawing does not have.  Free bodies slide on the plane; contacts and
    weights, which mean something else in space, are left out.
    """
    if mechanism.space is not PLANAR:
        return mechanism
    reference = mechanism.reference
    if reference is not None:
        cuts = {
            name: Cut(cut.kind, None if cut.at is None else (*cut.at, 0.0))
            for name, cut in reference.cuts.items()
        }
        reference = replace(reference, origin=_lifted(reference.origin), cuts=cuts)
    return replace(
        mechanism,
        space=SPATIAL,
        bodies=tuple(Body(body.name, _in_space(body.pose), body.drawn) for body in mechanism.bodies),
        joints=tuple(_joint(joint) for joint in mechanism.all_joints),
        frames=tuple(Frame(frame.name, frame.body, _in_space(frame.pose)) for frame in mechanism.frames),
        contacts=(),
        reference=reference,
        weights=None,
    )


def _joint(joint: Joint) -> Joint:
    turn = Pose.at(np.zeros(3), _ALONG_X if joint.type == "prismatic" else None)
    return replace(
        joint,
        type=_TYPES.get(joint.type, joint.type),
        frame_on_first=_in_space(joint.frame_on_first) @ turn,
        frame_on_second=_in_space(joint.frame_on_second) @ turn,
    )


def _lifted(vector: Vector) -> Vector:
    return np.append(vector, 0.0)


def _in_space(pose: Pose) -> Pose:
    rotation = np.eye(3)
    rotation[:2, :2] = pose.rotation
    return Pose.at(_lifted(pose.position), rotation)
