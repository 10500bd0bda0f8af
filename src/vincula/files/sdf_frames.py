"""Frames of an SDF model: what is attached to which link, and where (SDFormat 1.4 to 1.12).

Every link, frame and joint of a model is a frame.  Poses are relative to something (`relative_to`, or a
default that depends on the kind of frame), attachments lead to a link.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np

from vincula.files.problems import Place, Problems, shown
from vincula.files.robot_graph import WORLD
from vincula.files.xmltree import Element
from vincula.files.xmlvalues import XmlValues
from vincula.spatial.poses import Pose, rotation_from_quaternion_wxyz

MODEL: Final = "__model__"
"""The implicit frame of the model."""

_SHORTEST_QUATERNION: Final = 1e-6


@dataclass(frozen=True, slots=True)
class _Frame:
    """One frame: its raw pose, what the pose is relative to, and what it is attached to."""

    raw: Pose
    relative_to: str
    attached_to: str
    place: Place


class SdfFrames:
    """The frames of one model.

    Args:
        problems: Where problems go.
        values: Reads numbers.
    """

    def __init__(self, problems: Problems, values: XmlValues) -> None:
        self._problems, self._values = problems, values
        self._frames: dict[str, _Frame] = {}
        self._links: set[str] = set()
        self._lost: set[str] = set()
        self._poses: dict[str, Pose] = {MODEL: Pose.identity(3)}

    def add_model(self, model: Element, canonical_link: str) -> None:
        """The model's own frame; its `<pose>` places it, or its placement frame, in the world."""
        raw, _ = self.pose_of(model)
        placed = model.get("placement_frame", "") or MODEL
        self._frames[MODEL] = _Frame(Pose.identity(3), "", canonical_link, model.place)
        self._frames[WORLD] = _Frame(raw.inverse(), placed, WORLD, model.place)
        self._links.add(WORLD)

    def add_drawn(self, poses: Mapping[str, Pose], root: str) -> None:
        """Links that have their poses already; the model's frame and the world are the root link's."""
        for name, pose in poses.items():
            self._poses[name] = pose
            self._frames[name] = _Frame(pose, MODEL, name, Place(""))
            self._links.add(name)
        for name in (MODEL, WORLD):
            self._poses.setdefault(name, poses[root])
            self._frames.setdefault(name, _Frame(Pose.identity(3), root, root, Place("")))

    def add_link(self, element: Element, name: str) -> None:
        """A link: by default relative to the model."""
        raw, relative_to = self.pose_of(element)
        self._frames[name] = _Frame(raw, relative_to or MODEL, name, element.place)
        self._links.add(name)

    def add_frame(self, element: Element, name: str) -> None:
        """A frame: attached to the model, and relative to what it is attached to, by default."""
        raw, relative_to = self.pose_of(element)
        attached = element.get("attached_to", "") or MODEL
        self._frames[name] = _Frame(raw, relative_to or attached, attached, element.place)

    def add_joint(self, element: Element, name: str, child: str) -> None:
        """A joint: attached to its child, and relative to it by default."""
        raw, relative_to = self.pose_of(element)
        self._frames[name] = _Frame(raw, relative_to or child, child, element.place)

    @property
    def names(self) -> list[str]:
        """All names."""
        return list(self._frames)

    def is_link(self, name: str) -> bool:
        """Whether a name is that of a link, or the world."""
        return name in self._links or name == WORLD

    def link_of(self, name: str) -> str:
        """The link that a frame is attached to; empty after a problem (a circle, a name unknown)."""
        seen = {name}
        while name not in self._links:
            frame = self._frames.get(name)
            if frame is None or frame.attached_to in seen:
                return ""
            name = frame.attached_to
            seen.add(name)
        return name

    def pose(self, name: str) -> Pose | None:
        """Pose of a frame in the model's frame; None after a problem."""
        chain: dict[str, None] = {}
        while name not in self._poses:
            frame = self._frames.get(name)
            if frame is None or name in chain or name in self._lost:
                self._lost.update(chain)
                return None
            chain[name] = None
            name = frame.relative_to
        pose = self._poses[name]
        for step in reversed(chain):
            pose = pose @ self._frames[step].raw
            self._poses[step] = pose
        return pose

    def in_link(self, name: str) -> Pose | None:
        """Pose of a frame in the link that it is attached to; None after a problem."""
        link = self.link_of(name)
        own, base = self.pose(name), self.pose(link) if link else None
        return None if own is None or base is None else base.inverse() @ own

    def check(self) -> None:
        """Tell names that do not exist and frames that lead in a circle."""
        for name, frame in self._frames.items():
            for what, target in (("relative_to", frame.relative_to), ("attached_to", frame.attached_to)):
                if target and target not in self._frames:
                    self._problems.add(
                        frame.place, got=f"{what}={shown(target)}", name=target, choices=self.names
                    )
            if self.pose(name) is None and frame.relative_to in self._frames:
                self._problems.add(frame.place, f"the poses from {shown(name)} lead in a circle or nowhere")
            elif not self.link_of(name) and frame.attached_to in self._frames:
                self._problems.add(frame.place, f"frame {shown(name)} is attached to no link")

    def pose_of(self, element: Element) -> tuple[Pose, str]:
        """The `<pose>` of an element as written, and what it is relative to (empty for the default)."""
        found = next(element.find_all("pose"), None)
        if found is None or not found.text:
            return Pose.identity(3), "" if found is None else found.get("relative_to", "")
        relative_to = found.get("relative_to", "")
        if found.get("rotation_format") == "quat_xyzw":
            values = self._values.numbers(found, found.text, 7, what="pose")
            if values is None:
                return Pose.identity(3), relative_to
            if float(np.linalg.norm(values[3:])) < _SHORTEST_QUATERNION:
                self._problems.add(
                    found.place, got="a quaternion of length zero", expected="a unit quaternion"
                )
                return Pose.identity(3), relative_to
            x, y, z, w = values[3:]
            return Pose.at(values[:3], rotation_from_quaternion_wxyz([w, x, y, z])), relative_to
        words = found.text.split()
        if len(words) != 6:
            self._values.numbers(found, found.text, 6, what="pose")
            return Pose.identity(3), relative_to
        position = self._values.numbers(found, " ".join(words[:3]), 3, what="pose", unit="length")
        degrees = found.get("degrees", "").strip() in ("true", "1")
        turn = self._values.angles(found, " ".join(words[3:]), what="pose", degrees=degrees)
        if position is None or turn is None:
            return Pose.identity(3), relative_to
        return Pose.at(position, turn), relative_to
