"""Joints of SDF files (1.4 to 1.12): frames, axes, limits, screws, mimic."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from vincula.arrays import Vector
from vincula.files.problems import shown
from vincula.files.report import LoadReport
from vincula.files.robot_graph import WORLD, DraftJoint, RobotDraft
from vincula.files.sdf_frames import SdfFrames
from vincula.files.sdf_gearbox import GEARBOX, PARTS, read_gearbox
from vincula.files.xmltree import Element
from vincula.files.xmlvalues import XmlValues
from vincula.mechanism.parts import SMALLEST_DIRECTION, Coupling
from vincula.mechanism.parts import Limits as JointLimits
from vincula.spatial.poses import Pose

TYPES: Final = {
    "revolute": "revolute",
    "continuous": "revolute",
    "prismatic": "prismatic",
    "fixed": "fixed",
    "ball": "spherical",
    "universal": "universal",
    "revolute2": "universal",
    "screw": "screw",
}
"""Joint types of SDF and ours."""

_JOINT_PARTS: Final = {
    "physics": "simulator settings",
    "sensor": "no part of a mechanism",
    "provide_feedback": "simulator settings",
    "plugin": "plugins are never loaded",
    "drake:rotor_inertia": "masses play no part in kinematics and statics",
    "drake:gear_ratio": "the rate of a motor is that of its joint",
    "drake:controller_gains": "simulator settings",
}
_READ: Final = (
    "parent", "child", "pose", "axis", "axis2", "thread_pitch", "screw_thread_pitch", "drake:mimic",
    *PARTS,
)  # fmt: skip

_AXIS_PARTS: Final = {
    "dynamics": "friction, damping and springs play no part in kinematics and statics",
    "initial_position": "every joint value is zero in the drawn pose",
}
_READ_IN_AXIS: Final = ("xyz", "limit", "mimic", "use_parent_model_frame")
_LIMIT_PARTS: Final = {
    "stiffness": "simulator settings",
    "dissipation": "simulator settings",
    "drake:acceleration": "limits of acceleration are not used",
}
_READ_IN_LIMIT: Final = ("lower", "upper", "velocity", "effort")
KNOWN_IN_JOINTS: Final = {
    "joint": (*_READ, *_JOINT_PARTS),
    **dict.fromkeys(("axis", "axis2"), (*_READ_IN_AXIS, *_AXIS_PARTS)),
    "limit": (*_READ_IN_LIMIT, *_LIMIT_PARTS),
}
"""Elements that are understood in a joint, its axes and their limits."""


def end_of(joint: Element, tag: str, values: XmlValues) -> str:
    """The text of `<parent>` or `<child>`; empty after a problem."""
    found = list(joint.find_all(tag))
    if len(found) != 1 or not found[0].text:
        values.problems.add(joint.place, f"expected one <{tag}> with the name of a link or frame")
        return ""
    return found[0].text


class SdfJoints:
    """Reads the joints of a model into a draft.

    Args:
        frames: The frames of the model, the joints among them.
        draft: What the joints are added to.
        values: Reads numbers.
        report: Where the joints are recorded.
        version: 7 for SDF 1.7.
        closing: True where the joints close loops of a tree that is known already (Gazebo in URDF).

    Attributes:
        unknown: Elements in joints that nobody knows.
    """

    def __init__(
        self,
        frames: SdfFrames,
        draft: RobotDraft,
        values: XmlValues,
        report: LoadReport,
        version: float,
        *,
        closing: bool = False,
    ) -> None:
        self.frames, self.draft, self.values, self.report = frames, draft, values, report
        self.version, self.closing = version, closing
        self.unknown: list[Element] = []
        self._gearboxes: list[Element] = []

    def couple(self) -> None:
        """Add the gearboxes, once every joint has been read."""
        for element in self._gearboxes:
            axes = self._axes(element, GEARBOX, Pose.identity(3))
            if axes is not None:
                read_gearbox(element, (axes[0], axes[1]), self.frames, self.draft, self.values, self.report)

    def read(self, element: Element) -> None:
        """Add one `<joint>`."""
        written = element.get("type", "")
        if written not in (*TYPES, GEARBOX):
            self._refuse_type(element, written)
            return
        self._record_parts(element)
        parent, child = (end_of(element, tag, self.values) for tag in ("parent", "child"))
        for end, tag in ((parent, "parent"), (child, "child")):
            if end and end not in self.frames.names:
                self.values.problems.add(
                    element.place, got=f"{tag} {shown(end)}", name=end, choices=self.frames.names
                )
                return
        if not (parent and child):
            return
        placed = self._joint_frames(element.name, parent, child)
        if written == GEARBOX:
            self._gearboxes.append(element)
            return
        axes = self._axes(element, TYPES[written], placed[1])
        if axes is None:
            return
        if WORLD in (self.frames.link_of(parent), self.frames.link_of(child)):
            self.draft.links.setdefault(WORLD, element.place)
        self.draft.joints.append(
            DraftJoint(
                name=element.name, type=TYPES[written], parent=self.frames.link_of(parent),
                child=self.frames.link_of(child), on_parent=placed[0], on_child=placed[1],
                axis=axes[0] if axes else None, second_axis=axes[1] if len(axes) > 1 else None,
                lead=self._lead(element) if written == "screw" else 0.0,
                limits=self._limits(element, written), closure=self.closing, place=element.place,
            )
        )  # fmt: skip
        self.report.used("joint", element.name, TYPES[written])
        self._mimic(element)

    def _record_parts(self, joint: Element) -> None:
        """Record what is not read in a joint, its axes and their limits."""
        axes = [part for part in joint.children if part.tag in ("axis", "axis2")]
        limits = [part for axis in axes for part in axis.children if part.tag == "limit"]
        reasons = _JOINT_PARTS | _AXIS_PARTS | _LIMIT_PARTS
        for around in (joint, *axes, *limits):
            for part in around.children:
                if part.tag not in KNOWN_IN_JOINTS[around.tag]:
                    self.unknown.append(part)
                elif part.tag in reasons:
                    self.report.ignored(part.tag, joint.name, reasons[part.tag], of=part)

    def _refuse_type(self, element: Element, written: str) -> None:
        self.values.problems.add(
            element.place, got=f"joint type {shown(written)}", expected="a joint type", name=written,
            choices=TYPES,
        )  # fmt: skip

    def _mimic(self, element: Element) -> None:
        """SDF 1.11: follower = multiplier (leader - reference) + offset; Drake: without reference."""
        found = [("axis", m) for axis in element.find_all("axis") for m in axis.find_all("mimic")]
        found += [("axis2", m) for axis in element.find_all("axis2") for m in axis.find_all("mimic")]
        found += [("axis", m) for m in element.find_all("drake:mimic")]
        names = {joint.name: joint for joint in (element.parent or element).find_all("joint")}
        for axis, mimic in found:
            leader = mimic.get("joint", "")
            if leader not in names or leader == element.name:
                self.values.problems.add(
                    mimic.place, f"mimic names the joint {shown(leader)}", name=leader,
                    expected="another joint of the model", choices=[n for n in names if n != element.name],
                )  # fmt: skip
                continue
            factor, offset, reference = (
                self._mimic_number(mimic, key, default)
                for key, default in (("multiplier", 1.0), ("offset", 0.0), ("reference", 0.0))
            )
            if factor is None or offset is None or reference is None:
                continue
            follower_axis = _axis_name(element, axis)
            leader_axis = _axis_name(names[leader], mimic.get("axis", "axis"))
            self.draft.couplings.append(
                Coupling(
                    f"mimic:{follower_axis}",
                    {follower_axis: 1.0, leader_axis: -factor},
                    polynomial=(offset - factor * reference,),
                    references={follower_axis: 0.0, leader_axis: 0.0},
                )
            )
            self.report.used("mimic", element.name, f"{follower_axis} = {factor:g} x {leader_axis} + ...")

    def _mimic_number(self, mimic: Element, key: str, default: float) -> float | None:
        if key in mimic.attributes:
            return self.values.number(mimic, key)
        found = next(mimic.find_all(key), None)
        if found is None:
            return default
        value = self.values.numbers(found, found.text, 1, what=key)
        return None if value is None else float(value[0])

    def _joint_frames(self, name: str, parent: str, child: str) -> tuple[Pose, Pose]:
        """Joint frame in the parent link and in the child link."""
        on_child = self.frames.in_link(name) or Pose.identity(3)
        if not self.frames.is_link(parent):
            return self.frames.in_link(parent) or Pose.identity(3), on_child
        base, drawn = self.frames.pose(parent), self.frames.pose(name)
        on_parent = base.inverse() @ drawn if base is not None and drawn is not None else Pose.identity(3)
        return on_parent, on_child

    def _axes(self, element: Element, kind: str, on_child: Pose) -> list[Vector] | None:
        """Unit axes in the joint frame; None after a problem."""
        both = ("axis", "axis2")
        wanted = {"fixed": (), "spherical": (), "universal": both, GEARBOX: both}.get(kind, ("axis",))
        axes: list[Vector] = []
        for tag in wanted:
            found = next(element.find_all(tag), None)
            if found is None and tag == "axis2":
                self.values.problems.add(element.place, f"a joint of type {kind} needs <{tag}>")
                return None
            xyz = next(found.find_all("xyz"), None) if found is not None else None
            text = "0 0 1" if xyz is None else xyz.text
            axis = self.values.direction(xyz or element, text, what="xyz")
            if axis is None:
                return None
            axes.append(self._in_joint(element.name, found, xyz, axis))
        if kind == "universal" and float(np.linalg.norm(np.cross(axes[0], axes[1]))) < SMALLEST_DIRECTION:
            self.values.problems.add(element.place, "the two axes of a universal joint are parallel")
            return None
        return axes

    def _in_joint(self, joint: str, axis: Element | None, xyz: Element | None, vector: Vector) -> Vector:
        """An axis in the joint's frame, from the frame that it is expressed in."""
        frame = xyz.get("expressed_in", "") if xyz is not None else ""
        flag = next(axis.find_all("use_parent_model_frame"), None) if axis is not None else None
        old = self.version <= 6 and flag is not None and flag.text in ("1", "true")
        if not frame and not old and self.version != 4:
            return vector
        here, there = self.frames.pose(joint), self.frames.pose(frame or "__model__")
        if here is None or there is None:
            self.values.problems.add(
                (xyz or axis or Element("", {}, "", 0, 0)).place,
                got=f"expressed_in={shown(frame)}", name=frame, choices=self.frames.names,
            )  # fmt: skip
            return vector
        turned: Vector = here.rotation.T @ (there.rotation @ vector)
        return turned

    def _lead(self, element: Element) -> float:
        """Advance a turn: `screw_thread_pitch` [m], or 2 pi over minus `thread_pitch` [rad/m]."""
        for tag in ("screw_thread_pitch", "thread_pitch"):
            found = next(element.find_all(tag), None)
            if found is None:
                continue
            value = self.values.numbers(found, found.text, 1, what=tag)
            if value is None or value[0] == 0.0:
                self.values.problems.add(
                    found.place, got=f"{tag} {shown(found.text)}", expected="a number, not zero"
                )
                return 1.0
            pitch = float(value[0])
            return pitch if tag == "screw_thread_pitch" else -2 * math.pi / pitch
        self.values.problems.add(element.place, "a screw joint needs <screw_thread_pitch>")
        return 1.0

    def _limits(self, element: Element, written: str) -> tuple[JointLimits, ...]:
        """Limits by axis; an effort limit of zero marks a joint without a motor, as in Drake."""
        limits = []
        for tag in ("axis", "axis2"):
            axis = next((part for part in element.children if part.tag == tag), None)
            limit = next(axis.find_all("limit"), None) if axis is not None else None
            if axis is None:
                continue
            got: dict[str, float | None] = {}
            for key in ("lower", "upper", "velocity", "effort"):
                found = next(limit.find_all(key), None) if limit is not None else None
                value = self.values.numbers(found, found.text, 1, what=key) if found is not None else None
                got[key] = None if value is None else float(value[0])
            if got["effort"] == 0.0:
                self.draft.passive.add(element.name)
                self.report.note(f"{element.name} has an effort limit of zero: it is passive")
            lower, upper = (_bound(got[key]) for key in ("lower", "upper"))
            if lower is not None and upper is not None and lower > upper:
                self.values.problems.add(axis.place, f"lower limit {lower:g} is above upper limit {upper:g}")
                lower = upper = None
            if written == "continuous":
                lower = upper = None
            limits.append(JointLimits(lower, upper, _positive(got["velocity"]), _positive(got["effort"])))
        return tuple(limits)


def _bound(value: float | None) -> float | None:
    """SDF writes 1e16 for no limit."""
    return None if value is None or abs(value) >= 1e16 else value


def _positive(value: float | None) -> float | None:
    """SDF writes -1 for no limit."""
    return value if value is not None and value > 0.0 else None


def _axis_name(joint: Element, axis: str) -> str:
    """Name of an axis of a joint: a universal joint has two."""
    if TYPES.get(joint.get("type", "")) == "universal":
        return f"{joint.name}.{2 if axis == 'axis2' else 1}"
    return joint.name
