"""A mechanism whose structure is known and whose geometry is traced: what programs are laid out from.

It looks like a `Mechanism` to what lays out tables (`lanes.flatten`, `lanes.closing_flat`): names, rows and
signs are those of the nominal mechanism, frames and directions those of an `Outline`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from vincula.arrays import Vector
from vincula.elementary import larger, power_of_two, sqrt
from vincula.mechanism.drawn_mechanism import Outline
from vincula.mechanism.layout import Layout
from vincula.mechanism.mechanism import Mechanism
from vincula.mechanism.parts import ContactPart, Joint, ReferenceMember
from vincula.numerics.rank import negligible
from vincula.traced import Number, Trace, Traced, holds_traced

SAME_UNIT: Final = 1e-14
"""How far a direction that is a ground axis may be off in lanes: rounding."""


class Untraceable(Exception):  # noqa: N818  never reaches a user: variants are built one by one
    """Something whose dimensions are not traced."""


class Unequal(Traced):
    """A component of a direction that is no axis of its frame: it equals no number, and that is no guard."""

    __slots__ = ()

    def __eq__(self, other: object) -> bool:
        return False

    __hash__ = Traced.__hash__


class Twin:
    """A mechanism with traced geometry.

    Args:
        nominal: The mechanism of the same structure.
        outline: Its geometry, traced.
        trace: The trace.

    Raises:
        Untraceable: What is traced is not frames and directions alone, or the structure is another one.
    """

    def __init__(self, nominal: Mechanism, outline: Outline, trace: Trace) -> None:
        self._nominal, self._trace = nominal, trace
        drawing = outline.drawing
        self.joints: tuple[Joint, ...] = drawing.joints
        self.contacts: tuple[ContactPart, ...] = drawing.contacts
        self._refuse_others(outline)
        self.all_joints = (*self.joints, *nominal.implicit_joints)
        self.joint = {joint.name: joint for joint in self.all_joints}
        self.tree = tuple((self.joint[joint.name], forward) for joint, forward in nominal.tree)
        self.reference = self._reference(outline)
        self.weights = outline.weights or nominal.weights
        self.precision = outline.precision or nominal.precision

    def __getattr__(self, name: str) -> Any:
        return getattr(self._nominal, name)

    def _refuse_others(self, outline: Outline) -> None:
        nominal, drawing = self._nominal, outline.drawing
        pairs = (
            ([_facts(j) for j in nominal.joints], [_facts(j) for j in self.joints]),
            ([_facts(c) for c in nominal.contacts], [_facts(c) for c in self.contacts]),
            ([b.name for b in nominal.bodies], [b.name for b in drawing.bodies]),
        )
        if any(one != two for one, two in pairs):
            raise Untraceable("the outline has other parts")
        for one, two in zip(nominal.bodies, drawing.bodies, strict=True):
            if holds_traced(two.pose.position) or holds_traced(two.pose.rotation):
                raise Untraceable(f"body {two.name!r} stands elsewhere")
            same = np.array_equal(one.pose.position, two.pose.position)
            if not (same and np.array_equal(one.pose.rotation, two.pose.rotation)):
                raise Untraceable(f"body {two.name!r} has another home")
        for joint in self.joints:
            limits = [(limit.lower, limit.upper, limit.rate, limit.effort) for limit in joint.limits]
            if holds_traced([joint.lead, *limits]):
                raise Untraceable(f"joint {joint.name!r}: its limits or its lead are traced")

    def _reference(self, outline: Outline) -> ReferenceMember | None:
        """The member of the nominal mechanism, at the point that is drawn."""
        nominal = self._nominal.reference
        if nominal is None or outline.reference is None or outline.reference.body != nominal.body:
            raise Untraceable("another reference member")
        if any(cut.at is not None for cut in nominal.cuts.values()):
            raise Untraceable("declared cut points")
        drawn: Any = outline.drawing.reference(outline.reference, self)  # type: ignore[arg-type]
        return replace(nominal, origin=drawn.origin)

    @cached_property
    def layout(self) -> Layout:
        """The nominal layout with traced frames and directions."""
        layout, table = self._nominal.layout, self._nominal.layout.frames
        rotation, position = table.rotation.astype(object), table.position.astype(object)
        parts: list[tuple[int, Joint | ContactPart]] = [
            (table.of_joint[joint.name], joint) for joint in self.all_joints
        ]
        parts += [(table.of_contact[contact.name], contact) for contact in self.contacts]
        for index, part in parts:
            for k, pose in enumerate((part.frame_on_first, part.frame_on_second)):
                rotation[index + k], position[index + k] = pose.rotation, pose.position
        screws, blocked = layout.screws, layout.blocked
        axes = screws.axis.astype(object)
        second = {table.of_joint[joint.name]: joint for joint in self.joints if joint.type == "universal"}
        names = {joint.name: self._nominal.type_of(joint).axis_names(joint.name) for joint in self.joints}
        for column, label in enumerate(layout.columns):
            joint = second.get(int(screws.frame[column]) - 1)
            if joint is not None and label.name == names[joint.name][1]:
                axes[column] = self._direction(joint.second_axis, screws.axis[column])
        across = tuple(
            (row, other, self._second_axis(other, axis, second)) for row, other, axis in blocked.across
        )
        return replace(
            layout,
            frames=replace(table, rotation=rotation, position=position),
            screws=replace(screws, axis=axes),
            blocked=replace(blocked, across=across),
        )

    def _second_axis(self, frame: int, nominal: Vector, universal: Mapping[int, Joint]) -> Any:
        joint = universal.get(frame - 1)
        return nominal if joint is None else joint.second_axis

    def _direction(self, axis: Any, nominal: Vector) -> NDArray[Any]:
        """A direction as tables need it: exactly an axis of its frame where the nominal one is."""
        if not holds_traced(axis):
            return np.array(axis, dtype=object)
        if np.count_nonzero(nominal) == 1 and abs(nominal).max() == 1.0:
            for one, two in zip(axis, nominal, strict=True):
                self._trace.guard_near(one, float(two), SAME_UNIT)
            return nominal.astype(object)
        return np.array([Unequal(x.trace, x.place, x.value) if isinstance(x, Traced) else x for x in axis])

    @cached_property
    def length(self) -> Number:
        """Characteristic length, as `kinematics.characteristic_length` takes it."""
        member = self.reference
        bodies = self._nominal.body
        centre = bodies[member.body].pose.apply(member.origin) if member else np.zeros(3)
        parts: Sequence[Joint | ContactPart] = (*self.joints, *self.contacts)
        points = [
            bodies[part.first].pose.apply(part.frame_on_first.position)
            if part.first in bodies
            else part.frame_on_first.position
            for part in parts
            if part.type not in ("free", "fixed")
        ]
        if not points:
            return 1.0
        squares: Any = (np.array(points) - centre) ** 2
        distance = sqrt(squares.sum() / len(points))
        farthest: Number = 0.0
        for x in (*centre, *np.array(points).ravel()):
            farthest = larger(farthest, abs(x))
        return 1.0 if negligible(distance, farthest) else power_of_two(distance)


def _facts(part: Joint | ContactPart) -> tuple[Any, ...]:
    """What of a joint or contact is structure."""
    if isinstance(part, Joint):
        return part.name, part.type, part.first, part.second, part.closure, part.cut, tuple(part.home)
    return part.name, part.type, part.first, part.second
