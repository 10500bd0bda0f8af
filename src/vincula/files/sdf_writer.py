"""Any spatial mechanism as an SDF file, a true graph drawn at the home configuration.

Passive joints get an effort limit of zero, as the reader understands it.  What SDF cannot hold is
listed, never left out in silence.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final
from xml.sax.saxutils import escape, quoteattr

import numpy as np

from vincula.arrays import Vector
from vincula.errors import UnsupportedFeatureError, listing
from vincula.files.problems import shown
from vincula.mechanism.parts import GROUND, Coupling, Joint
from vincula.spatial.poses import Pose
from vincula.spatial.space import PLANAR

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

_MISFIT: Final = 1e-9


@dataclass
class SdfData:
    """A mechanism as the text of an SDF file.

    Attributes:
        text: The file.
        lost: What the format cannot hold.
        changed: What is held in another form, or has to be said with every command.
    """

    text: str
    lost: list[str] = field(default_factory=list)
    changed: list[str] = field(default_factory=list)

    def refuse_losses(self) -> None:
        """Refuse to go on if something is lost.

        Raises:
            UnsupportedFeatureError: The list of what the format cannot hold.
        """
        if self.lost:
            raise UnsupportedFeatureError(
                "an SDF file cannot hold everything here:\n" + "\n".join(self.lost), self.lost
            )


def sdf_data(mechanism: Mechanism) -> SdfData:
    """The SDF file of a mechanism, in m and rad.

    Raises:
        UnsupportedFeatureError: A planar mechanism: SDF is spatial.
    """
    if mechanism.space is PLANAR:
        raise UnsupportedFeatureError("SDF files are spatial: a planar mechanism cannot be written as one")
    writer = _Writer(mechanism)
    lines = ['<?xml version="1.0"?>', '<sdf version="1.11">', f"<model name={quoteattr(mechanism.name)}>"]
    lines += writer.links()
    lines += [line for joint in mechanism.joints if joint.type in TYPES for line in writer.joint(joint)]
    return SdfData("\n".join([*lines, "</model>", "</sdf>", ""]), list(writer.losses()), writer.changes())


class _Writer:
    def __init__(self, mechanism: Mechanism) -> None:
        self._mechanism = mechanism
        self._poses: Mapping[str, Pose] = {GROUND: Pose.identity(3)} | {
            body.name: body.pose for body in mechanism.bodies
        }
        self._mimics = {
            follower: (leader, factor, offset)
            for coupling in mechanism.couplings
            if (mimic := self._as_mimic(coupling)) is not None
            for follower, leader, factor, offset in [mimic]
        }

    def links(self) -> Iterator[str]:
        """Links at their home poses, and the named frames."""
        for body in self._mechanism.bodies:
            yield f"  <link name={quoteattr(body.name)}>{_pose(body.pose)}</link>"
        for frame in self._mechanism.frames:
            carrier = quoteattr(_link(frame.body))
            yield f"  <frame name={quoteattr(frame.name)} attached_to={carrier}>{_pose(frame.pose)}</frame>"

    def joint(self, joint: Joint) -> Iterator[str]:
        """One joint: its frame in the child, its axes in that frame."""
        yield f'  <joint name={quoteattr(joint.name)} type="{TYPES[joint.type]}">'
        yield f"    <parent>{escape(_link(joint.first))}</parent>"
        yield f"    <child>{escape(_link(joint.second))}</child>"
        yield f"    {_pose(joint.frame_on_second, joint.second)}"
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
            inside = f"<xyz>{_numbers(axis)}</xyz>{self._limit(joint, k, names[k])}{self._mimic(names[k])}"
            yield f"    <{tag}>{inside}</{tag}>"
        if joint.type == "screw":
            yield f"    <screw_thread_pitch>{float(joint.lead)!r}</screw_thread_pitch>"
        yield "  </joint>"

    def _limit(self, joint: Joint, k: int, axis: str) -> str:
        limit = joint.limits[k] if k < len(joint.limits) else None
        home = joint.home[k] if joint.home else 0.0
        parts = []
        bounds = (None, None) if limit is None else (limit.lower, limit.upper)
        for tag, value in zip(("lower", "upper"), bounds, strict=True):
            if value is not None:
                parts.append(f"<{tag}>{value - home!r}</{tag}>")
        if limit is not None and limit.rate is not None:
            parts.append(f"<velocity>{limit.rate!r}</velocity>")
        passive = axis not in self._mechanism.active
        effort = None if limit is None else limit.effort
        if passive or effort is not None:
            parts.append(f"<effort>{0 if passive else effort!r}</effort>")
        return f"<limit>{''.join(parts)}</limit>" if parts else ""

    def _mimic(self, axis: str) -> str:
        if axis not in self._mimics:
            return ""
        leader, factor, offset = self._mimics[axis]
        joint, which = leader, "axis"
        if leader not in {j.name for j in self._mechanism.joints}:
            joint, _, number = leader.rpartition(".")
            which = "axis2" if number == "2" else "axis"
        return (
            f'<mimic joint={quoteattr(joint)} axis="{which}"><multiplier>{factor!r}</multiplier>'
            f"<offset>{offset!r}</offset><reference>0</reference></mimic>"
        )

    def _as_mimic(self, coupling: Coupling) -> tuple[str, str, float, float] | None:
        """Follower, leader, factor and offset in displacements from home; None for any other coupling."""
        higher = [c for c in list(coupling.polynomial)[2:] if c != 0.0]
        if higher or (coupling.driver and len(coupling.polynomial) < 2):
            return None
        slope = coupling.polynomial[1] if coupling.driver else 0.0
        rates = dict(coupling.rates)
        for axis, c in coupling.driver.items():
            rates[axis] = rates.get(axis, 0.0) - slope * c
        if len(rates) != 2 or 0.0 in rates.values():
            return None
        follower, leader = rates
        home = {axis: self._home(axis) for axis in rates}
        factor = -rates[leader] / rates[follower]
        return follower, leader, factor, -coupling.residual(home, home) / rates[follower]

    def _home(self, axis: str) -> float:
        for joint in self._mechanism.joints:
            names = self._mechanism.type_of(joint).axis_names(joint.name)
            if axis in names and joint.home:
                return float(joint.home[names.index(axis)])
        return 0.0

    def losses(self) -> Iterator[str]:
        """What would be lost, one sentence a thing."""
        mechanism = self._mechanism
        names = [n.name for part in (mechanism.bodies, mechanism.joints, mechanism.frames) for n in part]
        for name in dict.fromkeys(n for n in names if names.count(n) > 1 or n in ("world", "__model__")):
            yield f"the name {shown(name)}: links, joints and frames share one space of names in SDF"
        for joint in mechanism.joints:
            if joint.type not in TYPES:
                yield f"joint {joint.name!r}: SDF has no joint of type {joint.type}"
            elif joint.type == "spherical" and set(mechanism.active) & {f"{joint.name}.{c}" for c in "xyz"}:
                yield f"joint {joint.name!r}: a ball with motors"
        tight = _MISFIT * mechanism.length
        for residual in mechanism.residuals():
            if residual.gap > tight:
                yield f"{residual} at the home configuration: it has no one place to be drawn at"
        for contact in mechanism.contacts:
            yield f"contact {contact.name!r}: SDF has no contacts between bodies"
        for coupling in mechanism.couplings:
            if self._as_mimic(coupling) is None:
                yield f"coupling {coupling.name!r}: SDF couples two axes at a constant ratio only"
        for drive in mechanism.drives:
            yield f"motor {drive.name!r} combines axes: SDF has motors on single axes only"
        if mechanism.lock:
            yield f"locks: {listing(mechanism.lock)}"

    def changes(self) -> list[str]:
        """What is held in another form, one sentence a thing."""
        mechanism, found = self._mechanism, []
        if any(j.home and any(j.home) for j in mechanism.joints if j.type not in ("spherical", "free")):
            found.append("joint values are displacements from the home configuration")
        if mechanism.reference is not None:
            found.append(
                f"the reference member is not in the file: say --reference {mechanism.reference.body}"
            )
        if mechanism.weights is not None:
            found.append("the weights are not in the file")
        if mechanism.keyframes:
            found.append(f"the configurations {listing(mechanism.keyframes)} are not in the file")
        return found


def _link(body: str) -> str:
    return "world" if body == GROUND else body


def _numbers(vector: Vector) -> str:
    return " ".join(repr(float(value) + 0.0) for value in vector)


def _pose(pose: Pose, relative_to: str = "") -> str:
    """A pose with a quaternion: roll, pitch and yaw lose digits near their singularity."""
    w, x, y, z = pose.as_quaternion_wxyz()
    values = _numbers(np.array([*pose.position, x, y, z, w]))
    base = f" relative_to={quoteattr(_link(relative_to))}" if relative_to else ""
    return f'<pose{base} rotation_format="quat_xyzw">{values}</pose>'
