"""The count of everything that a file is made of: what a reader asked for is used, the rest is ignored.

Elements of XML know which of their attributes a reader has asked for, so that nothing is counted as used
because a table says so.  What no reader has asked for, and none has told a reason for, is told here.
"""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Final

from vincula.files.report import Fate, LoadReport
from vincula.files.tree import Items, Node, Table

if TYPE_CHECKING:
    from vincula.files.xmltree import Element

_NOT_USED: Final = "not used here"


def account_elements(root: Element, report: LoadReport) -> None:
    """Count the elements and attributes of a document that has been read, and tell what was left.

    An element is used when a reader has asked for its text, for one of its attributes or for it by its
    tag, or when something inside it is used; its name is used with it, and so are namespaces it declares.
    What a reader has ignored is ignored with everything inside it.
    """
    used = _used_elements(root)
    elements: Counter[Fate] = Counter()
    attributes: Counter[Fate] = Counter()
    unread: Counter[str] = Counter()
    for element in list(root.walk()):
        parent = element.parent
        if parent is not None and parent.left_out:
            element.left_out = True
        is_used = element in used and not element.left_out
        if not is_used and not element.left_out and not any(part.left_out for part in element.children):
            report.ignored(element.tag, element.name or _owner(element), _NOT_USED, of=element)
        elements["used" if is_used else "ignored"] += 1
        for attribute in element.attributes:
            known = attribute in (element.read or ()) or attribute in ("name", "xmlns")
            if is_used and (known or attribute.startswith("xmlns:")):
                attributes["used"] += 1
            else:
                attributes["ignored"] += 1
                unread[f"{element.tag}/@{attribute}"] += 0 if element.left_out else 1
    for name, count in unread.items():
        if count:
            report.ignored("attribute", name, _NOT_USED, count)
    report.contain("elements", elements)
    report.contain("attributes", attributes)


def account_values(root: Node, report: LoadReport, ignored: tuple[str, ...] = ()) -> None:
    """Count the values of a YAML or JSON document that has been read; keys that nobody knows were refused.

    Args:
        root: The document.
        report: Where they are counted.
        ignored: Keys of the root whose values are not used.
    """
    fates: Counter[Fate] = Counter()
    for key, node in root.entries.items() if isinstance(root, Table) else [("", root)]:
        fates["ignored" if key in ignored else "used"] += _leaves(node)
    report.contain("values", fates)


def account_repairs(report: LoadReport) -> None:
    """Count elements that were used after a change as repaired; comments are no elements."""
    repaired = sum(e.count for e in report.entries if e.fate == "repaired" and e.kind != "comment")
    if repaired:
        report.contain("elements", Counter({"used": -repaired, "repaired": repaired}))


def _leaves(node: Node) -> int:
    """Values of a tree; an empty list or table is one."""
    count, waiting = 0, [node]
    while waiting:
        top = waiting.pop()
        inside = list(top.entries.values()) if isinstance(top, Table) else []
        inside = list(top.items) if isinstance(top, Items) else inside
        waiting += inside
        count += not inside
    return count


def _used_elements(root: Element) -> set[Element]:
    """The root, elements that were read, and those around them."""
    used = {root}
    waiting = list(root.walk())
    for element in waiting:
        around: Element | None = element if element.read is not None and not element.left_out else None
        while around is not None and around not in used:
            used.add(around)
            around = around.parent
    return used


def _owner(element: Element) -> str:
    """Name of the nearest named element around."""
    around: Element | None = element
    while around is not None and not around.name:
        around = around.parent
    return "" if around is None else around.name
