"""What Drake takes for granted in URDF files: a link `world`, and trees that float in it.

Source: documentation of drake::multibody::MultibodyPlant: a body that no joint leads to from the world has a
floating joint; the world body exists without being declared.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from vincula.files.robot_graph import WORLD, DraftJoint
from vincula.spatial.poses import Pose

if TYPE_CHECKING:
    from vincula.files.robot_graph import RobotDraft
    from vincula.files.xmltree import Element

_NAMESPACE: Final = "xmlns:drake"


def declare_world(root: Element, draft: RobotDraft) -> None:
    """Add the link `world` to a file with Drake's namespace whose joints name it without declaring it."""
    if _NAMESPACE not in root.attributes or WORLD in draft.links:
        return
    parents = [parent for joint in root.children if joint.tag == "joint" for parent in joint.children]
    if any(part.tag == "parent" and part.attributes.get("link") == WORLD for part in parents):
        draft.links[WORLD] = root.place
        draft.notes.append(f"the link {WORLD} is not declared: it is there, as Drake takes it")


def float_in_world(root: Element, draft: RobotDraft) -> None:
    """Join trees that nothing joins to the world by floating joints, in files with Drake's namespace."""
    if _NAMESPACE not in root.attributes or WORLD not in draft.links:
        return
    children = {joint.child for joint in draft.joints if not joint.closure}
    for link in [link for link in draft.links if link not in children and link != WORLD]:
        here = Pose.identity(3)
        draft.joints.append(
            DraftJoint(
                name=f"{link}.floating", type="free", parent=WORLD, child=link, on_parent=here, on_child=here,
                place=draft.links[link],
            )
        )  # fmt: skip
        draft.notes.append(f"no joint leads from the {WORLD} to {link}: it floats, as Drake takes it")
