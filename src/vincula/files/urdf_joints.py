"""Links and joints of a URDF tree: one joint an elementary motion, link frames on their axes."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Final
from xml.sax.saxutils import quoteattr

import numpy as np

from vincula.arrays import Vector
from vincula.files.written import free_name, number, numbers, roll_pitch_yaw
from vincula.files.written_couplings import Following
from vincula.files.written_tree import Branch, Motion, WrittenTree
from vincula.mechanism.parts import GROUND
from vincula.spatial.poses import Pose

_ON_AXIS: Final = 1e-15
"""A link's origin is on an axis up to this times its distance from the ground's origin: rounding."""


class UrdfJoints:
    """Writes the branches of a tree.

    Args:
        tree: The tree.
        names: Names that are taken; those of added links are put there.
        balls: Whether a side file can make balls of revolute joints.

    Attributes:
        root: Name of the root link.
        moved: Bodies whose link frame is not their own, because it has to be on an axis.
        unbounded: Joints whose limits URDF wants and the mechanism does not have.
        written: Joints with one axis.
        spherical: Joints that the side file has to make balls.
    """

    def __init__(self, tree: WrittenTree, names: set[str], *, balls: bool) -> None:
        self._tree, self._names, self._balls = tree, names, balls
        self.root = free_name("world", names)
        self.moved: list[str] = []
        self.unbounded: list[str] = []
        self.spherical: list[str] = []
        self.written: list[str] = []
        self._poses: dict[str, Pose] = {GROUND: Pose.identity(3)}
        for branch in tree.branches:
            self._poses[branch.link] = self._link_pose(branch)
            self.written += [step.name for step in self.steps(branch) if step.kind != "ball"]

    def pose(self, link: str) -> Pose:
        """Pose of a link's frame in ground axes."""
        return self._poses[link]

    def name(self, link: str) -> str:
        """What a link is called in the file."""
        return self.root if link == GROUND else link

    def on_link(self, body: str, pose: Pose) -> Pose:
        """A pose given in the frame of a body, in the frame of its link."""
        if body not in self.moved:
            return pose
        return self._poses[body].inverse() @ self._tree.poses[body] @ pose

    def is_chain(self, branch: Branch) -> bool:
        """Whether a branch is a chain of joints."""
        return len(self.steps(branch)) > 1

    def is_floating(self, branch: Branch) -> bool:
        """Whether a branch is one joint with all freedoms."""
        return branch.joint.type == "free" and branch.forward and not self._tree.is_used(branch.joint)

    def steps(self, branch: Branch) -> tuple[Motion, ...]:
        """The motions of a branch as joints; none for a fixed or floating one."""
        if self.is_floating(branch):
            return ()
        if self._balls and branch.joint.type == "spherical" and not self._tree.is_used(branch.joint):
            return branch.motions
        return self._tree.unfolded(branch)

    def _link_pose(self, branch: Branch) -> Pose:
        """The body's own pose where its joint lets it be, else the same axes at a point of the axis."""
        pose, steps = self._tree.poses[branch.link], self.steps(branch)
        if not steps or steps[-1].kind == "slide":
            return pose
        last = steps[-1]
        arm = pose.position - last.point
        across = arm if last.kind == "ball" else np.cross(last.axis, arm)
        size = max(float(np.abs(pose.position).max()), float(np.abs(last.point).max()))
        if float(np.linalg.norm(across)) <= _ON_AXIS * size and last.kind != "screw":
            return pose
        if branch.link not in self._tree.added:
            self.moved.append(branch.link)
        return Pose(pose.rotation, last.point)

    def branch(self, branch: Branch, followings: Mapping[str, Following]) -> Iterator[str]:
        """Links and joints of one branch."""
        steps, pose = self.steps(branch), self._poses[branch.link]
        parent, base = self.name(branch.parent), self._poses[branch.parent]
        if not steps:
            kind = "floating" if self.is_floating(branch) else "fixed"
            yield from _link(branch.link)
            yield from _joint(branch.joint.name, kind, parent, branch.link, base.inverse() @ pose)
            return
        for k, step in enumerate(steps):
            last = k == len(steps) - 1 and step.kind != "screw"
            link = branch.link if last else free_name(f"{branch.link}.{step.name}", self._names)
            place = pose if last else Pose(pose.rotation, step.point)
            inside = self._inside(step, pose, followings)
            name = branch.joint.name if step.kind == "ball" else step.name
            yield from _link(link)
            yield from _joint(name, self._kind(step), parent, link, base.inverse() @ place, inside)
            if step.kind == "ball":
                self.spherical.append(name)
            parent, base = link, place
            if step.kind == "screw":
                yield from self._advance(step, branch.link, parent, base.inverse() @ pose, pose)

    def _advance(self, step: Motion, link: str, parent: str, place: Pose, pose: Pose) -> Iterator[str]:
        """The second half of a screw: a slide that follows the turn."""
        ratio = step.lead / (2.0 * math.pi)
        inside = [
            _axis(pose.rotation.T @ step.axis),
            '<limit effort="0" velocity="0"/>',
            f"<mimic joint={quoteattr(step.name)} multiplier={quoteattr(number(ratio))}/>",
        ]
        name = f"{step.name}.advance"
        self.unbounded.append(name)
        yield from _link(link)
        yield from _joint(name, "prismatic", parent, link, place, inside)

    def _kind(self, step: Motion) -> str:
        if step.kind == "slide":
            return "prismatic"
        bounded = step.limits.lower is not None or step.limits.upper is not None
        return "revolute" if bounded else "continuous"

    def _inside(self, step: Motion, pose: Pose, followings: Mapping[str, Following]) -> list[str]:
        limits = step.limits
        inside = [_axis(pose.rotation.T @ step.axis)]
        bounds = [("lower", limits.lower), ("upper", limits.upper)]
        texts = [f'{tag}="{number(value - step.home)}"' for tag, value in bounds if value is not None]
        kind = self._kind(step)
        if kind != "continuous" and len(texts) < len(bounds):
            self.unbounded.append(step.name)
        if kind != "continuous" or limits.effort or limits.rate:
            texts += [f'effort="{number(limits.effort or 0.0)}"', f'velocity="{number(limits.rate or 0.0)}"']
            inside.append(f"<limit {' '.join(texts)}/>")
        if step.name in followings:
            mimic = followings[step.name]
            ratio = f"multiplier={quoteattr(number(mimic.factor))}"
            offset = f" offset={quoteattr(number(mimic.offset))}" if mimic.offset else ""
            inside.append(f"<mimic joint={quoteattr(mimic.leader)} {ratio}{offset}/>")
        return inside


def origin(pose: Pose, tag: str = "origin") -> str:
    """An `<origin>`."""
    angles = roll_pitch_yaw(pose)
    turn = f' rpy="{numbers(angles)}"' if np.any(angles) else ""
    return f'<{tag} xyz="{numbers(pose.position)}"{turn}/>'


def _axis(axis: Vector) -> str:
    return f'<axis xyz="{numbers(axis)}"/>'


def _link(name: str) -> Iterator[str]:
    yield f"<link name={quoteattr(name)}/>"


def _joint(
    name: str, kind: str, parent: str, child: str, place: Pose, inside: list[str] | None = None
) -> Iterator[str]:
    yield f'<joint name={quoteattr(name)} type="{kind}">'
    yield f"  <parent link={quoteattr(parent)}/>"
    yield f"  <child link={quoteattr(child)}/>"
    yield f"  {origin(place)}"
    yield from (f"  {line}" for line in inside or [])
    yield "</joint>"
