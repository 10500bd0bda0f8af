"""The snapping test for geometry: axes on one body that are parallel, or meet, but for rounded numbers.

Typed digits leave the axes on a link a little off parallel, and lines that should meet a little apart, also
where no single number means another one.  What is within the doubt of the typed digits is put right, joint by
joint, and every change is told.  Bodies that are fixed to each other count as one.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from vincula.arrays import Matrix, Vector
from vincula.files.problems import Place, shown
from vincula.files.snapping import Snap
from vincula.files.snapping_frames import Move, Node, ends, moved_ends, moved_joints
from vincula.files.snapping_loops import closed_along, loop_joints
from vincula.mechanism.mechanism import Mechanism
from vincula.mechanism.parts import GROUND, Joint
from vincula.spatial.poses import Pose, rotation_about
from vincula.spatial.space import SPATIAL

_DIGITS: Final = 8.0
"""Half units of the last digit that two axes on a body may be off: each comes of a frame and a vector."""
_ROUNDING: Final = 1e-14
"""Axes are parallel, and lines meet, up to this; lengths relative to the distance of their points."""

_CLOSED: Final = 1e-12
"""Loops that are drawn closed up to this, times the length of the mechanism, are so but for rounding."""

_LINES: Final = frozenset({"revolute", "screw", "cylindrical"})
_DIRECTIONS: Final = _LINES | {"prismatic", "planar"}
_POINTS: Final = frozenset({"spherical", "universal"})


@dataclass(eq=False)
class _Axis:
    """One end of a joint as seen from its body: a line, a direction or a point.

    Attributes:
        joint: The joint.
        point: Origin of the joint frame.
        axis: Its axis; None for a point.
        turn: Rotation that has been put on top.
        shift: Translation that has been put on top [m].
        placed: Whether it has been compared with others, so that others follow it.
    """

    joint: Joint
    point: Vector
    axis: Vector | None
    turn: Matrix
    shift: Vector
    placed: bool = False

    @property
    def is_line(self) -> bool:
        """Whether it matters where the axis is."""
        return self.joint.type in _LINES

    def shift_to(self, point: Vector) -> Vector:
        """The shift after which it passes through a point."""
        arm = point - self.point
        return arm if self.axis is None else arm - self.axis * float(self.axis @ arm)


def snapped_axes(mechanism: Mechanism, file: str) -> tuple[Mechanism, list[Snap]]:
    """The mechanism with axes parallel and meeting that are so within its typed digits, and the changes.

    Where all loops are closed as drawn, bodies stay and both frames of a joint move together; otherwise
    each body is put right for itself and the bodies after it follow.

    Args:
        mechanism: What was read; its precision tells how rounded its numbers are.
        file: The file, for the changes.
    """
    known = mechanism.precision
    if mechanism.space is not SPATIAL or not (known.digits_angle or known.digits_length):
        return mechanism, []
    poses = mechanism.body_poses()
    closed = all(r.gap <= _CLOSED * mechanism.length for r in mechanism.residuals())
    rooms = _rigid_groups(mechanism, poses if closed else None)
    snapper = _Snapper(mechanism, file, together=closed)
    for members in rooms:
        snapper.parallel(members)
    for axis in snapper.axes.values():
        axis.placed = False
    for members in rooms:
        snapper.meeting(members)
    place = {body: pose for room in rooms for body, pose in room.items()}
    if not closed:
        snapper.along()
    moves = {node: Move(axis.turn, axis.shift) for node, axis in snapper.axes.items()}
    if closed:
        return moved_joints(mechanism, moves, poses), snapper.found
    moved = moved_ends(mechanism, moves, place) if snapper.found else mechanism
    loops = [closed_along(moved, joint, snapper.length) for joint in loop_joints(moved)]
    for joint, gap in filter(None, loops):
        typed = f"a loop that is open by {abs(gap):.2g} m along axes that are all parallel"
        snapper.found.append(Snap(Place(file), f"joint {shown(joint.name)}", "axis", typed, "closed"))
    shifted = {joint.name: joint for joint, _ in filter(None, loops)}
    joints = tuple(shifted.get(joint.name, joint) for joint in moved.joints)
    return (replace(moved, joints=joints) if shifted else moved), snapper.found


Room = dict[str, Pose]
"""Bodies that are one rigid piece, each with its pose in the coordinates of the piece."""


def _rigid_groups(mechanism: Mechanism, poses: dict[str, Pose] | None) -> list[Room]:
    """Bodies joined by fixed joints, loops among them; in ground axes where poses are given."""
    beside: dict[str, list[tuple[str, Pose]]] = {}
    for joint in mechanism.joints:
        if joint.type == "fixed":
            step = joint.frame_on_first @ joint.frame_on_second.inverse()
            beside.setdefault(joint.first, []).append((joint.second, step))
            beside.setdefault(joint.second, []).append((joint.first, step.inverse()))
    rooms: list[Room] = []
    seen: set[str] = set()
    for body in (GROUND, *mechanism.body):
        if body in seen:
            continue
        room = {body: Pose.identity(3) if poses is None else poses[body]}
        queue = [body]
        for name in queue:
            for other, step in beside.get(name, ()):
                if other not in room:
                    room[other] = room[name] @ step if poses is None else poses[other]
                    queue.append(other)
        seen.update(room)
        rooms.append(room)
    return rooms


class _Snapper:
    """Puts axes right, room by room."""

    def __init__(self, mechanism: Mechanism, file: str, *, together: bool) -> None:
        self._mechanism, self._file, self._together = mechanism, file, together
        known = mechanism.precision
        self._angle = _DIGITS * known.digits_angle
        self.length = _DIGITS * (known.digits_length + known.digits_angle * mechanism.length)
        self.axes: dict[Node, _Axis] = {}
        self.found: list[Snap] = []
        self._meets: list[Vector] = []
        self._points: dict[Node, list[Vector]] = {}

    def _node(self, joint: Joint, end: str) -> Node:
        return joint.name, "first" if self._together else end

    def _on(self, room: Room) -> list[_Axis]:
        """The axes on a rigid piece, those that others follow already in front."""
        found: dict[Node, _Axis] = {}
        for joint in self._mechanism.joints:
            if joint.type not in _DIRECTIONS | _POINTS:
                continue
            for end, body, frame in ends(joint):
                node = self._node(joint, end)
                if body in room and node not in found:
                    if node not in self.axes:
                        pose = room[body] @ frame
                        axis = pose.rotation[:, 2] if joint.type in _DIRECTIONS else None
                        self.axes[node] = _Axis(joint, pose.position, axis, np.eye(3), np.zeros(3))
                    found[node] = self.axes[node]
        return sorted(found.values(), key=lambda axis: not axis.placed)

    def parallel(self, room: Room) -> None:
        """Turn every axis that is nearly parallel to another one on the piece."""
        before: list[_Axis] = []
        for one in self._on(room):
            for other in before if one.axis is not None and not one.placed else ():
                if other.axis is None or one.axis is None:
                    continue
                across = np.cross(one.axis, other.axis)
                off = float(np.linalg.norm(across))
                if off <= self._angle:
                    if off > _ROUNDING:
                        one.turn = rotation_about(across / off, float(np.arcsin(off)))
                        if float(one.axis @ other.axis) < 0.0:
                            one.turn = one.turn.T
                        self._tell(one, other, f"an angle of {off:.2g} rad between the axes", "parallel")
                    one.axis = other.axis if float(one.axis @ other.axis) > 0.0 else -other.axis
                    break
            one.placed = True
            before.append(one)

    def meeting(self, room: Room) -> None:
        """Shift lines and points that nearly meet another one on the piece; to where others meet, if near."""
        before: list[_Axis] = []
        if not self._together:
            self._meets = []
        room_axes = self._on(room)
        for one in room_axes:
            for other in before:
                gap = _gap(one, other)
                arm = float(np.linalg.norm(one.point - other.point))
                if gap is None or not self._is_near(gap, arm):
                    continue
                at_meet = [shift for shift in map(one.shift_to, self._meets) if self._is_near(shift, arm)]
                self._shift(one, other, at_meet[0] if at_meet else gap, arm)
                if not at_meet and (point := _crossing(one, other)) is not None:
                    self._meets.append(point)
                break
            one.placed = True
            before.append(one)
        for node, axis in self.axes.items():
            if axis in room_axes and axis.is_line:
                rounding = _ROUNDING * 10.0 * self._mechanism.length
                on_it = [p for p in self._meets if float(np.linalg.norm(axis.shift_to(p))) <= rounding]
                self._points[node] = on_it

    def along(self) -> None:
        """Shift second ends along their lines, so that lines of both bodies meet in one point of the axis."""
        for joint in self._mechanism.joints:
            ends_of = [(joint.name, end) for end in ("first", "second")]
            if joint.type != "revolute" or not all(node in self._points for node in ends_of):
                continue
            first, second = (self.axes[node] for node in ends_of)
            if first.axis is None or second.axis is None:
                continue
            far = [float(first.axis @ (p - first.point)) for p in self._points[ends_of[0]]]
            near = [float(second.axis @ (p - second.point)) for p in self._points[ends_of[1]]]
            offs = [b - a for a in far for b in near if abs(b - a) <= self.length]
            off = min(offs, key=abs, default=0.0)
            if abs(off) > _ROUNDING * self._mechanism.length:
                second.shift = second.shift + off * second.axis
                owner, what = f"joint {shown(joint.name)}", "where other axes meet its own"
                typed = f"a distance of {abs(off):.2g} m along the axis"
                self.found.append(Snap(Place(self._file), owner, what, typed, "0"))

    def _is_near(self, gap: Vector, arm: float) -> bool:
        known = _DIGITS * self._mechanism.precision.digits_length
        return float(np.linalg.norm(gap)) <= known + self._angle * arm

    def _shift(self, one: _Axis, other: _Axis, gap: Vector, arm: float) -> None:
        size = float(np.linalg.norm(gap))
        if not one.placed and size > _ROUNDING * max(arm, self._mechanism.length):
            one.shift, one.point = gap, one.point + gap
            self._tell(one, other, f"a distance of {size:.2g} m between them", "meeting")

    def _tell(self, one: _Axis, other: _Axis, typed: str, meant: str) -> None:
        owner = f"joints {shown(other.joint.name)} and {shown(one.joint.name)}"
        self.found.append(Snap(Place(self._file), owner, "axes on one body", typed, meant))


def _gap(one: _Axis, other: _Axis) -> Vector | None:
    """The shift of `one` after which it meets `other`; None for two of which no place matters."""
    if not all(axis.is_line or axis.axis is None for axis in (one, other)):
        return None
    normal = _normal(one, other)
    if normal is not None:
        return normal * float(normal @ (other.point - one.point))
    if one.axis is None and other.axis is not None:
        return -other.shift_to(one.point)
    return one.shift_to(other.point)


def _normal(one: _Axis, other: _Axis) -> Vector | None:
    """Unit vector across two lines that are not parallel."""
    if one.axis is None or other.axis is None:
        return None
    across = np.cross(one.axis, other.axis)
    size = float(np.linalg.norm(across))
    return across / size if size > _ROUNDING else None


def _crossing(one: _Axis, other: _Axis) -> Vector | None:
    """Where two lines meet."""
    normal = _normal(one, other)
    if normal is None or one.axis is None or other.axis is None:
        return None
    along = np.cross(normal, one.axis)  # across `one`, in the plane of both
    far = float(along @ (one.point - other.point)) / float(along @ other.axis)
    point: Vector = other.point + far * other.axis
    return point
