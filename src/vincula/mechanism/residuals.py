"""How far loops, contacts and couplings are from being closed."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from vincula.arrays import Vector
from vincula.mechanism.blocked import angle_beyond, blocked_directions
from vincula.mechanism.configuration import Configuration
from vincula.mechanism.frames import PlacedFrames
from vincula.mechanism.joint_types import motion
from vincula.mechanism.parts import ContactPart, Joint
from vincula.spatial.poses import Pose, rotation_vector
from vincula.spatial.selectors import contact_components

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism

CLOSED = 1e-8
"""A loop counts as closed when its residual is below this times the characteristic length."""


@dataclass(frozen=True, slots=True)
class LoopResidual:
    """The gap of one loop, contact or coupling.

    Attributes:
        name: Name of the joint, contact or coupling.
        kind: What it is.
        linear: Distance by which positions miss [m].
        angular: Angle by which orientations miss [rad].
        gap: Both together, angles times the characteristic length [m].
    """

    name: str
    kind: Literal["loop", "contact", "coupling"]
    linear: float
    angular: float
    gap: float

    def __str__(self) -> str:
        seen = 1e-9 * max(self.linear, self.angular)
        parts = [f"{self.linear:.3g} m"] if self.linear > seen or not self.angular else []
        parts += [f"{self.angular:.3g} rad"] if self.angular > seen else []
        return f"{self.kind} {self.name!r} is open by {' and '.join(parts)}"


def residuals_of_frames(
    mechanism: Mechanism, q: Configuration, frames: PlacedFrames
) -> tuple[LoopResidual, ...]:
    """Gaps of everything outside the kinematic tree, from where the frames are.

    Where both frames of a part coincide to the last bit, as in a drawing, nothing needs measuring.
    """
    table, length = mechanism.frame_table, mechanism.length
    tree = {joint.name for joint, _ in mechanism.tree}
    outside = [joint for joint in mechanism.all_joints if joint.name not in tree]
    index = np.array(
        [table.of_joint[j.name] for j in outside] + [table.of_contact[c.name] for c in mechanism.contacts],
        dtype=np.intp,
    )
    equal = frames.coincide(index, index + 1)
    result = []
    parts: tuple[Joint | ContactPart, ...] = (*outside, *mechanism.contacts)
    for part, at, same in zip(parts, index, equal, strict=True):
        kind: Literal["loop", "contact"] = "loop" if isinstance(part, Joint) else "contact"
        if same and not _displaced(mechanism, part, q):
            result.append(LoopResidual(part.name, kind, 0.0, 0.0, 0.0))
            continue
        ends = frames.pose(at), frames.pose(at + 1)
        if isinstance(part, Joint):
            linear, angular = _joint_gap(mechanism, part, q, *ends)
        else:
            linear, angular = _contact_gap(mechanism, part, *ends)
        result.append(_measured(part.name, kind, linear, angular, length))
    if q is mechanism.home or q == mechanism.home:
        result += mechanism.misdrawn
    return (*result, *_coupling_residuals(mechanism, q, length))


def misdrawn(mechanism: Mechanism) -> tuple[LoopResidual, ...]:
    """Joints of the kinematic tree that do not fit between their bodies as these are drawn.

    A file places every body once, through joints of its own choice; where a loop is open in the file,
    the gap may be at a joint of our tree, which is never measured at other configurations.
    """
    frames = mechanism.frame_table.placed(mechanism.body_poses())
    found = []
    for joint, _ in mechanism.tree:
        at = mechanism.frame_table.of_joint[joint.name]
        gaps = _joint_gap(mechanism, joint, mechanism.home, frames.pose(at), frames.pose(at + 1))
        residual = _measured(joint.name, "loop", *gaps, mechanism.length)
        if residual.gap > CLOSED * mechanism.length:
            found.append(residual)
    return tuple(found)


def _displaced(mechanism: Mechanism, part: Joint | ContactPart, q: Configuration) -> bool:
    """Whether a joint's own values put its frames apart."""
    if not isinstance(part, Joint) or part.closure:
        return False
    return not np.array_equal(q[part.name], mechanism.type_of(part).zero)


def _measured(
    name: str, kind: Literal["loop", "contact", "coupling"], linear: Vector, angular: Vector, length: float
) -> LoopResidual:
    far, turned = float(np.linalg.norm(linear)), float(np.linalg.norm(angular))
    return LoopResidual(name, kind, far, turned, math.hypot(far, length * turned))


def _joint_gap(
    mechanism: Mechanism, joint: Joint, q: Configuration, first: Pose, second: Pose
) -> tuple[Vector, Vector]:
    """Gap of a joint outside the tree: of its whole pose where it has values, else of what it blocks."""
    kind = mechanism.type_of(joint)
    if joint.closure:
        blocked = blocked_directions(kind, first, second, joint.lead, joint.second_axis)
        linear = np.array(blocked.linear, dtype=bool)
        return blocked.gaps[linear], blocked.gaps[~linear]
    wanted = first @ motion(kind, q[joint.name], joint.lead, joint.second_axis)
    turn = wanted.rotation.T @ second.rotation
    angular = np.zeros(1) if np.array_equal(wanted.rotation, second.rotation) else rotation_vector(turn)
    return second.position - wanted.position, angular


def _contact_gap(
    mechanism: Mechanism, contact: ContactPart, first: Pose, second: Pose
) -> tuple[Vector, Vector]:
    s = mechanism.space.translations
    components = contact_components(contact.type, mechanism.space)
    offset = first.rotation.T @ (second.position - first.position)
    linear = np.array([offset[k] for k in components if k < s])
    relative = first.rotation.T @ second.rotation
    if contact.type == "line":
        along = np.array([1.0, 0.0, 0.0])
        return linear, np.array([angle_beyond(relative @ along, along)])
    turn = rotation_vector(relative)
    return linear, np.array([turn[k - s] for k in components if k >= s])


def axis_values(mechanism: Mechanism, q: Configuration) -> dict[str, float]:
    """Value of every axis that has a scalar value of its own."""
    values: dict[str, float] = {}
    for joint in mechanism.all_joints:
        kind = mechanism.type_of(joint)
        if kind.scalar_values and not joint.closure:
            values.update(zip(kind.axis_names(joint.name), map(float, q[joint.name]), strict=True))
    return values


def axis_linear(mechanism: Mechanism) -> dict[str, bool]:
    """For every axis, whether its rate is in m/s."""
    return {
        axis: linear
        for joint in mechanism.all_joints
        for axis, linear in zip(
            mechanism.type_of(joint).axis_names(joint.name), mechanism.type_of(joint).linear, strict=True
        )
    }


def _coupling_residuals(mechanism: Mechanism, q: Configuration, length: float) -> list[LoopResidual]:
    if not mechanism.couplings:
        return []
    values, home = axis_values(mechanism, q), axis_values(mechanism, mechanism.home)
    linear = axis_linear(mechanism)
    result = []
    for coupling in mechanism.couplings:
        if not set(coupling.axes) <= set(values):
            continue
        gap = abs(coupling.residual(values, home))
        in_metres = any(linear[axis] for axis in coupling.rates)
        result.append(
            LoopResidual(
                coupling.name,
                "coupling",
                gap if in_metres else 0.0,
                0.0 if in_metres else gap,
                gap if in_metres else gap * length,
            )
        )
    return result
