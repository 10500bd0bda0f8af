"""What of a native file can still be read when parts of it do not fit the schema.

So that one run tells every independent mistake, whatever was refused is taken out or replaced by a
stand-in of the same name, and the rest is checked as usual.  What is then said about the parts that
were touched is a consequence, not a mistake, and is kept back.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any, Final

from pydantic import ValidationError

from vincula.files.names import name_problem
from vincula.files.schema import NativeFile
from vincula.files.schema_problems import location_of
from vincula.files.schema_values import Context
from vincula.files.tree import Document, Location
from vincula.spatial.space import PLANAR, Space

_ROUNDS: Final = 4
_UNKNOWN: Final = "?"
"""Stands for what has no readable name; no file can use it, because what it stands for is kept back."""

_NAMES: Final = frozenset({"bodies", "frames", "joints", "closures"})
"""Sections that name things which others refer to."""


@dataclass
class Touched:
    """The parts that were taken out or replaced.

    Attributes:
        locations: Where they are.
        names: Names of which less is known now than the file says.
        kinds: Sections of which not even the names are known.
    """

    locations: list[tuple[str | int, ...]] = field(default_factory=list)
    names: set[str] = field(default_factory=set)
    kinds: set[str] = field(default_factory=set)

    def covers(self, location: Location, named: Iterable[str] = (), message: str = "") -> bool:
        """Whether a problem is a consequence of what was touched.

        Args:
            location: Where the problem is.
            named: Names that it is about.
            message: Its words.
        """
        if any(tuple(location[: len(here)]) == here for here in self.locations):
            return True
        if self.kinds and (named or "named" in message):
            return True
        quoted = any(f"'{name}'" in message or f"'{name}." in message for name in self.names)
        return quoted or any(name in self.names or name.rpartition(".")[0] in self.names for name in named)


def rest_of(document: Document, context: Context, space: Space) -> tuple[NativeFile | None, Touched]:
    """The file without what does not fit the schema, and what was touched; None when nothing is left.

    Args:
        document: The file, refused by `schema_problems.validated` before.
        context: Parameters and dimensions, as they were then.
        space: PLANAR or SPATIAL.
    """
    rest = _Rest(document, space)
    if not isinstance(rest.data, dict):
        return None, rest.touched
    for _ in range(_ROUNDS):
        try:
            return NativeFile.model_validate(rest.data, context=context), rest.touched
        except ValidationError as error:
            for detail in error.errors(include_url=False):
                extra = detail["type"] == "extra_forbidden"
                rest.without(location_of(document, detail)[0], extra=extra)
    return None, rest.touched


class _Rest:
    """The content of a file, from which parts are taken."""

    def __init__(self, document: Document, space: Space) -> None:
        self.data: Any = document.plain()
        self.touched = Touched()
        self._space = space

    def without(self, location: tuple[str | int, ...], *, extra: bool) -> None:
        """Take out the part that a location is in."""
        if not location:
            return
        section = str(location[0])
        content = self.data.get(section)
        if extra:
            self._drop_key(location)
        elif len(location) == 1 or not isinstance(content, dict | list):
            self._drop_section(section)
        elif isinstance(content, list) and isinstance(location[1], int) and location[1] < len(content):
            self.touched.locations.append((section, location[1]))
            content[location[1]] = self._stand_in(section, content[location[1]], location[1])
        elif isinstance(content, dict) and location[1] in content:
            self._drop_entry(section, str(location[1]), content)
        else:
            self._drop_section(section)

    def _drop_key(self, location: tuple[str | int, ...]) -> None:
        holder = self.data
        for step in location[:-1]:
            in_table = isinstance(holder, dict) and step in holder
            if not in_table and not (
                isinstance(holder, list) and isinstance(step, int) and step < len(holder)
            ):
                return
            holder = holder[step]
        if isinstance(holder, dict):
            holder.pop(location[-1], None)

    def _drop_section(self, section: str) -> None:
        self.data.pop(section, None)
        self.touched.locations.append((section,))
        if section in _NAMES:
            self.touched.kinds.add(section)

    def _drop_entry(self, section: str, key: str, content: dict[str, Any]) -> None:
        self.touched.locations.append((section, key))
        if section == "bodies":
            content[key] = None
            self.touched.names.add(key)
            if name_problem(key):
                del content[key]
        elif section == "reference" and key in ("body", "axes"):
            self._drop_section(section)
        else:
            del content[key]
            if section == "frames":
                self.touched.names.add(key)

    def _stand_in(self, section: str, item: Any, index: int) -> Any:
        """Something of the section that fits the schema, with the names of the item."""
        given = item if isinstance(item, dict) else {}
        name = given.get("name", item if section in ("motors", "lock") else None)
        if not isinstance(name, str) or name_problem(name):
            name = f"{_UNKNOWN}{section}{index}"
            self.touched.kinds |= {section} & _NAMES
        self.touched.names.add(name)
        if section in ("motors", "lock"):
            return name
        if section == "couplings":
            return {"name": name, "rates": {_UNKNOWN: 1}}
        if section == "closures":
            return {"name": name, "type": "fixed", "frames": [_UNKNOWN, f"{_UNKNOWN}{_UNKNOWN}"]}
        bodies = given.get("bodies")
        if not (isinstance(bodies, list) and len(bodies) == 2 and all(map(_is_name, bodies))):
            bodies = ["ground", f"{_UNKNOWN}{index}"]
            self.touched.kinds.add("bodies")
        zero, one = [0, 0, 0][: self._space.translations], [0, 0, 1][-self._space.translations :]
        if section == "contacts":
            return {"name": name, "type": "hard-finger", "bodies": bodies, "at": zero, "normal": one}
        axis = {} if self._space is PLANAR else {"axis": one}
        return {"name": name, "type": "revolute", "bodies": bodies, "at": zero, **axis}


def _is_name(value: object) -> bool:
    return isinstance(value, str) and not name_problem(value)
