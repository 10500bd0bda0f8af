"""Which convention reads which element of a URDF file, and which side files belong to it."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Final, Protocol

from vincula.errors import FileError
from vincula.files.dialects.drake_urdf import read_drake, read_frame
from vincula.files.dialects.gazebo import read_gazebo
from vincula.files.dialects.gepetto import GepettoFile
from vincula.files.dialects.isaac import read_fixed_frame, read_loop_joint
from vincula.files.dialects.ros2_control import read_ros2_control
from vincula.files.dialects.srdf import SrdfFile
from vincula.files.dialects.unknown import read_unknown
from vincula.files.dialects.urdf_plus import read_coupling, read_loop, read_loop_constraint
from vincula.files.dialects.urdfdom_constraint import read_constraint
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
    if element.tag.startswith("drake:"):
        return read_drake
    return _READERS.get(element.tag, _not_understood)


def _not_understood(element: Element, draft: RobotDraft, values: XmlValues, report: LoadReport) -> None:
    """Nothing is dropped silently: an unknown element may be a loop."""
    known = ("link", "joint", "transmission", "material", *(tag for tag in _READERS if tag not in _OUTDATED))
    read_unknown(element, draft, values, report, known)


_OUTDATED: Final = ("loop_constraint", "joint_constraint")
"""Read, but not suggested."""
_READERS: Final[dict[str, ElementReader]] = {
    "loop": read_loop,
    "coupling": read_coupling,
    "loop_constraint": read_loop_constraint,
    "joint_constraint": read_coupling,
    "loop_joint": read_loop_joint,
    "fixed_frame": read_fixed_frame,
    "constraint": read_constraint,
    "frame": read_frame,
    "gazebo": read_gazebo,
    "ros2_control": read_ros2_control,
}


def side_files(source: Source, beside: Sequence[str | os.PathLike[str]], limits: Limits) -> list[SideFile]:
    """Readers of the side files: those named, else those found beside the URDF file.

    A Gepetto file is looked for as `<stem>.yaml`, then `robot.yaml`; an SRDF file as `<stem>.srdf`.

    Raises:
        FileError: A named side file that is not understood.
    """
    if beside:
        return [_side_file(os.fspath(path), limits) for path in beside]
    if source.path is None:
        return []
    found: list[SideFile] = []
    for name in (f"{source.path.stem}.yaml", "robot.yaml"):
        path = source.path.parent / name
        if path.is_file():
            opened = open_source(path, limits)
            if GepettoFile.recognises(opened):
                found.append(GepettoFile(opened, limits))
                break
    path = source.path.with_suffix(".srdf")
    if path.is_file():
        found.append(SrdfFile(open_source(path, limits), limits))
    return found


def _side_file(path: str, limits: Limits) -> SideFile:
    opened = open_source(path, limits)
    if GepettoFile.recognises(opened):
        return GepettoFile(opened, limits)
    if SrdfFile.recognises(opened):
        return SrdfFile(opened, limits)
    raise FileError(
        f"{shown(Path(path).name)}: expected a Gepetto file (closed_loop, type, name_mot) or an SRDF file"
    )
