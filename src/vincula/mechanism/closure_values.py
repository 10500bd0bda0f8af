"""The unknowns of closure as one vector: joint values, their rates, steps along rates, limits.

A state holds values in metres, radians and quaternions; a step holds rates in metres / L and radians,
a ball's three in the axes of its second body.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vincula.arrays import Vector, frozen
from vincula.mechanism.joint_types import JointType
from vincula.mechanism.parts import Drive, Joint
from vincula.mechanism.residuals import axis_linear

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism

Mask = NDArray[np.bool_]
"""One truth value a rate."""


class Variables:
    """Where the values and rates of every unknown stand.

    Args:
        mechanism: The mechanism.
        joints: Joints whose values are unknowns, in order.
        drives: Motors over several axes, one scalar unknown each.

    Attributes:
        joints: Every joint with its type and the place of its values.
        joint: The same by name.
        values_of: Place of the values by joint or drive name.
        columns_of: Place of the rates by joint or drive name.
        value: Place of the value by name of an axis (or drive) that has a scalar value.
        column: Place of the rate by axis or drive name.
        names: Axis and drive names in the order of the rates.
        column_scale: Metres or radians for one unit of a step.
        ball_places: For every ball the place of its quaternion and of its first rate.
        scalar_places: Places of the scalar values, and of their rates.
    """

    def __init__(self, mechanism: Mechanism, joints: Sequence[Joint], drives: Sequence[Drive]) -> None:
        self.joints: list[tuple[Joint, JointType, slice]] = []
        self.joint = {joint.name: joint for joint in joints}
        self.values_of: dict[str, slice] = {}
        self.columns_of: dict[str, slice] = {}
        self.value: dict[str, int] = {}
        self._size = 0
        self.ball_places: list[tuple[int, int]] = []
        scalars: list[tuple[int, int]] = []
        names: list[str] = []
        linear: list[bool] = []
        for joint in joints:
            kind = mechanism.type_of(joint)
            axes = kind.axis_names(joint.name)
            place = self._reserve(joint.name, kind.values, len(names), len(axes))
            self.joints.append((joint, kind, place))
            value, column = place.start, len(names)
            for step in kind.steps:
                if step == "S":
                    self.ball_places.append((value, column))
                    value, column = value + 4, column + 3
                else:
                    scalars.append((value, column))
                    value, column = value + 1, column + 1
            if kind.scalar_values:
                self.value.update(zip(axes, range(place.start, place.stop), strict=True))
            names += axes
            linear += kind.linear
        in_metres = axis_linear(mechanism)
        for drive in drives:
            place = self._reserve(drive.name, 1, len(names), 1)
            scalars.append((place.start, len(names)))
            self.value[drive.name] = place.start
            names.append(drive.name)
            guessed = any(in_metres[axis] for axis in drive.drives)
            linear.append(guessed if drive.linear is None else drive.linear)
        self.names = tuple(names)
        self.column = {name: k for k, name in enumerate(names)}
        self.column_scale = frozen(np.where(np.array(linear, dtype=bool), mechanism.length, 1.0))
        self.scalar_places = (
            np.array([v for v, _ in scalars], dtype=int),
            np.array([c for _, c in scalars], dtype=int),
        )

    def _reserve(self, name: str, values: int, column: int, columns: int) -> slice:
        place = slice(self._size, self._size + values)
        self.values_of[name] = place
        self.columns_of[name] = slice(column, column + columns)
        self._size += values
        return place

    @property
    def columns(self) -> int:
        """Number of rates."""
        return len(self.names)

    @property
    def balls(self) -> list[slice]:
        """Columns of every ball: an angular velocity in the axes that turn with it."""
        return [slice(column, column + 3) for _, column in self.ball_places]

    def gathered(self, known: Mapping[str, Vector]) -> Vector:
        """The state with the given values by joint or drive name."""
        state = np.empty(self._size)
        for name, place in self.values_of.items():
            state[place] = known[name]
        return state

    def axis_values(self, state: Vector) -> dict[str, float]:
        """Value of every axis and drive that has a scalar one."""
        return {axis: float(state[k]) for axis, k in self.value.items()}

    def moved(self, state: Vector, step: Vector) -> Vector:
        """The state after a step."""
        turned = step * self.column_scale
        result = state.copy()
        values, columns = self.scalar_places
        result[values] += turned[columns]
        for value, column in self.ball_places:
            turn = _quaternion(turned[column : column + 3])
            result[value : value + 4] = _product(state[value : value + 4], turn)
        return result

    def step_between(self, state: Vector, other: Vector) -> Vector:
        """The step from one state to another; balls by the shorter way."""
        step = np.zeros(self.columns)
        values, columns = self.scalar_places
        step[columns] = other[values] - state[values]
        for value, column in self.ball_places:
            back = state[value : value + 4] * np.array([1.0, -1.0, -1.0, -1.0])
            step[column : column + 3] = _logarithm(_product(back, other[value : value + 4]))
        return step / self.column_scale

    def limits(self, mechanism: Mechanism) -> tuple[Vector, Vector]:
        """Lower and upper limits in the order of the rates [m, rad]; infinite where there are none."""
        lower, upper = np.full(self.columns, -np.inf), np.full(self.columns, np.inf)
        for joint, kind, _ in self.joints:
            if not kind.scalar_values:
                continue
            for axis, limit in zip(kind.axis_names(joint.name), joint.limits, strict=False):
                column = self.column[axis]
                lower[column] = -np.inf if limit.lower is None else limit.lower
                upper[column] = np.inf if limit.upper is None else limit.upper
        return lower, upper

    def scalar_values(self, state: Vector) -> Vector:
        """Values in the order of the rates; zero for rates of balls, which have no scalar value."""
        values, columns = self.scalar_places
        found = np.zeros(self.columns)
        found[columns] = state[values]
        return found


def unwound(kind: JointType, found: Vector, near: Vector) -> Vector:
    """Joint values with every angle on the turn, and every quaternion with the sign, nearest to `near`."""
    result = found.copy()
    index = 0
    for step in kind.steps:
        if step == "S":
            if float(result[index : index + 4] @ near[index : index + 4]) < 0.0:
                result[index : index + 4] *= -1.0
            index += 4
            continue
        if step[0] != "T":
            turns = round((float(near[index]) - float(found[index])) / (2 * math.pi))
            result[index] += 2 * math.pi * turns
        index += 1
    return result


def _quaternion(rotation: Vector) -> Vector:
    """Unit quaternion (w, x, y, z) of a rotation vector."""
    angle = float(np.linalg.norm(rotation))
    half = 0.5 * angle
    factor = 0.5 if angle == 0.0 else math.sin(half) / angle
    return np.array([math.cos(half), *(factor * rotation)])


def _logarithm(quaternion: Vector) -> Vector:
    """Rotation vector of a unit quaternion (w, x, y, z), at most half a turn."""
    if quaternion[0] < 0.0:
        quaternion = -quaternion
    sine = float(np.linalg.norm(quaternion[1:]))
    if sine == 0.0:
        return np.zeros(3)
    return quaternion[1:] * (2.0 * math.atan2(sine, float(quaternion[0])) / sine)


def _product(one: Vector, two: Vector) -> Vector:
    a, b, c, d = one
    w, x, y, z = two
    product = np.array(
        [
            a * w - b * x - c * y - d * z,
            a * x + b * w + c * z - d * y,
            a * y - b * z + c * w + d * x,
            a * z + b * y - c * x + d * w,
        ]
    )
    return product / math.sqrt(float(product @ product))
