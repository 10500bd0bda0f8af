"""From links and joints as robot files give them to a mechanism: one draft for URDF and SDF.

A link may be child of several joints: the first that reaches it from the root places it, the others
close loops.  Everything is placed at zero joint values, as those formats define.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from vincula.arrays import Vector
from vincula.errors import ModelError, listing
from vincula.files.problems import Place, Problems, shown
from vincula.mechanism.joint_types import joint_type
from vincula.mechanism.mechanism import Mechanism
from vincula.mechanism.parts import GROUND, Body, Coupling, Drive, Frame, Joint, Limits, Precision
from vincula.spatial.poses import Pose, frame_with_z
from vincula.spatial.space import SPATIAL

WORLD = "world"
"""What robot files call the fixed surroundings."""


@dataclass(frozen=True, slots=True, eq=False)
class DraftJoint:
    """A joint of a robot file.

    Attributes:
        name: Its name.
        type: Name of the joint type here (revolute for continuous, free for floating ...).
        parent: Parent link.
        child: Child link.
        on_parent: Pose of the joint frame in the parent link.
        on_child: Pose of the joint frame in the child link.
        axis: Unit axis in the joint frame (first axis of a universal joint, normal of a planar one).
        second_axis: Second axis of a universal joint in the joint frame.
        lead: Advance of a screw a turn [m].
        limits: Limits by axis.
        closure: True for what only closes a loop and has no value in the file.
        rows_only: True for a closure that stands for its rows alone (no joint of its own).
        place: Where it is written.
    """

    name: str
    type: str
    parent: str
    child: str
    on_parent: Pose
    on_child: Pose
    axis: Vector | None = None
    second_axis: Vector | None = None
    lead: float = 0.0
    limits: tuple[Limits, ...] = ()
    closure: bool = False
    rows_only: bool = False
    place: Place = field(default_factory=lambda: Place(""))

    def resolved(self, closure: bool, names: dict[str, str]) -> Joint:
        """The joint of the mechanism."""
        turn = np.eye(3)
        second = np.array([1.0, 0.0, 0.0])
        if self.axis is not None:
            turn = frame_with_z(self.axis, self.second_axis)
        if self.second_axis is not None:
            second = turn.T @ self.second_axis
        aligned = Pose(turn, np.zeros(3))
        home = () if closure else tuple(float(v) for v in joint_type(self.type, SPATIAL).zero)
        return Joint(
            name=self.name,
            type=self.type,
            first=names[self.parent],
            second=names[self.child],
            frame_on_first=self.on_parent @ aligned,
            frame_on_second=self.on_child @ aligned,
            home=home,
            lead=self.lead,
            second_axis=second,
            limits=self.limits,
            closure=closure,
            cut="contact" if self.rows_only else None,
        )


@dataclass
class RobotDraft:
    """What a reader of a robot file has found so far.

    Attributes:
        file: The file, for messages.
        problems: Where problems go.
        name: Name of the robot.
        links: Links by name, with their places.
        joints: Joints, loops included.
        frames: Named frames on links.
        couplings: Couplings.
        drives: Motors that drive combinations of joints.
        motors: Joint or drive by motor name; None while the file names no motor at all.
        passive: Joints marked as passive.
        digits_length: Largest half unit of a typed length [m].
        digits_angle: Largest half unit of a typed angle or direction [rad].
        coupling_plugins: Plugins of a simulator that couple joints, which no reader loads.
        notes: Facts that the reader of a result must know.
        when_placed: What can be added only once every link has its drawn pose: called with the poses.
        ground: The link that is the ground; None for the one link that is nobody's child.
        directed: True where a joint places its child (URDF), False where it can place either of its
            links (SDF).
    """

    file: str
    problems: Problems
    name: str = "robot"
    links: dict[str, Place] = field(default_factory=dict)
    joints: list[DraftJoint] = field(default_factory=list)
    frames: list[Frame] = field(default_factory=list)
    couplings: list[Coupling] = field(default_factory=list)
    drives: list[Drive] = field(default_factory=list)
    motors: dict[str, str] | None = None
    passive: set[str] = field(default_factory=set)
    digits_length: float = 0.0
    digits_angle: float = 0.0
    coupling_plugins: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    when_placed: list[Callable[[Mapping[str, Pose]], None]] = field(default_factory=list)
    ground: str | None = None
    directed: bool = True

    def has_link(self, name: str, place: Place, *, what: str) -> bool:
        """Whether a link exists; adds a problem if not."""
        if name in self.links:
            return True
        self.problems.add(
            place, f"{what} names the link {shown(name)}, which does not exist", name=name, choices=self.links
        )
        return False

    def mechanism(self) -> Mechanism:
        """The mechanism of the draft.

        Raises:
            FileError: No root, several roots, islands, or anything else a mechanism cannot be.
        """
        self._check_names()
        self._check_mimics()
        self.problems.refuse_if_any()
        root = self.ground = self.ground or self._root()
        tree = self._tree(root)
        self.problems.refuse_if_any()
        if self.when_placed:
            placed = self._poses(root, tree)
            for add in self.when_placed:
                add(placed)
            self._check_names()
            tree = self._tree(root)
            self.problems.refuse_if_any()
        self._note_parents()
        self._note_plugins()
        names = self._names(root)
        poses = self._poses(root, tree)
        joints = [joint.resolved(joint.closure, names) for joint in self.joints]
        frames = [Frame(f.name, names.get(f.body, f.body), f.pose) for f in self.frames]
        if root != WORLD and root not in (frame.name for frame in frames):
            frames.append(Frame(root, GROUND, Pose.identity(3)))
        motors = self._motors()
        try:
            mechanism = Mechanism(
                space=SPATIAL,
                bodies=tuple(Body(names[link], poses[link]) for link in self.links if link != root),
                joints=tuple(joints),
                couplings=tuple(self.couplings),
                drives=tuple(self.drives),
                frames=tuple(frames),
                name=self.name,
                precision=Precision(self.digits_length, self.digits_angle),
                motors=motors,
            )
            return mechanism.with_active(list(dict.fromkeys(motors.values())))
        except ModelError as error:
            self.problems.add(Place(self.file), str(error))
            self.problems.refuse()

    def _names(self, root: str) -> dict[str, str]:
        """Names of the bodies: those of the links, but that the root is the ground, and nothing else is."""
        names = {link: link for link in self.links} | {root: GROUND}
        if root != GROUND and GROUND in names:
            other = f"{GROUND}_link"
            while other in names:
                other += "'"
            names[GROUND] = other
            self.notes.append(f"the link {GROUND} is called {other} here: {GROUND} is the fixed body")
        return names

    def _check_names(self) -> None:
        seen: dict[str, Place] = {}
        for joint in self.joints:
            if joint.name in seen:
                self.problems.add(
                    joint.place,
                    f"the joint name {shown(joint.name)} is used twice (line {seen[joint.name].line})",
                )
            seen[joint.name] = joint.place
            if joint.parent == joint.child:
                self.problems.add(
                    joint.place, f"joint {shown(joint.name)} connects {shown(joint.parent)} to itself"
                )

    def _check_mimics(self) -> None:
        """A joint that follows itself over others has no leader."""
        mimics = [c.axes for c in self.couplings if c.name.startswith("mimic:") and len(c.axes) > 1]
        follows = {axes[0]: axes[1] for axes in mimics}
        places = {joint.name: joint.place for joint in self.joints}
        for start in follows:
            chain = [start]
            while (leader := follows.get(chain[-1])) is not None and leader not in chain:
                chain.append(leader)
            if leader == start:
                place = places.get(start, Place(self.file))
                self.problems.add(place, f"joints mimic each other in a circle: {', '.join(chain)}")
                return

    def _note_parents(self) -> None:
        """In URDF a link with two parents is a surprise: most other readers drop one of them."""
        if not self.directed:
            return
        parents: dict[str, list[str]] = {}
        for joint in self._tree_joints():
            parents.setdefault(joint.child, []).append(joint.name)
        for link, names in parents.items():
            if len(names) > 1:
                self.notes.append(
                    f"link {link} is the child of {len(names)} joints ({', '.join(names)}): read as a closed "
                    "loop, which other readers of URDF files may not do"
                )

    def _note_plugins(self) -> None:
        if self.coupling_plugins:
            self.notes.append(
                f"plugins that couple joints are not read: {listing(self.coupling_plugins, 3)}; "
                "write <mimic> in the joints instead"
            )

    def _tree_joints(self) -> list[DraftJoint]:
        return [j for j in self.joints if not j.closure]

    def _root(self) -> str:
        """The link that is nobody's child."""
        if not self.links:
            self.problems.add(Place(self.file), "there is no link")
            self.problems.refuse()
        children = {j.child for j in self._tree_joints()}
        roots = [link for link in self.links if link not in children]
        if WORLD in roots:
            return WORLD
        if not roots:
            self.problems.add(
                Place(self.file), "every link is the child of a joint: no link can be the ground"
            )
            self.problems.refuse()
        if len(roots) > 1:
            self._refuse_roots(roots)
        return roots[0]

    def _refuse_roots(self, roots: Sequence[str]) -> None:
        for link in roots[1:]:
            self.problems.add(
                self.links[link],
                f"link {shown(link)} is connected to nothing above it, and so is {shown(roots[0])}: "
                "a robot has one root link",
            )
        self.problems.refuse()

    def _tree(self, root: str) -> list[tuple[DraftJoint, bool]]:
        """Joints that place a link and whether it is their child; in the order of the file, breadth first."""
        beside: dict[str, list[tuple[DraftJoint, bool]]] = {}
        for joint in self._tree_joints():
            beside.setdefault(joint.parent, []).append((joint, True))
            if not self.directed:
                beside.setdefault(joint.child, []).append((joint, False))
        reached, tree, queue = {root}, [], [root]
        for link in queue:
            for joint, forward in beside.get(link, ()):
                other = joint.child if forward else joint.parent
                if other not in reached:
                    reached.add(other)
                    tree.append((joint, forward))
                    queue.append(other)
        for link, place in self.links.items():
            if link not in reached:
                self.problems.add(place, f"no chain of joints leads from {shown(root)} to link {shown(link)}")
        return tree

    def _poses(self, root: str, tree: Sequence[tuple[DraftJoint, bool]]) -> dict[str, Pose]:
        poses = {root: Pose.identity(3)}
        for joint, forward in tree:
            step = joint.on_parent @ joint.on_child.inverse()
            if forward:
                poses[joint.child] = poses[joint.parent] @ step
            else:
                poses[joint.parent] = poses[joint.child] @ step.inverse()
        return poses

    def _motors(self) -> dict[str, str]:
        """Motors by name; where the file names none, every joint that nothing marks as passive but balls."""
        if self.motors is not None:
            return {name: axis for name, axis in self.motors.items() if axis not in self.passive}
        followers = {axis for coupling in self.couplings for axis in list(coupling.rates)[:1]}
        followers |= {axis.rpartition(".")[0] for axis in followers}
        moving = [
            j.name
            for j in self.joints
            if not j.closure
            and j.type not in ("fixed", "free", "spherical")
            and j.name not in self.passive | followers
        ]
        if moving and not self.passive:
            self.notes.append("the file marks no motors: every joint that follows no other counts as one")
        return {name: name for name in moving}
