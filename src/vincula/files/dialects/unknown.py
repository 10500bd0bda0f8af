"""Elements that nobody knows: harmless ones are ignored with a reason, possible loops are refused.

An element may close a loop, couple joints or mark a passive joint if its words say so, or if it names
two links or two joints of the robot; and it may be a part of a link or joint with a slip of the pen in its
tag (`<axs>`).
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import TYPE_CHECKING, Final

from vincula.files.report import LoadReport
from vincula.files.xmltree import Element
from vincula.files.xmlvalues import XmlValues

if TYPE_CHECKING:
    from vincula.files.robot_graph import RobotDraft

_WORDS: Final = re.compile(
    r"loop|clos|constrain|coupl|mimic|joint|passive|gear|weld|connect|equality|tendon|transmission|parallel"
    r"|actuat|motor|rolling(?!_friction)|pulley|linkage|predecessor|successor|parent|child",
    re.IGNORECASE,
)

_PARTS: Final = (
    "link", "joint", "frame", "axis", "axis2", "origin", "pose", "parent", "child", "limit", "mimic", "loop",
    "coupling", "constraint", "xyz", "lower", "upper",
)  # fmt: skip
"""Tags that make the mechanism: a tag that misses one of them by a letter is taken for it."""


def read_unknown(
    element: Element, draft: RobotDraft, values: XmlValues, report: LoadReport, known: Iterable[str]
) -> None:
    """Ignore an unknown element, or refuse it when it may be part of the mechanism."""
    reason = suspicion(element, draft)
    if not reason:
        report.ignored(
            element.tag, element.name, "not known; it says nothing about links and joints", of=element
        )
        return
    around = element.parent.tag if element.parent is not None else ""
    values.problems.add(
        element.place,
        f"<{element.tag}> is not understood in <{around}>: {reason}",
        name=element.tag,
        choices=list(known),
    )


def suspicion(element: Element, draft: RobotDraft) -> str:
    """Why an unknown element may be part of the mechanism; empty when it cannot be."""
    if any(_slip(element.tag, part) for part in _PARTS):
        return "it may be a slip of the pen"
    links, joints = set(draft.links), {joint.name for joint in draft.joints}
    named: set[str] = set()
    for part in element.walk():
        if _WORDS.search(part.tag):
            return f"<{part.tag}> may be a loop, a coupling or a motor"
        named.update(word for word in (*part.attributes.values(), part.characters) if word in links | joints)
    if len(named & links) > 1 or len(named & joints) > 1:
        return f"it names {' and '.join(sorted(named)[:2])}, so it may be a loop or a coupling"
    return ""


def _slip(tag: str, part: str) -> bool:
    """Whether a tag is another one with one letter too few, too many, changed or moved by one place."""
    if tag == part or tag[:1] != part[:1] or abs(len(tag) - len(part)) > 1:
        return False
    same = next((k for k, (a, b) in enumerate(zip(tag, part, strict=False)) if a != b), len(part))
    rest, other = tag[same:], part[same:]
    moved = len(rest) > 1 and rest[1::-1] == other[:2] and rest[2:] == other[2:]
    return moved or rest[1:] == other or rest == other[1:] or rest[1:] == other[1:]
