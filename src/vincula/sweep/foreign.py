"""Data sets of strangers: looked at before a library opens them, so that nothing in them is ever run."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

from vincula.errors import SweepError
from vincula.sweep.layout import SCHEMA

LARGEST_DESCRIPTION: Final = 64 * 2**20
"""Bytes of one file that describes an array or a group, at most."""
MOST_ARRAYS: Final = 10_000
"""Arrays of a data set, at most."""
_CODECS: Final = ("bytes",)
"""What chunks of sweeps are made with; `pickle` and others that run code or guess are not among them."""
_NUMBERS: Final = (
    "int8",
    "int16",
    "int32",
    "int64",
    "uint8",
    "uint16",
    "uint32",
    "uint64",
    "float32",
    "float64",
)


def refuse_foreign(data: Path) -> dict[str, Any]:
    """The attributes of a data set, after everything that describes it was found harmless.

    Raises:
        SweepError: It is no sweep of vincula, or names codecs or types that none has.
    """
    if not data.is_dir():
        raise SweepError(f"{data}: there is no such data set", kind="usage")
    for name in (".zgroup", ".zarray", ".zattrs", ".zmetadata"):
        if (data / name).exists():
            raise _foreign(data, f"it holds {name}: zarr 2, which can name codecs that run code (pickle)")
    root = _description(data / "zarr.json", data)
    attributes = root.get("attributes")
    if not isinstance(attributes, dict) or attributes.get("schema") != SCHEMA:
        told = attributes.get("schema") if isinstance(attributes, dict) else None
        raise _foreign(data, f"its schema is {told!r}, expected {SCHEMA!r}")
    inline = root.get("consolidated_metadata") or {}
    nodes = inline.get("metadata", {}) if isinstance(inline, dict) else None
    if not isinstance(nodes, dict):
        raise _foreign(data, "its consolidated description is no table")
    for name, node in [*nodes.items(), *_arrays(data)]:
        _refuse_array(data, name, node)
    return attributes


def _arrays(data: Path) -> Iterator[tuple[str, Any]]:
    with os.scandir(data) as entries:
        for count, entry in enumerate(entries):
            if count > MOST_ARRAYS:
                raise _foreign(data, f"it has more than {MOST_ARRAYS} arrays")
            if entry.is_symlink():
                raise _foreign(data, f"{entry.name!r} is a link")
            if entry.is_dir():
                for name in (".zarray", ".zgroup", ".zattrs"):
                    if (data / entry.name / name).exists():
                        raise _foreign(data, f"{entry.name!r} is zarr 2, which can name codecs that run code")
                yield entry.name, _description(data / entry.name / "zarr.json", data)


def _refuse_array(data: Path, name: str, node: Any) -> None:
    if not isinstance(node, dict) or node.get("node_type") != "array":
        raise _foreign(data, f"{name!r} is no array")
    codecs = node.get("codecs")
    for codec in codecs if isinstance(codecs, list) else [None]:
        told = codec.get("name") if isinstance(codec, dict) else codec
        if told not in _CODECS:
            raise _foreign(data, f"array {name!r} uses the codec {told!r}, expected {' or '.join(_CODECS)}")
    if node.get("data_type") not in _NUMBERS:
        raise _foreign(data, f"array {name!r} holds {node.get('data_type')!r}, expected numbers")
    if node.get("storage_transformers"):
        raise _foreign(data, f"array {name!r} uses storage transformers")


def _description(path: Path, data: Path) -> dict[str, Any]:
    try:
        if path.is_symlink() or not path.is_file() or path.stat().st_size > LARGEST_DESCRIPTION:
            raise _foreign(data, f"{path.name} is missing, a link or too large")
        found = json.loads(path.read_bytes())
    except (OSError, ValueError, RecursionError) as error:
        raise _foreign(data, f"{path.name} cannot be read ({type(error).__name__})") from None
    if not isinstance(found, dict):
        raise _foreign(data, f"{path.name} is no table")
    return found


def _foreign(data: Path, reason: str) -> SweepError:
    return SweepError(
        f"{data}: it is not opened, because it is no data set of vincula: {reason}", kind="usage"
    )
