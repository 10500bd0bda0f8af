"""SRDF files beside URDF files: only `<passive_joint>` is about the mechanism."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from vincula.files.contents import account_elements
from vincula.files.limits import Limits
from vincula.files.problems import Problems, shown
from vincula.files.report import LoadReport
from vincula.files.source import Source
from vincula.files.xmltree import parse_xml
from vincula.files.xmlvalues import TypedDigits, XmlValues

if TYPE_CHECKING:
    from vincula.files.robot_graph import RobotDraft

_IGNORED: Final = {
    "group": "groups are for motion planners",
    "group_state": "poses of groups are for motion planners",
    "end_effector": "groups are for motion planners",
    "virtual_joint": "the root link is the ground; a floating base is a joint of type floating",
    "disable_collisions": "contacts are never inferred from shapes",
    "enable_collisions": "contacts are never inferred from shapes",
    "disable_default_collisions": "contacts are never inferred from shapes",
    "link_sphere_approximation": "shapes are not read",
    "joint_property": "settings of motion planners",
    "chain": "groups are for motion planners",
}
PARTS: Final = ("passive_joint", *_IGNORED)
"""What an SRDF file holds."""


class SrdfFile:
    """One SRDF file.

    Args:
        source: Its text.
        limits: How much it may hold.
    """

    def __init__(self, source: Source, limits: Limits) -> None:
        self._source, self._limits = source, limits

    @staticmethod
    def recognises(source: Source) -> bool:
        """Whether a text looks like an SRDF file: XML that is no URDF file."""
        return source.text.lstrip().startswith("<")

    def read(self, draft: RobotDraft, _values: XmlValues, report: LoadReport) -> None:
        """Mark the passive joints of the draft.

        Raises:
            FileError: Not SRDF, or a joint that does not exist; every problem with its place.
        """
        problems = Problems(self._source.file)
        values = XmlValues(problems, TypedDigits())
        root = parse_xml(self._source, self._limits, report)
        if root.tag != "robot" or any(root.find_all("link")):
            problems.add(root.place, got=f"<{root.tag}>", expected="an SRDF file: <robot> without links")
            problems.refuse()
        joints = {joint.name for joint in draft.joints if not joint.closure}
        for element in root.children:
            if element.tag in _IGNORED:
                report.ignored(f"SRDF {element.tag}", element.name, _IGNORED[element.tag], of=element)
            elif element.tag != "passive_joint":
                problems.add(
                    element.place, f"<{element.tag}> is not understood in SRDF", name=element.tag,
                    choices=("passive_joint", *_IGNORED),
                )  # fmt: skip
            elif (name := values.name(element)) in joints:
                draft.passive.add(name)
                report.used("passive_joint", name, "passive")
            elif name:
                problems.add(element.place, f"there is no joint {shown(name)}", name=name, choices=joints)
        problems.refuse_if_any()
        account_elements(root, report)
