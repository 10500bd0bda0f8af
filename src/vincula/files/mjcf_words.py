"""Words of MuJoCo's own schema: its flags, and what the writer of an unknown word may have meant."""

from __future__ import annotations

import difflib
import re
from functools import cache
from typing import Final

import mujoco

from vincula.files.mjcf_document import Document
from vincula.files.xmltree import Element

_LINE_OF_TAG: Final = re.compile(r"^\s*([a-z0-9_]+) \(.\)\s*(.*)$")
_QUOTED: Final = re.compile(r"'([^']+)'")


def suggestion_for(message: str, element: Element | None, document: Document) -> tuple[str, list[str]]:
    """The word of a message that was not understood, and the words near it; both empty when unknown.

    Args:
        message: MuJoCo's message.
        element: The element that it is about.
        document: The document, whose names are the choices for a name that does not exist.
    """
    quoted = _QUOTED.findall(message)
    if "unrecognized element" in message and element is not None:
        word, choices = element.tag, list(_schema())
    elif "unrecognized attribute" in message and element is not None and quoted:
        word, choices = quoted[0], sorted(_schema().get(element.tag, ()))
    elif ("unknown" in message or "not found" in message) and quoted:
        word = quoted[0]
        parts = [e for e in document.root.walk() if e.parent is None or e.parent.tag != "asset"]
        choices = [e.name for e in parts if e.name and e.name != word]
    else:
        return "", []
    return word, difflib.get_close_matches(word[:100], choices[:1000], n=1)


def engine_flags() -> list[str]:
    """The flags by which this version of MuJoCo switches forces off."""
    return sorted(_schema()["flag"] & {"constraint", "gravity", "actuation", "passive", "spring", "damper"})


@cache
def _schema() -> dict[str, set[str]]:
    """Attributes by tag, from the schema that MuJoCo prints."""
    found: dict[str, set[str]] = {}
    attributes: set[str] = set()
    for line in mujoco.mj_printSchema(False, True).splitlines():
        match = _LINE_OF_TAG.match(line)
        if match is not None:
            attributes = found.setdefault(match[1], set())
        attributes.update((match[2] if match is not None else line).split())
    return found
