"""A spanning tree of a mechanism and the loops that are left, for formats that hold trees.

Everything is measured in ground axes at the home configuration: a link is placed by elementary
motions (turn, slide, screw, ball) from its parent outwards, each about an axis through a point.  The
product of their displacements is the motion of the joint, whatever values it has at home.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Literal

import numpy as np

from vincula.arrays import Matrix, Vector
from vincula.files.written import MISFIT, free_name
from vincula.mechanism.joint_types import motion, screws, values_between
from vincula.mechanism.parts import GROUND, Body, Joint, Limits
from vincula.spatial.poses import Pose

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism

_NO_LIMITS: Final = Limits()


@dataclass(frozen=True, slots=True, eq=False)
class Motion:
    """An elementary motion.

    Attributes:
        name: Name of the axis.
        kind: What it does.
        axis: Unit vector in ground axes at home.
        point: A point of the axis in ground axes at home [m].
        index: Which configuration value of its joint it is.
        lead: Advance of a screw a turn [m].
        limits: Limits of the axis.
        home: Value at home [rad or m].
        sign: -1 in a branch that is walked from second to first body, else 1.
    """

    name: str
    kind: Literal["turn", "slide", "screw", "ball"]
    axis: Vector
    point: Vector
    index: int = 0
    lead: float = 0.0
    limits: Limits = _NO_LIMITS
    home: float = 0.0
    sign: float = 1.0


@dataclass(frozen=True, slots=True, eq=False)
class Branch:
    """A link and the joint that places it.

    Attributes:
        link: The link.
        parent: Its parent link.
        joint: The joint between them.
        forward: Whether the parent is the joint's first body.
        motions: Elementary motions, the parent's first.
    """

    link: str
    parent: str
    joint: Joint
    forward: bool
    motions: tuple[Motion, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Loop:
    """A loop that is closed between two frames.

    Attributes:
        name: Its name.
        type: Joint type that stands for it.
        first: First link.
        second: Second link.
        on_first: Pose of the frame on the first link.
        on_second: Pose of the frame on the second link.
        second_axis: Second axis of a universal joint in the frame.
        open: Whether the frames are apart at home.
        carried: Whether the loop joint itself is a branch, to a link that is fixed to the second.
    """

    name: str
    type: str
    first: str
    second: str
    on_first: Pose
    on_second: Pose
    second_axis: Vector
    open: bool
    carried: bool = False


_USED, _TREE, _OTHER, _OPEN, _IMPLICIT = range(5)


class WrittenTree:
    """Tree, loops and added links of a mechanism.

    Args:
        mechanism: A spatial mechanism.
        loops: Joint types that the format can close a loop with; the others are carried: they become
            branches to an added link, which is fixed to the second body.

    Attributes:
        poses: Pose of every link and the ground in ground axes at home.
        branches: Branches, parents before their children.
        loops: The loops.
        used: Names of the axes that are used one by one: motors, locks, couplings, drives.
        added: Links that are no bodies of the mechanism.
    """

    def __init__(self, mechanism: Mechanism, loops: Iterable[str]) -> None:
        self._mechanism, self._closing = mechanism, tuple(loops)
        self.poses: dict[str, Pose] = {GROUND: Pose.identity(3)}
        self.poses |= {body.name: body.pose for body in mechanism.bodies}
        self.used = set(mechanism.active) | set(mechanism.lock)
        self.used |= {axis for coupling in mechanism.couplings for axis in coupling.axes}
        self.used |= {axis for drive in mechanism.drives for axis in drive.drives}
        self.added: list[str] = []
        self._taken = {GROUND, "world", *self.poses, *(joint.name for joint in mechanism.all_joints)}
        self._gaps = {r.name: r.gap for r in mechanism.residuals() if r.kind == "loop"}
        chosen = self._choose()
        self.branches: list[Branch] = []
        self._grow(chosen)
        self.loops: list[Loop] = []
        for joint in mechanism.all_joints:
            if joint.name not in chosen and joint.type != "free":
                self._close(joint)

    @property
    def free_loops(self) -> list[str]:
        """Joints with all freedoms between bodies that are placed otherwise: they hold nothing."""
        placed = {branch.joint.name for branch in self.branches}
        return [j.name for j in self._mechanism.all_joints if j.type == "free" and j.name not in placed]

    def is_used(self, joint: Joint) -> bool:
        """Whether an axis of a joint is used by itself."""
        return bool(self.used & set(self._mechanism.type_of(joint).axis_names(joint.name)))

    def body(self, name: str) -> Body:
        """A link of the tree as a body."""
        return Body(name, self.poses[name])

    def _choose(self) -> set[str]:
        """Joints of the tree: those with motors and couplings first, then those of the mechanism's own."""
        own = {joint.name for joint, _ in self._mechanism.tree}
        declared = {joint.name for joint in self._mechanism.joints}

        def rank(joint: Joint) -> int:
            if joint.name not in declared:
                return _IMPLICIT
            if self._open(joint.name):
                return _OPEN
            if self.is_used(joint):
                return _USED
            return _TREE if joint.name in own else _OTHER

        group = {name: name for name in self.poses}

        def root(name: str) -> str:
            while group[name] != name:
                name = group[name]
            return name

        chosen = set()
        for joint in sorted((j for j in self._mechanism.all_joints if not j.closure), key=rank):
            one, other = root(joint.first), root(joint.second)
            if one != other:
                group[one] = other
                chosen.add(joint.name)
        return chosen

    def _open(self, joint: str) -> bool:
        return self._gaps.get(joint, 0.0) > MISFIT * self._mechanism.length

    def _grow(self, chosen: set[str]) -> None:
        joints = [joint for joint in self._mechanism.all_joints if joint.name in chosen]
        reached, queue = {GROUND}, [GROUND]
        for parent in queue:
            for joint in joints:
                forward = joint.first == parent
                link = joint.second if forward else joint.first
                if parent in (joint.first, joint.second) and link not in reached:
                    reached.add(link)
                    queue.append(link)
                    second = self.poses[joint.second] @ joint.frame_on_second
                    self.branches.append(
                        Branch(link, parent, joint, forward, self._motions(joint, second, forward))
                    )

    def _motions(self, joint: Joint, second: Pose, forward: bool) -> tuple[Motion, ...]:
        """Elementary motions of a joint whose frame B stands at `second`."""
        kind = self._mechanism.type_of(joint)
        first = self.poses[joint.first] @ joint.frame_on_first
        lines = screws(kind, joint.lead, joint.second_axis)
        names = kind.axis_names(joint.name)
        sign = 1.0 if forward else -1.0
        found: list[Motion] = []
        axis = value = 0
        for step in kind.steps:
            line = lines[axis]
            direction = sign * ((second if line.on_second else first).rotation @ line.axis)
            what: Literal["turn", "slide", "screw", "ball"] = "turn"
            if step == "S":
                what, direction = "ball", second.rotation[:, 2]
            elif step == "H":
                what = "screw"
            elif step[0] == "T":
                what = "slide"
            limits = joint.limits[axis] if axis < len(joint.limits) else _NO_LIMITS
            home = joint.home[value] if joint.home and step != "S" else 0.0
            found.append(
                Motion(names[axis], what, direction, second.position, value, joint.lead, limits, home, sign)
            )
            axis += 3 if step == "S" else 1
            value += 4 if step == "S" else 1
        return tuple(found if forward else reversed(found))

    def _close(self, joint: Joint) -> None:
        """A loop between two frames, or a branch to an added link that is fixed to the second body."""
        apart = self._open(joint.name)
        if joint.type in self._closing and not self.is_used(joint):
            self.loops.append(
                Loop(joint.name, joint.type, joint.first, joint.second, joint.frame_on_first,
                     joint.frame_on_second, joint.second_axis, apart)
            )  # fmt: skip
            return
        second = self.poses[joint.second] @ joint.frame_on_second
        if apart:
            first = self.poses[joint.first] @ joint.frame_on_first
            kind = self._mechanism.type_of(joint)
            value = (
                np.array(joint.home) if joint.home else values_between(kind, first, second, joint.second_axis)
            )
            second = first @ motion(kind, value, joint.lead, joint.second_axis)
        link = free_name(f"{joint.name}.loop", self._taken)
        self.added.append(link)
        self.poses[link] = second
        self.branches.append(
            Branch(link, joint.first, joint, True, self._motions(joint, second, forward=True))
        )
        self.loops.append(
            Loop(free_name(f"{joint.name}.closed", self._taken), "fixed", link, joint.second,
                 Pose.identity(3), joint.frame_on_second, joint.second_axis, apart, carried=True)
        )  # fmt: skip

    def unfolded(self, branch: Branch) -> tuple[Motion, ...]:
        """The motions of a branch, a ball as three turns about the axes of its child frame.

        At home their rates are the components of the ball's angular velocity, under the same names.
        """
        found: list[Motion] = []
        names = self._mechanism.type_of(branch.joint).axis_names(branch.joint.name)
        for step in branch.motions:
            if step.kind != "ball":
                found.append(step)
                continue
            frame = self.ball_axes(branch)
            turns = [
                Motion(name, "turn", step.sign * axis, step.point, step.index, sign=step.sign)
                for name, axis in zip(names[names.index(step.name) :], frame.T, strict=False)
            ]
            found += turns if branch.forward else reversed(turns)
        return tuple(found)

    def ball_axes(self, branch: Branch) -> Matrix:
        """The axes of a ball's child frame in ground axes at home, as columns."""
        if branch.link in self.added:
            return self.poses[branch.link].rotation
        return (self.poses[branch.joint.second] @ branch.joint.frame_on_second).rotation


def children(branches: Iterable[Branch]) -> Mapping[str, list[Branch]]:
    """Branches by their parent link."""
    below: dict[str, list[Branch]] = {}
    for branch in branches:
        below.setdefault(branch.parent, []).append(branch)
    return below
