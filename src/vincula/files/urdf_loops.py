"""Loops and couplings of a written URDF tree, in URDF+ or in a Gepetto side file."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from itertools import product
from typing import TYPE_CHECKING
from xml.sax.saxutils import quoteattr

import numpy as np

from vincula.errors import listing
from vincula.files.urdf_joints import UrdfJoints, origin
from vincula.files.written import free_name, number, numbers
from vincula.files.written_couplings import Following, home_residual, linear_rates
from vincula.files.written_tree import Loop, WrittenTree
from vincula.mechanism.parts import GROUND, Coupling
from vincula.spatial.poses import Pose

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism

_SAME = 1e-14
"""Relative difference of coefficients, and of a residual at home, that is rounding."""


class UrdfLoops(ABC):
    """Loops and couplings in one of the conventions.

    Args:
        mechanism: The mechanism.
        tree: Its tree and loops.
        joints: The written joints.
        followings: Couplings of two axes.
        left: The other couplings.

    Attributes:
        mimics: Couplings that are `<mimic>`.
        left: Couplings that the format cannot hold.
    """

    def __init__(
        self,
        mechanism: Mechanism,
        tree: WrittenTree,
        joints: UrdfJoints,
        followings: Sequence[Following],
        left: Sequence[Coupling],
    ) -> None:
        self._mechanism, self._tree, self._joints = mechanism, tree, joints
        self.mimics, self.left = list(followings), list(left)
        self._prepare()

    @abstractmethod
    def _prepare(self) -> None:
        """Choose names and what each coupling becomes."""

    @abstractmethod
    def lines(self) -> Iterator[str]:
        """What the convention adds to the file."""

    @abstractmethod
    def changes(self) -> list[str]:
        """What is held in another form, one sentence a thing."""


class PlusLoops(UrdfLoops):
    """URDF+: `<loop>` for a loop joint, `<coupling>` for axes on two ways down the tree."""

    def _prepare(self) -> None:
        self._couplings: list[str] = []
        by_name = {coupling.name: coupling for coupling in self._mechanism.couplings}
        self.mimics = [f for f in self.mimics if not self._couple(by_name[f.coupling])]
        self.left = [coupling for coupling in self.left if not self._couple(coupling)]

    def lines(self) -> Iterator[str]:
        """All loops and couplings."""
        for loop in self._tree.loops:
            yield from self._loop(loop)
        yield from self._couplings

    def changes(self) -> list[str]:
        """What is held in another form, one sentence a thing."""
        loops = [x.name for x in self._tree.loops if not x.carried]
        lost = [name for name in loops if not self._mechanism.joint[name].closure]
        return [f"loop joints have no joint values or rates: {listing(lost, 8)}"] if lost else []

    def _loop(self, loop: Loop) -> Iterator[str]:
        yield f'<loop name={quoteattr(loop.name)} type="{loop.type}">'
        ends = ("predecessor", loop.first, loop.on_first), ("successor", loop.second, loop.on_second)
        for tag, link, pose in ends:
            place = origin(self._joints.on_link(link, pose))
            yield f"  <{tag} link={quoteattr(self._joints.name(link))}>{place}</{tag}>"
        if loop.type not in ("spherical", "fixed"):
            yield '  <axis xyz="0 0 1"/>'
        if loop.type == "universal":
            yield f'  <axis xyz="{numbers(loop.second_axis)}"/>'
        yield "</loop>"

    def _couple(self, coupling: Coupling) -> bool:
        """Write a coupling if the ways down to two links say just this; whether they do."""
        rates = linear_rates(coupling)
        if not rates or abs(home_residual(coupling, self._mechanism)) > _SAME:
            return False
        ends = [b.link for b in self._tree.branches if rates.keys() & {m.name for m in b.motions}]
        scale = max(map(abs, rates.values()))
        for first, second in product([*ends, GROUND], repeat=2):
            one, other = self._way(first), self._way(second)
            shared = [axis for axis in one if axis in other]
            ahead = [axis for axis in one if axis not in shared]
            behind = [axis for axis in other if axis not in shared]
            if {*ahead, *behind} != set(rates) or not behind:
                continue
            ratio = -rates[ahead[0]] / rates[behind[0]] if ahead else 0.0
            want = dict.fromkeys(ahead, ratio) | dict.fromkeys(behind, -1.0)
            unit = -rates[behind[0]]
            if ahead and all(abs(unit * want[a] - rates[a]) <= _SAME * scale for a in rates):
                self._write(coupling.name, first, second, ratio)
                return True
        return False

    def _write(self, name: str, first: str, second: str, ratio: float) -> None:
        ends = (("predecessor", first), ("successor", second))
        self._couplings += [
            f"<coupling name={quoteattr(name)}>",
            *(f"  <{tag} link={quoteattr(self._joints.name(link))}/>" for tag, link in ends),
            f'  <ratio value="{number(ratio)}"/>',
            "</coupling>",
        ]

    def _way(self, link: str) -> list[str]:
        """Axes on the way from the root to a link."""
        above = {branch.link: branch for branch in self._tree.branches}
        way: list[str] = []
        while link in above:
            way = [step.name for step in self._joints.steps(above[link])] + way
            link = above[link].parent
        return way


class GepettoLoops(UrdfLoops):
    """A Gepetto side file: pairs of frames that coincide; each is a link, if need be an added one."""

    def _prepare(self) -> None:
        tree, mechanism = self._tree, self._mechanism
        taken = {*tree.poses, *(joint.name for joint in mechanism.all_joints)}
        taken |= {frame.name for frame in mechanism.frames} | {self._joints.root}
        self._seats: list[tuple[str, str, Pose]] = []
        self._pairs = [
            (self._seat(loop, loop.first, loop.on_first, "first", taken),
             self._seat(loop, loop.second, loop.on_second, "second", taken))
            for loop in tree.loops
        ]  # fmt: skip

    def _seat(self, loop: Loop, link: str, pose: Pose, end: str, taken: set[str]) -> str:
        """The link that stands for the frame at an end of a loop."""
        place = self._joints.on_link(link, pose)
        level = loop.type == "spherical" or np.array_equal(place.rotation, np.eye(3))
        if level and not np.any(place.position):
            return self._joints.name(link)
        name = free_name(f"{loop.name}.{end}", taken)
        self._seats.append((name, link, place))
        return name

    def lines(self) -> Iterator[str]:
        """The added links, which are fixed."""
        for name, link, pose in self._seats:
            yield f"<link name={quoteattr(name)}/>"
            yield f'<joint name={quoteattr(f"{name}.fixed")} type="fixed">'
            yield f"  <parent link={quoteattr(self._joints.name(link))}/>"
            yield f"  <child link={quoteattr(name)}/>"
            yield f"  {origin(pose)}"
            yield "</joint>"

    def changes(self) -> list[str]:
        """What is held in another form, one sentence a thing."""
        found = []
        loops = [loop.name for loop in self._tree.loops if not loop.carried]
        if loops:
            words = "loops are named by their frames, without joint values or rates"
            found.append(f"{words}: {listing(loops, 8)}")
        called = [motor for motor, axis in self._mechanism.motors.items() if motor != axis]
        if called:
            found.append(f"motors are named by their joints: {listing(called, 8)}")
        return found

    def side_file(self) -> str:
        """The text of the side file; call it when the joints are written."""
        axes = set(self._joints.written)
        kinds = ["3d" if loop.type == "spherical" else "6d" for loop in self._tree.loops]
        pairs = ", ".join(_yaml(pair) for pair in self._pairs)
        balls = self._joints.spherical
        return "\n".join(
            [
                f"closed_loop: [{pairs}]",
                f"type: {_yaml(kinds)}",
                f"name_mot: {_yaml([axis for axis in self._mechanism.active if axis in axes])}",
                f"joint_name: {_yaml(balls)}",
                f"joint_type: {_yaml(['SPHERICAL'] * len(balls))}",
                "",
            ]
        )


def _yaml(names: Sequence[str]) -> str:
    """A list of texts in single quotes, where YAML knows one escape only."""
    return "[" + ", ".join("'" + name.replace("'", "''") + "'" for name in names) + "]"
