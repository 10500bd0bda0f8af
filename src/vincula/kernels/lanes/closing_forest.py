"""What closing solves for: a forest of bodies, unknown joint values, gaps that must vanish.

Motors given, all bodies hang from the ground, as in `mechanism.kinematics`.  The pose of the reference
member given, the member is a second root: limbs then have nothing to do with each other, and every one
is closed by itself.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from vincula.kernels.lanes.flatten import Unsupported
from vincula.mechanism.parts import GROUND, Joint

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism

Given = Literal["motors", "reference"]


@dataclass(frozen=True, slots=True)
class Forest:
    """The opened mechanism.

    Attributes:
        given: What is given.
        tree: Joints from the roots outwards, each with whether it is walked from first to second body.
        own: Joints outside it whose values are unknowns: what they permit is not cut away.
        measured: Joints outside it whose values are read off at the end: balls and free joints.
        closures: Joints outside it that have no values.
        held: Axes that do not move by themselves: motors that are given, locked axes.
    """

    given: Given
    tree: tuple[tuple[Joint, bool], ...]
    own: tuple[Joint, ...]
    measured: tuple[Joint, ...]
    closures: tuple[Joint, ...]
    held: frozenset[str]


def forest_of(mechanism: Mechanism, given: Given) -> Forest:
    """The forest of a mechanism with a reference member.

    Raises:
        Unsupported: Something that lanes do not close: a motor or lock on one axis of a ball, a closure
            that is a screw, or no member.
    """
    reference = mechanism.reference
    if reference is None:
        raise Unsupported("no reference member is named")
    roots = [GROUND] if given == "motors" else [GROUND, reference.body]
    if _one_body(mechanism, roots):
        raise Unsupported("the reference member is fixed to the ground")
    tree = _grown(mechanism, roots)
    names = {joint.name for joint, _ in tree}
    driven = {drive.name for drive in mechanism.drives}
    motors = {name for name in mechanism.active if name not in driven} if given == "motors" else set()
    held = frozenset(motors | set(mechanism.lock))
    outside = [joint for joint in mechanism.all_joints if joint.name not in names]
    for joint, _ in tree:
        _refuse_partly_held(mechanism, joint, held)
    own, measured, closures = [], [], []
    for joint in outside:
        axes = set(mechanism.type_of(joint).axis_names(joint.name))
        if joint.closure:
            if joint.type == "screw" or axes & held:
                raise Unsupported(f"closure {joint.name!r} has a value to follow: the reference path does")
            closures.append(joint)
        elif "S" in mechanism.type_of(joint).steps and not axes & held:
            measured.append(joint)
        else:
            _refuse_partly_held(mechanism, joint, held)
            own.append(joint)
    return Forest(given, tuple(tree), tuple(own), tuple(measured), tuple(closures), held)


def _refuse_partly_held(mechanism: Mechanism, joint: Joint, held: Iterable[str]) -> None:
    kind = mechanism.type_of(joint)
    axes = kind.axis_names(joint.name)
    count = len(set(axes).intersection(held))
    if "S" in kind.steps and 0 < count < len(axes):
        raise Unsupported(
            f"some axes of {joint.name!r} are held and others not: the reference path does that"
        )


def _one_body(mechanism: Mechanism, roots: list[str]) -> bool:
    """Whether fixed joints make the roots one body."""
    reached = {GROUND}
    count = 0
    while count != len(reached):
        count = len(reached)
        for joint in mechanism.all_joints:
            if joint.type == "fixed" and reached & {joint.first, joint.second}:
                reached |= {joint.first, joint.second}
    return len(roots) > 1 and roots[1] in reached


def _grown(mechanism: Mechanism, roots: list[str]) -> list[tuple[Joint, bool]]:
    """Breadth first in the order of declaration, closures never; from the ground first."""
    neighbours: dict[str, list[tuple[Joint, bool, str]]] = {}
    for joint in mechanism.all_joints:
        if not joint.closure:
            neighbours.setdefault(joint.first, []).append((joint, True, joint.second))
            neighbours.setdefault(joint.second, []).append((joint, False, joint.first))
    reached = set(roots)
    order: list[tuple[Joint, bool]] = []
    for root in roots:
        queue = [root]
        for name in queue:
            for joint, forward, other in neighbours.get(name, ()):
                if other not in reached:
                    reached.add(other)
                    queue.append(other)
                    order.append((joint, forward))
    return order
