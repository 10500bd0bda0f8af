"""Another body as the ground: a foot seen from the trunk, a platform held instead of its base."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from vincula.errors import UnknownNameError
from vincula.mechanism.configuration import Configuration
from vincula.mechanism.joint_types import values_between
from vincula.mechanism.kinematics import part_frames
from vincula.mechanism.parts import GROUND, Body, ContactPart, Cut, Frame, Joint, ReferenceMember
from vincula.spatial.poses import Pose

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism

_Part = TypeVar("_Part", Joint, ContactPart)


def with_ground(mechanism: Mechanism, body: str) -> Mechanism:
    """The same mechanism seen from a body that is now the ground; see `Mechanism.with_ground`."""
    if body == GROUND or _is_ground(mechanism, body):
        return mechanism
    if body not in mechanism.body:
        raise UnknownNameError("body", body, mechanism.body)
    seen = mechanism.body[body].pose.inverse()
    old = _free_name(mechanism, "world")
    dropped = _floating(mechanism, body)
    needed = _old_ground_needed(mechanism, dropped)
    names = {body: GROUND, GROUND: old}
    bodies = tuple(replace(b, pose=seen @ b.pose) for b in mechanism.bodies if b.name != body) + (
        (Body(old, seen),) if needed else ()
    )
    gone = {
        axis
        for joint in mechanism.joints
        if joint.name in dropped
        for axis in mechanism.type_of(joint).axis_names(joint.name)
    }
    return replace(
        mechanism,
        bodies=bodies,
        joints=tuple(_renamed(j, names) for j in mechanism.joints if j.name not in dropped),
        contacts=tuple(_renamed(c, names) for c in mechanism.contacts),
        frames=_frames(mechanism, names, needed),
        couplings=tuple(c for c in mechanism.couplings if not gone.intersection(c.axes)),
        drives=tuple(d for d in mechanism.drives if not gone.intersection(d.drives)),
        active=tuple(a for a in mechanism.active if a not in gone),
        lock=tuple(a for a in mechanism.lock if a not in gone),
        reference=_reference(mechanism, body, seen),
        motors={m: axis for m, axis in mechanism.motors.items() if axis not in gone | dropped},
        keyframes=_without(mechanism.keyframes, dropped),
        notes=(*mechanism.notes, f"{body} is the ground: positions and directions are in its axes"),
    )


def seen_from(drawn: Mechanism, grounded: Mechanism, body: str, q: Configuration) -> Configuration:
    """A configuration of a mechanism as one of the same mechanism with another ground.

    A free joint that led to the new ground is gone, with its value; where the old ground is a body that
    floats now, that body gets its pose from it.

    Args:
        drawn: The mechanism.
        grounded: `with_ground(drawn, body)`.
        body: The new ground.
        q: The configuration of `drawn`.
    """
    values = {name: q[name] for name in grounded.home if name in q}
    floating = [joint for joint in grounded.all_joints if joint.name in grounded.home and joint.name not in q]
    if floating:
        poses = drawn.body_poses(q)
        seen = poses[body].inverse()
        there = {name: seen @ pose for name, pose in poses.items() if name not in (body, GROUND)}
        there[GROUND] = Pose.identity(drawn.space.translations)
        there.update({b.name: seen for b in grounded.bodies if b.name not in drawn.body})
        for joint in floating:
            frames = part_frames(joint, there)
            values[joint.name] = values_between(grounded.type_of(joint), *frames, joint.second_axis)
    return grounded.configuration(values)


def _is_ground(mechanism: Mechanism, name: str) -> bool:
    """Whether it is the name that the ground has in the file: a frame that coincides with it."""
    here = Pose.identity(mechanism.space.translations)
    return any(
        frame.name == name
        and frame.body == GROUND
        and np.array_equal(frame.pose.position, here.position)
        and np.array_equal(frame.pose.rotation, here.rotation)
        for frame in mechanism.frames
        if name not in mechanism.body
    )


def _free_name(mechanism: Mechanism, wanted: str) -> str:
    name = wanted
    while name in mechanism.body:
        name = f"old {name}"
    return name


def _floating(mechanism: Mechanism, body: str) -> set[str]:
    """Free joints that constrain nothing: to the new ground, or the only part that touches the old one."""
    free = {j.name for j in mechanism.joints if j.type == "free" and GROUND in (j.first, j.second)}
    if len(free) == 1 and not _old_ground_needed(mechanism, free):
        return free
    return {name for name in free if body in (mechanism.joint[name].first, mechanism.joint[name].second)}


def _old_ground_needed(mechanism: Mechanism, dropped: set[str]) -> bool:
    """Whether anything but floating joints touches the old ground."""
    parts: list[Joint | ContactPart] = [j for j in mechanism.joints if j.name not in dropped]
    parts += mechanism.contacts
    return any(GROUND in (part.first, part.second) for part in parts)


def _renamed(part: _Part, names: Mapping[str, str]) -> _Part:
    return replace(part, first=names.get(part.first, part.first), second=names.get(part.second, part.second))


def _frames(mechanism: Mechanism, names: Mapping[str, str], needed: bool) -> tuple[Frame, ...]:
    kept = [frame for frame in mechanism.frames if needed or frame.body != GROUND]
    return tuple(replace(frame, body=names.get(frame.body, frame.body)) for frame in kept)


def _reference(mechanism: Mechanism, body: str, seen: Pose) -> ReferenceMember | None:
    """The reference member with its cut points in the new axes; none when it is the new ground."""
    reference = mechanism.reference
    if reference is None or reference.body == body:
        return None
    cuts = {
        name: Cut(cut.kind, None if cut.at is None else tuple(map(float, seen.apply(np.array(cut.at)))))
        for name, cut in reference.cuts.items()
    }
    return replace(reference, cuts=cuts)


def _without(
    keyframes: Mapping[str, Mapping[str, Sequence[float]]], dropped: set[str]
) -> dict[str, dict[str, Sequence[float]]]:
    return {
        name: {joint: value for joint, value in values.items() if joint not in dropped}
        for name, values in keyframes.items()
    }
