"""Which texts may be names: printable, without the characters that deceive a reader or a page."""

from __future__ import annotations

import unicodedata

from vincula.files.limits import DEFAULT_LIMITS, Limits

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
