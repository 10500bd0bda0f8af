"""From drawn parts to a mechanism."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import cast

from vincula.mechanism.drawing import Contact, Drawing, DrawnBody, DrawnJoint, Reference
from vincula.mechanism.kinds import refuse_other_kinds
from vincula.mechanism.mechanism import Mechanism
from vincula.mechanism.parts import ContactPart, Coupling, Drive, Joint, Precision, _All
from vincula.spatial.space import Space
from vincula.traced import holds_traced
from vincula.weights import Weights


@dataclass(frozen=True, slots=True, eq=False)
class Outline:
    """What is drawn with traced numbers: the geometry of many mechanisms of one structure.

    Attributes:
        drawing: Joints, contacts and bodies.
        reference: The reference member as it is drawn; None where none is named.
        weights: Weights declared with the mechanism; None for those of the nominal one.
        precision: Typed digits and tolerances, where they are traced; None for those of the mechanism.
    """

    drawing: Drawing
    reference: Reference | None
    weights: Weights | None
    precision: Precision | None = None


def is_traced(drawing: Drawing) -> bool:
    """Whether anything is drawn with traced numbers, so that it is an outline and no mechanism."""
    parts: list[Joint | ContactPart] = [*drawing.joints, *drawing.contacts]
    poses = [pose for part in parts for pose in (part.frame_on_first, part.frame_on_second)]
    poses += [body.pose for body in drawing.bodies]
    return any(holds_traced(array) for pose in poses for array in (pose.rotation, pose.position))


def draw(
    space: Space,
    joints: Sequence[DrawnJoint],
    contacts: Sequence[Contact],
    couplings: Sequence[Coupling],
    drives: Sequence[Drive],
    bodies: Sequence[DrawnBody],
    reference: Reference | None,
    active: Iterable[str] | str | _All,
    lock: Iterable[str] | str,
    weights: Weights | None,
    name: str,
) -> Mechanism:
    """A mechanism from drawn parts; see `Mechanism.planar` and `Mechanism.spatial`.

    From parts drawn with traced numbers (see `vincula.traced`) it is an `Outline`.
    """
    lists = {
        "joints": joints,
        "contacts": contacts,
        "couplings": couplings,
        "drives": drives,
        "bodies": bodies,
    }
    refuse_other_kinds(lists, reference, weights)
    drawing = Drawing(space)
    drawing.add(bodies=bodies, joints=joints, contacts=contacts)
    if is_traced(drawing) or (reference is not None and holds_traced(reference.origin)):
        outline = Outline(drawing, reference, weights)
        return cast("Mechanism", outline)
    mechanism = Mechanism(
        space=space,
        bodies=drawing.bodies,
        joints=drawing.joints,
        contacts=drawing.contacts,
        frames=drawing.frames,
        couplings=tuple(couplings),
        drives=tuple(drives),
        weights=weights,
        name=name,
    )
    mechanism = mechanism.with_lock(lock)
    if reference is not None:
        mechanism = replace(mechanism, reference=drawing.reference(reference, mechanism))
    return mechanism.with_active(active)
