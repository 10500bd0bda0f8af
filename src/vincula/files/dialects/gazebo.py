"""Gazebo's extensions in URDF files: an SDF `<joint>` below `<gazebo>` closes a loop; the rest is ignored.

Links stand where the URDF tree puts them at zero joint values, and the model's frame is that of the
root link, as where Gazebo turns a URDF file into SDF.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Final

from vincula.files.dialects.unknown import read_unknown
from vincula.files.problems import shown
from vincula.files.report import LoadReport
from vincula.files.robot_graph import WORLD
from vincula.files.sdf_frames import SdfFrames
from vincula.files.sdf_joints import KNOWN_IN_JOINTS, SdfJoints, end_of
from vincula.files.xmltree import Element
from vincula.files.xmlvalues import XmlValues
from vincula.spatial.poses import Pose

if TYPE_CHECKING:
    from vincula.files.robot_graph import RobotDraft

_VERSION: Final = 5.0
"""Joints are written as in SDF 1.5: axes in the joint's frame unless a flag says otherwise."""
_COUPLING: Final = ("mimicJoint", "mimic_joint")


def read_gazebo(element: Element, draft: RobotDraft, values: XmlValues, report: LoadReport) -> None:
    """Read one `<gazebo>` element."""
    if not element.children:
        report.ignored("gazebo", element.get("reference", ""), "simulator settings", of=element)
    for part in element.children:
        if part.tag == "joint" and "reference" not in element.attributes:
            _loop(part, draft, values, report)
        elif part.tag in ("link", "model", "include"):
            values.problems.add(
                part.place, f"<{part.tag}> in <gazebo> adds bodies: it cannot be read", unsupported=True
            )
        elif part.tag == "plugin":
            report.ignored("plugin", part.name, "plugins are never loaded", of=part)
            if any(inner.tag in _COUPLING for inner in part.walk()):
                draft.coupling_plugins.append(part.name)
        else:
            reference = element.attributes.get("reference", "")
            report.ignored(f"gazebo {part.tag}", reference, "simulator settings", of=part)


def _loop(element: Element, draft: RobotDraft, values: XmlValues, report: LoadReport) -> None:
    name = values.name(element)
    ends = [end_of(element, tag, values) for tag in ("parent", "child")]
    for end in ends:
        if end and end != WORLD:
            draft.has_link(end, element.place, what=f"joint {shown(name)}")
    if not name or not all(end in draft.links or end == WORLD for end in ends):
        return

    def place(poses: Mapping[str, Pose]) -> None:
        root = draft.ground or WORLD
        if WORLD in ends and WORLD not in draft.links:
            report.note(f"{name}: the world is taken for the root link {root}")
        frames = SdfFrames(values.problems, values)
        frames.add_drawn(poses, root)
        frames.add_joint(element, name, ends[1])
        reader = SdfJoints(frames, draft, values, report, _VERSION, closing=True)
        reader.read(element)
        reader.couple()
        for part in reader.unknown:
            read_unknown(part, draft, values, report, KNOWN_IN_JOINTS["joint"])

    draft.when_placed.append(place)
