"""Any mechanism as a native file, drawn at its home configuration.

In a drawing every joint value is zero, so values in the new file are displacements from the home
configuration of the old one.  What the format cannot hold is listed, never left out in silence.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from vincula.errors import UnsupportedFeatureError
from vincula.files.native_losses import changes, losses
from vincula.files.native_writer_values import (
    coupling_entry,
    keyframe_entry,
    limits_entry,
    numbers,
    weights_entry,
)
from vincula.mechanism.parts import GROUND, ContactPart, Frame, Joint
from vincula.spatial.poses import Pose
from vincula.spatial.space import PLANAR

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism


@dataclass
class NativeData:
    """A mechanism as the content of a native file.

    Attributes:
        content: Plain values, for YAML or JSON.
        lost: What the format cannot hold.
        changed: What is held in another form than before.
    """

    content: dict[str, Any]
    lost: list[str] = field(default_factory=list)
    changed: list[str] = field(default_factory=list)

    def refuse_losses(self) -> None:
        """Refuse to go on if something is lost.

        Raises:
            UnsupportedFeatureError: The list of what the format cannot hold.
        """
        if self.lost:
            raise UnsupportedFeatureError(
                "a native file cannot hold everything here:\n" + "\n".join(self.lost), self.lost
            )


def native_data(mechanism: Mechanism) -> NativeData:
    """The content of a native file for a mechanism, in m and rad."""
    poses = {GROUND: Pose.identity(mechanism.space.translations)}
    poses.update({body.name: body.pose for body in mechanism.bodies})
    content = _Writer(mechanism, poses).content()
    kept = {key: value for key, value in content.items() if value not in ([], {}) or key == "weights"}
    return NativeData(kept, losses(mechanism, poses), changes(mechanism))


_DOUBLE: Final = 1e-14
"""Relative precision of numbers that were written in full: nothing worth stating."""


class _Writer:
    def __init__(self, mechanism: Mechanism, poses: Mapping[str, Pose]) -> None:
        self._mechanism, self._poses = mechanism, poses
        self._planar = mechanism.space is PLANAR
        self._frames = {frame.name: frame for frame in mechanism.frames}

    def content(self) -> dict[str, Any]:
        """Everything that the format holds, sections without content included."""
        mechanism = self._mechanism
        content: dict[str, Any] = {"vincula": 1, "name": mechanism.name, "space": mechanism.space.name}
        joints = [joint for joint in mechanism.joints if not joint.closure]
        content["bodies"] = {}
        content["frames"] = {}
        content["joints"] = [self._joint(joint) for joint in joints]
        content["contacts"] = [self._contact(contact) for contact in mechanism.contacts]
        content["closures"] = [self._closure(joint) for joint in mechanism.joints if joint.closure]
        content["bodies"] = self._bodies(content)
        content["frames"] = {name: self._frame(frame) for name, frame in self._frames.items()}
        content["couplings"] = [coupling_entry(coupling, mechanism) for coupling in mechanism.couplings]
        content["motors"] = self._motors()
        content["lock"] = list(mechanism.lock)
        if mechanism.reference is not None:
            content["reference"] = self._reference()
        if mechanism.weights is not None:
            content["weights"] = weights_entry(mechanism.weights)
        content["keyframes"] = {
            name: keyframe_entry(values, mechanism, self._poses)
            for name, values in mechanism.keyframes.items()
        }
        content["precision"] = self._precision()
        content["notes"] = list(mechanism.notes)
        return content

    def _precision(self) -> dict[str, float]:
        """How roughly the source is known; stated always, since the digits here are those of doubles."""
        digits = self._mechanism.precision
        known = (
            ("length", digits.digits_length, self._mechanism.length),
            ("angle", digits.digits_angle, 1.0),
        )
        return {key: value if value > _DOUBLE * size else 0.0 for key, value, size in known}

    def _joint(self, joint: Joint) -> dict[str, Any]:
        first = self._poses[joint.first] @ joint.frame_on_first
        second = self._poses[joint.second] @ joint.frame_on_second
        entry: dict[str, Any] = {
            "name": joint.name,
            "type": joint.type,
            "bodies": [joint.first, joint.second],
            "at": numbers(second.position),
        }
        if joint.type == "prismatic":
            entry["axis"] = numbers(first.rotation[:, 0 if self._planar else 2])
        elif joint.type == "universal":
            entry["axes"] = [numbers(first.rotation[:, 2]), numbers(second.rotation @ joint.second_axis)]
        elif joint.type in ("revolute", "screw", "cylindrical", "planar") and not self._planar:
            entry["axis"] = numbers(first.rotation[:, 2])
        if joint.type == "screw":
            entry["lead"] = float(joint.lead)
        limits = [limits_entry(limit, home) for limit, home in zip(joint.limits, joint.home, strict=False)]
        if any(limits):
            entry["limits"] = limits if joint.type in ("cylindrical", "universal") else limits[0]
        return entry

    def _contact(self, contact: ContactPart) -> dict[str, Any]:
        first = self._poses[contact.first] @ contact.frame_on_first
        entry: dict[str, Any] = {
            "name": contact.name,
            "type": contact.type,
            "bodies": [contact.first, contact.second],
            "at": numbers(first.position),
            "normal": numbers(first.rotation[:, -1]),
        }
        if contact.type.startswith("line"):
            entry["line"] = numbers(first.rotation[:, 0])
        if contact.friction is not None:
            entry["friction"] = float(contact.friction)
        return entry

    def _closure(self, joint: Joint) -> dict[str, Any]:
        names = []
        for end, body, pose in (
            ("first", joint.first, joint.frame_on_first),
            ("second", joint.second, joint.frame_on_second),
        ):
            name = f"{joint.name}.{end}"
            frame = Frame(name, body, pose)
            while name in self._frames and not _same_frame(self._frames[name], frame):
                name += "'"
            self._frames.setdefault(name, Frame(name, body, pose))
            names.append(name)
        entry: dict[str, Any] = {"name": joint.name, "type": joint.type, "frames": names}
        if joint.cut is not None:
            entry["cut"] = joint.cut
        return entry

    def _frame(self, frame: Frame) -> dict[str, Any]:
        pose = self._poses[frame.body] @ frame.pose
        entry: dict[str, Any] = {"body": frame.body, "at": numbers(pose.position)}
        if not np.array_equal(pose.rotation, np.eye(len(pose.position))):
            if not self._planar:
                entry["z"] = numbers(pose.rotation[:, 2])
            entry["x"] = numbers(pose.rotation[:, 0])
        return entry

    def _bodies(self, content: Mapping[str, Any]) -> dict[str, Any]:
        """Bodies, when use alone would not declare them in their order."""
        parts = [*content["joints"], *content["contacts"]]
        used = dict.fromkeys(name for part in parts for name in part["bodies"] if name != GROUND)
        every = [body.name for body in self._mechanism.bodies]
        return {} if list(used) == every else {name: {} for name in every}

    def _motors(self) -> list[Any]:
        mechanism = self._mechanism
        drives = {drive.name: drive for drive in mechanism.drives}
        motors: list[Any] = []
        for name in mechanism.active:
            called = [motor for motor, axis in mechanism.motors.items() if axis == name and motor != name]
            if name in drives:
                motors.append(
                    {"name": name, "drives": {axis: float(c) for axis, c in drives[name].drives.items()}}
                )
            elif called:
                motors.append({"name": called[0], "axis": name})
            else:
                motors.append(name)
        return motors

    def _reference(self) -> dict[str, Any]:
        reference = self._mechanism.reference
        if reference is None:
            return {}
        pose = self._poses[reference.body]
        entry: dict[str, Any] = {"body": reference.body, "origin": numbers(pose.apply(reference.origin))}
        if reference.axes == "body":
            entry["axes"] = "body"
        cuts = {}
        for name, cut in reference.cuts.items():
            cuts[name] = {"kind": cut.kind} | ({} if cut.at is None else {"at": numbers(np.array(cut.at))})
        return entry | ({"cuts": cuts} if cuts else {})


def _same_frame(one: Frame, other: Frame) -> bool:
    """Whether two frames are on one body at one place, but for rounding."""
    return (
        one.body == other.body
        and np.allclose(one.pose.position, other.pose.position, rtol=0.0, atol=_DOUBLE)
        and np.allclose(one.pose.rotation, other.pose.rotation, rtol=0.0, atol=_DOUBLE)
    )
