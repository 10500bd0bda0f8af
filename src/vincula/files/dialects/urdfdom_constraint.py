"""Loop constraints of a proposal for urdfdom; experimental, since the proposal may still change.

    <constraint name="..." type="revolute">
      <parent link="..."/> <parent_origin xyz="..." rpy="..."/> <parent_axis xyz="..."/>
      <child link="..."/> <child_origin xyz="..." rpy="..."/> <child_axis xyz="..."/>
    </constraint>

Source: ros/urdfdom pull request 264.  Each axis is given in the frame of its own origin.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vincula.arrays import Matrix, Vector
from vincula.files.dialects.closing import close_loop, link_named, loop_type, only_child
from vincula.files.dialects.urdf_plus import read_old_constraint
from vincula.files.report import LoadReport
from vincula.files.urdf_places import origin
from vincula.files.xmltree import Element
from vincula.files.xmlvalues import XmlValues
from vincula.spatial.poses import Pose, frame_with_z

if TYPE_CHECKING:
    from vincula.files.robot_graph import RobotDraft

NOTE = "<constraint> follows a proposal for urdfdom that may still change: experimental"
_SAME = 1e-9


def read_constraint(element: Element, draft: RobotDraft, values: XmlValues, report: LoadReport) -> None:
    """Add one `<constraint>` to the draft; one with a predecessor is an old form of URDF+."""
    if any(element.find_all("predecessor")) or any(element.find_all("successor")):
        read_old_constraint(element, draft, values, report)
        return
    values.only(
        element,
        ("parent", "child", "parent_origin", "child_origin", "parent_axis", "child_axis", "axis", "origin",
         "limit", "dynamics"),
    )  # fmt: skip
    values.name(element)
    kind = loop_type(element, values)
    ends = [only_child(element, tag, values) for tag in ("parent", "child")]
    links = ["" if end is None else link_named(end, draft, values) for end in ends]
    places = [_place(element, side, values) for side in ("parent", "child")]
    axes = [_axis(element, side, values) for side in ("parent", "child")]
    if not (kind and all(links)) or any(end is None for end in (*places, *axes)):
        return
    on_parent, on_child = (place or Pose.identity(3) for place in places)
    first, second = (np.array([1.0, 0.0, 0.0]) if axis is None else axis for axis in axes)
    report.note(NOTE)
    if kind == "universal":
        # The child's frame has its x along the second axis; its z is free, as the joint turns there.
        turned = frame_with_z(second)[:, [2, 0, 1]]
        frames = (on_parent @ _turn(frame_with_z(first)), on_child @ _turn(turned))
        _close(element, draft, report, kind, links, *frames)
    elif kind in ("spherical", "fixed"):
        _close(element, draft, report, kind, links, on_parent, on_child)
    elif kind in ("revolute", "cylindrical") or np.abs(first - second).max() < _SAME:
        frames = (on_parent @ _turn(frame_with_z(first)), on_child @ _turn(frame_with_z(second)))
        _close(element, draft, report, kind, links, *frames)
    else:
        values.problems.add(
            element.place, f"the axes of a {kind} constraint differ in their frames", unsupported=True
        )


def _turn(rotation: Matrix) -> Pose:
    return Pose(rotation, np.zeros(3))


def _close(
    element: Element,
    draft: RobotDraft,
    report: LoadReport,
    kind: str,
    links: list[str],
    one: Pose,
    other: Pose,
) -> None:
    close_loop(element, draft, report, kind, ((links[0], one), (links[1], other)))


def _place(element: Element, side: str, values: XmlValues) -> Pose | None:
    """`<parent_origin>`; an `<origin>` alone is the parent's, as of a joint."""
    tag = "origin" if side == "parent" and any(element.find_all("origin")) else f"{side}_origin"
    return origin(element, values, tag)


def _axis(element: Element, side: str, values: XmlValues) -> Vector | None:
    tags = (f"{side}_axis", "axis")
    found = next((child for tag in tags for child in element.find_all(tag)), None)
    text = "1 0 0" if found is None else found.get("xyz", "1 0 0")
    return values.direction(found or element, text, what=tags[0])
