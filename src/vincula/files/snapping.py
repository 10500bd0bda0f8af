"""The snapping test: the numbers of a file replaced by what they were probably meant to be, with a list.

Nothing is replaced but on request, and every replaced number is told with its place.  Angles become
multiples of pi/12, components of directions roots of simple fractions, and lengths that are roundings
of another length of the file become that one.  What counts as near is decided in `meant`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Final, Literal

from vincula.files.digits import is_number
from vincula.files.meant import Meant, meant_angle, meant_direction, meant_length, meant_quaternion
from vincula.files.problems import Place, shown
from vincula.files.xmltree import Element

Kind = Literal["length", "radians", "degrees", "direction", "quaternion"]
"""What the words of a text are: single numbers, or the components of one vector."""

Part = tuple[Kind, int]
"""A kind, and how many words in a row are of it."""

_SHAPES: Final = frozenset({"visual", "collision", "inertial", "sensor", "geom", "light", "camera"})


@dataclass(frozen=True, slots=True)
class Snap:
    """One number that was replaced.

    Attributes:
        place: Where it is written.
        owner: The named thing that it belongs to, such as `joint 'elbow'`.
        what: Attribute or key: `rpy`, `axis`, `pose`.
        typed: The number as it was typed.
        meant: What it was replaced by.
    """

    place: Place
    owner: str
    what: str
    typed: str
    meant: str

    def __str__(self) -> str:
        where = f"{self.place.file}:{self.place.line}" if self.place.line else self.place.file
        owner = f"{self.owner}, " if self.owner else ""
        return f"{self.typed} means {self.meant} ({where}, {owner}{self.what})"


@dataclass
class Snapping:
    """Replaces numbers, and keeps what it replaced.

    Attributes:
        found: The numbers replaced so far, in the order of the files.
    """

    found: list[Snap] = field(default_factory=list)

    def urdf(self, root: Element) -> None:
        """Replace numbers of a URDF document in place."""
        self._elements(root, _urdf_parts)

    def sdf(self, root: Element) -> None:
        """Replace numbers of an SDF document in place."""
        self._elements(root, _sdf_parts)

    def mjcf(self, root: Element, angle: str) -> None:
        """Replace numbers of an MJCF document in place.

        Args:
            root: Its root.
            angle: Unit of its angles: `degree` or `radian`.
        """
        self._elements(root, lambda element: _mjcf_parts(element, angle))

    def words(
        self, words: Sequence[str], parts: Sequence[Part], lengths: Sequence[str]
    ) -> list[Meant | None] | None:
        """What the words of one text mean; None when every word is taken as it is."""
        if len(words) != sum(count for _, count in parts) or not all(map(is_number, words)):
            return None
        result: list[Meant | None] = []
        at = 0
        for kind, count in parts:
            result += _meanings(kind, words[at : at + count], lengths)
            at += count
        return result if any(result) else None

    def _elements(
        self, root: Element, parts_of: Callable[[Element], Iterator[tuple[str, list[Part]]]]
    ) -> None:
        texts = [(e, key, parts) for e in _without_shapes(root) for key, parts in parts_of(e)]
        lengths = [word for e, key, parts in texts for word in _lengths(_text(e, key).split(), parts)]
        for element, key, parts in texts:
            words = _text(element, key).split()
            meanings = self.words(words, parts, lengths)
            if meanings is None:
                continue
            owner = _owner(element)
            for k, meant in enumerate(meanings):
                if meant is not None:
                    self.found.append(Snap(element.place, owner, key or element.tag, words[k], meant.words))
                    words[k] = repr(meant.value)
            if key:
                element.attributes[key] = " ".join(words)
            else:
                element.characters = " ".join(words)


def snapped_words(found: Sequence[Snap], most: int = 4) -> str:
    """The replaced numbers in words, the first few with their places."""
    told = "; ".join(str(snap) for snap in found[:most])
    return f"{told}; and {len(found) - most} more" if len(found) > most else told


def _meanings(kind: Kind, words: Sequence[str], lengths: Sequence[str]) -> list[Meant | None]:
    if kind in ("direction", "quaternion"):
        whole = (meant_direction if kind == "direction" else meant_quaternion)(words)
        if whole is None:
            return [None] * len(words)
        return [m if m.value != float(w) else None for w, m in zip(words, whole, strict=True)]
    if kind == "length":
        return [meant_length(word, lengths) for word in words]
    return [meant_angle(word, degrees=kind == "degrees") for word in words]


def _lengths(words: Sequence[str], parts: Sequence[Part]) -> list[str]:
    at, found = 0, []
    for kind, count in parts:
        if kind == "length":
            found += [word for word in words[at : at + count] if is_number(word)]
        at += count
    return found


def _without_shapes(root: Element) -> Iterator[Element]:
    waiting = [root]
    while waiting:
        element = waiting.pop()
        if element.tag not in _SHAPES:
            yield element
            waiting.extend(reversed(element.children))


def _text(element: Element, key: str) -> str:
    return element.attributes[key] if key else element.characters


def _owner(element: Element) -> str:
    """The nearest named element around."""
    around: Element | None = element
    while around is not None and not around.name:
        around = around.parent
    return "" if around is None else f"{around.tag} {shown(around.name)}"


def _urdf_parts(element: Element) -> Iterator[tuple[str, list[Part]]]:
    if "rpy" in element.attributes:
        yield "rpy", [("radians", 1)] * 3
    if "quat_xyzw" in element.attributes:
        yield "quat_xyzw", [("quaternion", 4)]
    if "xyz" in element.attributes:
        yield "xyz", [("direction", 3)] if element.tag.endswith("axis") else [("length", 3)]
    if element.tag in _DRAKE and "value" in element.attributes:
        yield "value", _DRAKE[element.tag]
    yield from _sdf_parts(element)  # Gazebo's joints


def _sdf_parts(element: Element) -> Iterator[tuple[str, list[Part]]]:
    if element.tag == "pose":
        in_degrees = element.attributes.get("degrees", "").strip() in ("true", "1")
        angle: Kind = "degrees" if in_degrees else "radians"
        quaternion = element.attributes.get("rotation_format") == "quat_xyzw"
        yield "", [("length", 3), ("quaternion", 4)] if quaternion else [("length", 3), (angle, 3)]
    elif element.tag == "xyz" and element.parent is not None and element.parent.tag in ("axis", "axis2"):
        yield "", [("direction", 3)]
    elif element.tag in _DRAKE and element.characters:
        yield "", _DRAKE[element.tag]


_DRAKE: Final[dict[str, list[Part]]] = {
    **{
        f"drake:{kind}_constraint_{point}": [("length", 3)]
        for kind in ("ball", "distance")
        for point in ("p_AP", "p_BQ")
    },
    "drake:distance_constraint_distance": [("length", 1)],
}
"""Tags of Drake that hold lengths: their text in SDF, their `value` in URDF."""

_MJCF: Final[dict[str, list[Part]]] = {
    "pos": [("length", 3)],
    "anchor": [("length", 3)],
    "quat": [("quaternion", 4)],
    "xyaxes": [("direction", 3), ("direction", 3)],
    "zaxis": [("direction", 3)],
    "axis": [("direction", 3)],
    "relpose": [("length", 3), ("quaternion", 4)],
}


def _mjcf_parts(element: Element, angle: str) -> Iterator[tuple[str, list[Part]]]:
    if element.tag not in ("body", "joint", "site", "frame", "replicate", "connect", "weld"):
        return
    for key in element.attributes:
        turn: Kind = "degrees" if angle == "degree" else "radians"
        if key == "euler":
            yield key, [(turn, 1)] * 3
        elif key == "axisangle":
            yield key, [("direction", 3), (turn, 1)]
        elif key in _MJCF:
            yield key, _MJCF[key]
