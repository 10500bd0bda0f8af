"""Joints, contacts and closures of a native file, drawn on its base or on nothing.

Every part is tried by itself, so that all mistakes are found in one run, each at its place.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

from vincula.files.limits import Limits
from vincula.files.names import MOST_COMPARED, similar_name
from vincula.files.native_bodies import add_frame, declare_bodies, new_bodies
from vincula.files.native_parts import drawn_contact, drawn_joint
from vincula.files.problems import shown
from vincula.files.sketch import Sketch
from vincula.files.tree import Document, Location
from vincula.files.units import Scale
from vincula.mechanism.drawing import Contact, Drawing, DrawnJoint
from vincula.mechanism.parts import Joint
from vincula.spatial.space import PLANAR, Space

if TYPE_CHECKING:
    from vincula.files.schema import NativeFile
    from vincula.files.schema_rest import Touched
    from vincula.mechanism.mechanism import Mechanism


def draw(
    document: Document,
    entry: NativeFile,
    space: Space,
    scale: Scale,
    base: Mechanism | None,
    limits: Limits,
    touched: Touched | None = None,
) -> Sketch:
    """Draw everything that has a place; what is wrong is in the problems of the document."""
    sketch = Sketch(document, entry, Drawing(space, base), scale, base, touched=touched)
    if _refuse_too_many(sketch, limits):
        document.problems.refuse()
    _refuse_repeated_names(sketch)
    declare_bodies(sketch)
    _refuse_slips(sketch)
    for name, frame in entry.frames.items():
        add_frame(sketch, name, frame)
    joints, contacts = _joints(sketch), _contacts(sketch)
    if not document.problems:
        sketch.drawing.add(joints=joints, contacts=contacts)
    for index in range(len(entry.closures)):
        _add_closure(sketch, index)
    return sketch


def _refuse_too_many(sketch: Sketch, limits: Limits) -> bool:
    """Refuse what passes the limits; whether there was any."""
    entry, base, before = sketch.entry, sketch.base, len(sketch.document.problems)
    joints = len(entry.joints) + len(entry.closures) + (len(base.joints) if base else 0)
    if joints > limits.joints:
        sketch.problem(["joints"], f"got {joints} joints, expected at most {limits.joints}")
    if len(entry.contacts) > limits.joints:
        sketch.problem(["contacts"], f"got {len(entry.contacts)} contacts, expected at most {limits.joints}")
    bodies = len(list(new_bodies(sketch))) + (len(base.bodies) if base else 0)
    if bodies > limits.bodies:
        sketch.problem(["bodies"], f"got {bodies} bodies, expected at most {limits.bodies}")
    return len(sketch.document.problems) > before


def _refuse_repeated_names(sketch: Sketch) -> None:
    entry, base = sketch.entry, sketch.base
    kinds: list[tuple[str, list[tuple[str, Any]], list[str]]] = [
        (
            "joint",
            [("joints", entry.joints), ("closures", entry.closures)],
            [j.name for j in base.joints] if base else [],
        ),
        ("contact", [("contacts", entry.contacts)], [c.name for c in base.contacts] if base else []),
        ("coupling", [("couplings", entry.couplings)], [c.name for c in base.couplings] if base else []),
        ("frame", [("frames", entry.frames)], [f.name for f in base.frames] if base else []),
    ]
    for kind, sections, before in kinds:
        seen = set(before)
        for key, part_names in ((key, _names(parts)) for key, parts in sections):
            for step, name in part_names:
                if name in seen:
                    where = "the base" if name in before else "this file"
                    sketch.problem([key, step], f"{where} has a {kind} named {shown(name)} already")
                seen.add(name)
                sketch.first_use.setdefault(name, [key, step])


def _refuse_slips(sketch: Sketch) -> None:
    """Refuse a body that only contacts name, that nothing declares, and that looks like another one."""
    entry = sketch.entry
    meant = {name for joint in entry.joints for name in joint.bodies} | set(entry.bodies)
    meant |= {entry.reference.body} if entry.reference else set()
    known = [body.name for body in sketch.drawing.bodies]
    if len(known) > MOST_COMPARED:
        return
    for name, location in new_bodies(sketch):
        similar = "" if name in meant else similar_name(name, [other for other in known if other != name])
        if similar:
            sketch.problem(
                location,
                f"no joint leads to a body named {shown(name)}; did you mean {shown(similar)}? "
                "(a new free body that looks so is declared in `bodies`)",
            )


def _names(parts: Any) -> list[tuple[str | int, str]]:
    if isinstance(parts, dict):
        return [(name, name) for name in parts]
    return [(index, part.name) for index, part in enumerate(parts)]


def _joints(sketch: Sketch) -> list[DrawnJoint]:
    planar = sketch.drawing.space is PLANAR
    result = []
    for index, entry in enumerate(sketch.entry.joints):
        drawn = drawn_joint(entry, sketch.scale)
        location: Location = ["joints", index]
        _refuse_ends(sketch, location, entry.bodies)
        if planar and entry.type == "revolute" and entry.axis is not None:
            sketch.problem(
                [*location, "axis"], "a revolute joint in the plane turns about its normal: leave `axis` out"
            )
        if not planar and entry.type == "revolute" and entry.axis is None:
            sketch.problem(location, "the key 'axis' is missing: in space a revolute joint has an axis")
            continue
        sketch.attempt(location, partial(sketch.drawing.joint, drawn))
        for limit in drawn.limits:
            if limit.lower is not None and limit.upper is not None and limit.lower > limit.upper:
                sketch.problem(
                    [*location, "limits"], f"lower limit {limit.lower:g} is above upper limit {limit.upper:g}"
                )
        result.append(drawn)
    return result


def _contacts(sketch: Sketch) -> list[Contact]:
    result = []
    for index, entry in enumerate(sketch.entry.contacts):
        drawn = drawn_contact(entry, sketch.scale)
        location: Location = ["contacts", index]
        _refuse_ends(sketch, location, entry.bodies)
        if drawn.friction is not None and drawn.friction < 0.0:
            sketch.problem(
                [*location, "friction"], f"got {drawn.friction:g}, expected a friction that is not negative"
            )
        sketch.attempt(location, partial(sketch.drawing.contact, drawn))
        result.append(drawn)
    return result


def _refuse_ends(sketch: Sketch, location: Location, bodies: Sequence[str]) -> None:
    first, second = (sketch.drawing.body_name(name) for name in bodies)
    if first == second:
        sketch.problem([*location, "bodies"], f"got {shown(bodies[0])} twice, expected two different bodies")


def _add_closure(sketch: Sketch, index: int) -> None:
    entry = sketch.entry.closures[index]
    frames = {frame.name: frame for frame in sketch.drawing.frames}
    missing = [k for k, name in enumerate(entry.frames) if name not in frames]
    for k in missing:
        if entry.frames[k] not in sketch.entry.frames:  # else what is wrong with the frame is told there
            sketch.unknown(["closures", index, "frames", k], "named frame", entry.frames[k], frames)
    if missing:
        return
    first, second = (frames[name] for name in entry.frames)
    if first.body == second.body:
        sketch.problem(["closures", index, "frames"], f"both frames are on body {shown(first.body)}")
        return
    joint = Joint(
        entry.name,
        entry.type,
        first.body,
        second.body,
        first.pose,
        second.pose,
        closure=True,
        cut=entry.cut,
    )
    sketch.drawing.joints += (joint,)
