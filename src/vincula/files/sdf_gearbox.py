"""Gearboxes of SDF files: joints that only couple two hinges of a third link.

Source: SDF specification, `gearbox_reference_body` and `gearbox_ratio`: theta_1 is the angle from the
reference body to the parent along `axis`, theta_2 the angle from the reference body to the child along
`axis2`, and theta_2 = -ratio theta_1.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from vincula.arrays import Vector
from vincula.files.problems import shown
from vincula.files.report import LoadReport
from vincula.files.sdf_frames import SdfFrames
from vincula.files.xmltree import Element
from vincula.files.xmlvalues import XmlValues
from vincula.mechanism.parts import Coupling

if TYPE_CHECKING:
    from vincula.files.robot_graph import RobotDraft
    from vincula.spatial.poses import Pose

GEARBOX: Final = "gearbox"
"""The joint type."""
PARTS: Final = ("gearbox_ratio", "gearbox_reference_body")
"""What a joint of that type has besides links and axes."""
_ALONG: Final = 1.0 - 1e-6
"""Cosine from which two axes are taken for one; typed axes have five digits and more."""


def read_gearbox(
    element: Element,
    axes: tuple[Vector, Vector],
    frames: SdfFrames,
    draft: RobotDraft,
    values: XmlValues,
    report: LoadReport,
) -> None:
    """Add the coupling of one gearbox to the draft, once all hinges are in it.

    Args:
        element: The joint of the type gearbox.
        axes: `axis` and `axis2` in the joint frame.
        frames: The frames of the model.
        draft: What the coupling is added to.
        values: Reads the ratio.
        report: Where it is recorded.
    """
    named = ("gearbox_reference_body", "parent", "child")
    texts = {part.tag: part.text for part in element.children if part.tag in named}
    reference = texts.get("gearbox_reference_body", "")
    if reference not in frames.names:
        values.problems.add(
            element.place, got=f"gearbox_reference_body {shown(reference)}", name=reference,
            choices=frames.names,
        )  # fmt: skip
        return
    found = next(element.find_all("gearbox_ratio"), None)
    ratio = None if found is None else values.numbers(found, found.text, 1, what="gearbox_ratio")
    if found is not None and (ratio is None or ratio[0] == 0.0):
        values.problems.add(found.place, got=f"gearbox_ratio {shown(found.text)}", expected="a number, not 0")
        return
    factor = 1.0 if ratio is None else float(ratio[0])
    placed = frames.pose(element.name)
    first, second = (
        _hinge(draft, frames, frames.link_of(reference), frames.link_of(texts.get(end, "")), axis, placed)
        for end, axis in zip(("parent", "child"), axes, strict=True)
    )
    if first is None or second is None:
        lacking = texts.get("parent" if first is None else "child", "")
        values.problems.add(
            element.place,
            "a gearbox can be read where its reference body has hinges to its two links, along its axes: "
            f"{shown(reference)} has none to {shown(lacking)}",
            unsupported=True,
        )
        return
    (fast, fast_sign), (slow, slow_sign) = first, second
    draft.couplings.append(
        Coupling(
            element.name,
            {slow: slow_sign, fast: factor * fast_sign},
            references={slow: 0.0, fast: 0.0},
        )
    )
    report.used("joint", element.name, f"gearbox: {slow} = {-factor * fast_sign * slow_sign:g} x {fast}")


def _hinge(
    draft: RobotDraft, frames: SdfFrames, reference: str, link: str, axis: Vector, placed: Pose | None
) -> tuple[str, float] | None:
    """The joint that turns a link against the reference along an axis, and 1 or -1 for its direction."""
    for joint in draft.joints:
        if joint.type != "revolute" or {joint.parent, joint.child} != {reference, link} or reference == link:
            continue
        there = frames.pose(joint.name)
        if there is None or placed is None or joint.axis is None:
            continue
        along = float((there.rotation @ joint.axis) @ (placed.rotation @ axis))
        if abs(along) > _ALONG:
            forward = 1.0 if joint.child == link else -1.0
            return joint.name, forward if along > 0.0 else -forward
    return None
