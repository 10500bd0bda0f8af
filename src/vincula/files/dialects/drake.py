"""Drake's extensions: what SDF and URDF files share, and the constraints of SDF files.

Welds and balls close loops; a distance is a rod with a universal joint at one end and a ball at the
other; springs (bushings, distances with a stiffness) hold nothing exactly and are left out with a note.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Final

import numpy as np

from vincula.files.dialects.closing import close_loop, free_name
from vincula.files.dialects.unknown import suspicion
from vincula.files.problems import shown
from vincula.files.report import LoadReport
from vincula.files.robot_graph import WORLD, DraftJoint, RobotDraft
from vincula.files.xmltree import Element
from vincula.files.xmlvalues import XmlValues
from vincula.spatial.poses import Pose, frame_with_z

if TYPE_CHECKING:
    from vincula.files.sdf_frames import SdfFrames

End = tuple[str, Pose]
"""A link and a place on it."""

CONSTRAINTS: Final = (
    "drake:weld_constraint", "drake:ball_constraint", "drake:distance_constraint", "drake:joint",
)  # fmt: skip
IGNORED: Final = {
    "drake:proximity_properties": "contacts are never inferred from shapes",
    "drake:illustration_properties": "pictures are not read",
    "drake:perception_properties": "pictures are not read",
    "drake:collision_filter_group": "contacts are never inferred from shapes",
    "drake:ignored_collision_filter_group": "contacts are never inferred from shapes",
    "drake:rotor_inertia": "masses play no part in kinematics and statics",
    "drake:gear_ratio": "the rate of a motor is that of its joint",
}
"""Elements that say nothing about the mechanism."""

_SPRING: Final = "springs are no joints"
SPRINGS: Final = {"drake:linear_bushing_rpy": _SPRING, "drake:linear_spring_damper": _SPRING}
"""Elements that hold two bodies together by forces alone."""

UNSUPPORTED: Final = ("curvilinear",)
_WELD_ENDS: Final = {
    False: ("drake:weld_constraint_frame_a", "drake:weld_constraint_frame_b"),
    True: ("parent", "child"),
}


def read_constraint(
    element: Element, frames: SdfFrames, draft: RobotDraft, values: XmlValues, report: LoadReport
) -> None:
    """Add one `drake:` element of an SDF model to the draft."""
    kind = element.tag.removeprefix("drake:").removesuffix("_constraint")
    if element.tag in IGNORED:
        report.ignored(element.tag, element.name, IGNORED[element.tag], of=element)
    elif element.tag in SPRINGS:
        report.ignored(element.tag, element.name, SPRINGS[element.tag], of=element)
        report.note(f"<{element.tag}> is a spring, not a joint: what it holds together is open here")
    elif kind == "weld":
        tags = _WELD_ENDS[any(element.find_all("parent"))]
        names = [_text(element, tag, values) for tag in tags]
        ends = [_place(element, name, frames, draft, values) for name in names]
        if ends[0] is not None and ends[1] is not None:
            name = element.name or f"weld:{names[0]}-{names[1]}"
            close_loop(element, draft, report, "fixed", (ends[0], ends[1]), name=name, rows_only=True)
    elif kind in ("ball", "distance"):
        _between_points(element, kind, frames, draft, values, report)
    elif kind == "joint":
        _planar_joint(element, frames, draft, values, report)
    elif not suspicion(element, draft):
        report.ignored(
            element.tag, element.name, "not known; it says nothing about links and joints", of=element
        )
    else:
        values.problems.add(
            element.place, f"<{element.tag}> cannot be represented", name=element.tag,
            choices=(*CONSTRAINTS, *IGNORED), unsupported=True,
        )  # fmt: skip


def _between_points(
    element: Element,
    kind: str,
    frames: SdfFrames,
    draft: RobotDraft,
    values: XmlValues,
    report: LoadReport,
) -> None:
    prefix = f"drake:{kind}_constraint_"
    ends: list[End] = []
    names = [_text(element, prefix + tag, values) for tag in ("body_A", "body_B")]
    for name, tag in zip(names, ("p_AP", "p_BQ"), strict=True):
        place = _place(element, name, frames, draft, values)
        text = _text(element, prefix + tag, values)
        point = values.numbers(element, text, 3, what=tag, unit="length") if text else None
        if place is not None and point is not None:
            ends.append((place[0], place[1] @ Pose.at(point)))
    if len(ends) != 2:
        return
    if kind == "ball":
        name = element.name or f"ball:{names[0]}-{names[1]}"
        close_loop(element, draft, report, "spherical", (ends[0], ends[1]), name=name, rows_only=True)
    elif has_stiffness(element, values):
        report.ignored(element.tag, element.name, "a distance with a stiffness is a spring", of=element)
        report.note(f"<{element.tag}> with a stiffness is a spring, not a rod: it is left out")
    else:
        tag = prefix + "distance"
        text = _text(element, tag, values)
        distance = values.numbers(element, text, 1, what=tag, unit="length") if text else None
        if distance is not None:
            add_rod(element, draft, values, report, (ends[0], ends[1]), float(distance[0]))


def has_stiffness(element: Element, values: XmlValues) -> bool:
    """Whether a distance constraint has a finite stiffness."""
    for part in element.children:
        if part.tag.endswith("_stiffness"):
            text = part.get("value", part.text).strip()
            if text.lstrip("+") not in ("inf", "Inf", "INF", "infinity"):
                return values.numbers(part, text, 1, what="stiffness") is not None
    return False


def add_rod(
    element: Element,
    draft: RobotDraft,
    values: XmlValues,
    report: LoadReport,
    ends: tuple[End, End],
    distance: float,
) -> None:
    """Two points at a fixed distance: a rod that cannot spin, so that it adds no motion of its own."""
    if distance <= 0.0:
        values.problems.add(element.place, got=f"a distance of {distance:g}", expected="a positive one")
        return
    rod = free_name(draft, element.name or f"rod:{ends[0][0]}-{ends[1][0]}")
    while rod in draft.links:
        rod += "'"

    def place(poses: Mapping[str, Pose]) -> None:
        (first, on_first), (second, on_second) = ends
        start, stop = poses[first] @ on_first, poses[second] @ on_second
        along = stop.position - start.position
        size = float(np.linalg.norm(along))
        along = along / size if size > 1e-9 * distance else np.array([1.0, 0.0, 0.0])
        # x of the rod points to the other end; the two axes of the universal joint are across it.
        turn = poses[first].rotation.T @ frame_with_z(along)[:, [2, 0, 1]]
        axes = np.eye(3)
        draft.links[rod] = element.place
        draft.joints.append(
            DraftJoint(
                name=f"{rod}.start", type="universal", parent=first, child=rod,
                on_parent=Pose(turn, on_first.position), on_child=Pose.identity(3),
                axis=axes[2], second_axis=axes[1], place=element.place,
            )
        )  # fmt: skip
        draft.passive.add(f"{rod}.start")
        far = (rod, Pose.at([distance, 0.0, 0.0]))
        close_loop(element, draft, report, "spherical", (far, (second, on_second)), name=f"{rod}.end")

    draft.when_placed.append(place)


def _planar_joint(
    element: Element, frames: SdfFrames, draft: RobotDraft, values: XmlValues, report: LoadReport
) -> None:
    """`<drake:joint type="planar">`: the x-y planes of two frames."""
    name, kind = values.name(element), element.get("type", "")
    if kind != "planar":
        values.problems.add(
            element.place, got=f"joint type {shown(kind)}", name=kind, choices=("planar",),
            unsupported=kind in UNSUPPORTED,
        )  # fmt: skip
        return
    ends = [
        _place(element, _text(element, tag, values), frames, draft, values)
        for tag in ("drake:parent", "drake:child")
    ]
    if name and ends[0] is not None and ends[1] is not None:
        draft.joints.append(
            DraftJoint(
                name=name, type="planar", parent=ends[0][0], child=ends[1][0], on_parent=ends[0][1],
                on_child=ends[1][1], axis=np.eye(3)[2], place=element.place,
            )
        )  # fmt: skip
        report.used(element.tag, name, "planar")


def _text(element: Element, tag: str, values: XmlValues) -> str:
    found = next(element.find_all(tag), None)
    if found is None or not found.text:
        values.problems.add(element.place, f"<{tag}> is missing")
        return ""
    return found.text


def _place(
    element: Element, name: str, frames: SdfFrames, draft: RobotDraft, values: XmlValues
) -> End | None:
    """Link and pose in it of a frame that is named."""
    if not name:
        return None
    pose = frames.in_link(name) if name in frames.names else None
    if pose is None:
        values.problems.add(element.place, got=f"frame {shown(name)}", name=name, choices=frames.names)
        return None
    link = frames.link_of(name)
    if link == WORLD:
        draft.links.setdefault(WORLD, element.place)
    return link, pose
