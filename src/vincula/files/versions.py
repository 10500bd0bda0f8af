"""What kind of file a tree is: its kind is a key of the root, and the value of that key its version."""

from __future__ import annotations

from typing import NoReturn

from vincula.errors import FileError
from vincula.files.problems import shown
from vincula.files.tree import Document, Leaf, Table


def check_version(document: Document, key: str, what: str) -> None:
    """Refuse a file of another kind, or of another version than 1.

    Args:
        document: The file.
        key: The key of its root that names its kind: `vincula`, `design`, `sweep`.
        what: Its kind in words.

    Raises:
        FileError: The key is missing, or is not 1.
    """
    version = document.node([key])
    if isinstance(document.root, Table) and isinstance(version, Leaf):
        if version.value == 1 and not isinstance(version.value, bool):
            return
        place = document.place([key])
        raise FileError(f"{place.text()}: got version {shown(version.value)}, expected 1")
    _refuse_kind(document, key, what)


def _refuse_kind(document: Document, key: str, what: str) -> NoReturn:
    entries = document.root.entries if isinstance(document.root, Table) else {}
    near = [word for word in entries if word.lower().startswith(key[:3])]
    got = f" (got {shown(near[0])})" if near else ""
    hint = ""
    if {"closed_loop", "name_mot"} & set(entries):
        hint = "; it looks like a Gepetto side file: name the URDF file beside it"
    place = document.place([]).text()
    raise FileError(f"{place}: expected the key `{key}: 1`{got}: the file is no {what}, version 1{hint}")
