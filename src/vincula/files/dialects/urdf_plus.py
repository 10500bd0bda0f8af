"""URDF+: loop joints and couplings below `<robot>` (Chignoli et al., URDF+, 2024).

    <loop name="..." type="revolute">
      <predecessor link="..."><origin xyz="..." rpy="..."/></predecessor>
      <successor link="..."><origin xyz="..." rpy="..."/></successor>
      <axis xyz="0 0 1"/>
    </loop>
    <coupling name="..."><predecessor link="..."/><successor link="..."/><ratio value="2"/></coupling>

A coupling relates the joints on the two ways down from the nearest common ancestor of both links: ratio
times the sum over the predecessor's way is the sum over the successor's.

The exporter ACDC4Robot writes `<predecessor name="...">` and `<sucessor name="...">`, which is read as meant.

Older files write `<constraint type="position">` for a point that coincides and `<constraint type="rolling">`
with a ratio for a coupling; a ratio that is missing is 1.  The oldest write `<loop_constraint>` for the
point, with parent, parent_origin, child and child_origin, and `<joint_constraint>` with parent, child and
gear_ratio for the coupling.  An attribute `independent` of a joint chooses
coordinates, not motors; it is not used.

Source: src/Urdf/constraint.cpp and src/Dynamics/ClusterTreeParsing.cpp of ROAM-Lab-ND/generalized_rbda.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from vincula.files.dialects.closing import WITH_AXIS, close_loop, link_named, loop_type, only_child
from vincula.files.problems import shown
from vincula.files.report import LoadReport
from vincula.files.urdf_places import origin, placement
from vincula.files.xmltree import Element
from vincula.files.xmlvalues import XmlValues
from vincula.mechanism.parts import Coupling
from vincula.spatial.poses import Pose

if TYPE_CHECKING:
    from vincula.files.robot_graph import DraftJoint, RobotDraft

_MISSPELLED: Final = "sucessor"


def read_loop(element: Element, draft: RobotDraft, values: XmlValues, report: LoadReport) -> None:
    """Add one `<loop>` to the draft."""
    second_end = _MISSPELLED if any(element.find_all(_MISSPELLED)) else "successor"
    values.only(element, ("predecessor", second_end, "axis", "limit", "dynamics"))
    kind = loop_type(element, values)
    values.name(element)
    ends = [only_child(element, tag, values) for tag in ("predecessor", second_end)]
    if ends[0] is None or ends[1] is None or not kind:
        return
    called = "name" if all(end and "name" in end.attributes for end in ends) else "link"
    links = [link_named(end, draft, values, called) for end in ends if end is not None]
    poses = [origin(end, values) for end in ends if end is not None]
    axis = second = None
    found = list(element.find_all("axis"))
    if kind in WITH_AXIS or (kind == "universal" and found):
        text = found[0].get("xyz", "1 0 0") if found else "1 0 0"
        axis = values.direction(found[0] if found else element, text, what="axis")
        if axis is None:
            return
    if kind == "universal":
        if len(found) != 2:
            values.problems.add(element.place, "a universal loop needs two <axis>")
            return
        second = values.direction(found[1], found[1].get("xyz", ""), what="axis")
        if second is None:
            return
        if axis is not None and abs(float(axis @ second)) > 1.0 - 1e-9:
            values.problems.add(found[1].place, "the two axes of a universal joint are parallel")
            return
    if all(links) and poses[0] is not None and poses[1] is not None:
        close_loop(
            element, draft, report, kind, ((links[0], poses[0]), (links[1], poses[1])),
            axis=axis, second_axis=second,
        )  # fmt: skip


def read_old_constraint(element: Element, draft: RobotDraft, values: XmlValues, report: LoadReport) -> None:
    """Add one `<constraint>` with a predecessor and a successor: a point, or wheels that roll."""
    kind = element.get("type", "")
    if kind == "rolling":
        read_coupling(element, draft, values, report)
        return
    if kind != "position":
        values.problems.add(
            element.place, got=f"constraint type {shown(kind)}", name=kind, choices=("position", "rolling")
        )
        return
    values.only(element, ("predecessor", "successor"))
    values.name(element)
    ends = [only_child(element, tag, values) for tag in ("predecessor", "successor")]
    if ends[0] is None or ends[1] is None:
        return
    links = [link_named(end, draft, values) for end in ends if end is not None]
    poses = [origin(end, values) for end in ends if end is not None]
    if all(links) and poses[0] is not None and poses[1] is not None:
        close_loop(element, draft, report, "spherical", ((links[0], poses[0]), (links[1], poses[1])))


def read_loop_constraint(element: Element, draft: RobotDraft, values: XmlValues, report: LoadReport) -> None:
    """Add one `<loop_constraint>`: a point of the parent and one of the child that coincide."""
    tags = ("parent", "child")
    values.only(element, (*tags, *(f"{tag}_origin" for tag in tags)))
    values.name(element)
    ends: list[tuple[str, Pose]] = []
    for tag in tags:
        end, place = only_child(element, tag, values), only_child(element, f"{tag}_origin", values)
        link = link_named(end, draft, values) if end is not None else ""
        pose = placement(place, values) if place is not None else None
        if link and pose is not None:
            ends.append((link, pose))
    if len(ends) == 2:
        close_loop(element, draft, report, "spherical", (ends[0], ends[1]))


def read_coupling(element: Element, draft: RobotDraft, values: XmlValues, report: LoadReport) -> None:
    """Add one `<coupling>` to the draft, or what older files write for it."""
    oldest = element.tag == "joint_constraint"
    tags = ("parent", "child", "gear_ratio") if oldest else ("predecessor", "successor", "ratio")
    values.only(element, tags)
    name = values.name(element)
    ends = [only_child(element, tag, values) for tag in tags[:2]]
    old = element.tag == "constraint" and not any(element.find_all("ratio"))
    found = None if old else only_child(element, tags[2], values)
    ratio = (1.0 if old else None) if found is None else values.number(found, "value")
    if found is not None and "value" not in found.attributes:
        values.problems.add(found.place, "attribute 'value' is missing")
    if ends[0] is None or ends[1] is None or ratio is None:
        return
    links = [link_named(end, draft, values) for end in ends if end is not None]
    if not all(links):
        return
    ways = [_way_down(draft, link) for link in links]
    shared = 0
    while shared < min(map(len, ways)) and ways[0][shared] is ways[1][shared]:
        shared += 1
    rates: dict[str, float] = {}
    for way, factor in zip(ways, (ratio, -1.0), strict=True):
        for joint in way[shared:]:
            if joint.type in ("revolute", "prismatic"):
                rates[joint.name] = rates.get(joint.name, 0.0) + factor
            elif joint.type != "fixed":
                values.problems.add(
                    element.place, f"joint {shown(joint.name)} of type {joint.type} cannot be coupled",
                    unsupported=True,
                )  # fmt: skip
                return
    if not rates or not np.any(list(rates.values())):
        values.problems.add(element.place, f"no joint between {shown(links[0])} and {shown(links[1])}")
        return
    draft.couplings.append(Coupling(name, rates, references=dict.fromkeys(rates, 0.0)))
    terms = " + ".join(f"{c:g} {joint}" for joint, c in rates.items())
    report.used(element.tag, name, f"{terms} = 0".replace("+ -", "- "))


def _way_down(draft: RobotDraft, link: str) -> list[DraftJoint]:
    """The joints from the root to a link, the root's first."""
    above = {joint.child: joint for joint in reversed(draft.joints) if not joint.closure}
    way: list[DraftJoint] = []
    while link in above and above[link] not in way:
        way.append(above[link])
        link = above[link].parent
    way.reverse()
    return way
