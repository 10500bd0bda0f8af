"""What a ledger says against what is there: other models, other versions, other files."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

from vincula.errors import SweepError
from vincula.sweep.ledger import Record
from vincula.sweep.storage import checksum

_NOT_COMPARED: Final = ("source", "name")
_WORDS: Final = {
    "model": "the model has changed",
    "points": "the points have changed",
    "code": "another version computes now, whose last digits may differ",
    "shard": "it is another share",
    "start": "the start configuration has changed",
    "base": "the numbers that no variable sets have changed",
    "quantities": "other quantities are asked for",
    "block": "the chunks have another size",
    "given": "something else is given",
}


def differences(recorded: Mapping[str, Any], now: Mapping[str, Any]) -> dict[str, tuple[Any, Any]]:
    """What differs between the manifest of a ledger and that of a sweep: recorded and present value."""
    keys = [key for key in (*_WORDS, *now) if key not in _NOT_COMPARED]
    return {key: (recorded.get(key), now.get(key)) for key in keys if recorded.get(key) != now.get(key)}


def refuse_differences(data: Path, found: Mapping[str, tuple[Any, Any]]) -> None:
    """Refuse to go on with a sweep that is another one.

    Raises:
        SweepError: It is; shows both values of what differs first.
    """
    if not found:
        return
    key, (recorded, now) = next(iter(found.items()))
    raise SweepError(
        f"{data}: {_WORDS.get(key, f'{key} has changed')} since the sweep was begun: it was {recorded}, "
        f"it is {now}. Undo the change to go on, or run the sweep anew with --overwrite or another output",
        kind="refused",
        differs=key,
        recorded=recorded,
        now=now,
    )


def trusted(data: Path, record: Record) -> bool:
    """Whether the files of a chunk are there, with the content that was recorded."""
    for name, expected in record.checksums.items():
        try:
            content = (data / name).read_bytes()
        except OSError:
            return False
        if checksum([content]) != expected:
            return False
    return True
