"""Any spatial mechanism as an SDF file, a true graph drawn at the home configuration.

Passive joints get an effort limit of zero, as the reader understands it.  What SDF cannot hold is
listed, never left out in silence.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Final
from xml.sax.saxutils import escape, quoteattr

import numpy as np

from vincula.arrays import Vector
from vincula.errors import listing
from vincula.files.problems import shown
from vincula.files.written import (
    Written,
    bad_names,
    free_name,
    in_space,
    lost_locks,
    number,
    numbers,
    open_parts,
    reference_frame,
    said_with_commands,
)
from vincula.files.written_couplings import followings
from vincula.mechanism.parts import GROUND, Body, Frame, Joint
from vincula.spatial.poses import Pose

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism

TYPES: Final = {
    "revolute": "revolute",
    "prismatic": "prismatic",
    "screw": "screw",
    "universal": "universal",
    "spherical": "ball",
    "fixed": "fixed",
}
"""Joint types of ours that SDF has, and its names."""

_RESERVED: Final = ("world", "__model__")


def sdf_data(mechanism: Mechanism) -> Written:
    """The SDF file of a mechanism, in m and rad; of a planar one its twin in space."""
    mechanism, lost = in_space(mechanism)
    writer = _Writer(mechanism)
    lines = ['<?xml version="1.0"?>', '<sdf version="1.11">', f"<model name={quoteattr(mechanism.name)}>"]
    lines += writer.links()
    lines += [line for joint in writer.joints() for line in writer.joint(joint)]
    text = "\n".join([*lines, "</model>", "</sdf>", ""])
    return Written(text, [*lost, *writer.losses()], writer.changes(), format="an SDF file")


class _Writer:
    def __init__(self, mechanism: Mechanism) -> None:
        self._mechanism = mechanism
        self._poses: Mapping[str, Pose] = {GROUND: Pose.identity(3)} | {
            body.name: body.pose for body in mechanism.bodies
        }
        found, self._left = followings(mechanism)
        self._mimics = {following.follower: following for following in found}
        taken = set(_RESERVED)
        self._links = _distinct(mechanism.bodies, "_link", taken) | {GROUND: "world"}
        self._joints = _distinct(mechanism.joints, "_joint", taken)
        self._frames = _distinct(mechanism.frames, "_frame", taken)
        self._point = reference_frame(mechanism, {frame.name for frame in mechanism.frames} | taken)

    def links(self) -> Iterator[str]:
        """Links at their home poses, and the named frames."""
        for body in self._mechanism.bodies:
            yield f"  <link name={quoteattr(self._links[body.name])}>{_pose(body.pose)}</link>"
        frames = list(self._mechanism.frames)
        if self._point is not None and self._point[0] not in {frame.name for frame in frames}:
            frames.append(Frame(*self._point))
        for frame in frames:
            name = quoteattr(self._frames.get(frame.name, frame.name))
            carrier = quoteattr(self._links[frame.body])
            yield f"  <frame name={name} attached_to={carrier}>{_pose(frame.pose)}</frame>"

    def joints(self) -> list[Joint]:
        """The joints that SDF has, those with motors first: the file has no other order of motors."""
        mechanism = self._mechanism
        order = {axis: k for k, axis in enumerate(mechanism.active)}

        def first_motor(joint: Joint) -> int:
            axes = mechanism.type_of(joint).axis_names(joint.name)
            return min((order[axis] for axis in axes if axis in order), default=len(order))

        return sorted((joint for joint in mechanism.joints if joint.type in TYPES), key=first_motor)

    def joint(self, joint: Joint) -> Iterator[str]:
        """One joint: its frame in the child, its axes in that frame."""
        yield f'  <joint name={quoteattr(self._joints[joint.name])} type="{TYPES[joint.type]}">'
        yield f"    <parent>{escape(self._links[joint.first])}</parent>"
        yield f"    <child>{escape(self._links[joint.second])}</child>"
        yield f"    {_pose(joint.frame_on_second, self._links[joint.second])}"
        first = self._poses[joint.first] @ joint.frame_on_first
        second = self._poses[joint.second] @ joint.frame_on_second
        axes: list[Vector] = []
        if joint.type not in ("spherical", "fixed"):
            axes.append(second.rotation.T @ first.rotation[:, 2])
        if joint.type == "universal":
            axes.append(joint.second_axis)
        names = self._mechanism.type_of(joint).axis_names(joint.name)
        for k, axis in enumerate(axes):
            tag = "axis" if k == 0 else "axis2"
            inside = f"<xyz>{numbers(axis)}</xyz>{self._limit(joint, k, names[k])}{self._mimic(names[k])}"
            yield f"    <{tag}>{inside}</{tag}>"
        if joint.type == "screw":
            yield f"    <screw_thread_pitch>{number(joint.lead)}</screw_thread_pitch>"
        yield "  </joint>"

    def _limit(self, joint: Joint, k: int, axis: str) -> str:
        limit = joint.limits[k] if k < len(joint.limits) else None
        home = joint.home[k] if joint.home else 0.0
        parts = []
        bounds = (None, None) if limit is None else (limit.lower, limit.upper)
        for tag, value in zip(("lower", "upper"), bounds, strict=True):
            if value is not None:
                parts.append(f"<{tag}>{number(value - home)}</{tag}>")
        if limit is not None and limit.rate is not None:
            parts.append(f"<velocity>{number(limit.rate)}</velocity>")
        passive = axis not in self._mechanism.active
        effort = None if limit is None else limit.effort
        if passive or effort is not None:
            parts.append(f"<effort>{number(0.0 if passive else effort or 0.0)}</effort>")
        return f"<limit>{''.join(parts)}</limit>" if parts else ""

    def _mimic(self, axis: str) -> str:
        if axis not in self._mimics:
            return ""
        mimic = self._mimics[axis]
        leader = mimic.leader
        joint, which = leader, "axis"
        if leader not in self._joints:
            joint, _, last = leader.rpartition(".")
            which = "axis2" if last == "2" else "axis"
        return (
            f'<mimic joint={quoteattr(self._joints[joint])} axis="{which}">'
            f"<multiplier>{number(mimic.factor)}</multiplier>"
            f"<offset>{number(mimic.offset)}</offset><reference>0</reference></mimic>"
        )

    def losses(self) -> Iterator[str]:
        """What would be lost, one sentence a thing."""
        mechanism = self._mechanism
        yield from bad_names(mechanism)
        for kind, names in (("body", self._links), ("joint", self._joints), ("frame", self._frames)):
            for name, written in names.items():
                if written != name and name != GROUND:
                    yield (
                        f"the name {shown(name)} of a {kind}: links, joints and frames share one space of "
                        f"names in SDF; the {kind} becomes {shown(written)}"
                    )
        for joint in mechanism.joints:
            if joint.type not in TYPES:
                yield f"joint {joint.name!r}: SDF has no joint of type {joint.type}"
            elif joint.type == "spherical" and set(mechanism.active) & {f"{joint.name}.{c}" for c in "xyz"}:
                yield f"joint {joint.name!r}: a ball with motors"
        yield from open_parts(mechanism)
        for contact in mechanism.contacts:
            yield f"contact {contact.name!r}: SDF has no contacts between bodies"
        for coupling in self._left:
            yield f"coupling {coupling.name!r}: SDF couples two axes at a constant ratio only"
        for drive in mechanism.drives:
            yield f"motor {drive.name!r} combines axes: SDF has motors on single axes only"
        yield from lost_locks(mechanism)

    def changes(self) -> list[str]:
        """What is held in another form, one sentence a thing."""
        mechanism, found = self._mechanism, []
        if any(j.home and any(j.home) for j in mechanism.joints if j.type not in ("spherical", "free")):
            found.append("joint values are displacements from the home configuration")
        if mechanism.keyframes:
            found.append(f"the configurations {listing(mechanism.keyframes)} are not in the file")
        said = said_with_commands(mechanism, self._point[0] if self._point else "")
        return [*found, *(text for text in said if "speed" not in text)]


def _distinct(parts: Sequence[Body | Joint | Frame], ending: str, taken: set[str]) -> dict[str, str]:
    """Names for parts in SDF's one space of names, which must not be in use by a part of another kind."""
    found = {}
    own = {part.name for part in parts}
    for part in parts:
        name = part.name
        if name in taken:
            name = free_name(name + ending, taken | own)
        found[part.name] = name
        taken.add(name)
    return found


def _pose(pose: Pose, relative_to: str = "") -> str:
    """A pose with a quaternion: roll, pitch and yaw lose digits near their singularity."""
    w, x, y, z = pose.as_quaternion_wxyz()
    values = numbers(np.array([*pose.position, x, y, z, w]))
    base = f" relative_to={quoteattr(relative_to)}" if relative_to else ""
    return f'<pose{base} rotation_format="quat_xyzw">{values}</pose>'
