"""Files that are there whole or not at all: written aside, synced, then put in place."""

from __future__ import annotations

import contextlib
import errno
import os
import shutil
import sqlite3
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Final

from vincula.errors import SweepError

_FULL: Final = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
_FULL_WORDS: Final = ("disk is full", "disk i/o error", "database or disk is full")


class StorageRoom:
    """What is still to be written, for the message when there is no room for it.

    Attributes:
        needed: Bytes that are still to come.
    """

    def __init__(self, target: Path) -> None:
        self.target = target
        self.needed = 0

    def full(self, error: BaseException) -> SweepError:
        """The refusal for a full disk, or for another failure of storage."""
        reason = error.strerror if isinstance(error, OSError) else str(error)
        if not _is_full(error):
            return SweepError(
                f"{self.target}: results cannot be stored ({reason}). What is recorded as done is safe; "
                "`vincula sweep resume` goes on from there",
                kind="storage",
            )
        free = "an unknown number of"
        with contextlib.suppress(OSError):
            free = str(shutil.disk_usage(self.target.parent).free)
        return SweepError(
            f"{self.target}: no room to store the results ({reason}): about {self.needed} bytes are still "
            f"needed, {free} are free. What is recorded as done is safe: make room, then "
            "`vincula sweep resume`",
            kind="storage",
            needed=self.needed,
        )

    @contextmanager
    def guarded(self) -> Iterator[None]:
        """Failures of files and of the ledger inside become refusals.

        Raises:
            SweepError: Storage failed; says how many bytes are needed when it is full.
        """
        try:
            yield
        except (OSError, sqlite3.Error) as error:
            raise self.full(error) from error


def _is_full(error: BaseException) -> bool:
    if isinstance(error, OSError):
        return error.errno in _FULL
    return any(word in str(error).lower() for word in _FULL_WORDS)


class DurableFolder:
    """A folder whose files are complete whenever they are there, also after a power cut.

    Args:
        root: The folder.
        aside: A file beside it on the same file system, for what is being written.
    """

    def __init__(self, root: Path, aside: Path) -> None:
        self.root, self._aside = root, aside

    def write(self, name: str, data: bytes) -> None:
        """Put a file in place, its folder made if needed; synced when this returns.

        Raises:
            OSError: It cannot be written.
        """
        target = self.root / name
        if not target.parent.is_dir():
            target.parent.mkdir(parents=True)
            _sync_folder(target.parent.parent)
        try:
            with self._aside.open("wb") as stream:
                stream.write(data)
                stream.flush()
                os.fsync(stream.fileno())
            self._aside.replace(target)
        except OSError:
            self.tidy()
            raise

    def sync(self, folders: Iterator[str] | tuple[str, ...]) -> None:
        """Make the names of files written into folders durable, as `write` makes their content."""
        for folder in folders:
            _sync_folder(self.root / folder)

    def tidy(self) -> None:
        """Remove what an interrupted writing left aside."""
        with contextlib.suppress(OSError):
            self._aside.unlink(missing_ok=True)


def _sync_folder(folder: Path) -> None:
    """Sync a folder; systems that cannot open folders (Windows) need no such thing."""
    flags = getattr(os, "O_DIRECTORY", None)
    if flags is None:
        return
    descriptor = os.open(folder, os.O_RDONLY | flags)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def checksum(parts: Iterator[bytes] | list[bytes]) -> str:
    """CRC-32 and length of some bytes, as text."""
    value = size = 0
    for part in parts:
        value = zlib.crc32(part, value)
        size += len(part)
    return f"{value:08x}-{size}"
