"""What a picture is made of, before anybody draws it: links, joints, contacts, the reference point.

Positions are in ground axes [m], two numbers each in the plane and three in space.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from vincula.arrays import Matrix, Vector
from vincula.spatial.space import Space

Role = Literal["motor", "driven", "passive", "locked"]
"""Who commands a joint: its own motor, a motor through a transmission, nobody, or the analysis."""


@dataclass(frozen=True, slots=True, eq=False)
class Link:
    """One body: a line through its points, a plate when there are three or more.

    Attributes:
        body: Name of the body.
        points: n x s points where joints and contacts attach, in drawing order.
        member: Whether it is the reference member.
    """

    body: str
    points: Matrix
    member: bool


@dataclass(frozen=True, slots=True, eq=False)
class JointMark:
    """The symbol of one joint.

    Attributes:
        name: Name of the joint.
        type: Joint type.
        at: Where it is drawn.
        axis: Unit direction of its axis; None where it has none (balls; pins in the plane).
        role: Who commands it.
        grounded: Whether one of its bodies is the ground.
    """

    name: str
    type: str
    at: Vector
    axis: Vector | None
    role: Role
    grounded: bool

    @property
    def slides(self) -> bool:
        """Whether it is drawn as a slider on its axis."""
        return self.type in SLIDING


SLIDING = ("prismatic", "cylindrical", "screw")
"""Joint types whose place along their axis is free, so that the picture may choose it."""


@dataclass(frozen=True, slots=True, eq=False)
class ContactMark:
    """The symbol of one contact.

    Attributes:
        name: Name of the contact.
        type: Contact type of Table I.
        at: Contact point.
        normal: Unit normal from the first (limb) body into the second (object).
        ground_side: 1 where the normal points into the ground, -1 out of it, 0 between moving bodies.
    """

    name: str
    type: str
    at: Vector
    normal: Vector
    ground_side: int


@dataclass(frozen=True, slots=True, eq=False)
class GroundMark:
    """Hatching where something is attached to the ground.

    Attributes:
        at: The attachment point.
        towards: Unit direction into the ground.
        rail: True for the guide of a slider, which runs across `towards`.
    """

    at: Vector
    towards: Vector
    rail: bool


@dataclass(frozen=True, slots=True, eq=False)
class ReferenceMark:
    """The reference point.

    Attributes:
        body: The reference member.
        at: The point.
        rotation: s x s; columns are the axes of twist and wrench in ground axes.
    """

    body: str
    at: Vector
    rotation: Matrix


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """A mechanism as drawables at one configuration.

    Attributes:
        name: Name of the mechanism.
        space: PLANAR or SPATIAL.
        links: Bodies.
        joints: Joint symbols.
        contacts: Contact symbols.
        grounds: Ground hatching.
        reference: The reference point; None where no member is named.
    """

    name: str
    space: Space
    links: tuple[Link, ...]
    joints: tuple[JointMark, ...]
    contacts: tuple[ContactMark, ...]
    grounds: tuple[GroundMark, ...]
    reference: ReferenceMark | None

    @property
    def points(self) -> Matrix:
        """n x s: everything that has a place; the ground's origin when nothing has."""
        blocks = [link.points for link in self.links]
        marks: tuple[JointMark | ContactMark, ...] = (*self.joints, *self.contacts)
        blocks += [mark.at[None, :] for mark in marks]
        if self.reference is not None:
            blocks.append(self.reference.at[None, :])
        return np.vstack(blocks) if blocks else np.zeros((1, self.space.translations))

    @property
    def size(self) -> float:
        """The largest extent along an axis [m]; 1 m for a single point."""
        extent = float(np.ptp(self.points, axis=0).max())
        return extent if extent > 0.0 else 1.0
