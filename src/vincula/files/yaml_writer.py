"""Plain values as YAML that a person can read: one line an item, texts quoted only where they must be."""

from __future__ import annotations

import json
import re
from typing import Any, Final

_PLAIN: Final = re.compile(r"[A-Za-z_][A-Za-z0-9_./@'-]*(?<!:)")
_OTHER_MEANING: Final = {
    "true",
    "false",
    "null",
    "yes",
    "no",
    "on",
    "off",
    "y",
    "n",
    "nan",
    "inf",
    "infinity",
}


def as_yaml(content: dict[str, Any]) -> str:
    """A table as YAML: top-level keys in blocks, everything inside of them on single lines."""
    lines: list[str] = []
    for key, value in content.items():
        name = _text(key)
        if isinstance(value, list) and any(isinstance(item, (dict, list)) for item in value):
            lines.append(f"{name}:")
            lines.extend(f"  - {_flow(item)}" for item in value)
        elif isinstance(value, dict) and any(isinstance(item, dict) and item for item in value.values()):
            lines.append(f"{name}:")
            lines.extend(f"  {_text(inner)}: {_flow(item)}" for inner, item in value.items())
        else:
            lines.append(f"{name}: {_flow(value)}")
    return "\n".join(lines) + "\n"


def as_json(content: dict[str, Any]) -> str:
    """A table as JSON."""
    return json.dumps(content, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def _flow(value: Any) -> str:
    if isinstance(value, dict):
        return "{" + ", ".join(f"{_text(key)}: {_flow(item)}" for key, item in value.items()) + "}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_flow(item) for item in value) + "]"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float)):
        return _number(value)
    return _text(str(value))


def _number(value: float) -> str:
    """The shortest text that reads back to the same double."""
    text = repr(value + 0)
    return text.removesuffix(".0")


def _text(text: str) -> str:
    if _PLAIN.fullmatch(text) and text.lower() not in _OTHER_MEANING:
        return text
    return json.dumps(text, ensure_ascii=False)
