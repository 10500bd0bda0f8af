"""Drawing a mechanism: positions and directions in ground axes, as people think of linkages.

Everything is given at the drawn configuration, where every joint value is zero.  A `Drawing` turns
drawn parts into resolved ones; it serves new mechanisms and additions to loaded ones alike.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Final, Literal

import numpy as np

from vincula.arrays import Vector, checked
from vincula.errors import DuplicateNameError, ModelError, TopologyError, UnknownNameError
from vincula.mechanism import names as naming
from vincula.mechanism.joint_types import joint_type
from vincula.mechanism.parts import (
    GROUND,
    SMALLEST_DIRECTION,
    Body,
    ContactPart,
    Cut,
    Frame,
    Joint,
    Limits,
    ReferenceMember,
)
from vincula.mechanism.written import Written
from vincula.spatial.poses import Pose, frame_with_z
from vincula.spatial.selectors import contact_components
from vincula.spatial.space import PLANAR, Space

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism


@dataclass(frozen=True, slots=True)
class In:
    """A position or direction given in the axes of a body or named frame instead of ground axes.

    Attributes:
        frame: Name of the body or frame.
        xyz: The coordinates there [m, or a direction].
    """

    frame: str
    xyz: Sequence[float]


Place = Sequence[float] | Vector | In


@dataclass(frozen=True, slots=True, eq=False)
class DrawnBody:
    """A declared body, or one fixed to another.

    Attributes:
        name: Its name.
        fixed_to: A body that it is rigidly attached to.
        at: Origin of its frame; its axes are ground axes at the drawing.
    """

    name: str
    fixed_to: str | None = None
    at: Place | None = None


@dataclass(frozen=True, slots=True, eq=False)
class DrawnJoint:
    """A joint drawn in ground axes; made by `Revolute`, `Prismatic` and the others."""

    name: str
    type: str
    first: str
    second: str
    at: Place | None = None
    axis: Place | None = None
    second_axis: Place | None = None
    lead: float = 0.0
    limits: tuple[Limits, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class Contact:
    """A contact drawn in ground axes.

    Attributes:
        name: Unique name.
        first: Limb-side body.
        second: Object-side body.
        type: Table I: point, hard-finger, line, line-friction, plane, complete, soft-finger.
        at: Contact point.
        normal: Unit normal from the first body into the second.
        line: Direction of the line, for line contacts.
        friction: Coefficient of friction.
    """

    name: str
    first: str
    second: str
    type: str
    at: Place
    normal: Place
    line: Place | None = None
    friction: float | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Reference:
    """The reference member.

    Attributes:
        body: Its name.
        origin: Reference point; by default the mean of the body's joint and contact points.
        axes: Axes of twist and wrench: `ground` or `body`.
        cuts: How joints are cut, by joint name.
    """

    body: str
    origin: Place | None = None
    axes: Literal["ground", "body"] = "ground"
    cuts: Mapping[str, Cut] = field(default_factory=dict)


_ANYWHERE: Final = ("prismatic", "fixed", "free")
"""Joint types whose constraints do not depend on where the joint is."""


class Drawing:
    """Turns drawn parts into resolved ones.

    Args:
        space: PLANAR or SPATIAL.
        base: A loaded mechanism that is drawn upon, at its home configuration.
    """

    def __init__(self, space: Space, base: Mechanism | None = None) -> None:
        self.space = space
        self.bodies: tuple[Body, ...] = base.bodies if base else ()
        self.frames: tuple[Frame, ...] = base.frames if base else ()
        self.joints: tuple[Joint, ...] = base.joints if base else ()
        self.contacts: tuple[ContactPart, ...] = base.contacts if base else ()
        self._pose: dict[str, Pose] = {GROUND: Pose.identity(space.translations)}
        self._pose.update({body.name: body.pose for body in self.bodies})

    def add(
        self,
        *,
        bodies: Sequence[DrawnBody] = (),
        joints: Sequence[DrawnJoint] = (),
        contacts: Sequence[Contact] = (),
    ) -> None:
        """Add drawn parts; bodies are declared by use."""
        for body in bodies:
            self._declare(body)
        parts: tuple[DrawnJoint | Contact, ...] = (*joints, *contacts)
        for part in parts:
            for name in map(self.body_name, (part.first, part.second)):
                if name not in self._pose:
                    self._new_body(name, Pose.identity(self.space.translations))
        self.joints += tuple(self.joint(self._with_place(j, parts)) for j in joints)
        self.contacts += tuple(self.contact(c) for c in contacts)

    def body_name(self, name: str) -> str:
        """The body that a name means: `world` is the ground where no body is called so."""
        return GROUND if name == "world" and name not in self._pose else name

    def _with_place(self, slide: DrawnJoint, parts: Sequence[DrawnJoint | Contact]) -> DrawnJoint:
        """A slide drawn without a place, put amid the other joints and contacts of its bodies.

        Its motion does not depend on where it is, but pictures, cut points and the characteristic
        length do: a slide left at the origin would make them depend on where the origin is.
        """
        if slide.type != "prismatic" or slide.at is not None:
            return slide
        bodies = {slide.first, slide.second} - {GROUND, "world"}
        near = [
            self.point(part.at, f"{part.name!r}: at")
            for part in parts
            if part.at is not None and bodies & {part.first, part.second}
        ]
        return replace(slide, at=np.mean(near, axis=0)) if near else slide

    def _declare(self, body: DrawnBody) -> None:
        if body.name in self._pose:
            raise DuplicateNameError("body", body.name)
        origin = np.zeros(self.space.translations)
        if body.at is not None:
            origin = self.point(body.at, f"body {body.name!r}: at")
        pose = Pose.at(origin)
        self._new_body(body.name, pose)
        if body.fixed_to is None:
            return
        if body.fixed_to not in self._pose:
            self._new_body(body.fixed_to, Pose.identity(self.space.translations))
        self.joints += (
            Joint(
                f"{body.name}.fixed",
                "fixed",
                body.fixed_to,
                body.name,
                self._pose[body.fixed_to].inverse() @ pose,
                Pose.identity(self.space.translations),
            ),
        )

    def _new_body(self, name: str, pose: Pose) -> None:
        self._pose[name] = pose
        self.bodies += (Body(name, pose, drawn=True),)

    def frame_pose(self, name: str) -> Pose:
        """Pose of a body or named frame in ground axes at the drawing.

        Raises:
            UnknownNameError: No such body or frame.
        """
        if name in self._pose:
            return self._pose[name]
        for frame in self.frames:
            if frame.name == name:
                return self._pose[frame.body] @ frame.pose
        raise UnknownNameError("body or frame", name, [*self._pose, *(f.name for f in self.frames)])

    def point(self, place: Place, what: str) -> Vector:
        """A position in ground axes [m]."""
        shape = (self.space.translations,)
        if isinstance(place, In):
            return self.frame_pose(place.frame).apply(checked(place.xyz, what, shape))
        return checked(place, what, shape)

    def direction(self, place: Place, what: str) -> Vector:
        """A unit direction in ground axes.

        Raises:
            ModelError: The direction is (nearly) zero.
        """
        shape = (self.space.translations,)
        if isinstance(place, In):
            vector = self.frame_pose(place.frame).rotation @ checked(place.xyz, what, shape)
        else:
            vector = checked(place, what, shape)
        size = np.linalg.norm(vector)
        if size < SMALLEST_DIRECTION:
            raise ModelError(f"{what} {vector.tolist()} has no direction: give a vector of length one")
        # A comparison of what may be rounding is no guard of traced numbers: they are always divided.
        return vector if vector.dtype != object and abs(size - 1.0) < 1e-15 else vector / size

    def joint(self, drawn: DrawnJoint) -> Joint:
        """The resolved joint of a drawn one."""
        kind = joint_type(drawn.type, self.space)
        what = f"joint {drawn.name!r}"
        at = np.zeros(self.space.translations)
        if drawn.at is not None or drawn.type not in _ANYWHERE:
            at = self.point(_given(drawn.at, what, "at"), f"{what}: at")
        rotation = np.eye(self.space.translations)
        second_axis = np.array([1.0, 0.0, 0.0])
        if self.space is PLANAR:
            if drawn.type == "prismatic":
                x = self.direction(_given(drawn.axis, what, "axis"), f"{what}: axis")
                rotation = np.array([[x[0], -x[1]], [x[1], x[0]]])
        elif drawn.type == "universal":
            one = self.direction(_given(drawn.axis, what, "axes"), f"{what}: first axis")
            two = self.direction(_given(drawn.second_axis, what, "axes"), f"{what}: second axis")
            if np.linalg.norm(np.cross(one, two)) < SMALLEST_DIRECTION:
                raise ModelError(f"{what}: the two axes of a universal joint are parallel")
            rotation = frame_with_z(one, two)
            second_axis = rotation.T @ two
        elif drawn.type not in ("spherical", "fixed", "free"):
            rotation = frame_with_z(self.direction(_given(drawn.axis, what, "axis"), f"{what}: axis"))
        pose = Pose.at(at, rotation)
        first, second = self.body_name(drawn.first), self.body_name(drawn.second)
        return Joint(
            name=drawn.name,
            type=drawn.type,
            first=first,
            second=second,
            frame_on_first=self._on_body(first, pose),
            frame_on_second=self._on_body(second, pose),
            home=tuple(kind.zero),
            lead=drawn.lead,
            second_axis=second_axis,
            limits=drawn.limits,
            written=Written(None if drawn.type in _ANYWHERE else drawn.at, (drawn.axis, drawn.second_axis)),
        )

    def contact(self, drawn: Contact) -> ContactPart:
        """The resolved contact of a drawn one."""
        contact_components(drawn.type, self.space)
        what = f"contact {drawn.name!r}"
        normal = self.direction(drawn.normal, f"{what}: normal")
        if self.space is PLANAR:
            rotation = np.array([[normal[1], normal[0]], [-normal[0], normal[1]]])
        else:
            rotation = frame_with_z(normal, self._line(drawn, normal, what))
        pose = Pose.at(self.point(drawn.at, f"{what}: at"), rotation)
        first, second = self.body_name(drawn.first), self.body_name(drawn.second)
        return ContactPart(
            drawn.name,
            drawn.type,
            first,
            second,
            self._on_body(first, pose),
            self._on_body(second, pose),
            drawn.friction,
            Written(drawn.at, (drawn.normal, drawn.line)),
        )

    def _line(self, drawn: Contact, normal: Vector, what: str) -> Vector | None:
        if not drawn.type.startswith("line"):
            if drawn.line is not None:
                raise ModelError(f"{what}: only line contacts have a line, {drawn.type!r} has none")
            return None
        if drawn.line is None:
            raise ModelError(f"{what}: a line contact needs `line`, the direction of the line")
        line = self.direction(drawn.line, f"{what}: line")
        if abs(line @ normal) > 1e-6:
            raise ModelError(
                f"{what}: the line {line.tolist()} is not perpendicular to the normal {normal.tolist()}"
            )
        return line

    def _on_body(self, body: str, pose: Pose) -> Pose:
        frame = self._pose[body]
        at_ground_origin = not frame.position.any() and np.array_equal(
            frame.rotation, np.eye(len(frame.position))
        )
        return pose if at_ground_origin else frame.inverse() @ pose

    def reference(self, drawn: Reference, mechanism: Mechanism) -> ReferenceMember:
        """The resolved reference member of a drawn one."""
        if drawn.axes not in ("ground", "body"):
            raise UnknownNameError("choice of axes", str(drawn.axes), ("ground", "body"))
        if drawn.origin is None:
            point, label = naming.reference_point(mechanism, drawn.body, None, None)
        else:
            naming.reference_point(mechanism, drawn.body, None, None)
            ground_point = self.point(drawn.origin, "reference: origin")
            point = self._pose[drawn.body].inverse().apply(ground_point)
            label = f"{drawn.body} at ({', '.join(f'{x:g}' for x in ground_point)})"
        return ReferenceMember(drawn.body, point, drawn.axes, dict(drawn.cuts), label)


def _given(value: Place | None, what: str, key: str) -> Place:
    if value is None:
        raise TopologyError(f"{what} needs `{key}`")
    return value
