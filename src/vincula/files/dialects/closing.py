"""Loop joints of the dialects: the types that may close a loop, and how one is added to a draft."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from vincula.arrays import Vector
from vincula.files.problems import shown
from vincula.files.robot_graph import DraftJoint
from vincula.files.xmlvalues import XmlValues
from vincula.spatial.poses import Pose

if TYPE_CHECKING:
    from vincula.files.report import LoadReport
    from vincula.files.robot_graph import RobotDraft
    from vincula.files.xmltree import Element

TYPES: Final = {
    "revolute": "revolute",
    "continuous": "revolute",
    "prismatic": "prismatic",
    "fixed": "fixed",
    "spherical": "spherical",
    "ball": "spherical",
    "universal": "universal",
    "cylindrical": "cylindrical",
    "planar": "planar",
}
"""Types of loop joints in the dialects, and ours."""

WITH_AXIS: Final = ("revolute", "prismatic", "cylindrical", "planar")
"""Types that need one axis."""


def loop_type(element: Element, values: XmlValues) -> str:
    """Our name of the type of a loop joint; empty after a problem."""
    written = element.get("type", "")
    if written in TYPES:
        return TYPES[written]
    values.problems.add(
        element.place,
        got=f"loop type {shown(written)}",
        expected="a type of joint",
        name=written,
        choices=TYPES,
        unsupported=written in ("floating", "screw"),
    )
    return ""


def link_named(element: Element, draft: RobotDraft, values: XmlValues, attribute: str = "link") -> str:
    """The link that an attribute names; empty after a problem."""
    name = values.name(element, attribute)
    known = bool(name) and draft.has_link(name, element.place, what=f"<{element.tag}>")
    return name if known else ""


def only_child(element: Element, tag: str, values: XmlValues) -> Element | None:
    """The one child with a tag; None after a problem."""
    found = list(element.find_all(tag))
    if len(found) == 1:
        return found[0]
    values.problems.add(element.place, f"expected one <{tag}>, got {len(found)}")
    return None


def close_loop(
    element: Element,
    draft: RobotDraft,
    report: LoadReport,
    kind: str,
    ends: tuple[tuple[str, Pose], tuple[str, Pose]],
    *,
    name: str = "",
    axis: Vector | None = None,
    second_axis: Vector | None = None,
    rows_only: bool = False,
) -> None:
    """Add a loop joint between two frames.

    Args:
        element: Where it is written.
        draft: What it is added to.
        report: Where it is recorded.
        kind: Our name of the joint type.
        ends: Link and pose of the joint frame in it, first and second.
        name: Its name; by default the element's, or one made of the links.
        axis: Unit axis in the joint frame.
        second_axis: Second axis of a universal joint in the joint frame.
        rows_only: True for a loop that stands for its rows alone.
    """
    (first, on_first), (second, on_second) = ends
    wanted = name or element.name or f"{kind}:{first}-{second}"
    draft.joints.append(
        DraftJoint(
            name=free_name(draft, wanted) if not element.name else wanted,
            type=kind, parent=first, child=second, on_parent=on_first, on_child=on_second,
            axis=axis, second_axis=second_axis, closure=True, rows_only=rows_only, place=element.place,
        )
    )  # fmt: skip
    report.used(element.tag, wanted, f"{kind} joint that closes a loop")


def free_name(draft: RobotDraft, wanted: str) -> str:
    """A name that no joint has yet: the one wanted, or that with a number."""
    taken = {joint.name for joint in draft.joints}
    if wanted not in taken:
        return wanted
    return next(f"{wanted}.{k}" for k in range(2, len(taken) + 3) if f"{wanted}.{k}" not in taken)
