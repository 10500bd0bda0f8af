"""Drake's extensions in URDF files: ball, weld and distance constraints, `<drake:joint>`.

Source: multibody/parsing/parsing_doxygen.h and detail_common.h of RobotLocomotion/drake: children of a ball
constraint are `drake:ball_constraint_body_A name=`, `..._p_AP value=` and B with Q likewise; values of
`drake:joint` are ball, planar, universal.  A weld constraint is understood in the same spelling.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from vincula.files.dialects.closing import close_loop, link_named, only_child
from vincula.files.dialects.drake import IGNORED, SPRINGS, UNSUPPORTED, add_rod, has_stiffness
from vincula.files.dialects.unknown import suspicion
from vincula.files.problems import shown
from vincula.files.report import LoadReport
from vincula.files.robot_graph import DraftJoint
from vincula.files.urdf_places import origin, placement
from vincula.files.xmltree import Element
from vincula.files.xmlvalues import XmlValues
from vincula.mechanism.parts import Frame
from vincula.spatial.poses import Pose

if TYPE_CHECKING:
    from vincula.files.robot_graph import RobotDraft

JOINTS: Final = {"ball": "spherical", "planar": "planar", "screw": "screw", "universal": "universal"}
"""Types of `<drake:joint>`, and ours."""


def read_drake(element: Element, draft: RobotDraft, values: XmlValues, report: LoadReport) -> None:
    """Add one `drake:` element of a URDF file to the draft."""
    kind = element.tag.removeprefix("drake:")
    if element.tag in IGNORED:
        report.ignored(element.tag, element.name, IGNORED[element.tag], of=element)
    elif element.tag in SPRINGS:
        report.ignored(element.tag, element.name, SPRINGS[element.tag], of=element)
        report.note(f"<{element.tag}> is a spring, not a joint: what it holds together is open here")
    elif kind == "joint":
        _joint(element, draft, values, report)
    elif kind in ("ball_constraint", "distance_constraint"):
        _between_points(element, kind.removesuffix("_constraint"), draft, values, report)
    elif kind == "weld_constraint":
        ends = [_frame(element, tag, draft, values) for tag in ("frame_a", "frame_b")]
        if ends[0] is not None and ends[1] is not None:
            close_loop(element, draft, report, "fixed", (ends[0], ends[1]), rows_only=True)
    elif kind == "frame":
        read_frame(element, draft, values, report)
    elif not suspicion(element, draft):
        report.ignored(
            element.tag, element.name, "not known; it says nothing about links and joints", of=element
        )
    else:
        values.problems.add(
            element.place, f"<{element.tag}> cannot be represented", name=element.tag,
            choices=("drake:joint", "drake:ball_constraint", "drake:weld_constraint", *IGNORED),
            unsupported=True,
        )  # fmt: skip


def _joint(element: Element, draft: RobotDraft, values: XmlValues, report: LoadReport) -> None:
    name, written = values.name(element), element.get("type", "")
    if written not in JOINTS:
        values.problems.add(
            element.place, got=f"joint type {shown(written)}", name=written, choices=JOINTS,
            unsupported=written in UNSUPPORTED,
        )  # fmt: skip
        return
    links = [link_named(e, draft, values) if e is not None else "" for e in (
        only_child(element, "parent", values), only_child(element, "child", values))]  # fmt: skip
    place = origin(element, values)
    axis = second = None
    if written == "universal":
        axis, second = np.eye(3)[0], np.eye(3)[1]
    elif written != "ball":
        found = next(element.find_all("axis"), None)
        default = "0 0 1" if written == "planar" else "1 0 0"
        text = default if found is None else found.get("xyz", default)
        axis = values.direction(found or element, text, what="axis")
        if axis is None:
            return
    lead = _pitch(element, values) if written == "screw" else 0.0
    if name and all(links) and place is not None:
        draft.joints.append(
            DraftJoint(
                name=name, type=JOINTS[written], parent=links[0], child=links[1], on_parent=place,
                on_child=Pose.identity(3), axis=axis, second_axis=second, lead=lead, place=element.place,
            )
        )  # fmt: skip
        report.used("drake:joint", name, JOINTS[written])


def _pitch(element: Element, values: XmlValues) -> float:
    found = only_child(element, "drake:screw_thread_pitch", values)
    pitch = None if found is None else values.number(found, "value", default=0.0)
    if found is not None and pitch == 0.0:
        values.problems.add(found.place, "a screw needs a pitch that is not zero")
    return pitch or 1.0


def read_frame(element: Element, draft: RobotDraft, values: XmlValues, report: LoadReport) -> None:
    """`<drake:frame>` and the plain `<frame>` of Drake: name, link, xyz and rpy in one element."""
    name, link, pose = values.name(element), link_named(element, draft, values), placement(element, values)
    if name and link and pose is not None:
        draft.frames.append(Frame(name, link, pose))
        report.used(element.tag, name, f"frame on {link}")


def _frame(element: Element, end: str, draft: RobotDraft, values: XmlValues) -> tuple[str, Pose] | None:
    """Link and pose of the frame that an end of a weld names."""
    found = only_child(element, f"drake:weld_constraint_{end}", values)
    if found is None:
        return None
    name = values.name(found)
    frames = {frame.name: frame for frame in draft.frames}
    if name in frames:
        return frames[name].body, frames[name].pose
    if name in draft.links:
        return name, Pose.identity(3)
    if name:
        values.problems.add(
            found.place, got=f"frame {shown(name)}", name=name, choices=[*frames, *draft.links]
        )
    return None


def _between_points(
    element: Element, kind: str, draft: RobotDraft, values: XmlValues, report: LoadReport
) -> None:
    """Two points that coincide (ball), or keep their distance."""
    prefix = f"drake:{kind}_constraint_"
    ends: list[tuple[str, Pose]] = []
    for body, point in (("body_A", "p_AP"), ("body_B", "p_BQ")):
        holder, place = (only_child(element, prefix + tag, values) for tag in (body, point))
        link = link_named(holder, draft, values, "name") if holder is not None else ""
        text = place.get("value", "") if place is not None else "0 0 0"
        xyz = values.numbers(place or element, text, 3, what=point, unit="length")
        if link and xyz is not None:
            ends.append((link, Pose.at(xyz)))
    if len(ends) != 2:
        return
    if kind == "ball":
        close_loop(element, draft, report, "spherical", (ends[0], ends[1]), rows_only=True)
        return
    if has_stiffness(element, values):
        report.ignored(element.tag, element.name, "a distance with a stiffness is a spring", of=element)
        report.note(f"<{element.tag}> with a stiffness is a spring, not a rod: it is left out")
        return
    found = only_child(element, prefix + "distance", values)
    distance = None if found is None else values.number(found, "value", default=0.0, unit="length")
    if distance is not None:
        add_rod(element, draft, values, report, (ends[0], ends[1]), distance)
