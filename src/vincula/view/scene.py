"""From a mechanism at a configuration to drawables.

A body is drawn through the points where joints and contacts hold it.  The place of a slider along
its axis says nothing, so the picture puts it between the two bodies that it joins.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from vincula.arrays import Matrix, Vector
from vincula.mechanism.kinematics import part_frames
from vincula.mechanism.mechanism import Mechanism
from vincula.mechanism.parts import GROUND, ContactPart, Joint
from vincula.spatial.poses import Pose
from vincula.spatial.space import PLANAR
from vincula.view.drawables import (
    SLIDING,
    ContactMark,
    GroundMark,
    JointMark,
    Link,
    ReferenceMark,
    Role,
    Scene,
)

DOWN = {2: np.array([0.0, -1.0]), 3: np.array([0.0, 0.0, -1.0])}
"""Where the ground is, unless the picture says otherwise."""


def scene(mechanism: Mechanism, q: Mapping[str, float | Sequence[float] | Vector] | None = None) -> Scene:
    """The drawables of a mechanism at a configuration (the home configuration by default).

    The configuration need not be closed: each body is drawn where its own joint values put it.

    Raises:
        UnknownNameError: A joint in `q` that does not exist.
        ShapeError: The wrong number of values.
    """
    poses = mechanism.body_poses(q)
    places = _places(mechanism, poses)
    reference = _reference(mechanism, poses)
    marks = tuple(
        JointMark(
            joint.name,
            joint.type,
            places[joint.name][1],
            _axis(mechanism, joint, poses),
            _role(mechanism, joint),
            GROUND in (joint.first, joint.second),
        )
        for joint in mechanism.joints
        if joint.name in places
    )
    contacts = tuple(_contact(contact, poses) for contact in mechanism.contacts)
    attached = _attached(mechanism, places, poses)
    links = tuple(
        _link(mechanism, body, points, reference, poses)
        for body, points in attached.items()
        if body != GROUND
    )
    return Scene(
        mechanism.name,
        mechanism.space,
        links,
        marks,
        contacts,
        _grounds(marks, contacts, attached),
        reference,
    )


Places = dict[str, tuple[Vector, Vector]]
"""By joint: the point on its first body and the point on its second body."""


def _places(mechanism: Mechanism, poses: Mapping[str, Pose]) -> Places:
    """Where every joint is drawn; free joints are not, they hold nothing."""
    places: Places = {}
    held: dict[str, list[Vector]] = {}
    for contact in mechanism.contacts:
        for body, frame in zip((contact.first, contact.second), part_frames(contact, poses), strict=True):
            held.setdefault(body, []).append(frame.position)
    pending = []
    for joint in mechanism.joints:
        first, second = part_frames(joint, poses)
        if joint.type == "free" or (joint.type == "fixed" and _unplaced(first, second)):
            continue
        if joint.type in SLIDING:
            pending.append((joint, first, second))
            continue
        places[joint.name] = (first.position, second.position)
        held.setdefault(joint.first, []).append(first.position)
        held.setdefault(joint.second, []).append(second.position)
    for joint, first, second in pending:
        point = _slider_place(mechanism, joint, first, second, held)
        places[joint.name] = (point, point)
    return {joint.name: places[joint.name] for joint in mechanism.joints if joint.name in places}


def _unplaced(first: Pose, second: Pose) -> bool:
    """Whether a joint was drawn without a place: its frames then sit exactly at the ground's origin."""
    return not first.position.any() and not second.position.any()


def _slider_place(
    mechanism: Mechanism, joint: Joint, first: Pose, second: Pose, held: Mapping[str, Sequence[Vector]]
) -> Vector:
    """A point on the slider's axis between the two bodies, or beside the only one that moves."""
    others = [
        np.mean(held[body], axis=0) for body in (joint.first, joint.second) if body != GROUND and body in held
    ]
    if not others:
        return second.position
    middle = np.asarray(np.mean(others, axis=0))
    if _unplaced(first, second):
        return middle
    axis = _direction(mechanism, joint, first)
    return second.position + axis * float(axis @ (middle - second.position))


def _direction(mechanism: Mechanism, joint: Joint, first: Pose) -> Vector:
    return np.asarray(first.rotation[:, 0 if mechanism.space is PLANAR else 2])


def _axis(mechanism: Mechanism, joint: Joint, poses: Mapping[str, Pose]) -> Vector | None:
    if joint.type in ("spherical", "fixed") or (mechanism.space is PLANAR and joint.type != "prismatic"):
        return None
    return _direction(mechanism, joint, part_frames(joint, poses)[0])


def _role(mechanism: Mechanism, joint: Joint) -> Role:
    axes = mechanism.type_of(joint).axis_names(joint.name)
    if any(axis in mechanism.active for axis in axes):
        return "motor"
    driven = {axis for drive in mechanism.drives if drive.name in mechanism.active for axis in drive.drives}
    if driven.intersection(axes):
        return "driven"
    return "locked" if axes and all(axis in mechanism.lock for axis in axes) else "passive"


def _contact(contact: ContactPart, poses: Mapping[str, Pose]) -> ContactMark:
    frame = part_frames(contact, poses)[0]
    side = int(contact.second == GROUND) - int(contact.first == GROUND)
    return ContactMark(contact.name, contact.type, frame.position, frame.rotation[:, -1], side)


def _reference(mechanism: Mechanism, poses: Mapping[str, Pose]) -> ReferenceMark | None:
    reference = mechanism.reference
    if reference is None:
        return None
    pose = poses[reference.body]
    rotation = pose.rotation if reference.axes == "body" else np.eye(mechanism.space.translations)
    return ReferenceMark(reference.body, pose.apply(reference.origin), rotation)


def _attached(mechanism: Mechanism, places: Places, poses: Mapping[str, Pose]) -> dict[str, list[Vector]]:
    """Points of every body, the ground included, in the order of declaration."""
    points: dict[str, list[Vector]] = {name: [] for name in (GROUND, *(b.name for b in mechanism.bodies))}
    for joint in mechanism.joints:
        if joint.name in places:
            on_first, on_second = places[joint.name]
            points[joint.first].append(on_first)
            points[joint.second].append(on_second)
    for contact in mechanism.contacts:
        first, second = part_frames(contact, poses)
        points[contact.first].append(first.position)
        points[contact.second].append(second.position)
    return points


def _link(
    mechanism: Mechanism,
    body: str,
    points: Sequence[Vector],
    reference: ReferenceMark | None,
    poses: Mapping[str, Pose],
) -> Link:
    """A body that is held at one point only reaches to its sites, its origin or the reference point."""
    member = reference is not None and reference.body == body
    ends = list(points)
    if len(ends) < 2:
        ends += [poses[body].apply(frame.pose.position) for frame in mechanism.frames if frame.body == body]
        if not mechanism.body[body].drawn:
            ends.append(poses[body].position)
        if member and reference is not None:
            ends.append(reference.at)
    shape = (-1, mechanism.space.translations)
    return Link(body, _ordered(np.array(ends, dtype=float).reshape(shape)), member)


def _ordered(points: Matrix) -> Matrix:
    """The points as a polygon: turned around their mean in the plane that fits them best."""
    if len(points) < 3:
        return points
    apart = points - points.mean(axis=0)
    along, across = np.linalg.svd(apart)[2][:2]
    return points[np.argsort(np.arctan2(apart @ across, apart @ along), kind="stable")]


def _grounds(
    marks: Sequence[JointMark], contacts: Sequence[ContactMark], attached: Mapping[str, Sequence[Vector]]
) -> tuple[GroundMark, ...]:
    everything = [point for points in attached.values() for point in points]
    if not everything:
        return ()
    low, high = np.min(everything, axis=0), np.max(everything, axis=0)
    found = []
    for mark in marks:
        if mark.grounded:
            towards = _outwards(mark.at, low, high)
            rail = mark.slides and mark.axis is not None
            if rail and mark.axis is not None and len(mark.at) == 2:
                towards = _across(mark.axis)
            found.append(GroundMark(mark.at, towards, rail))
    found += [GroundMark(c.at, c.ground_side * c.normal, False) for c in contacts if c.ground_side]
    return tuple(found)


def _outwards(at: Vector, low: Vector, high: Vector) -> Vector:
    """The axis direction in which the mechanism ends soonest; downwards among equals."""
    if len(at) == 3:
        return DOWN[3]
    left, below = at - low
    right, above = high - at
    reach = {(0, -1): below, (-1, 0): left, (1, 0): right, (0, 1): above}
    return np.array(min(reach, key=lambda k: float(reach[k])), dtype=float)


def _across(axis: Vector) -> Vector:
    """The normal of a planar axis that points downwards (to the right of a vertical one)."""
    normal = np.array([axis[1], -axis[0]])
    return -normal if normal @ DOWN[2] < -1e-9 else normal
