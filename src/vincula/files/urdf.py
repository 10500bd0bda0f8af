"""URDF files (1.0 to 1.2) as mechanisms: links, joints, mimic, limits, transmissions, and their loops.

URDF itself knows trees only; loops come from dialects, one file each in `dialects`, inside the file or
beside it.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Final

from vincula.arrays import Vector
from vincula.files.contents import account_elements, account_repairs
from vincula.files.dialects import reader_of_element, side_files
from vincula.files.dialects.drake_world import declare_world, float_in_world
from vincula.files.dialects.srdf import PARTS as SRDF_PARTS
from vincula.files.dialects.unknown import read_unknown
from vincula.files.limits import DEFAULT_LIMITS, Limits
from vincula.files.packages import Packages, record_meshes
from vincula.files.problems import Place, Problems, shown
from vincula.files.report import LoadReport
from vincula.files.robot_graph import DraftJoint, RobotDraft
from vincula.files.snapping import Snapping
from vincula.files.source import Source, open_source
from vincula.files.unclosed import note_unclosed_ends
from vincula.files.urdf_motors import read_transmission
from vincula.files.urdf_places import origin
from vincula.files.xmltree import Element, parse_xml
from vincula.files.xmlvalues import TypedDigits, XmlValues
from vincula.mechanism.mechanism import Mechanism
from vincula.mechanism.parts import Coupling
from vincula.mechanism.parts import Limits as JointLimits
from vincula.spatial.poses import Pose

TYPES: Final = {
    "revolute": "revolute",
    "continuous": "revolute",
    "prismatic": "prismatic",
    "fixed": "fixed",
    "floating": "free",
    "planar": "planar",
    "spherical": "spherical",
}
"""Joint types of URDF and ours; spherical is an extension of Bullet's reader."""

_WITHOUT_KINEMATICS: Final = {
    "material": "colours are no part of a mechanism",
    "sensor": "no part of a mechanism",
    "gripper": "no part of a mechanism",
}
_LINK_PARTS: Final = {
    "inertial": "masses play no part in kinematics and statics",
    "visual": "shapes are not read",
    "collision": "shapes are not read; contacts are never inferred from them",
    "self_collision_checking": "no part of a mechanism",
    "contact": "simulator settings",
    "sensor": "no part of a mechanism",
}
_JOINT_PARTS: Final = {
    "dynamics": "friction and damping play no part in kinematics and statics",
    "joint_properties": "friction and damping play no part in kinematics and statics",
    "calibration": "no part of a mechanism",
    "safety_controller": "no part of a mechanism",
    "gazebo": "simulator settings",
    "hardwareInterface": "no part of a mechanism",
}
_WITH_ONE_VALUE: Final = ("revolute", "continuous", "prismatic")
_READ_IN_JOINT: Final = ("parent", "child", "origin", "axis", "limit", "mimic")


def load_urdf(
    path: str | os.PathLike[str] | Source,
    limits: Limits = DEFAULT_LIMITS,
    *,
    beside: Sequence[str | os.PathLike[str]] = (),
    snapping: Snapping | None = None,
    packages: Packages | None = None,
) -> tuple[Mechanism, LoadReport]:
    """The mechanism of a URDF file, at zero joint values.

    The root link is the ground.  Loops, motors and passive joints are taken from the file and from
    side files.

    Args:
        path: The file, or its text where it is open already.
        limits: How much the files may hold.
        beside: Side files (loops, SRDF); by default those found beside the file.
        snapping: Replaces numbers of the file by what they mean; side files hold none.
        packages: Where `package://` leads; by default to the packages of the environment.

    Returns:
        The mechanism, and the report of everything used and ignored.

    Raises:
        FileError: The file cannot be read, or is no mechanism; with file, line, column and element.
        UnsupportedFeatureError: The file holds a loop or a part that cannot be represented.
    """
    source = path if isinstance(path, Source) else open_source(path, limits)
    reader = UrdfReader(source, limits)
    root = parse_xml(source, limits, reader.report)
    if snapping is not None:
        snapping.urdf(root)
    reader.read(root)
    record_meshes(root, source.path, packages or Packages.of(), reader.report)
    for loops in side_files(source, beside, limits):
        loops.read(reader.draft, reader.values, reader.report)
    mechanism = reader.finish()
    account_elements(root, reader.report)
    account_repairs(reader.report)
    return mechanism, reader.report


class UrdfReader:
    """Reads the elements of one URDF document into a draft."""

    def __init__(self, source: Source, limits: Limits) -> None:
        self.limits = limits
        self.problems = Problems(source.file)
        self.digits = TypedDigits()
        self.values = XmlValues(self.problems, self.digits)
        self.report = LoadReport(source.file, "URDF")
        self.draft = RobotDraft(source.file, self.problems)

    def read(self, root: Element) -> None:
        """Read the whole document."""
        if root.tag != "robot":
            self.problems.add(root.place, got=f"<{root.tag}>", expected="<robot>")
            self.problems.refuse()
        self.draft.name = root.name or "robot"
        later: list[Element] = []
        for element in root.children:
            if element.tag == "link":
                self._link(element)
            elif element.tag in ("joint", "transmission"):
                later.append(element)
            elif element.tag in _WITHOUT_KINEMATICS:
                self.report.ignored(element.tag, element.name, _WITHOUT_KINEMATICS[element.tag], of=element)
            else:
                later.append(element)
        if not self.draft.links and any(part.tag in SRDF_PARTS for part in later):
            expected = "a URDF file: name this one with --loops beside it"
            self.problems.add(root.place, got="an SRDF file", expected=expected)
            self.problems.refuse()
        declare_world(root, self.draft)
        for element in later:
            if element.tag == "joint":
                self._joint(element)
        for element in later:
            if element.tag == "transmission":
                read_transmission(element, self.draft, self.values, self.report)
            elif element.tag != "joint":
                reader_of_element(element)(element, self.draft, self.values, self.report)
        float_in_world(root, self.draft)

    def finish(self) -> Mechanism:
        """The mechanism of what was read."""
        if len(self.draft.links) > self.limits.bodies or len(self.draft.joints) > self.limits.joints:
            self.problems.add(
                Place(self.draft.file), f"more than {self.limits.bodies} links or {self.limits.joints} joints"
            )
        self.draft.digits_length, self.draft.digits_angle = self.digits.length, self.digits.angle
        note_unclosed_ends(self.draft, "A side file does: closed_loop: [[{}]], type: [3d], or 6d")
        mechanism = self.draft.mechanism()
        for note in self.draft.notes:
            self.report.note(note)
        return mechanism

    def _link(self, element: Element) -> None:
        name = self.values.name(element)
        if not name:
            return
        if name in self.draft.links:
            self.problems.add(
                element.place,
                f"the link name {shown(name)} is used twice (line {self.draft.links[name].line})",
            )
            return
        self.draft.links[name] = element.place
        self.report.used("link", name)
        for part in element.children:
            if part.tag in _LINK_PARTS:
                self.report.ignored(part.tag, name, _LINK_PARTS[part.tag], of=part)
            else:
                read_unknown(part, self.draft, self.values, self.report, _LINK_PARTS)

    def _joint(self, element: Element) -> None:
        name = self.values.name(element)
        written = element.get("type", "")
        if written not in TYPES:
            self.problems.add(
                element.place, got=f"joint type {shown(written)}", expected="a joint type", name=written,
                choices=TYPES,
            )  # fmt: skip
            return
        known = (*_READ_IN_JOINT, *_JOINT_PARTS)
        for part in element.children:
            if part.tag in _JOINT_PARTS:
                self.report.ignored(part.tag, name, _JOINT_PARTS[part.tag], of=part)
            elif part.tag not in _READ_IN_JOINT:
                read_unknown(part, self.draft, self.values, self.report, known)
        parent, child = (self.values.child_link(element, tag) for tag in ("parent", "child"))
        linked = [
            bool(link) and self.draft.has_link(link, element.place, what=f"joint {shown(name)}")
            for link in (parent, child)
        ]
        place = origin(element, self.values)
        axis = self._axis(element, written)
        limits = self._limits(element, written)
        if not (name and all(linked) and place is not None):
            return
        self.draft.joints.append(
            DraftJoint(
                name=name, type=TYPES[written], parent=parent, child=child, on_parent=place,
                on_child=Pose.identity(3), axis=axis, limits=limits, place=element.place,
            )
        )  # fmt: skip
        self.report.used("joint", name, TYPES[written])
        self._mimic(element, name)

    def _axis(self, element: Element, written: str) -> Vector | None:
        if written in ("fixed", "floating", "spherical"):
            return None
        found = next(element.find_all("axis"), None)
        text = "1 0 0" if found is None else found.get("xyz", "1 0 0")
        return self.values.direction(found or element, text, what="axis")

    def _limits(self, element: Element, written: str) -> tuple[JointLimits, ...]:
        found = next(element.find_all("limit"), None)
        if found is None or written not in _WITH_ONE_VALUE:
            return ()
        got = {key: self.values.number(found, key) for key in ("lower", "upper", "velocity", "effort")}
        lower, upper = got["lower"], got["upper"]
        if written == "continuous":
            lower = upper = None
        if lower is not None and upper is not None and lower > upper:
            self.problems.add(found.place, f"lower limit {lower:g} is above upper limit {upper:g}")
            return ()
        return (JointLimits(lower, upper, got["velocity"] or None, got["effort"] or None),)

    def _mimic(self, element: Element, name: str) -> None:
        found = next(element.find_all("mimic"), None)
        if found is None:
            return
        leader = self.values.name(found, "joint")
        factor = self.values.number(found, "multiplier", default=1.0)
        offset = self.values.number(found, "offset", default=0.0)
        if not leader or factor is None or offset is None:
            return
        joints = {j.get("name", ""): j for j in (element.parent or element).find_all("joint")}
        if leader not in joints or leader == name:
            self.problems.add(
                found.place, f"mimic names the joint {shown(leader)}", name=leader,
                expected="another joint of the file", choices=[j for j in joints if j != name],
            )  # fmt: skip
            return
        kinds = {joint: written.get("type", "") for joint, written in joints.items()}
        if kinds[name] == "fixed":
            self.report.ignored("mimic", name, "the joint is fixed: it follows nothing", of=found)
            return
        several = [joint for joint in (name, leader) if kinds[joint] not in (*_WITH_ONE_VALUE, "fixed")]
        if several:
            self.problems.add(
                found.place,
                f"joint {shown(several[0])} of type {shown(kinds[several[0]])} has no single value",
            )
            return
        # A fixed leader stays at zero: the follower is held at the offset.
        rates = {name: 1.0} if kinds[leader] == "fixed" else {name: 1.0, leader: -factor}
        self.draft.couplings.append(
            Coupling(f"mimic:{name}", rates, polynomial=(offset,), references=dict.fromkeys(rates, 0.0))
        )
        self.report.used("mimic", name, f"{name} = {factor:g} x {leader} + {offset:g}")
