"""One process at a time: a lock that the system lets go of when its owner dies, however it dies."""

from __future__ import annotations

import contextlib
import os
import sys
from pathlib import Path
from types import TracebackType
from typing import IO

from vincula.errors import SweepError


class SweepLock:
    """Holds a sweep; use it as a context manager.

    The lock is the system's own on an open file, not the existence of a file: kill -9 frees it.

    Args:
        path: The lock file.
        target: The data set, for the message.
    """

    def __init__(self, path: Path, target: Path) -> None:
        self._path, self._target = path, target
        self._stream: IO[str] | None = None

    def __enter__(self) -> SweepLock:
        while self._stream is None:
            try:
                stream = self._path.open("a+", encoding="ascii")
            except OSError as error:
                raise SweepError(
                    f"{self._target}: results cannot be stored there ({error.strerror})", kind="storage"
                ) from None
            if not _locked(stream):
                stream.seek(0)
                owner = stream.read(40).strip()
                stream.close()
                who = f" (process {owner})" if owner.isdigit() else ""
                raise SweepError(
                    f"{self._target}: another process{who} is working on this sweep; one at a time. Wait for "
                    "it, or share the work with --shard i/n",
                    kind="refused",
                )
            if _still_there(stream, self._path):
                self._stream = stream
            else:  # its owner removed it between our opening and our locking
                stream.close()
        self._stream.truncate(0)
        self._stream.write(f"{os.getpid()}\n")
        with contextlib.suppress(OSError):  # who holds it is a courtesy; a full disk is told elsewhere
            self._stream.flush()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._stream is not None:
            with contextlib.suppress(OSError):
                self._path.unlink(missing_ok=True)
            with contextlib.suppress(OSError):
                self._stream.close()
            self._stream = None


def _still_there(stream: IO[str], path: Path) -> bool:
    try:
        return os.path.samestat(os.fstat(stream.fileno()), path.stat())
    except FileNotFoundError:
        return False


if sys.platform == "win32":
    import msvcrt

    def _locked(stream: IO[str]) -> bool:
        # A byte far behind the text, so that others can still read who holds the lock.
        stream.seek(1 << 20)
        try:
            msvcrt.locking(stream.fileno(), msvcrt.LK_NBLCK, 1)
        except OSError:
            return False
        stream.seek(0)
        return True

else:
    import fcntl

    def _locked(stream: IO[str]) -> bool:
        try:
            fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            return False
        return True
