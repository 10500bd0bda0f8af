"""Which texts may be names, and which names look like a slip of the pen for another."""

from __future__ import annotations

import difflib
import re
import unicodedata
from collections.abc import Iterable

from vincula.files.limits import DEFAULT_LIMITS, Limits

MOST_COMPARED = 200
"""Slips of the pen are looked for among at most so many names: comparing takes time."""

_DECEIVING = {"Cc", "Cf", "Cs", "Co", "Cn", "Zl", "Zp"}


def name_problem(name: str, limits: Limits = DEFAULT_LIMITS) -> str:
    """What is expected of a name that `name` is not; empty when it is a good name.

    Control characters, line breaks and characters that turn the direction of writing are refused
    because they make a message or a table say something else than the file; angle brackets because
    no name needs them and a page could take them for a tag.
    """
    if not name:
        return "a name, not an empty text"
    if len(name) > limits.name_characters:
        return f"a name of at most {limits.name_characters} characters"
    if name != name.strip():
        return "a name without blanks at its ends"
    for character in name:
        if unicodedata.category(character) in _DECEIVING:
            return f"a name without the invisible character U+{ord(character):04X}"
    if "<" in name or ">" in name:
        return "a name without '<' and '>'"
    return ""


def similar_name(name: str, others: Iterable[str]) -> str:
    """Another name that differs by a slip of the pen and not by its numbers; empty if there is none."""
    digits = re.sub(r"[^0-9]", "", name)
    alike = [other for other in others if re.sub(r"[^0-9]", "", other) == digits and len(other) > 3]
    near = difflib.get_close_matches(name, alike, n=1, cutoff=0.8)
    return near[0] if near else ""
