"""The checks that make a graph a mechanism; run once, when it is made."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from vincula.arrays import checked
from vincula.errors import (
    DuplicateNameError,
    ModelError,
    NonFiniteError,
    ShapeError,
    TopologyError,
    UnknownNameError,
)
from vincula.mechanism.parts import GROUND, SMALLEST_DIRECTION, ContactPart, Joint
from vincula.spatial.poses import Pose
from vincula.spatial.selectors import contact_components
from vincula.spatial.space import Space

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism


def validate(mechanism: Mechanism) -> None:
    """Refuse everything that is not a mechanism.

    Raises:
        DuplicateNameError: Two parts of one kind share a name.
        UnknownNameError: A part names something that does not exist.
        TopologyError: A joint from a body to itself, an island, an impossible cut.
        ModelError: Numbers that cannot be used.
    """
    _unique("body", [GROUND, *(b.name for b in mechanism.bodies)])
    _unique("joint", [j.name for j in mechanism.joints])
    _unique("contact", [c.name for c in mechanism.contacts])
    _unique("coupling", [c.name for c in mechanism.couplings])
    _unique("motor", [d.name for d in mechanism.drives])
    _unique("frame", [f.name for f in mechanism.frames])
    bodies = {GROUND, *(b.name for b in mechanism.bodies)}
    for joint in mechanism.joints:
        _check_joint(mechanism, joint, bodies)
    for contact in mechanism.contacts:
        _check_contact(mechanism, contact, bodies)
    for frame in mechanism.frames:
        if frame.body not in bodies:
            raise UnknownNameError(f"body of frame {frame.name!r}", frame.body, sorted(bodies))
        _check_space(f"frame {frame.name!r}", frame.pose, mechanism.space)
    for body in mechanism.bodies:
        _check_space(f"body {body.name!r}: pose", body.pose, mechanism.space)
    mechanism.implicit_joints  # noqa: B018  (raises for islands)
    _unique("joint axis", mechanism.axis_names)
    _check_axes(mechanism)
    _check_reference(mechanism)


def _unique(kind: str, names: Sequence[str]) -> None:
    seen: set[str] = set()
    for name in names:
        if not name:
            raise ModelError(f"a {kind} has an empty name")
        if name in seen:
            raise DuplicateNameError(kind, name)
        seen.add(name)


def _check_contact(mechanism: Mechanism, contact: ContactPart, bodies: set[str]) -> None:
    what = f"contact {contact.name!r}"
    contact_components(contact.type, mechanism.space)
    _check_ends("contact", contact, bodies)
    for side, pose in (("first", contact.frame_on_first), ("second", contact.frame_on_second)):
        _check_space(f"{what}: frame on the {side} body", pose, mechanism.space)
    if contact.friction is not None and not (np.isfinite(contact.friction) and contact.friction >= 0.0):
        raise ModelError(f"{what}: the coefficient of friction is {contact.friction}, it must be 0 or more")


def _check_ends(kind: str, part: Joint | ContactPart, bodies: set[str]) -> None:
    for end in (part.first, part.second):
        if end not in bodies:
            raise UnknownNameError(f"body of {kind} {part.name!r}", end, sorted(bodies))
    if part.first == part.second:
        raise TopologyError(f"{kind} {part.name!r} connects body {part.first!r} to itself")


def _check_space(what: str, pose: Pose, space: Space) -> None:
    if pose.position.shape != (space.translations,):
        raise ShapeError(what, pose.position.shape, f"the position of a {space.name} pose")


def _check_joint(mechanism: Mechanism, joint: Joint, bodies: set[str]) -> None:
    kind = mechanism.type_of(joint)
    what = f"joint {joint.name!r}"
    _check_ends("joint", joint, bodies)
    for side, pose in (("first", joint.frame_on_first), ("second", joint.frame_on_second)):
        _check_space(f"{what}: frame on the {side} body", pose, mechanism.space)
    if joint.type == "screw" and not (np.isfinite(joint.lead) and joint.lead != 0.0):
        raise ModelError(f"{what}: a screw needs a lead, its advance a turn in metres, not {joint.lead}")
    if joint.type == "universal" and np.hypot(*joint.second_axis[:2]) < SMALLEST_DIRECTION:
        raise ModelError(f"{what}: the two axes of a universal joint are parallel")
    if joint.closure:
        return
    home = checked(joint.home, f"{what}: home values", (kind.values,))
    if not kind.scalar_values and not home[-4:].any():
        raise ModelError(f"{what}: the home quaternion (w, x, y, z) {home[-4:].tolist()} has length zero")
    for limit in joint.limits:
        if limit.lower is not None and limit.upper is not None and limit.lower > limit.upper:
            raise ModelError(f"{what}: lower limit {limit.lower:g} is above upper limit {limit.upper:g}")


def _check_axes(mechanism: Mechanism) -> None:
    axes = set(mechanism.axis_names)
    scalar = _axes_with_values(mechanism)
    for coupling in mechanism.couplings:
        _known(f"axis in coupling {coupling.name!r}", coupling.axes, axes)
        values = [*coupling.rates.values(), *coupling.driver.values(), *coupling.polynomial]
        _finite(f"coefficient of coupling {coupling.name!r}", values)
        if not any(coupling.rates.values()):
            raise ModelError(f"coupling {coupling.name!r} has no coefficient other than zero")
        _finite(f"reference of coupling {coupling.name!r}", coupling.references.values())
        rate_only = [] if not coupling.driver else sorted(set(coupling.axes) - scalar)
        if rate_only:
            raise ModelError(
                f"coupling {coupling.name!r} needs the value of {', '.join(rate_only)}, but balls and loop "
                "joints have rates alone: only a linear coupling (without driver) can name them"
            )
    for drive in mechanism.drives:
        _known(f"axis in motor {drive.name!r}", drive.drives, axes)
        _finite(f"coefficient of motor {drive.name!r}", drive.drives.values())
        if not any(drive.drives.values()):
            raise ModelError(
                f"motor {drive.name!r} drives nothing: give at least one coefficient other than zero"
            )
    drives = {drive.name for drive in mechanism.drives}
    for name in sorted(drives & axes):
        raise ModelError(
            f"motor {name!r} has the name of a joint axis: `--active {name}` could mean either; rename it"
        )
    _known("active axis or motor", mechanism.active, axes | drives)
    _known("locked axis", mechanism.lock, axes)
    both = [name for name in mechanism.active if name in set(mechanism.lock)]
    if both:
        raise ModelError(
            f"{', '.join(both)} cannot be active and locked at once: drop it from one of the two"
        )
    _unique("active axis", mechanism.active)
    targets = axes | drives | set(mechanism.joint)
    for motor, axis in mechanism.motors.items():
        _known(f"axis of motor {motor!r}", [axis], targets)


def _axes_with_values(mechanism: Mechanism) -> set[str]:
    return {
        axis
        for joint in mechanism.all_joints
        if not joint.closure and mechanism.type_of(joint).scalar_values
        for axis in mechanism.type_of(joint).axis_names(joint.name)
    }


def _known(kind: str, names: Iterable[str], known: set[str]) -> None:
    for name in names:
        if name not in known:
            raise UnknownNameError(kind, name, sorted(known))


def _finite(what: str, values: Iterable[float]) -> None:
    for value in values:
        if not np.isfinite(value):
            raise NonFiniteError(what, (), float(value))


def _check_reference(mechanism: Mechanism) -> None:
    reference = mechanism.reference
    if reference is None:
        return
    if reference.body not in mechanism.body:
        raise UnknownNameError("body", reference.body, mechanism.body)
    checked(reference.origin, "reference point", (mechanism.space.translations,))
    if reference.axes not in ("ground", "body"):
        raise UnknownNameError("choice of axes", str(reference.axes), ("ground", "body"))
    for joint, cut in reference.cuts.items():
        if joint not in mechanism.joint:
            raise UnknownNameError("joint to cut", joint, mechanism.joint)
        if cut.kind not in ("kept", "contact"):
            raise UnknownNameError(f"kind of cut for joint {joint!r}", cut.kind, ("kept", "contact"))
        if cut.at is not None:
            checked(cut.at, f"cut of joint {joint!r}: at", (mechanism.space.translations,))


def islands(mechanism: Mechanism) -> list[list[str]]:
    """Groups of bodies that ordinary joints hold together, without the one of the ground."""
    parent = {name: name for name in (GROUND, *mechanism.body)}

    def root(name: str) -> str:
        while parent[name] != name:
            parent[name] = parent[parent[name]]
            name = parent[name]
        return name

    for joint in mechanism.joints:
        if not joint.closure:
            parent[root(joint.first)] = root(joint.second)
    groups: dict[str, list[str]] = {}
    for name in mechanism.body:
        if root(name) != root(GROUND):
            groups.setdefault(root(name), []).append(name)
    return list(groups.values())


def implicit_free_joints(mechanism: Mechanism) -> tuple[Joint, ...]:
    """A free joint to the ground for every group of bodies that only contacts or closures hold.

    It goes to the reference member where that is in the group, else to the first body touched.

    Raises:
        TopologyError: A group that nothing holds.
    """
    touched = [end for c in mechanism.contacts for end in (c.first, c.second)]
    touched += [end for j in mechanism.joints if j.closure for end in (j.first, j.second)]
    member = mechanism.reference.body if mechanism.reference else None
    result = []
    for group in islands(mechanism):
        held = [name for name in touched if name in group]
        if not held:
            shown = ", ".join(repr(name) for name in group[:6])
            raise TopologyError(
                f"{shown} {'is' if len(group) == 1 else 'are'} connected to nothing: no joint or contact "
                "leads to the ground. Add one (a floating base has a `free` joint to the ground), or "
                "remove the body."
            )
        body = mechanism.body[member] if member in group and member is not None else mechanism.body[held[0]]
        result.append(_free_joint(mechanism, body.name, body.pose))
    return tuple(result)


def _free_joint(mechanism: Mechanism, body: str, pose: Pose) -> Joint:
    from vincula.mechanism.joint_types import joint_type

    zero = tuple(joint_type("free", mechanism.space).zero)
    identity = Pose.identity(mechanism.space.translations)
    return Joint(f"{body}.free", "free", GROUND, body, pose, identity, home=zero)
