"""From drawn parts to a mechanism."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

from vincula.mechanism.drawing import Contact, Drawing, DrawnBody, DrawnJoint, Reference
from vincula.mechanism.kinds import refuse_other_kinds
from vincula.mechanism.mechanism import Mechanism
from vincula.mechanism.parts import Coupling, Drive, _All
from vincula.spatial.space import Space
from vincula.weights import Weights


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
    """A mechanism from drawn parts; see `Mechanism.planar` and `Mechanism.spatial`."""
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
