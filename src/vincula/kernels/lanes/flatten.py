"""From a mechanism's layout to flat arrays: see `tables`.

Bodies need no frames of their own: every body is represented by the frame of the tree joint that carries
it, and all its other frames follow by one constant pose each.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from vincula.arrays import Vector, frozen
from vincula.errors import ModelError
from vincula.kernels.lanes import tables as t
from vincula.kernels.lanes.tables import Code
from vincula.mechanism.joint_types import JointType
from vincula.mechanism.parts import GROUND, Joint
from vincula.spatial.poses import Pose

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism


@dataclass(frozen=True, slots=True, eq=False)
class Flat:
    """A mechanism as flat arrays.

    Attributes:
        code: Whole numbers, structure only.
        constants: Doubles: geometry in units of the characteristic length.
        frames: Slot of every frame that is used, by its index in `layout.frames`.
        values: First value slot of every joint by name.
    """

    code: Code
    constants: Vector
    frames: dict[int, int]
    values: dict[str, int]


class Unsupported(ModelError):  # noqa: N818  never reaches a user: the reference path takes over
    """Something that lanes do not do; the reference path does."""


def flatten(mechanism: Mechanism, *, general: bool = False) -> Flat:
    """The flat arrays of a mechanism with a reference member.

    Args:
        mechanism: The mechanism.
        general: Whether frames that coincide, and rotations that are none, are to be computed all the
            same: variants of other dimensions then have the same `code`.

    Raises:
        Unsupported: A part that lanes do not do.
    """
    from vincula.kernels.lanes.flat_rows import add_gaps, add_rows

    builder = Builder(mechanism, general)
    builder.place_tree()
    builder.place_frames()
    add_rows(builder)
    add_gaps(builder)
    return builder.flat()


class Builder:
    """Collects constants, slots and tables.

    Attributes:
        mechanism: The mechanism.
        general: See `flatten`.
        code: The tables so far, header included.
        constants: The constants so far.
        slots: Slots given out.
        tape: Instructions that place frames.
        slot_of: Slot of every frame placed, by its index in the frame table.
        value_of: First value slot by joint.
    """

    def __init__(self, mechanism: Mechanism, general: bool) -> None:
        self.mechanism, self.general = mechanism, general
        self.layout = mechanism.layout
        self.length = mechanism.length
        self.code = [0] * t.HEADER
        self.constants: list[float] = []
        self.tape: list[tuple[int, ...]] = []
        self.slot_of: dict[int, int] = {}
        self.aliases: dict[int, int] = {}
        self.value_of: dict[str, int] = {}
        self.slots = 0
        self._values()

    def _values(self) -> None:
        """Values come first in the workspace, linear ones divided by the length."""
        scale: list[int] = []
        metre = self.constant(1.0 / self.length)
        for joint in self.mechanism.all_joints:
            if joint.name in self.mechanism.home:
                self.value_of[joint.name] = len(scale)
                scale += [metre if linear else -1 for linear in self.mechanism.type_of(joint).value_linear]
        self.code[t.VALUES] = len(scale)
        self.code[t.VALUE_SLOT] = self.slot(len(scale))
        self.table(t.VALUE_SCALE, scale)
        self.code[t.SCRATCH] = self.slot(24)

    def slot(self, count: int) -> int:
        """The first of `count` new slots."""
        self.slots += count
        return self.slots - count

    def constant(self, *values: float) -> int:
        """Index of the first of new constants."""
        self.constants.extend(values)
        return len(self.constants) - len(values)

    def table(self, entry: int, numbers: Sequence[int]) -> None:
        """Append a table and note where it begins."""
        self.code[entry] = len(self.code)
        self.code.extend(int(n) for n in numbers)

    # Frames -----------------------------------------------------------------------------------------

    def place_tree(self) -> None:
        """Both frames of every tree joint; each body is then carried by one of them."""
        self.carrier: dict[str, tuple[int, Pose]] = {
            GROUND: (-1, Pose.identity(self.mechanism.space.translations))
        }
        needed = self._frames_used()
        for joint, forward in self.mechanism.tree:
            index = self.layout.frames.of_joint[joint.name]
            first, second = (index, index + 1) if forward else (index + 1, index)
            body, other = (joint.first, joint.second) if forward else (joint.second, joint.first)
            own, others = joint.frame_on_first, joint.frame_on_second
            if not forward:
                own, others = others, own
            if first in needed and not self._same_axes(joint):
                start = self.place(body, own)
                self.slot_of[first] = start
                target = self.copy(start)
            else:
                target = self.place(body, own, fresh=True)
                self.aliases[first] = target
            self._move(joint, target, 1 if forward else -1)
            self.slot_of[second] = target
            self.carrier[other] = (target, others.inverse())

    def _frames_used(self) -> set[int]:
        """Frames that rows, columns and gaps look at."""
        layout = self.layout
        used = {*layout.screws.frame.tolist(), *layout.screws.centre.tolist()}
        used |= {*layout.blocked.frame.tolist(), *layout.blocked.point.tolist()}
        used |= {other for _, other, _ in layout.blocked.across}
        return {int(index) for index in used}

    def _same_axes(self, joint: Joint) -> bool:
        """Whether frame A of a tree joint may stand for B: only axes and points in common are used."""
        kind = self.mechanism.type_of(joint)
        index = self.layout.frames.of_joint[joint.name]
        blocked = self.layout.blocked
        ends = (index, index + 1)
        if np.isin(ends, blocked.frame).any():
            return False
        if any(step[0] in "TH" for step in kind.steps) and np.isin(ends, blocked.point).any():
            return False
        if kind.planar:
            return len(kind.steps) <= 1
        return all(step in ("Rz", "Tz", "H") for step in kind.steps)

    def place_frames(self) -> None:
        """The other frames that are used, and the one at the reference point."""
        for index in sorted(self._frames_used() - {0}):
            if index in self.aliases and index not in self.slot_of:
                self.slot_of[index] = self.aliases[index]
            self.frame(index)
        reference = self.mechanism.reference
        if reference is None:
            raise Unsupported("no reference member is named")
        at = Pose(np.eye(self.mechanism.space.translations), reference.origin)
        self.code[t.REFERENCE] = self.place(reference.body, at)
        self.code[t.BODY_AXES] = int(reference.axes == "body")

    def frame(self, index: int) -> int:
        """Slot of any frame of the frame table."""
        if index not in self.slot_of:
            table = self.layout.frames
            body = table.bodies[table.carrier[index]]
            self.slot_of[index] = self.place(body, Pose(table.rotation[index], table.position[index]))
        return self.slot_of[index]

    def place(self, body: str, pose: Pose, *, fresh: bool = False) -> int:
        """Slot of a frame fixed on a body.

        Args:
            body: The body.
            pose: The frame in the body's frame.
            fresh: Whether the slot is going to be changed.
        """
        source, inverse = self.carrier[body]
        relative = inverse @ pose
        turned = self.general or not np.array_equal(relative.rotation, np.eye(len(relative.rotation)))
        moved = self.general or bool(relative.position.any())
        if not (turned or moved or fresh) and source >= 0:
            return source
        rotation, position = embedded(relative, self.length)
        first = self.constant(*rotation.ravel(), *position)
        target = self.slot(12)
        flags = int(turned) + 2 * int(moved)
        self.tape.append((t.PLACE, target, source, first, 0, 1, flags, 0))
        return target

    def copy(self, source: int) -> int:
        """A new slot that begins as a frame already placed."""
        target = self.slot(12)
        self.tape.append((t.PLACE, target, source, 0, 0, 1, 0, 0))
        return target

    def _move(self, joint: Joint, target: int, sign: int) -> None:
        self.tape.extend(self.motion(joint, target, sign))

    def motion(self, joint: Joint, target: int, sign: int) -> list[tuple[int, ...]]:
        """Instructions that carry a frame along the joint's motion, or back for sign -1."""
        kind = self.mechanism.type_of(joint)
        at = self.code[t.VALUE_SLOT] + self.value_of[joint.name]
        steps: list[tuple[int, ...]] = []
        for step in kind.steps:
            steps.append(self._instruction(kind, step, joint, target, at, sign))
            at += 4 if step == "S" else 1
        return steps if sign > 0 else steps[::-1]

    def _instruction(
        self, kind: JointType, step: str, joint: Joint, target: int, at: int, sign: int
    ) -> tuple[int, ...]:
        if step[0] == "T":
            return (t.SLIDE, target, 0, 0, at, sign, 0, "xyz".index(step[1]))
        if step == "S":
            return (t.BALL, target, 0, 0, at, sign, 0, 0)
        if step == "R2":
            return (t.TURN_ABOUT, target, 0, self.constant(*joint.second_axis), at, sign, 0, 0)
        if step == "H":
            advance = self.constant(joint.lead / (2.0 * np.pi) / self.length)
            return (t.HELIX, target, 0, advance, at, sign, 0, 0)
        return (t.TURN, target, 0, 0, at, sign, 0, 0)

    def flat(self) -> Flat:
        """Everything as arrays."""
        layout = self.layout
        self.code[t.TAPE_LENGTH] = len(self.tape)
        self.code[t.COLUMNS] = len(layout.columns)
        self.code[t.MOTORS] = len(layout.active)
        self.code[t.ROWS] = len(layout.rows)
        self.code[t.TWIST] = self.mechanism.space.dimension
        self.code[t.SLOTS] = self.slots
        self.table(t.TAPE, [number for step in self.tape for number in step])
        return Flat(
            np.array(self.code, dtype=np.int64),
            frozen(np.array(self.constants)),
            dict(self.slot_of),
            dict(self.value_of),
        )


def embedded(pose: Pose, length: float) -> tuple[Vector, Vector]:
    """Rotation (3 x 3) and position (in units of `length`) of a pose, one of the plane laid into space."""
    if len(pose.position) == 3:
        return pose.rotation, pose.position / length
    rotation = np.eye(3, dtype=pose.rotation.dtype)
    rotation[:2, :2] = pose.rotation
    return rotation, np.array([*(pose.position / length), 0.0])
