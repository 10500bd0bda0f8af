"""What a map is drawn over: two motor values, or two coordinates of the reference member's pose."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from vincula.arrays import Vector
from vincula.errors import ModelError, UnknownNameError, listing
from vincula.maps.stacked_rows import Stack, products, quaternions
from vincula.mechanism.closure_problem import ClosureProblem
from vincula.mechanism.closure_solver import solve
from vincula.mechanism.closure_unknowns import MEMBER
from vincula.mechanism.configuration import Configuration
from vincula.mechanism.holding import Holding, holding, problem_for
from vincula.mechanism.kinematics import reference_position
from vincula.mechanism.mechanism import Mechanism
from vincula.mechanism.modes import motors_at
from vincula.mechanism.residuals import axis_linear, axis_values
from vincula.mechanism.watching import decided, locked
from vincula.numerics.lapack import svd
from vincula.numerics.rank import decide_rank
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

    Motors that are no variables stand where they start, as far as the variables leave them free to: over two
    joints that follow the motors (pitch and roll of an ankle) the motors follow instead, and of redundant
    motors some do.  The other coordinates of the member stand.  A member
    with no more freedoms than its reference point (a five-bar, a Delta, an arm of two joints in the plane) is
    looked at as that point: its orientation follows, and motors have authority if they move the point.

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
        self._motors = motors_at(mechanism, start)
        drives = motors_at(mechanism, start, [drive.name for drive in mechanism.drives])
        self._scalar = {**axis_values(mechanism, start), **{k: float(v) for k, v in drives.items()}}
        poses = mechanism.body_poses(start)
        self._point = reference_position(mechanism, poses)
        reference = mechanism.reference
        self._rotation = poses[reference.body].rotation if reference else np.eye(s)
        self._quaternion = Pose(self._rotation, self._point).as_quaternion_wxyz() if s == 3 else np.zeros(4)
        self.names = tuple(self._resolved(v.name) for v in self.variables)
        for name in self.names:
            self._refuse_unknown(name)
        if self.names[0] == self.names[1]:
            raise ModelError(f"{variables[0].name!r} and {variables[1].name!r} are one motor: choose two")
        of_member = [name in self._coordinates and name not in self._scalar for name in self.names]
        if any(of_member) and not all(of_member):
            raise ModelError(
                f"{listing(v.name for v in variables)}: one is a joint, the other a coordinate of the "
                "member: choose two of a kind"
            )
        self.of_member = all(of_member)
        self._standing = {} if self.of_member else self._motors_that_stand()
        self.whole_pose = self.of_member and self._freedom() > s
        self.point_counts = mechanism.reference is not None and self._freedom() <= s

    @property
    def units(self) -> tuple[str, str]:
        """Units of the two variables."""
        linear = axis_linear(self.mechanism)
        for drive in self.mechanism.drives:
            guessed = any(linear[axis] for axis in drive.drives)
            linear[drive.name] = guessed if drive.linear is None else drive.linear
        one, two = ("m" if linear.get(name, name in POSITIONS) else "rad" for name in self.names)
        return one, two

    def held_at(self, values: Sequence[float] | Vector) -> Holding:
        """What is held at a point of the plane."""
        asked = dict(zip(self.names, map(float, values), strict=True))
        if not self.of_member:
            return holding(self.mechanism, {**self._standing, **asked})
        point = self._point.copy()
        for k, name in enumerate(self._positions):
            point[k] = asked.get(name, point[k])
        if not self.whole_pose:
            return holding(self.mechanism, None, point)
        return holding(self.mechanism, None, Pose(self._turned(asked), point))

    def held_states(self, problem: ClosureProblem, states: Stack, values: Stack) -> Stack:
        """States with the two variables at other values; what else is held stays as it is.

        Args:
            problem: Equations in which everything held is an unknown.
            states: n states.
            values: n x 2 values of the variables.
        """
        result, where = states.copy(), problem.variables
        if not self.of_member:
            result[:, where.value[self.names[0]]] = values[:, 0]
            result[:, where.value[self.names[1]]] = values[:, 1]
            return result
        start, turns = where.values_of[MEMBER].start, np.zeros((len(states), 3))
        turning = False
        for name, column in zip(self.names, values.T, strict=True):
            if name in self._positions:
                result[:, start + self._positions.index(name)] = column
            elif name == "angle":
                result[:, start + 2] = column
            else:
                turning = True
                turns[:, self._turns.index(name)] = column
        if turning:
            before = np.broadcast_to(self._quaternion, (len(states), 4))
            result[:, start + 3 : start + 7] = products(quaternions(turns), before)
        return result

    def at_start(self) -> Vector:
        """The values of the two variables at the start."""
        found = [self._scalar.get(name, math.nan) for name in self.names]
        if self.of_member:
            known = dict(zip(self._positions, self._point, strict=True))
            known.update(dict.fromkeys(self._turns, 0.0))
            if len(self._point) == 2:
                known["angle"] = math.atan2(self._rotation[1, 0], self._rotation[0, 0])
            found = [float(known[name]) for name in self.names]
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

    def _motors_that_stand(self) -> dict[str, float | Vector]:
        """The motors beside the variables that are independent of them, in order, with their values."""
        names = [name for name in self._motors if name not in self.names]
        everything = holding(self.mechanism, {name: self._motors[name] for name in names})
        also = [*self.mechanism.active, *(name for name in self.names if name not in self.mechanism.active)]
        problem = problem_for(self.mechanism, everything, also)
        free, place = ~locked(problem), problem.variables
        state = problem.start(self.start)
        rng = np.random.default_rng(0)
        nudge = np.where(free, 0.02 * rng.uniform(-1.0, 1.0, problem.columns), 0.0)
        # Beside the start: at a singular one more would seem to depend on each other than do.
        beside = solve(problem, place.moved(state, nudge), free)
        jacobian = beside.equations.jacobian[:, free]
        _, values, right = svd(jacobian)
        motions = np.zeros((problem.columns, right.shape[1]))
        motions[free] = right
        motions = motions[:, decided(jacobian, beside.residual, values).rank :]
        rows = motions[[place.column[name] for name in self.names]]
        standing: dict[str, float | Vector] = {}
        for name in names:
            columns = [place.column[name]] if name in place.column else place.columns_of[name]
            more = np.vstack([rows, motions[columns]])
            before, after = (decide_rank(block, name="variables of a map").rank for block in (rows, more))
            if after - before == len(more) - len(rows):
                rows, standing[name] = more, self._motors[name]
        return standing

    def _freedom(self) -> int:
        """Dimension of the twists that the member can have at the start."""
        summary = self.mechanism.linearize(self.start).ledger.summary
        free = summary.coordinated + summary.indeterminacy
        s = len(self._point)
        if any(name in self._turns for name in self.names):
            return max(free, s + 1)
        return free

    def _resolved(self, name: str) -> str:
        """The axis or motor over several axes that a motor's name stands for."""
        known = name in self._scalar or name in self._coordinates
        return name if known else self.mechanism.motors.get(name, name)

    def _refuse_unknown(self, name: str) -> None:
        if name in self._scalar or name in self._coordinates:
            return
        motors = [m for m in self.mechanism.active if m in self._scalar]
        rest = [axis for axis in self._scalar if axis not in motors]
        raise UnknownNameError("variable of a map", name, [*motors, *self._coordinates, *rest])
