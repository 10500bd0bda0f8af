"""The one door through which every file is opened: local, regular, small, UTF-8 text."""

from __future__ import annotations

import os
import re
import stat
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from vincula.errors import FileError
from vincula.files.limits import DEFAULT_LIMITS, Limits
from vincula.files.problems import shown


@dataclass(frozen=True, slots=True)
class Source:
    """The text of a file.

    Attributes:
        file: The path as the user gave it, for messages.
        text: The decoded text, line ends normalised to newlines.
        size: Size in bytes.
        path: The path, for what is found beside it; None for text that is in no file.
    """

    file: str
    text: str
    size: int
    path: Path | None = None

    def refuse_larger_than(self, most: int, kind: str) -> None:
        """Refuse the file if it has more than `most` bytes.

        Raises:
            FileError: It has.
        """
        if self.size > most:
            raise FileError(_too_large(self.file, self.size, most, kind))


def open_source(path: str | os.PathLike[str], limits: Limits = DEFAULT_LIMITS) -> Source:
    """The text of a local, regular, reasonably small UTF-8 file.

    Raises:
        FileError: It is not there, not readable, no regular file, too large, or not UTF-8 text.
    """
    file = os.fspath(path)
    if _is_remote(file):
        raise FileError(f"{shown(file)}: expected a file on this machine; network addresses are not read")
    return decode(read_bytes(path, limits.largest_file), shown_path(file), Path(file))


def shown_path(file: str) -> str:
    """A path for messages: as it is, unless it holds characters that would disturb a terminal."""
    return file if file.isprintable() else shown(file)


def read_bytes(path: str | os.PathLike[str], most: int) -> bytes:
    """The bytes of a regular file of at most `most` bytes.

    The file is opened without waiting and looked at through its descriptor, so that a FIFO cannot
    block and nothing can be swapped in between the check and the reading.

    Raises:
        FileError: It is not there, not readable, no regular file, or too large.
    """
    file = shown_path(os.fspath(path))
    flags = (
        os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_CLOEXEC", 0) | getattr(os, "O_BINARY", 0)
    )
    try:
        descriptor = os.open(path, flags)
    except (OSError, ValueError) as error:
        raise FileError(f"{file}: {_why_not_opened(error)}") from None
    status = os.fstat(descriptor)
    if not stat.S_ISREG(status.st_mode):
        os.close(descriptor)
        raise FileError(f"{file}: expected a file, got {_kind_of(status.st_mode)}")
    with os.fdopen(descriptor, "rb", closefd=True) as stream:
        if status.st_size > most:
            raise FileError(_too_large(file, status.st_size, most, "file"))
        data = stream.read(most + 1)
    if len(data) > most:
        raise FileError(_too_large(file, len(data), most, "file"))
    return data


def decode(data: bytes, file: str, path: Path | None = None) -> Source:
    """The text of UTF-8 bytes.

    Raises:
        FileError: Compressed, binary, another encoding, empty, or damaged UTF-8 (with its place).
    """
    looks_like = _foreign(data)
    if looks_like:
        raise FileError(f"{file}:1:1: expected UTF-8 text, got {looks_like}")
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line, column = _line_and_column(data, error.start)
        value = data[error.start]
        raise FileError(
            f"{file}:{line}:{column}: byte 0x{value:02x} is not UTF-8 text; save the file as UTF-8"
        ) from None
    text = text.replace("\r\n", "\n").replace("\r", "\n")
    _refuse_control_characters(text, file)
    if not text.strip():
        raise FileError(f"{file}:1:1: the file is empty")
    return Source(file, text, len(data), path)


_CONTROL: Final = re.compile("[\\x00-\\x08\\x0b-\\x1f\\x7f-\\x9f]")


def _refuse_control_characters(text: str, file: str) -> None:
    found = _CONTROL.search(text)
    if found:
        line = text.count("\n", 0, found.start()) + 1
        column = found.start() - text.rfind("\n", 0, found.start())
        code = ord(found.group())
        raise FileError(
            f"{file}:{line}:{column}: got the control character U+{code:04X}, expected plain text"
        )


_MAGIC: Final = (
    (b"\x1f\x8b", "a gzip archive: unpack it first"),
    (b"PK\x03\x04", "a zip archive: unpack it first"),
    (b"BZh", "a bzip2 archive: unpack it first"),
    (b"\xfd7zXZ\x00", "an xz archive: unpack it first"),
    (b"\xff\xfe\x00\x00", "UTF-32: save the file as UTF-8"),
    (b"\x00\x00\xfe\xff", "UTF-32: save the file as UTF-8"),
    (b"\xff\xfe", "UTF-16: save the file as UTF-8"),
    (b"\xfe\xff", "UTF-16: save the file as UTF-8"),
    (b"\x80\x04\x95", "a Python pickle: pickles are never read"),
    (b"\x80\x05\x95", "a Python pickle: pickles are never read"),
    (b"\x89PNG", "a picture"),
    (b"\x7fELF", "a program"),
)


def _foreign(data: bytes) -> str:
    for magic, meaning in _MAGIC:
        if data.startswith(magic):
            return meaning
    head = data[:4096]
    if b"\x00" in data:
        halves = (head[0::2].count(0), head[1::2].count(0))
        if len(head) >= 4 and max(halves) > len(head) // 4 and min(halves) == 0:
            return "UTF-16 without a byte order mark: save the file as UTF-8"
        return f"binary data (a NUL byte at byte {data.index(0)})"
    return ""


def _line_and_column(data: bytes, index: int) -> tuple[int, int]:
    before = data[:index]
    line_start = before.rfind(b"\n") + 1
    return before.count(b"\n") + 1, len(before[line_start:].decode("utf-8", "replace")) + 1


def _is_remote(file: str) -> bool:
    scheme = file.split(":", 1)[0].lower() if "://" in file else ""
    return scheme in ("http", "https", "ftp", "file", "data", "s3", "gs")


def _too_large(file: str, size: int, most: int, kind: str) -> str:
    return f"{file}: the {kind} has {size} bytes, at most {most} are read"


def _kind_of(mode: int) -> str:
    kinds = (
        (stat.S_ISDIR, "a directory"),
        (stat.S_ISFIFO, "a FIFO"),
        (stat.S_ISCHR, "a device"),
        (stat.S_ISBLK, "a device"),
        (stat.S_ISSOCK, "a socket"),
    )
    return next((name for test, name in kinds if test(mode)), "something that is not a regular file")


def _why_not_opened(error: OSError | ValueError) -> str:
    if isinstance(error, FileNotFoundError):
        return "there is no such file"
    if isinstance(error, PermissionError):
        return "no permission to read it"
    if isinstance(error, OSError):
        return f"it cannot be opened ({error.strerror})"
    return "it cannot be opened (the path holds a NUL character)"
