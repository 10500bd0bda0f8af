"""Unknown rates of closing: the screws of joint axes, and the values that they change."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from vincula.arrays import Vector
from vincula.kernels.lanes import closing_tables as c
from vincula.kernels.lanes import tables as t
from vincula.kernels.lanes.flatten import Builder
from vincula.mechanism.parts import Joint


@dataclass(slots=True)
class Unknowns:
    """The unknown rates so far.

    Attributes:
        builder: Gives slots and constants.
        held: Axes that do not move by themselves.
        columns: Frame, axis, centre, turn and slide of every unknown.
        of_axis: Unknown by axis.
        updates: Kind, value slot and first unknown of what changes values.
        directions: Constant axes to turn with a frame: target slot, frame slot, constant.
    """

    builder: Builder
    held: frozenset[str]
    columns: list[list[int]] = field(default_factory=list)
    of_axis: dict[str, int] = field(default_factory=dict)
    updates: list[tuple[int, int, int]] = field(default_factory=list)
    directions: list[int] = field(default_factory=list)

    def add(self, joint: Joint, first: int, second: int) -> list[int]:
        """Unknown rates of a joint with frames A and B in these slots."""
        kind = self.builder.mechanism.type_of(joint)
        value = self.builder.code[t.VALUE_SLOT] + self.builder.value_of[joint.name] if kind.values else 0
        names, axis = kind.axis_names(joint.name), 0
        own: list[int] = []
        for step in kind.steps:
            count = 3 if step == "S" else 1
            if names[axis] not in self.held:
                start = len(self.columns)
                self.updates.append((c.BALL if step == "S" else c.NUMBER, value, start))
                for k in range(count):
                    self.of_axis[names[axis + k]] = start + k
                    self.columns.append(self._screw(joint, step, k, first, second))
                own += range(start, start + count)
            axis += count
            value += 4 if step == "S" else 1
        return own

    def _screw(self, joint: Joint, step: str, k: int, first: int, second: int) -> list[int]:
        """Frame, axis, centre, turn and slide of one unself."""
        planar = self.builder.mechanism.type_of(joint).planar
        if step[0] == "T":
            return [first, "xyz".index(step[1]), second, 0, -2]
        if step == "S":
            return [second, k, second, 1, -1]
        if step == "R2":
            return [self._direction(second, joint.second_axis), -1, second, 1, -1]
        if step == "H":
            advance = self.builder.constant(joint.lead / (2.0 * np.pi) / self.builder.length)
            return [first, 2, second, 1, advance]
        return [second if planar else first, 2, second, 1, -1]

    def _direction(self, frame: int, axis: Vector) -> int:
        target = self.builder.slot(3)
        self.directions += [target, frame, self.builder.constant(*axis)]
        return target
