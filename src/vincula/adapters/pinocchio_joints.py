"""Joints of a Pinocchio model as joints of the mechanism graph, each a chain of one or more elements.

A Pinocchio joint moves its child frame by  oMi = oMparent placement M(q).  Joints with one freedom are
known by their motion subspace S alone: a line with a direction and a pitch.  Composite joints, three
Euler angles and three translations become chains with massless bodies between them.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np

from vincula.arrays import Vector
from vincula.errors import UnsupportedFeatureError
from vincula.mechanism.parts import Limits
from vincula.spatial.poses import Pose, frame_with_z

_UNIT: Final = np.eye(3)
_HUGE: Final = 1e10
"""Limits beyond this are no limits: what Pinocchio and robot files write for "none"."""


@dataclass(frozen=True, slots=True, eq=False)
class Element:
    """One elementary joint: offset @ frame @ motion(values) @ frame^-1.

    Attributes:
        type: Name of the joint type.
        offset: What comes before it.
        values: Its values.
        turn: Frame of the joint in its own child frame; z is the axis.
        lead: Advance of a screw a turn [m].
        second_axis: Second axis of a universal joint in the joint frame.
        limits: Limits by axis.
    """

    type: str
    offset: Pose
    values: tuple[float, ...]
    turn: Pose = field(default_factory=Pose.identity)
    lead: float = 0.0
    second_axis: Vector = field(default_factory=lambda: _UNIT[0])
    limits: tuple[Limits, ...] = ()


def pose_of(placement: Any) -> Pose:
    """Our pose of a `pinocchio.SE3`."""
    return Pose.at(np.array(placement.translation, dtype=float), np.array(placement.rotation, dtype=float))


def elements(model: Any, joint: Any, placement: Pose, q: Vector, name: str) -> Iterator[Element]:
    """The chain of elements that a joint is.

    Args:
        model: The `pinocchio.Model`.
        joint: One of its joint models, or of the parts of a composite one.
        placement: What comes before it.
        q: Configuration of the whole model.
        name: Its name, for messages.

    Raises:
        UnsupportedFeatureError: A kind of joint that the mechanism graph does not have.
    """
    kind = joint.shortname().removeprefix("JointModel")
    start = int(joint.idx_q)
    values = [float(x) for x in q[start : start + int(joint.nq)]]
    if kind == "Composite":
        composite = joint.extract()
        for part, before in zip(composite.joints, composite.jointPlacements, strict=True):
            yield from elements(model, part, placement @ pose_of(before), q, name)
            placement = Pose.identity()
    elif kind in ("FreeFlyer", "Spherical"):
        x, y, z, w = values[-4:]
        type_name = "free" if kind == "FreeFlyer" else "spherical"
        yield Element(type_name, placement, (*values[:-4], w, x, y, z))
    elif kind == "SphericalZYX":
        yield from _chain("revolute", _UNIT[::-1], placement, values)
    elif kind == "Translation":
        yield from _chain("prismatic", _UNIT, placement, values)
    elif kind == "Planar":
        x, y, cosine, sine = values
        yield Element("planar", placement, (x, y, math.atan2(sine, cosine)))
    elif kind == "Universal":
        yield _universal(joint.extract(), placement, values)
    elif kind == "Mimic" or int(joint.nv) == 1:
        yield _with_one_freedom(model, joint, placement, q, name)
    else:
        raise UnsupportedFeatureError(
            f"joint {name!r}: a joint of the kind {kind} has no counterpart here; supported are revolute, "
            "prismatic, helical, universal, spherical, planar, translation, free-flyer, mimic and composite "
            "joints"
        )


@dataclass(frozen=True, slots=True)
class Follower:
    """How a mimic joint follows: value = scaling * leader + offset.

    Attributes:
        leader: Index of the joint that leads.
        scaling: The factor.
        offset: The value where the leader is at zero.
    """

    leader: int
    scaling: float
    offset: float


def follower(model: Any, joint: Any) -> Follower | None:
    """What a mimic joint follows; None for any other joint."""
    if joint.shortname() != "JointModelMimic":
        return None
    mimic = joint.extract()
    pairs = dict(zip(model.mimicking_joints, model.mimicked_joints, strict=True))
    return Follower(int(pairs[joint.id]), float(mimic.scaling), float(mimic.offset))


def _chain(kind: str, axes: Any, placement: Pose, values: list[float]) -> Iterator[Element]:
    for axis, value in zip(axes, values, strict=True):
        yield Element(kind, placement, (value,), turn=_frame(axis))
        placement = Pose.identity()


def _universal(joint: Any, placement: Pose, values: list[float]) -> Element:
    first, second = (np.array(axis, dtype=float).ravel() for axis in (joint.axis1, joint.axis2))
    turn = frame_with_z(first, second)
    return Element(
        "universal", placement, tuple(values), turn=Pose.at(np.zeros(3), turn), second_axis=turn.T @ second
    )


def _with_one_freedom(model: Any, joint: Any, placement: Pose, q: Vector, name: str) -> Element:
    state = joint.createData()
    joint.calc(state, q)
    subspace = np.array(state.S, dtype=float).ravel()
    value = _value(joint, q)
    mimic = follower(model, joint)
    if mimic is not None:
        if mimic.scaling == 0.0 or int(model.joints[mimic.leader].nv) != 1:
            raise UnsupportedFeatureError(
                f"joint {name!r} follows joint {model.names[mimic.leader]!r} with scaling {mimic.scaling:g}: "
                "supported is following a joint with one axis, with a scaling other than zero"
            )
        subspace = subspace / mimic.scaling
        value = mimic.scaling * _value(model.joints[mimic.leader], q) + mimic.offset
    linear, angular = subspace[:3], subspace[3:]
    turns = bool(angular.any())
    axis = angular if turns else linear
    pitch = float(linear @ angular) if turns else 0.0
    kind = ("screw" if pitch != 0.0 else "revolute") if turns else "prismatic"
    return Element(
        kind,
        placement,
        (value,),
        turn=_frame(axis),
        lead=2.0 * math.pi * pitch,
        limits=_limits(model, joint) if mimic is None else (),
    )


def _value(joint: Any, q: Vector) -> float:
    """Value of a joint with one freedom; joints without limits keep cosine and sine."""
    start = int(joint.idx_q)
    if int(joint.nq) == 2:
        return math.atan2(float(q[start + 1]), float(q[start]))
    return float(q[start])


def _limits(model: Any, joint: Any) -> tuple[Limits, ...]:
    at, rate = int(joint.idx_q), int(joint.idx_v)
    bounded = int(joint.nq) == 1
    lower, upper = model.lowerPositionLimit[at], model.upperPositionLimit[at]
    speeds = getattr(model, "upperVelocityLimit", None)
    efforts = getattr(model, "upperEffortLimit", None)
    found = Limits(
        _finite(lower) if bounded else None,
        _finite(upper) if bounded else None,
        _finite((model.velocityLimit if speeds is None else speeds)[rate]),
        _finite((model.effortLimit if efforts is None else efforts)[rate]),
    )
    return () if found == Limits() else (found,)


def _finite(value: Any) -> float | None:
    return float(value) if abs(value) < _HUGE else None


def _frame(axis: Vector) -> Pose:
    return Pose.at(np.zeros(3), frame_with_z(axis))
