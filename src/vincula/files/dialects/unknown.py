"""Elements that nobody knows: harmless ones are ignored with a reason, possible loops are refused.

An element may close a loop, couple joints or mark a passive joint if its words say so, or if it names
two links or two joints of the robot.
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
    r"|actuat|motor|rolling|pulley|linkage|predecessor|successor|parent|child",
    re.IGNORECASE,
)


def read_unknown(
    element: Element, draft: RobotDraft, values: XmlValues, report: LoadReport, known: Iterable[str]
) -> None:
    """Ignore an unknown element, or refuse it when it may be part of the mechanism."""
    reason = _suspicion(element, draft)
    if not reason:
        report.ignored(element.tag, element.name, "not known; it says nothing about links and joints")
        return
    around = element.parent.tag if element.parent is not None else ""
    values.problems.add(
        element.place,
        f"<{element.tag}> is not understood in <{around}>: {reason}",
        name=element.tag,
        choices=list(known),
    )


def _suspicion(element: Element, draft: RobotDraft) -> str:
    links, joints = set(draft.links), {joint.name for joint in draft.joints}
    named: set[str] = set()
    for part in element.walk():
        if _WORDS.search(part.tag):
            return f"<{part.tag}> may be a loop, a coupling or a motor"
        named.update(word for word in (*part.attributes.values(), part.text) if word in links | joints)
    if len(named & links) > 1 or len(named & joints) > 1:
        return f"it names {' and '.join(sorted(named)[:2])}, so it may be a loop or a coupling"
    return ""
