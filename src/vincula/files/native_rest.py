"""What else is wrong with a native file that has problems already: names, motors, member, weights.

These are checked on a mechanism, and where parts of the drawing are refused there is none.  One of the
same names stands in for it, with all its parts at the origin: names need no geometry.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Final

from vincula.errors import DuplicateNameError, ModelError, TopologyError
from vincula.files.native_names import (
    joint_values,
    with_couplings,
    with_keyframes,
    with_locks_and_motors,
    with_reference,
    with_weights,
)
from vincula.files.sketch import Sketch
from vincula.files.tree import Location
from vincula.mechanism.joint_types import joint_type
from vincula.mechanism.mechanism import Mechanism
from vincula.mechanism.parts import GROUND, ContactPart, Joint
from vincula.spatial.poses import Pose

PlaceOf = Callable[[ModelError, Sketch], Location]
"""Where the refusal of a whole mechanism is told."""

STEPS: Final[tuple[Callable[[Sketch, Mechanism], Mechanism], ...]] = (
    with_couplings,
    with_locks_and_motors,
    with_reference,
    with_weights,
    with_keyframes,
)
"""What makes a mechanism of what is drawn, in the order of need."""


def tell_rest(sketch: Sketch, place_of: PlaceOf) -> None:
    """Add the problems of everything that refers to the drawing by name.

    Args:
        sketch: The drawing, with problems.
        place_of: Where the refusal of a whole mechanism is told.
    """
    mechanism = _stand_in(sketch, place_of)
    if mechanism is None:
        return
    for step in STEPS:
        mechanism = step(sketch, mechanism)
    own = {name: given for name, given in sketch.entry.configuration.items() if not _of_base(sketch, name)}
    joint_values(sketch, mechanism, ["configuration"], own)


def _of_base(sketch: Sketch, name: str) -> bool:
    """Whether a configuration value is one of the base's, which were read before the drawing."""
    base = sketch.base
    return base is not None and (name in base.home or name in base.axis_names)


def _stand_in(sketch: Sketch, place_of: PlaceOf) -> Mechanism | None:
    """A mechanism of the same names; None where even its names make none."""
    drawing = sketch.drawing
    here = Pose.identity(drawing.space.translations)
    drawn = {joint.name for joint in drawing.joints} | {contact.name for contact in drawing.contacts}
    joints, contacts = list(drawing.joints), list(drawing.contacts)
    for entry in sketch.entry.joints:
        first, second = (drawing.body_name(name) for name in entry.bodies)
        if entry.name in drawn or first == second:
            sketch.doubt(first, second)
            continue
        kind = _type_of(sketch, entry.name, entry.type)
        home = tuple(float(value) for value in joint_type(kind, drawing.space).zero)
        joints.append(Joint(entry.name, kind, first, second, here, here, home, lead=1.0))
        drawn.add(entry.name)
    for contact in sketch.entry.contacts:
        first, second = (drawing.body_name(name) for name in contact.bodies)
        if contact.name not in drawn and first != second:
            contacts.append(ContactPart(contact.name, "complete", first, second, here, here))
            drawn.add(contact.name)
    try:
        return _of_parts(sketch, joints, contacts)
    except DuplicateNameError:
        return None  # told where the second one is
    except TopologyError as error:
        sketch.problem(place_of(error, sketch), str(error))
    except ModelError as error:
        sketch.problem(place_of(error, sketch), str(error))
        return None
    held = [ContactPart(f"?{b.name}", "complete", GROUND, b.name, here, here) for b in drawing.bodies]
    try:
        return _of_parts(sketch, joints, [*contacts, *held])
    except ModelError:
        return None  # it is told what is wrong with the whole


def _type_of(sketch: Sketch, name: str, kind: str) -> str:
    """The type of a joint, or another one where the space has none of that type: its axes are not known."""
    try:
        joint_type(kind, sketch.drawing.space)
    except TopologyError:
        sketch.doubt(name)
        return "revolute"
    return kind


def _of_parts(sketch: Sketch, joints: Sequence[Joint], contacts: Sequence[ContactPart]) -> Mechanism:
    drawing = sketch.drawing
    parts = {
        "bodies": drawing.bodies,
        "joints": tuple(joints),
        "contacts": tuple(contacts),
        "frames": drawing.frames,
    }
    if sketch.base is not None:
        return replace(sketch.base, **parts)  # type: ignore[arg-type]
    return Mechanism(space=drawing.space, **parts)  # type: ignore[arg-type]
