"""Isaac Sim's loop joints and frames in URDF files, in both forms that are in use.

    <loop_joint name="..." type="spherical">
      <link1 link="..." xyz="..." rpy="..."/> <link2 link="..." xyz="..." rpy="..."/>
    </loop_joint>

The second link is printed as another `<link1>` in Isaac's manual; both are read.  Exporters of CAD
programs write the other form, which gives one axis in the parent link; its direction in the child
follows from the pose in which the file is drawn:

    <loop_joint name="..." type="revolute">
      <parent link="..."/> <child link="..."/>
      <parent_origin xyz="..."/> <child_origin xyz="..."/> <axis xyz="..."/>
    </loop_joint>
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from vincula.files.dialects.closing import WITH_AXIS, close_loop, link_named, loop_type, only_child
from vincula.files.report import LoadReport
from vincula.files.urdf_places import origin, placement
from vincula.files.xmltree import Element
from vincula.files.xmlvalues import XmlValues
from vincula.mechanism.parts import Frame
from vincula.spatial.poses import Pose

if TYPE_CHECKING:
    from vincula.files.robot_graph import RobotDraft


def read_loop_joint(element: Element, draft: RobotDraft, values: XmlValues, report: LoadReport) -> None:
    """Add one `<loop_joint>` to the draft."""
    values.name(element)
    kind = loop_type(element, values)
    if kind == "universal":
        values.problems.add(element.place, "a universal <loop_joint> has no second axis", unsupported=True)
        return
    if any(element.find_all("parent")):
        _parent_and_child(element, draft, values, report, kind)
        return
    values.only(element, ("link1", "link2", "axis", "limit"))
    ends = [*element.find_all("link1"), *element.find_all("link2")]
    if len(ends) != 2:
        values.problems.add(element.place, f"expected <link1> and <link2>, got {len(ends)} of them")
        return
    links = [link_named(end, draft, values) for end in ends]
    poses = [placement(end, values) for end in ends]
    axis = None
    if kind in WITH_AXIS:
        found = next(element.find_all("axis"), None)
        text = "1 0 0" if found is None else found.get("xyz", "1 0 0")
        axis = values.direction(found or element, text, what="axis")
        if axis is None:
            return
    if kind and all(links) and poses[0] is not None and poses[1] is not None:
        close_loop(element, draft, report, kind, ((links[0], poses[0]), (links[1], poses[1])), axis=axis)


def _parent_and_child(
    element: Element, draft: RobotDraft, values: XmlValues, report: LoadReport, kind: str
) -> None:
    values.only(element, ("parent", "child", "parent_origin", "child_origin", "axis", "limit"))
    ends = [only_child(element, tag, values) for tag in ("parent", "child")]
    links = ["" if end is None else link_named(end, draft, values) for end in ends]
    places = [origin(element, values, tag) for tag in ("parent_origin", "child_origin")]
    found = next(element.find_all("axis"), None)
    axis = None
    if kind in WITH_AXIS:
        text = "1 0 0" if found is None else found.get("xyz", "1 0 0")
        axis = values.direction(found or element, text, what="axis")
        if axis is None:
            return
    if found is not None and found.get("frame", "parent") != "parent":
        values.problems.add(found.place, got="another frame than the parent's", expected='frame="parent"')
    if not (kind and all(links)) or places[0] is None or places[1] is None:
        return
    on_parent, on_child = Pose.at(places[0].position), places[1].position

    def place(poses: Mapping[str, Pose]) -> None:
        turn = poses[links[1]].rotation.T @ poses[links[0]].rotation
        ends = (links[0], on_parent), (links[1], Pose.at(on_child, turn))
        close_loop(element, draft, report, kind, ends, axis=axis)

    draft.when_placed.append(place)


def read_fixed_frame(element: Element, draft: RobotDraft, values: XmlValues, report: LoadReport) -> None:
    """Add one `<fixed_frame>` to the draft: a named frame on a link."""
    values.only(element, ("parent", "origin"))
    name, end, pose = values.name(element), only_child(element, "parent", values), origin(element, values)
    link = "" if end is None else link_named(end, draft, values)
    if name and link and pose is not None:
        draft.frames.append(Frame(name, link, pose))
        report.used("fixed_frame", name, f"frame on {link}")
