"""Which convention reads which element of a URDF file, and which side files belong to it."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Final, Protocol

from vincula.errors import FileError
from vincula.files.limits import Limits
from vincula.files.problems import shown
from vincula.files.report import LoadReport
from vincula.files.source import Source, open_source
from vincula.files.xmltree import Element
from vincula.files.xmlvalues import XmlValues

if TYPE_CHECKING:
    from vincula.files.robot_graph import RobotDraft

ElementReader = Callable[[Element, "RobotDraft", XmlValues, LoadReport], None]
"""Reads one element of a URDF file into the draft."""


class SideFile(Protocol):
    """What stands in a file beside the URDF file."""

    def read(self, draft: RobotDraft, values: XmlValues, report: LoadReport) -> None:
        """Add it to the draft."""


def reader_of_element(element: Element) -> ElementReader:
    """The reader of an element below `<robot>` that is neither link, joint nor transmission."""
    return _READERS.get(element.tag, _not_understood)


def _not_understood(element: Element, draft: RobotDraft, values: XmlValues, report: LoadReport) -> None:
    """Nothing is dropped silently: an unknown element may be a loop."""
    values.problems.add(
        element.place,
        f"<{element.tag}> is not understood in <robot>; it may be a loop or a coupling",
        name=element.tag,
        choices=("link", "joint", "transmission", "material", *_READERS),
    )


_READERS: Final[dict[str, ElementReader]] = {}


def loop_readers(source: Source, beside: Sequence[str | os.PathLike[str]], limits: Limits) -> list[SideFile]:
    """Readers of the side files: those named, else a Gepetto file found beside the URDF file.

    Raises:
        FileError: A side file that is not understood.
    """
    from vincula.files.dialects.gepetto import GepettoFile

    if beside:
        return [_side_file(os.fspath(path), limits) for path in beside]
    if source.path is None:
        return []
    for name in (f"{source.path.stem}.yaml", "robot.yaml"):
        path = source.path.parent / name
        if path.is_file():
            opened = open_source(path, limits)
            if GepettoFile.recognises(opened):
                return [GepettoFile(opened, limits)]
    return []


def _side_file(path: str, limits: Limits) -> SideFile:
    from vincula.files.dialects.gepetto import GepettoFile

    opened = open_source(path, limits)
    if GepettoFile.recognises(opened):
        return GepettoFile(opened, limits)
    raise FileError(f"{shown(Path(path).name)}: expected a side file with closed_loop, type and name_mot")
