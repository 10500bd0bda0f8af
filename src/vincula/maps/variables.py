"""What a map is drawn over: two motor values, or two coordinates of the reference member's pose."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from vincula.arrays import Vector
from vincula.errors import ModelError, UnknownNameError, listing
from vincula.mechanism.configuration import Configuration
from vincula.mechanism.holding import Holding, holding
from vincula.mechanism.kinematics import reference_position
from vincula.mechanism.mechanism import Mechanism
from vincula.mechanism.modes import motors_at
from vincula.mechanism.residuals import axis_linear, axis_values
from vincula.spatial.poses import Pose, rotation_about

POSITIONS: Final = ("x", "y", "z")
"""Coordinates of the reference point in ground axes [m]."""
TURNS: Final = {2: ("angle",), 3: ("rx", "ry", "rz")}
"""Turns of the member: its angle in the plane; in space a rotation vector from the start [rad]."""
MOST: Final = 2000
"""Most points along one variable."""


@dataclass(frozen=True, slots=True)
class Variable:
    """One variable of a map and where it is looked at.

    Attributes:
        name: A motor or joint axis with a value, or x, y, z, angle, rx, ry, rz of the reference member.
        low: Smallest value [m, rad].
        high: Largest value.
        count: Number of values, at least two.
    """

    name: str
    low: float
    high: float
    count: int = 61

    def __post_init__(self) -> None:
        if not (math.isfinite(self.low) and math.isfinite(self.high) and self.low < self.high):
            raise ModelError(
                f"variable {self.name!r}: {self.low:g} to {self.high:g} is no range: give the smaller first"
            )
        if not 2 <= self.count <= MOST:
            raise ModelError(f"variable {self.name!r}: {self.count} values; choose 2 to {MOST}")

    @property
    def values(self) -> Vector:
        """Its values, evenly spaced."""
        return np.linspace(self.low, self.high, self.count)


class Plane:
    """Two variables of a mechanism, and what is held at a point of their plane.

    Motors that are no variables stand where they start; so do the other coordinates of the member.

    Args:
        mechanism: The mechanism.
        variables: The two.
        start: A closed configuration to start from.

    Raises:
        UnknownNameError: A name that is no motor, axis or coordinate.
        ModelError: Two variables of one name, or motors and coordinates of the member together.
    """

    def __init__(self, mechanism: Mechanism, variables: Sequence[Variable], start: Configuration) -> None:
        if len(variables) != 2:
            raise ModelError(f"a map is drawn over two variables, got {len(variables)}")
        self.mechanism, self.variables, self.start = mechanism, tuple(variables), start
        if variables[0].name == variables[1].name:
            raise ModelError(f"both variables are {variables[0].name!r}: choose two")
        s = mechanism.space.translations
        self._positions, self._turns = POSITIONS[:s], TURNS[s]
        self._scalar = axis_values(mechanism, start)
        self._motors = motors_at(mechanism, start)
        poses = mechanism.body_poses(start)
        self._point = reference_position(mechanism, poses)
        reference = mechanism.reference
        self._rotation = poses[reference.body].rotation if reference else np.eye(s)
        of_member = [v.name in self._coordinates and v.name not in self._scalar for v in variables]
        for variable in variables:
            self._refuse_unknown(variable.name)
        if any(of_member) and not all(of_member):
            raise ModelError(
                f"{listing(v.name for v in variables)}: one is a joint, the other a coordinate of the "
                "member: choose two of a kind"
            )
        self.of_member = all(of_member)
        self.whole_pose = self.of_member and self._freedom() > s

    @property
    def units(self) -> tuple[str, str]:
        """Units of the two variables."""
        linear = axis_linear(self.mechanism)
        one, two = ("m" if linear.get(v.name, v.name in POSITIONS) else "rad" for v in self.variables)
        return one, two

    def held_at(self, values: Sequence[float] | Vector) -> Holding:
        """What is held at a point of the plane."""
        asked = dict(zip((v.name for v in self.variables), map(float, values), strict=True))
        if not self.of_member:
            return holding(self.mechanism, {**self._motors, **asked})
        point = self._point.copy()
        for k, name in enumerate(self._positions):
            point[k] = asked.get(name, point[k])
        if not self.whole_pose:
            return holding(self.mechanism, None, point)
        return holding(self.mechanism, None, Pose(self._turned(asked), point))

    def at_start(self) -> Vector:
        """The values of the two variables at the start."""
        found = [self._scalar.get(v.name, math.nan) for v in self.variables]
        if self.of_member:
            known = dict(zip(self._positions, self._point, strict=True))
            known.update(dict.fromkeys(self._turns, 0.0))
            if len(self._point) == 2:
                known["angle"] = math.atan2(self._rotation[1, 0], self._rotation[0, 0])
            found = [float(known[v.name]) for v in self.variables]
        return np.array(found)

    def _turned(self, asked: dict[str, float]) -> Vector:
        if len(self._point) == 2:
            angle = asked.get("angle")
            return self._rotation if angle is None else Pose.from_angle(angle).rotation
        vector = np.array([asked.get(name, 0.0) for name in self._turns])
        size = float(np.linalg.norm(vector))
        return self._rotation if size == 0.0 else rotation_about(vector / size, size) @ self._rotation

    @property
    def _coordinates(self) -> tuple[str, ...]:
        return (*self._positions, *self._turns) if self.mechanism.reference else ()

    def _freedom(self) -> int:
        """Dimension of the twists that the member can have at the start."""
        summary = self.mechanism.linearize(self.start).ledger.summary
        free = summary.coordinated + summary.indeterminacy
        s = len(self._point)
        if any(v.name in self._turns for v in self.variables):
            return max(free, s + 1)
        return free

    def _refuse_unknown(self, name: str) -> None:
        if name in self._scalar or name in self._coordinates:
            return
        motors = [m for m in self.mechanism.active if m in self._scalar]
        rest = [axis for axis in self._scalar if axis not in motors]
        raise UnknownNameError("variable of a map", name, [*motors, *self._coordinates, *rest])
