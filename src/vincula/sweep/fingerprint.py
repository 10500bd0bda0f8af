"""Fingerprints of mechanisms and sweeps: equal content gives equal hashes, on any machine."""

from __future__ import annotations

import dataclasses
import hashlib
from collections.abc import Callable, Mapping, Sequence, Set
from typing import Any, Final

import numpy as np

from vincula.errors import ModelError

_NO_CONTENT: Final = ("notes", "keyframes")
"""Fields of a mechanism that change no number."""
_NOISE: Final = 1e-15
"""Numbers below this count as zero, and twelve digits are kept, so that the last bits, in which machines
differ, do not make one model two."""


def fingerprint(value: Any) -> str:
    """SHA-256, in hexadecimal digits, of frozen dataclasses, mappings, sequences, arrays and plain values.

    Raises:
        ModelError: Something that has no content of its own, such as a function.
    """
    digest = hashlib.sha256()
    _feed(value, digest.update)
    return digest.hexdigest()


def _feed(value: Any, put: Callable[[bytes], None]) -> None:
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        put(f"<{type(value).__name__}".encode())
        for field in dataclasses.fields(value):
            if field.name not in _NO_CONTENT:
                put(f"|{field.name}=".encode())
                _feed(getattr(value, field.name), put)
        put(b">")
    elif isinstance(value, np.ndarray):
        put(f"<array {value.shape}".encode())
        _feed_array(value, put)
    elif isinstance(value, (bool, int, str, bytes, type(None), np.integer, np.bool_)):
        plain = value.item() if isinstance(value, np.generic) else value
        put(f"<{plain!r}>".encode())
    elif isinstance(value, (float, np.floating)):
        put(b"<" + _digits(float(value)) + b">")
    elif isinstance(value, Mapping):
        put(f"<map {len(value)}".encode())
        for key in sorted(value, key=repr):
            _feed(key, put)
            _feed(value[key], put)
    elif isinstance(value, Set):
        _feed(sorted(value, key=repr), put)
    elif isinstance(value, Sequence):
        put(f"<list {len(value)}".encode())
        for item in value:
            _feed(item, put)
    else:
        _feed_object(value, put)


def _feed_array(array: np.ndarray[Any, Any], put: Callable[[bytes], None]) -> None:
    if array.size > 10_000:  # tables of points: read from files or drawn, never computed by geometry
        put(np.ascontiguousarray(array.astype(array.dtype.newbyteorder("<"))).tobytes())
        return
    for item in array.ravel().tolist():
        _feed(item, put)


def _feed_object(value: Any, put: Callable[[bytes], None]) -> None:
    """Objects with slots or a dictionary of plain content (enumerations, weights)."""
    names = [name for kind in type(value).__mro__ for name in getattr(kind, "__slots__", ())]
    content = {name: getattr(value, name) for name in names if hasattr(value, name)}
    content |= getattr(value, "__dict__", {})
    if not content or callable(value):
        raise ModelError(f"{value!r} has no content that could be compared when a sweep is resumed")
    put(f"<{type(value).__name__}".encode())
    _feed(content, put)


def _digits(number: float) -> bytes:
    return b"0" if abs(number) < _NOISE else f"{number:.11e}".encode()
