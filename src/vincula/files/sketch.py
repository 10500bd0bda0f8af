"""A native file in the making: what is drawn so far, and where what is wrong with it is told."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final, TypeVar

from vincula.errors import ModelError
from vincula.files.problems import shown
from vincula.files.schema_rest import Touched
from vincula.files.tree import Document, Location
from vincula.files.units import Scale
from vincula.mechanism.drawing import Drawing

if TYPE_CHECKING:
    from vincula.files.schema import NativeFile
    from vincula.mechanism.mechanism import Mechanism

_PART: Final = re.compile(r"(?P<part>(?:joint|contact|frame|body) '[^']*': )(?P<words>\w+(?: \w+)?)")
Result = TypeVar("Result")


@dataclass
class Sketch:
    """What is drawn from one file.

    Attributes:
        document: The file.
        entry: Its validated content.
        drawing: Everything drawn so far, the base included.
        scale: Units of the file.
        base: The base, at the configuration of the overlay.
        first_use: Where every new name is first written, for messages about the whole.
        touched: What of the file was replaced because it does not fit the schema; None while all fits.
    """

    document: Document
    entry: NativeFile
    drawing: Drawing
    scale: Scale
    base: Mechanism | None
    first_use: dict[str, Location] = field(default_factory=dict)
    touched: Touched | None = None

    def problem(self, location: Location, message: str) -> None:
        """Add a problem at a place of the file."""
        if self.touched is not None and self.touched.covers(location, (), message):
            return
        self.document.problems.add(self.document.place(location), message)

    def unknown(self, location: Location, kind: str, name: str, choices: Iterable[str]) -> None:
        """Add that a name at a place is not one of those that exist."""
        if self.touched is not None and self.touched.covers(location, [name]):
            return
        known = list(choices) or [f"(there is no {kind})"]
        place = self.document.place(location)
        self.document.problems.add(
            place, got=shown(name), expected=f"a {kind} that exists", name=name, choices=known
        )

    def doubt(self, *names: str) -> None:
        """Tell nothing further about names of parts that are not as the file wants them."""
        if names:
            self.touched = self.touched or Touched()
            self.touched.names.update(names)

    def attempt(self, location: Location, action: Callable[[], Result]) -> Result | None:
        """What the action returns, None when it refuses; the refusal is told at the place.

        Nothing is tried any more once enough problems are found: every refusal looks for similar names.
        """
        if self.document.problems.full:
            return None
        try:
            return action()
        except ModelError as error:
            self.problem(*self._nearest(location, str(error)))
            return None

    def _nearest(self, location: Location, message: str) -> tuple[Location, str]:
        """The place and the words of a refusal `joint 'o1': axis ...`: the path says the beginning."""
        match = _PART.match(message)
        if match is None:
            return location, message
        key = next((key for key in match["words"].split() if self.document.node([*location, key])), None)
        return (location if key is None else [*location, key]), message[match.end("part") :]
