"""From a mechanism to the flat arrays of its closing: see `closing_tables`."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from vincula.arrays import Vector
from vincula.kernels.lanes import closing_tables as c
from vincula.kernels.lanes import tables as t
from vincula.kernels.lanes.closing_forest import Forest, Given, forest_of
from vincula.kernels.lanes.closing_order import Elimination, elimination, pair_entries
from vincula.kernels.lanes.closing_scalars import Scalar, scalar_table, scalars_of
from vincula.kernels.lanes.closing_unknowns import Unknowns
from vincula.kernels.lanes.flatten import Builder
from vincula.kernels.lanes.jit import Code
from vincula.mechanism.closure_rows import Selection, contact_selection, joint_selection, whole_pose
from vincula.mechanism.parts import GROUND, Joint
from vincula.spatial.poses import Pose

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism


@dataclass(frozen=True, slots=True, eq=False)
class ClosingArrays:
    """A mechanism's closing as flat arrays.

    Attributes:
        code: Values and instructions that place frames, see `tables`.
        plan: See `closing_tables`.
        constants: Geometry in units of the characteristic length.
        value_scale: What configuration values are multiplied by when they come in.
        input_scale: The same for what is given.
        forest: What is solved for.
    """

    code: Code
    plan: Code
    constants: Vector
    value_scale: Vector
    input_scale: Vector
    forest: Forest


@dataclass(slots=True)
class _Part:
    """A joint or contact outside the forest, with its frames and the unknowns that move its gap."""

    first: int
    second: int
    selection: Selection
    constant: int
    signs: dict[int, int]


def closing_arrays(mechanism: Mechanism, given: Given, *, general: bool = False) -> ClosingArrays:
    """The flat arrays of a mechanism's closing.

    Args:
        mechanism: The mechanism.
        given: What is given.
        general: Whether variants of other dimensions are to have the same `code` and `plan`.

    Raises:
        Unsupported: Something that lanes do not close.
    """
    return _Assembly(mechanism, given, general).arrays()


class _Assembly:
    """Places frames, collects unknowns and parts, then lays out the tables."""

    def __init__(self, mechanism: Mechanism, given: Given, general: bool) -> None:
        self.mechanism = mechanism
        self.builder = Builder(mechanism, general)
        self.forest = forest_of(mechanism, given)
        self.plan = [0] * c.HEADER
        self.unknowns = Unknowns(self.builder, self.forest.held)
        self._inputs()
        self.paths: dict[str, tuple[tuple[int, int], ...]] = {GROUND: ()}
        self.builder.carrier = {GROUND: (-1, Pose.identity(mechanism.space.translations))}
        reference = mechanism.reference
        if given == "reference" and reference is not None:
            self.plan[c.POSE] = self.builder.slot(12)
            self.builder.carrier[reference.body] = (self.plan[c.POSE], Pose.at(-reference.origin))
            self.paths[reference.body] = ()
        for joint, forward in self.forest.tree:
            self._walk(joint, forward)
        self.parts = [*self._own(), *self._closures(), *self._contacts()]
        self.scalars = scalars_of(self.builder, given, self.unknowns.of_axis, self.drive_inputs)

    def _inputs(self) -> None:
        """Slots of what is given; motors on joints are values, motors over several axes are not."""
        mechanism, builder = self.mechanism, self.builder
        linear: list[bool] = []
        held: list[int] = []
        self.drive_inputs: dict[str, int] = {}
        if self.forest.given == "reference":
            s = mechanism.space.translations
            linear = [True] * s + [False] * (1 if s == 2 else 4)
        else:
            place = self._value_places()
            drives = {drive.name for drive in mechanism.drives}
            for k, motor in enumerate(mechanism.active):
                if motor in drives:
                    self.drive_inputs[motor] = k
                    linear.append(False)  # scaled with its equation
                else:
                    slot, in_metres = place[motor]
                    held += [slot, k]
                    linear.append(in_metres)
        self.input_scale = np.where(linear, 1.0 / builder.length, 1.0)
        self.plan[c.INPUTS] = len(linear)
        self.plan[c.INPUT] = builder.slot(len(linear))
        self._table(c.HELD, [len(held) // 2, *held])
        self.plan[c.POSE] = -1

    def _value_places(self) -> dict[str, tuple[int, bool]]:
        """Value slot of every axis with a scalar value, and whether it is in metres."""
        first = self.builder.code[t.VALUE_SLOT]
        found: dict[str, tuple[int, bool]] = {}
        for joint in self.mechanism.all_joints:
            kind = self.mechanism.type_of(joint)
            if kind.scalar_values and joint.name in self.builder.value_of:
                at = first + self.builder.value_of[joint.name]
                for k, axis in enumerate(kind.axis_names(joint.name)):
                    found[axis] = at + k, kind.linear[k]
        return found

    def _table(self, entry: int, numbers: Iterable[int]) -> None:
        self.plan[entry] = len(self.plan)
        self.plan.extend(int(number) for number in numbers)

    # Frames and unknowns -----------------------------------------------------------------------------

    def _walk(self, joint: Joint, forward: bool) -> None:
        """Frames of a tree joint; the next body is then carried by the far one."""
        builder = self.builder
        here, there = (joint.first, joint.second) if forward else (joint.second, joint.first)
        near, far = joint.frame_on_first, joint.frame_on_second
        if not forward:
            near, far = far, near
        start, target = self._moved(joint, here, near, 1 if forward else -1)
        builder.carrier[there] = (target, far.inverse())
        first, second = (start, target) if forward else (target, start)
        columns = self.unknowns.add(joint, first, second)
        sign = 1 if forward else -1
        self.paths[there] = self.paths[here] + tuple((k, sign) for k in columns)

    def _moved(self, joint: Joint, body: str, frame: Pose, sign: int) -> tuple[int, int]:
        """Slots of a joint's frame on `body`, and of where the joint's values carry it."""
        builder = self.builder
        if self._tells_frames_apart(joint):
            start = builder.place(body, frame)
            target = builder.copy(start)
        else:
            start = target = builder.place(body, frame, fresh=True)
        builder.tape.extend(builder.motion(joint, target, sign))
        return start, target

    def _tells_frames_apart(self, joint: Joint) -> bool:
        """Whether the axes of a joint look different from its frames A and B."""
        kind = self.mechanism.type_of(joint)
        if kind.planar:
            return len(kind.steps) > 1
        return not (all(step in ("Rz", "Tz", "H") for step in kind.steps) or kind.steps == ("S",))

    # Parts with gaps ---------------------------------------------------------------------------------

    def _signs(self, first: str, second: str) -> dict[int, int]:
        signs: dict[int, int] = {}
        for body, side in ((second, 1), (first, -1)):
            for column, sign in self.paths[body]:
                signs[column] = signs.get(column, 0) + side * sign
        return {column: sign for column, sign in signs.items() if sign}

    def _own(self) -> Iterable[_Part]:
        """Joints with values outside the forest: B against where the values put it."""
        builder = self.builder
        for joint in self.forest.own:
            start, wanted = self._moved(joint, joint.first, joint.frame_on_first, 1)
            signs = self._signs(joint.first, joint.second)
            signs.update(dict.fromkeys(self.unknowns.add(joint, start, wanted), -1))
            there = builder.place(joint.second, joint.frame_on_second)
            yield _Part(wanted, there, whole_pose(self.mechanism.space.translations), 0, signs)

    def _closures(self) -> Iterable[_Part]:
        self.measured: list[int] = []
        for joint in (*self.forest.measured, *self.forest.closures):
            kind = self.mechanism.type_of(joint)
            part = self._part(joint.first, joint.second, joint.frame_on_first, joint.frame_on_second,
                              joint_selection(kind, joint.second_axis))  # fmt: skip
            if not joint.closure:
                value = self.builder.code[t.VALUE_SLOT] + self.builder.value_of[joint.name]
                read = c.TURN if kind.steps == ("S",) else c.PLACE
                self.measured += [read, value, part.first, part.second]
            if part.selection.count:
                yield part

    def _contacts(self) -> Iterable[_Part]:
        for contact in self.mechanism.contacts:
            yield self._part(contact.first, contact.second, contact.frame_on_first, contact.frame_on_second,
                             contact_selection(contact.type, self.mechanism.space))  # fmt: skip

    def _part(self, one: str, two: str, on_one: Pose, on_two: Pose, selection: Selection) -> _Part:
        first, second = self._framed(one, on_one), self._framed(two, on_two)
        axis = selection.second_axis
        index = self.builder.constant(*axis, axis[2]) if selection.turning == "between axes" else 0
        return _Part(first, second, selection, index, self._signs(one, two))

    def _framed(self, body: str, frame: Pose) -> int:
        """A slot with a frame, on the ground too, where frames need none unless something is read off."""
        return self.builder.place(body, frame)

    # Tables ------------------------------------------------------------------------------------------

    def arrays(self) -> ClosingArrays:
        """Everything laid out."""
        builder, plan = self.builder, self.plan
        parts: list[_Part | Scalar] = [*self.parts, *self.scalars]
        pattern = elimination(len(self.unknowns.columns), [sorted(part.signs) for part in parts])
        place = {unknown: k for k, unknown in enumerate(pattern.order)}
        plan[c.UNKNOWNS] = len(pattern.order)
        plan[c.BLOCKS], plan[c.ENTRIES] = len(self.parts), len(pattern.entry)
        self._table(c.COLUMN, [n for unknown in pattern.order for n in self.unknowns.columns[unknown]])
        self._table(c.DIRECTION, [len(self.unknowns.directions) // 3, *self.unknowns.directions])
        self._factor(pattern)
        self._updates(place)
        plan[c.EQUATIONS] = sum(part.selection.count for part in self.parts) + len(self.scalars)
        plan[c.GAP] = builder.slot(plan[c.EQUATIONS])
        plan[c.NORMAL] = builder.slot(plan[c.ENTRIES])
        plan[c.STEP] = builder.slot(max(plan[c.UNKNOWNS], 2))
        plan[c.SIDE] = builder.slot(1)
        self._blocks(pattern, place)
        gap = plan[c.GAP] + plan[c.EQUATIONS] - len(self.scalars)
        self._table(c.SCALAR, scalar_table(builder, self.scalars, gap, pattern, place))
        self._table(c.MEASURED, [len(self.measured) // 4, *self.measured])
        plan[c.STATE_VALUES] = builder.code[t.VALUES]
        plan[c.STATE] = builder.slot(2 * plan[c.STATE_VALUES] + 3 * plan[c.INPUTS])
        plan[c.ANCHOR] = builder.slot(plan[c.STATE_VALUES] + plan[c.INPUTS])
        plan[c.SLOTS] = builder.slots
        builder.code[t.TAPE_LENGTH] = len(builder.tape)
        builder.table(t.TAPE, [number for step in builder.tape for number in step])
        return ClosingArrays(
            np.array(builder.code, dtype=np.int64), np.array(plan, dtype=np.int64),
            np.array(builder.constants), self._value_scale(), self.input_scale, self.forest,
        )  # fmt: skip

    def _factor(self, pattern: Elimination) -> None:
        """Table of the factor, with the place of every unknown's part of it just before."""
        numbers: list[int] = []
        starts: list[int] = []
        first = len(self.plan) + len(pattern.below)
        for column, below in enumerate(pattern.below):
            starts.append(first + len(numbers))
            numbers += [pattern.entry[column, column], len(below), *below]
            numbers += [pattern.entry[two, one] for k, one in enumerate(below) for two in below[k:]]
        self.plan.extend(starts)
        self._table(c.FACTOR, numbers)

    def _value_scale(self) -> Vector:
        linear = [flag for joint in self.mechanism.all_joints if joint.name in self.builder.value_of
                  for flag in self.mechanism.type_of(joint).value_linear]  # fmt: skip
        return np.where(np.array(linear, dtype=bool), 1.0 / self.builder.length, 1.0)

    def _updates(self, place: dict[int, int]) -> None:
        """Where steps go: values, with their unknowns' places in the order of elimination."""
        numbers: list[int] = []
        for how, value, start in self.unknowns.updates:
            own = [place[start + k] for k in range(3)] if how == c.BALL else [place[start], 0, 0]
            numbers += [how, value, *own]
        self._table(c.UPDATE, [len(self.unknowns.updates), *numbers])
        balls: list[int] = []
        for joint in self.mechanism.all_joints:
            kind = self.mechanism.type_of(joint)
            if "S" in kind.steps and joint.name in self.builder.value_of:
                after = self.builder.value_of[joint.name] + kind.values - 4
                balls.append(self.builder.code[t.VALUE_SLOT] + after)
        self._table(c.QUATERNIONS, [len(balls), *balls])

    def _blocks(self, pattern: Elimination, place: dict[int, int]) -> None:
        entries: list[int] = []
        gap = self.plan[c.GAP]
        for part in self.parts:
            entries += self._block(part, pattern, place, gap)
            gap += part.selection.count
        self._table(c.BLOCK, entries)

    def _block(self, part: _Part, pattern: Elimination, place: dict[int, int], gap: int) -> list[int]:
        selection, planar = part.selection, self.mechanism.space.translations == 2
        turns = _turns(selection, planar)
        offset = sum(1 << k for k in selection.linear)
        if offset == (3 if planar else 7):
            offset |= c.ALL
        angular = (4 if planar else sum(1 << k for k in selection.angular)) if selection.angular else 0
        columns = sorted((place[unknown], sign) for unknown, sign in part.signs.items())
        where = len(self.plan)
        self.plan.extend(number for pair in columns for number in pair)
        self.plan.extend(pair_entries([k for k, _ in columns], pattern))
        return [part.first, part.second, offset, turns, angular, part.constant, gap, selection.count,
                self.builder.slot(3 * len(selection.angular)), where, len(columns),
                self.builder.slot(selection.count * len(columns))]  # fmt: skip


def _turns(selection: Selection, planar: bool) -> int:
    if not selection.angular:
        return c.FREE
    if selection.turning == "tilt":
        return c.TILT
    if selection.turning == "between axes":
        return c.BETWEEN
    whole = planar or len(selection.angular) == 3
    return c.WHOLE if whole else c.VECTOR
