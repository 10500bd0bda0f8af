"""What a native file cannot hold of a mechanism, and what it holds in another form."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Final

import numpy as np

from vincula.arrays import Matrix
from vincula.errors import listing
from vincula.files.names import name_problem
from vincula.files.problems import shown
from vincula.mechanism.parts import Joint
from vincula.mechanism.residuals import axis_linear
from vincula.spatial.poses import Pose, frame_with_z

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism

CLOSURE_TYPES: Final = ("revolute", "prismatic", "cylindrical", "spherical", "planar", "fixed")
"""Joint types that may close a loop between named frames."""

_SAME: Final = 1e-12
_MISFIT: Final = 1e-9


def losses(mechanism: Mechanism, poses: Mapping[str, Pose]) -> list[str]:
    """What would be lost, one sentence a thing.

    Args:
        mechanism: The mechanism.
        poses: Pose of every body and the ground at its home configuration.
    """
    return [
        *_bad_names(mechanism),
        *_open_parts(mechanism, poses),
        *_turned_axes(mechanism, poses),
        *_closures(mechanism),
        *_motors(mechanism),
        *_member(mechanism, poses),
    ]


def _bad_names(mechanism: Mechanism) -> Iterator[str]:
    names = [mechanism.name, *mechanism.body, *mechanism.motors, *mechanism.keyframes]
    names += [joint.name for joint in mechanism.joints] + [contact.name for contact in mechanism.contacts]
    names += [coupling.name for coupling in mechanism.couplings] + [drive.name for drive in mechanism.drives]
    names += [frame.name for frame in mechanism.frames]
    for name in names:
        expected = name_problem(name)
        if expected:
            yield f"the name {shown(name)}: expected {expected}"


def _open_parts(mechanism: Mechanism, poses: Mapping[str, Pose]) -> Iterator[str]:
    """Joints and contacts whose two halves are apart: a drawing has one place for both."""
    tight = _MISFIT * mechanism.length
    closures = {joint.name for joint in mechanism.joints if joint.closure}
    for residual in mechanism.residuals():
        if residual.kind == "loop" and residual.name not in closures and residual.gap > tight:
            yield f"{residual} at the home configuration: it has no one place to be drawn at"
    for contact in mechanism.contacts:
        first = poses[contact.first] @ contact.frame_on_first
        second = poses[contact.second] @ contact.frame_on_second
        apart = float(np.linalg.norm(first.position - second.position))
        if apart > tight or not np.allclose(first.rotation, second.rotation, rtol=0.0, atol=_MISFIT):
            yield f"contact {contact.name!r} is open by {apart:.3g} m at the home configuration"


def drawn_axes(joint: Joint, first: Pose) -> Matrix:
    """The axes that a drawing gives to a joint's translations: of a planar joint some in its plane."""
    size = len(first.position)
    return frame_with_z(first.rotation[:, 2]) if joint.type == "planar" and size == 3 else np.eye(size)


def _turned_axes(mechanism: Mechanism, poses: Mapping[str, Pose]) -> Iterator[str]:
    """Joints whose axes x, y, z a drawing turns, which matters when they are used one by one."""
    used = [set(mechanism.active), set(mechanism.lock)]
    used += [{name} for coupling in mechanism.couplings for name in coupling.axes]
    used += [{name} for drive in mechanism.drives for name in drive.drives]
    for joint in mechanism.joints:
        if joint.type not in ("spherical", "free", "planar"):
            continue
        names = mechanism.type_of(joint).axis_names(joint.name)
        moved = [name for name, linear in zip(names, mechanism.type_of(joint).linear, strict=True) if linear]
        turned = [name for name in names if name not in moved]
        first = poses[joint.first] @ joint.frame_on_first
        second = poses[joint.second] @ joint.frame_on_second
        groups = [(moved, first.rotation, drawn_axes(joint, first))]
        if len(turned) == 3:
            groups.append((turned, second.rotation, np.eye(3)))
        for group, now, then in groups:
            singly = any(set(group) & names and not set(group) <= names for names in used)
            if singly and not np.allclose(now, then, rtol=0.0, atol=_SAME):
                yield f"joint {joint.name!r}: its axes {listing(group)}, used one by one, would be turned"


def _closures(mechanism: Mechanism) -> Iterator[str]:
    for joint in mechanism.joints:
        if joint.closure and joint.type not in CLOSURE_TYPES:
            yield f"loop joint {joint.name!r}: closures of type {joint.type} are not in the format"
        if not joint.closure and joint.cut is not None:
            yield f"joint {joint.name!r}: its cut ({joint.cut}) belongs to the reference in the format"


def _motors(mechanism: Mechanism) -> Iterator[str]:
    linear = axis_linear(mechanism)
    for drive in mechanism.drives:
        if drive.name not in mechanism.active:
            yield f"motor {drive.name!r} combines axes and is not active: the format has active ones only"
        elif drive.linear is not None and drive.linear != linear[next(iter(drive.drives))]:
            unit = "m/s" if drive.linear else "rad/s"
            yield f"motor {drive.name!r}: its rate is in {unit}, unlike its first axis"


def _member(mechanism: Mechanism, poses: Mapping[str, Pose]) -> Iterator[str]:
    reference = mechanism.reference
    if reference is None or reference.axes != "body":
        return
    rotation = poses[reference.body].rotation
    if not np.allclose(rotation, np.eye(len(rotation)), rtol=0.0, atol=_SAME):
        yield f"body {reference.body!r}: twists are in its axes, which are turned against the ground's"


def changes(mechanism: Mechanism) -> list[str]:
    """What is held in another form, one sentence a thing."""
    moved = [
        joint.name
        for joint in mechanism.joints
        if not joint.closure and not np.array_equal(joint.home, mechanism.type_of(joint).zero)
    ]
    result = []
    if moved:
        result.append(
            "joint values are displacements from the home configuration, where these joints have other "
            f"values than zero in the source: {listing(moved, 8)}"
        )
    if any(not body.drawn for body in mechanism.bodies):
        result.append(
            "body axes are ground axes at the home configuration, and a body's own point is the mean of its "
            "joint and contact points"
        )
    return result
