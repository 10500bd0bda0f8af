"""Any spatial mechanism as an MJCF file: a tree of bodies, equalities for its loops.

Body frames and joint values stay what they are: a value at home becomes the joint's `ref`.  MuJoCo wants
masses, which a mechanism does not have: every body gets the same, and the file says so.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Final
from xml.sax.saxutils import quoteattr

import numpy as np

from vincula.errors import listing
from vincula.files.mjcf_equalities import actuators, couplings, locks
from vincula.files.mjcf_keyframes import keyframes
from vincula.files.written import (
    Written,
    bad_names,
    free_name,
    in_space,
    number,
    numbers,
    reference_frame,
    said_with_commands,
)
from vincula.files.written_tree import Branch, Loop, Motion, WrittenTree, children
from vincula.mechanism.parts import GROUND, Frame
from vincula.spatial.poses import Pose

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism

MASS: Final = '<inertial pos="0 0 0" mass="1" diaginertia="0.01 0.01 0.01"/>'
"""What every body weighs: 1 kg, as a ball with a radius of 16 cm."""

UNBOUNDED: Final = 1e9
"""Stands for the limit that is not there where only the other one is: MJCF has ranges."""


def mjcf_data(mechanism: Mechanism) -> Written:
    """The MJCF file of a mechanism, in m and rad; of a planar one its twin in space."""
    mechanism, lost = in_space(mechanism)
    writer = _Writer(mechanism)
    lines = [
        f"<mujoco model={quoteattr(mechanism.name)}>",
        "  <!-- Masses and inertias are placeholders: the mechanism that this was written from has none. -->",
        '  <compiler angle="radian" autolimits="true"/>',
        "  <worldbody>",
        *writer.sites(GROUND, "    "),
        *writer.bodies(),
        "  </worldbody>",
    ]
    couples = couplings(mechanism)
    drives, motors = actuators(mechanism)
    equalities = [*writer.loops(), *couples.equalities, *locks(mechanism)]
    for section, content in (
        ("tendon", [*couples.tendons, *drives]),
        ("equality", equalities),
        ("actuator", motors),
        ("keyframe", keyframes(mechanism, writer.values)),
    ):
        if content:
            lines += [f"  <{section}>", *(f"    {line}" for line in content), f"  </{section}>"]
    lost += [*writer.losses(), *couples.lost]
    return Written("\n".join([*lines, "</mujoco>", ""]), lost, writer.changes(), format="an MJCF file")


class _Writer:
    def __init__(self, mechanism: Mechanism) -> None:
        self._mechanism = mechanism
        self.tree = WrittenTree(mechanism, ("spherical", "fixed"))
        taken = {frame.name for frame in mechanism.frames}
        self._point = reference_frame(mechanism, taken)
        self._frames = list(mechanism.frames)
        if self._point is not None and self._point[0] not in {frame.name for frame in self._frames}:
            self._frames.append(Frame(*self._point))
        self._sites_of_loops(taken)
        self.values: list[tuple[Branch, str, Motion | None]] = []

    def _sites_of_loops(self, taken: set[str]) -> None:
        """A loop that is open at home is written between sites: an anchor would be taken for closed."""
        self._ends: dict[str, tuple[str, str]] = {}
        for loop in self.tree.loops:
            if loop.open:
                names = free_name(f"{loop.name}.first", taken), free_name(f"{loop.name}.second", taken)
                self._ends[loop.name] = names
                self._frames.append(Frame(names[0], loop.first, loop.on_first))
                self._frames.append(Frame(names[1], loop.second, loop.on_second))

    def sites(self, body: str, indent: str) -> Iterator[str]:
        """The named frames of a body."""
        for frame in self._frames:
            if frame.body == body:
                yield f"{indent}<site name={quoteattr(frame.name)}{_placed(frame.pose)}/>"

    def bodies(self) -> Iterator[str]:
        """All bodies, each inside its parent."""
        below = children(self.tree.branches)
        waiting: list[tuple[Branch | None, int]] = [(branch, 2) for branch in reversed(below.get(GROUND, []))]
        while waiting:
            branch, depth = waiting.pop()
            indent = "  " * depth
            if branch is None:
                yield f"{indent}</body>"
                continue
            pose = self.tree.poses[branch.parent].inverse() @ self.tree.poses[branch.link]
            yield f"{indent}<body name={quoteattr(branch.link)}{_placed(pose)}>"
            yield f"{indent}  {MASS}"
            yield from (f"{indent}  {line}" for line in self._joints(branch))
            yield from self.sites(branch.link, f"{indent}  ")
            waiting.append((None, depth))
            waiting += [(child, depth + 1) for child in reversed(below.get(branch.link, []))]

    def _joints(self, branch: Branch) -> Iterator[str]:
        joint = branch.joint
        whole = not self.tree.is_used(joint)
        if joint.type == "free" and whole and branch.forward and branch.parent == GROUND:
            self.values.append((branch, "free", None))
            yield f"<freejoint name={quoteattr(joint.name)}/>"
            return
        for step in branch.motions if whole else self.tree.unfolded(branch):
            yield from self._motion(branch, step)

    def _motion(self, branch: Branch, step: Motion) -> Iterator[str]:
        pose = self.tree.poses[branch.link]
        place = f'pos="{numbers(pose.inverse().apply(step.point))}"'
        axis = f'axis="{numbers(pose.rotation.T @ step.axis)}"'
        if step.kind == "ball":
            name = branch.joint.name if branch.joint.type == "spherical" else f"{branch.joint.name}.w"
            self.values.append((branch, "ball", step))
            yield f'<joint name={quoteattr(name)} type="ball" {place}/>'
            return
        kind = "slide" if step.kind == "slide" else "hinge"
        ref = f' ref="{number(step.home)}"' if step.home else ""
        self.values.append((branch, kind, step))
        yield f'<joint name={quoteattr(step.name)} type="{kind}" {place} {axis}{ref}{_limits(step)}/>'
        if step.kind == "screw":
            self.values.append((branch, "advance", step))
            yield f'<joint name={quoteattr(f"{step.name}.advance")} type="slide" {place} {axis}/>'

    def loops(self) -> Iterator[str]:
        """The loops and screws as equalities."""
        for loop in self.tree.loops:
            yield self._loop(loop)
        for branch in self.tree.branches:
            for step in branch.motions:
                if step.kind == "screw":
                    name = quoteattr(f"{step.name}.screw")
                    ratio = numbers([0.0, step.lead / (2.0 * np.pi), 0.0, 0.0, 0.0])
                    joints = f"joint1={quoteattr(f'{step.name}.advance')} joint2={quoteattr(step.name)}"
                    yield f'<joint name={name} {joints} polycoef="{ratio}"/>'

    def _loop(self, loop: Loop) -> str:
        kind = "connect" if loop.type == "spherical" else "weld"
        name = f"<{kind} name={quoteattr(loop.name)}"
        if loop.name in self._ends:
            one, two = self._ends[loop.name]
            return f"{name} site1={quoteattr(one)} site2={quoteattr(two)}/>"
        # An anchor is told in the first body of a connect, in the second of a weld.
        anchor = loop.on_first.position if kind == "connect" else loop.on_second.position
        bodies = f"body1={quoteattr(_name(loop.first))} body2={quoteattr(_name(loop.second))}"
        return f'{name} {bodies} anchor="{numbers(anchor)}"/>'

    def losses(self) -> Iterator[str]:
        """What would be lost, one sentence a thing."""
        mechanism = self._mechanism
        yield from bad_names(mechanism, reserved=("world",))
        for contact in mechanism.contacts:
            yield f"contact {contact.name!r}: MJCF has contacts of shapes only"
        for name in self.tree.free_loops:
            yield f"joint {name!r}: it has all freedoms and holds nothing, so it is not in the file"
        for drive in mechanism.drives:
            if drive.name not in mechanism.active:
                yield f"motor {drive.name!r} combines axes and is not active: MJCF has active ones only"

    def changes(self) -> list[str]:
        """What is held in another form, one sentence a thing."""
        mechanism, tree = self._mechanism, self.tree
        found = ["masses and inertias are placeholders: 1 kg and 0.01 kg m2 a body"]
        several = [b.joint.name for b in tree.branches if len(b.motions) > 1 and b.joint.type != "free"]
        if several:
            found.append(f"joints with several axes are one joint an axis: {listing(several, 8)}")
        if tree.added:
            found.append(
                f"loop joints lead to links of their own, which are welded: {listing(tree.added, 8)}"
            )
        balls = [x.name for x in tree.loops if x.type == "spherical" and not mechanism.joint[x.name].closure]
        if balls:
            words = "loops closed by balls are connects, without joint values or rates"
            found.append(f"{words}: {listing(balls, 8)}")
        opened = [loop.name for loop in tree.loops if loop.open]
        if opened:
            found.append(
                f"loops that are open at the home configuration are held at sites: {listing(opened, 8)}"
            )
        if mechanism.lock:
            found.append(f"locks are equalities of one joint: {listing(mechanism.lock, 8)}")
        return [*found, *said_with_commands(mechanism, self._point[0] if self._point else "")]


def _name(body: str) -> str:
    return "world" if body == GROUND else body


def _placed(pose: Pose) -> str:
    place = f' pos="{numbers(pose.position)}"'
    if np.array_equal(pose.rotation, np.eye(3)):
        return place
    return f'{place} quat="{numbers(pose.as_quaternion_wxyz())}"'


def _limits(step: Motion) -> str:
    lower, upper, effort = step.limits.lower, step.limits.upper, step.limits.effort
    text = ""
    if lower is not None or upper is not None:
        least = -UNBOUNDED if lower is None else lower
        most = UNBOUNDED if upper is None else upper
        text += f' range="{numbers([least, most])}"'
    return text if effort is None else f'{text} actuatorfrcrange="{numbers([-effort, effort])}"'
