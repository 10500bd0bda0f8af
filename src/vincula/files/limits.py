"""How much a file may hold.

The limits keep hostile files from costing time or memory: bytes are counted before reading, nodes,
depth and aliases while parsing, seconds on the way.  Memory of our own readers needs no meter: a few
hundred bytes a node times the node limit stays far below 512 MiB.  MuJoCo's parser, which knows no
limits, is held to 512 MiB and to the same seconds in a process of its own (see `mjcf_child`).
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import Final

from vincula.errors import FileError
from vincula.files.problems import Place

_MIB: Final = 1 << 20

LARGEST_NUMBER: Final = 1e30
"""Numbers above this are refused: their squares would overflow in every formula."""


@dataclass(frozen=True, slots=True)
class Limits:
    """Limits of one file; `DEFAULT_LIMITS` unless a caller replaces some.

    Attributes:
        xml_bytes: Size of an XML file.
        json_bytes: Size of a JSON file.
        yaml_bytes: Size of a YAML file.
        yaml_nodes: Keys, values and collections of a YAML file, aliases counted as what they stand for.
        nodes: The same for JSON, elements for XML.
        depth: Nesting of collections or elements.
        attributes: Attributes of one XML element.
        attribute_characters: Characters in one XML attribute.
        bodies: Bodies of a mechanism.
        joints: Joints of a mechanism.
        includes: Files that one model may pull in (`base:`, includes).
        aliases: Aliases of a YAML file.
        number_characters: Characters in one number.
        name_characters: Characters in one name.
        seconds: Computing time for parsing one file [s].
        isolated: Whether MuJoCo's parser, which nobody can stop from within, runs in a process of its own.
    """

    xml_bytes: int = 8 * _MIB
    json_bytes: int = 8 * _MIB
    yaml_bytes: int = _MIB
    yaml_nodes: int = 20_000
    nodes: int = 200_000
    depth: int = 64
    attributes: int = 256
    attribute_characters: int = 65_536
    bodies: int = 2_000
    joints: int = 2_000
    includes: int = 32
    aliases: int = 1_000
    number_characters: int = 400
    name_characters: int = 256
    seconds: float = 5.0
    isolated: bool = True

    @property
    def largest_file(self) -> int:
        """The size above which no file of any format is read [bytes]."""
        return max(self.xml_bytes, self.json_bytes, self.yaml_bytes)


DEFAULT_LIMITS: Final = Limits()
"""The limits of the library."""


class Deadline:
    """A clock of computing time that refuses to go on after `limits.seconds`; waiting does not count."""

    def __init__(self, file: str, limits: Limits) -> None:
        self._file, self._seconds = file, limits.seconds
        self._end = time.thread_time() + limits.seconds

    def check(self, line: int = 0, column: int = 0) -> None:
        """Go on, or refuse.

        Raises:
            FileError: The time is over.
        """
        if time.thread_time() > self._end:
            place = Place(self._file, line, column)
            raise FileError(
                f"{place.text()}: reading took more than {self._seconds:g} s; the file is too complex"
            )
