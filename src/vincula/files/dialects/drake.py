"""Drake's constraints in SDF files: welds and balls between frames; the rest is named and refused."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from vincula.files.problems import shown
from vincula.files.report import LoadReport
from vincula.files.robot_graph import DraftJoint, RobotDraft
from vincula.files.xmltree import Element
from vincula.files.xmlvalues import XmlValues
from vincula.spatial.poses import Pose

if TYPE_CHECKING:
    from vincula.files.sdf_frames import SdfFrames

CONSTRAINTS: Final = ("drake:weld_constraint", "drake:ball_constraint")
_IGNORED: Final = {
    "drake:proximity_properties": "contacts are never inferred from shapes",
    "drake:illustration_properties": "pictures are not read",
    "drake:collision_filter_group": "contacts are never inferred from shapes",
    "drake:rotor_inertia": "masses play no part in kinematics and statics",
    "drake:gear_ratio": "the rate of a motor is that of its joint",
}


def read_constraint(
    element: Element, frames: SdfFrames, draft: RobotDraft, values: XmlValues, report: LoadReport
) -> None:
    """Add one `drake:` element of a model to the draft."""
    if element.tag in _IGNORED:
        report.ignored(element.tag, element.name, _IGNORED[element.tag])
        return
    if element.tag not in CONSTRAINTS:
        values.problems.add(
            element.place,
            f"<{element.tag}> cannot be represented",
            name=element.tag,
            choices=(*CONSTRAINTS, *_IGNORED),
            unsupported=True,
        )
        return
    weld = element.tag == CONSTRAINTS[0]
    ends = ("drake:weld_constraint_frame_a", "drake:weld_constraint_frame_b") if weld else (
        "drake:ball_constraint_body_A", "drake:ball_constraint_body_B")  # fmt: skip
    names = [_text(element, tag, values) for tag in ends]
    places = [_place_in_link(element, name, frames, values) for name in names]
    if not weld:
        for i, tag in enumerate(("drake:ball_constraint_p_AP", "drake:ball_constraint_p_BQ")):
            point = values.numbers(element, _text(element, tag, values), 3, what=tag, unit="length")
            if point is not None and places[i] is not None:
                places[i] = (places[i] or Pose.identity(3)) @ Pose.at(point, np.eye(3))
    if places[0] is None or places[1] is None:
        return
    count = sum(j.closure for j in draft.joints)
    name = f"{'weld' if weld else 'ball'}:{names[0]}-{names[1]}"
    draft.joints.append(
        DraftJoint(
            name=name if all(j.name != name for j in draft.joints) else f"{name}.{count}",
            type="fixed" if weld else "spherical",
            parent=frames.link_of(names[0]),
            child=frames.link_of(names[1]),
            on_parent=places[0],
            on_child=places[1],
            closure=True,
            rows_only=True,
            place=element.place,
        )
    )
    report.used(element.tag, name, "closes a loop")


def _text(element: Element, tag: str, values: XmlValues) -> str:
    found = next(element.find_all(tag), None)
    if found is None or not found.text:
        values.problems.add(element.place, f"<{tag}> is missing")
        return ""
    return found.text


def _place_in_link(element: Element, name: str, frames: SdfFrames, values: XmlValues) -> Pose | None:
    if name and name not in frames.names:
        values.problems.add(element.place, got=f"frame {shown(name)}", name=name, choices=frames.names)
        return None
    return frames.in_link(name) if name else None
