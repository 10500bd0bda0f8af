"""Writing a mechanism as a file of any format that can be written."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final

from vincula.errors import FileError, UnknownNameError, listing
from vincula.files.written import Written

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism

WRITABLE: Final = ("native", "mjcf", "sdf", "urdf-plus", "urdf-gepetto")
"""The formats that can be written."""

ENDINGS: Final = {
    ".yaml": "native",
    ".yml": "native",
    ".json": "native",
    ".xml": "mjcf",
    ".mjcf": "mjcf",
    ".sdf": "sdf",
    ".urdf": "urdf-plus",
}
"""The format that the end of a file's name means."""


@dataclass(frozen=True, slots=True)
class Saved:
    """What `save` wrote.

    Attributes:
        format: The format.
        files: The files, the side files after the file itself.
        lost: What the format cannot hold, one sentence a thing; not empty only if losses were allowed.
        changed: What is held in another form, or has to be said with every command.
    """

    format: str
    files: tuple[str, ...]
    lost: tuple[str, ...]
    changed: tuple[str, ...]


def format_of(path: str | os.PathLike[str], to: str | None = None) -> str:
    """The format that a file is to be written in.

    Raises:
        UnknownNameError: No such format.
        FileError: The name's end says no format.
    """
    if to is not None:
        if to not in WRITABLE:
            raise UnknownNameError("format", to, WRITABLE)
        return to
    ending = Path(path).suffix.lower()
    if ending not in ENDINGS:
        raise FileError(
            f"{os.fspath(path)}: the name says the format; it must end in {', '.join(ENDINGS)}, or name the "
            f"format ({listing(WRITABLE)})"
        )
    return ENDINGS[ending]


def written(mechanism: Mechanism, path: str | os.PathLike[str], to: str | None = None) -> Written:
    """The texts of the files of a mechanism.

    Args:
        mechanism: The mechanism.
        path: The file it is written for.
        to: The format, one of `WRITABLE`; by default what the end of the name means.

    Raises:
        UnknownNameError: No such format.
        FileError: The name's end says no format.
    """
    kind = format_of(path, to)
    if kind == "mjcf":
        from vincula.files.mjcf_writer import mjcf_data

        return mjcf_data(mechanism)
    if kind == "sdf":
        from vincula.files.sdf_writer import sdf_data

        return sdf_data(mechanism)
    if kind in ("urdf-plus", "urdf-gepetto"):
        from vincula.files.urdf_writer import urdf_data

        return urdf_data(mechanism, "plus" if kind == "urdf-plus" else "gepetto")
    from vincula.files.native_writer import native_data
    from vincula.files.yaml_writer import as_json, as_yaml

    data = native_data(mechanism)
    text = as_json(data.content) if Path(path).suffix.lower() == ".json" else as_yaml(data.content)
    return Written(text, data.lost, data.changed, format="a native file")


def save(
    mechanism: Mechanism,
    path: str | os.PathLike[str],
    to: str | None = None,
    *,
    lossy: bool = False,
    force: bool = False,
) -> Saved:
    """Write a mechanism as a file, in m and rad, drawn at its home configuration.

    Args:
        mechanism: The mechanism.
        path: The file: .yaml, .json (native), .xml (MJCF), .sdf, .urdf (URDF+).
        to: The format, one of `WRITABLE`; by default what the end of the name means.
        lossy: Write the file even if the format cannot hold everything.
        force: Replace files that are there.

    Returns:
        The files, what they hold in another form and what they do not hold.

    Raises:
        UnsupportedFeatureError: The format cannot hold everything; the list of what it cannot hold.
        FileError: A file is there already or cannot be written, or the name's end says no format.
        UnknownNameError: No such format.
    """
    target = Path(path)
    data = written(mechanism, target, to)
    files = [(target, data.text)]
    files += [(target.with_name(target.stem + ending), text) for ending, text in data.beside.items()]
    for file, _ in files:
        if file.exists() and not force:
            raise FileError(f"{file}: there is such a file already")
    if not lossy:
        data.refuse_losses()
    for file, text in files:
        _write(file, text)
    names = tuple(str(file) for file, _ in files)
    return Saved(format_of(target, to), names, tuple(data.lost), tuple(data.changed))


def _write(target: Path, text: str) -> None:
    """Write beside the target and move there, so that a failure leaves no half file."""
    part = target.with_name(f".{target.name}.{os.getpid()}.part")
    try:
        part.write_text(text, encoding="utf-8")
        part.replace(target)
    except OSError as error:
        part.unlink(missing_ok=True)
        raise FileError(f"{target}: cannot be written ({error.strerror})") from error
