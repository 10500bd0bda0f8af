"""Following a mechanism along motor values or poses of its reference member, on one assembly branch."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from vincula.arrays import Vector
from vincula.errors import ModelError, listing
from vincula.mechanism.closure import asked_exactly, close
from vincula.mechanism.closure_solver import Limits
from vincula.mechanism.closure_unknowns import MEMBER
from vincula.mechanism.closure_values import Mask
from vincula.mechanism.configuration import Configuration
from vincula.mechanism.holding import (
    Holding,
    MotorValues,
    PoseOrPoint,
    asked,
    held_columns,
    holding,
    problem_for,
)
from vincula.mechanism.paths import Path, PathEvent, PathPoint, StopKind
from vincula.mechanism.residuals import CLOSED
from vincula.mechanism.singularities import singularities_at
from vincula.mechanism.stepping import Found, Stepper
from vincula.mechanism.tracks import Track, TrackPoint
from vincula.mechanism.watching import SingularityKind, watches

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism

Waypoint = MotorValues | PoseOrPoint
"""Motor values, or a pose of the reference member, or a position of the reference point."""


def follow(
    mechanism: Mechanism,
    path: Sequence[Waypoint],
    *,
    start: MotorValues | None = None,
    samples: int | None = None,
    limits: bool = True,
    through: Collection[SingularityKind] = (),
) -> Path:
    """Closed configurations along a path; see `Mechanism.follow`."""
    waypoints = [_waypoint(mechanism, w) for w in path]
    _same_names(waypoints)
    began = mechanism.configuration(start)
    if max((r.gap for r in mechanism.residuals(began)), default=0.0) > CLOSED * mechanism.length:
        began = close(mechanism, began, limits=limits)
    run = _Run(mechanism, waypoints[0], began, limits, through)
    return run.along(waypoints, samples)


def _waypoint(mechanism: Mechanism, waypoint: Waypoint) -> Holding:
    if isinstance(waypoint, Mapping):
        return holding(mechanism, waypoint)
    return holding(mechanism, None, waypoint)


def _same_names(waypoints: Sequence[Holding]) -> None:
    if not waypoints:
        raise ModelError("a path needs at least one waypoint: motor values or poses to go to")
    first = waypoints[0]
    for waypoint in waypoints:
        if waypoint.names != first.names or (waypoint.pose is None) != (first.pose is None):
            raise ModelError(
                "every waypoint of a path must give the same things in the same order: "
                f"{listing(first.names)}; one gives {listing(waypoint.names)}"
            )


class _Run:
    """One following: the equations, the stepper, and the points recorded so far."""

    def __init__(
        self,
        mechanism: Mechanism,
        first: Holding,
        began: Configuration,
        limits: bool,
        through: Collection[SingularityKind],
    ) -> None:
        self.mechanism, self.held = mechanism, first
        self.motors = _motors(mechanism, first)
        member = mechanism.reference is not None
        limited = [
            axis
            for joint in mechanism.joints
            if limits and joint.limits and not joint.closure
            for axis in mechanism.type_of(joint).axis_names(joint.name)
        ]
        also = tuple(dict.fromkeys([*self.motors, *mechanism.active, *limited]))
        self.problem = problem_for(mechanism, first, also, member=member)
        fixed = held_columns(self.problem, first)
        if not first.member:
            for name in mechanism.active:
                fixed[self.problem.variables.column[name]] = True
        self.free: Mask = ~fixed
        bounds = Limits(*self.problem.variables.limits(mechanism)) if limits else None
        watching = watches(self.problem, self.motors, fixed)
        self.stepper = Stepper(self.problem, self.free, watching, self.motors, bounds, through)
        self.state = self.problem.start(began)
        self.equations = self.problem.equations(self.state)
        self.last = began
        self.stepper.ranks_at(self.equations)
        self.travelled = 0.0
        self.points: list[PathPoint] = []
        self.passed: list[PathEvent] = []

    def along(self, waypoints: Sequence[Holding], samples: int | None) -> Path:
        """The path through the waypoints, recorded there or at evenly spaced samples."""
        goals = self._goals(waypoints)
        lengths = [float(np.linalg.norm(way)) for way in self._ways(goals)]
        total = sum(lengths)
        marks = None if samples is None else np.linspace(0.0, total, samples + 1)[1:]
        self._record(TrackPoint(self.state, 0.0, self.equations))
        stopped: PathEvent | None = None
        for k, (goal, length) in enumerate(zip(goals, lengths, strict=True)):
            if length == 0.0:
                if k > 0 and marks is None:
                    self.points.append(self.points[-1])
                continue
            inside = np.zeros(0) if marks is None else marks - self.travelled
            slack = 1e-12 * total
            own = [float(m) for m in inside[(inside > slack) & (inside < length - slack)]]
            ends_here = marks is None or bool((np.abs(inside - length) <= slack).any())
            stopped = self._track(goal, [*own, length], ends_here)
            if stopped is not None:
                break
        return Path(
            self.mechanism,
            self.held.names,
            tuple(self.points),
            total,
            stopped,
            tuple(self.passed),
            self.stepper.steps,
        )

    def _goals(self, waypoints: Sequence[Holding]) -> list[Vector]:
        """States with the held values of every waypoint, the rest as at the start."""
        return [asked(self.problem, self.state, waypoint) for waypoint in waypoints]

    def _ways(self, goals: Sequence[Vector]) -> list[Vector]:
        ways = []
        for one, two in zip([self.state, *goals[:-1]], goals, strict=True):
            way = self.problem.variables.step_between(one, two)
            way[self.free] = 0.0
            ways.append(way)
        return ways

    def _track(self, goal: Vector, marks: list[float], record_end: bool) -> PathEvent | None:
        way = self.problem.variables.step_between(self.state, goal)
        way[self.free] = 0.0
        track = Track(self.problem, self.free, way, self.stepper.rank)
        point = TrackPoint(self.state, 0.0, self.equations)
        for mark in marks:
            last = mark == marks[-1]
            point, found = self.stepper.follow(track, point, mark)
            self.passed += [self._event(one) for one in self.stepper.passed]
            self.stepper.passed.clear()
            if found is not None:
                event = self._event(found)
                self._record(point, event.configuration)
                return event
            if last:
                exact = asked_exactly(self.problem, point.state, goal, self.free)
                point = TrackPoint(exact, point.travelled, point.equations)
            if not last or record_end:
                self._record(point)
        self.travelled += track.length
        self.state, self.equations = point.state, point.equations
        return None

    def _record(self, point: TrackPoint, known: Configuration | None = None) -> None:
        q = known or self.problem.configuration(point.state, self.last)
        self.last = q
        residual = point.residual * self.problem.length
        parameter = self.travelled + point.travelled
        self.points.append(PathPoint(parameter, q, residual, self.stepper.margin(point)))

    def _event(self, found: Found) -> PathEvent:
        q = self.problem.configuration(found.point.state, self.last)
        parameter = self.travelled + found.point.travelled
        kind: StopKind = "lost"
        singular = found.singularities
        axis = ""
        if found.kind == "singularity":
            kind, reason = "singularity", "; ".join(str(s) for s in singular)
        elif found.kind == "limit":
            kind, axis = "limit", self.problem.variables.names[found.column]
            reason = f"{axis} reaches its limit {found.bound:.6g}"
        else:
            singular = singularities_at(self.mechanism, q, self.motors)
            kind = "singularity" if singular else "incompatible" if found.kind == "incompatible" else "lost"
            reason = "; ".join(str(s) for s in singular) or _without_singularity(found.kind, self.held)
        where = self._held_values(found.point)
        passable = found.kind == "singularity" and not found.turns
        return PathEvent(kind, parameter, q, singular, axis, found.bound, f"{reason}, at {where}", passable)

    def _held_values(self, point: TrackPoint) -> str:
        """Where the motors and the held pose stand, for messages."""
        where = self.problem.variables
        shown = []
        if self.held.member:
            values = point.state[where.values_of[MEMBER]]
            values = values if self.held.pose is not None else values[: self.mechanism.space.translations]
            shown.append(f"{'pose' if self.held.pose is not None else 'point'} {_numbers(values)}")
        joints = [name for name in self.held.joints if name not in where.value]
        shown += [f"{name} = {_numbers(point.state[where.values_of[name]])}" for name in joints]
        shown += [f"{n} = {_numbers([point.state[where.value[n]]])}" for n in self.motors if n in where.value]
        return listing(shown, 8)


def _numbers(values: Sequence[float] | Vector) -> str:
    return " ".join(f"{float(v):.9g}" for v in values)


def _without_singularity(kind: str, held: Holding) -> str:
    if kind == "incompatible":
        return (
            f"the loops do not let {listing(held.names)} move together that way: too much is held, "
            "or active motors that the path does not name stand still"
        )
    return "the branch could not be followed any further"


def _motors(mechanism: Mechanism, held: Holding) -> tuple[str, ...]:
    """Axes and drives that count as motors: those of a path of motor values, and the active ones."""
    named: list[str] = []
    for joint in held.joints:
        named += mechanism.type_of(mechanism.joint[joint]).axis_names(joint)
    named += [*held.axes, *held.drives]
    return tuple(dict.fromkeys([*named, *mechanism.active]))
