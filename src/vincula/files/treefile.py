"""From a source to a tree: YAML or JSON, decided by content."""

from __future__ import annotations

import re
from pathlib import PurePath
from typing import Final

from vincula.files.jsontree import read_json
from vincula.files.limits import DEFAULT_LIMITS, Limits
from vincula.files.source import Source
from vincula.files.tree import Document
from vincula.files.yamltree import read_yaml

_LIKE_JSON: Final = re.compile(r"\s*(?:\{\s*[\"}]|\[\s*[\[{\]\"0-9tfn-])")


def read_tree(source: Source, limits: Limits = DEFAULT_LIMITS) -> Document:
    """The tree of a YAML or JSON file, whatever its name.

    JSON begins with a bracket and a quoted key; a file called .yaml that does so is still read as
    YAML, of which JSON is a part, and a file called .json that begins with a bracket as JSON.

    Raises:
        FileError: Neither, or a limit passed; with line and column.
    """
    ending = PurePath(source.file).suffix.lower()
    begins = source.text.lstrip()[:1]
    if ending in (".yaml", ".yml"):
        return read_yaml(source, limits)
    if begins in ("{", "[") and (ending == ".json" or _LIKE_JSON.match(source.text)):
        return read_json(source, limits)
    return read_yaml(source, limits)
