"""The load report of a native file, and what in it deserves a second look though it is legal."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from vincula.files.names import MOST_COMPARED, similar_name
from vincula.files.schema_values import PlacedVector
from vincula.mechanism.parts import GROUND, ContactPart, Joint

if TYPE_CHECKING:
    from vincula.files.expressions import Measured
    from vincula.files.report import LoadReport
    from vincula.files.schema import JointEntry, NativeFile
    from vincula.mechanism.mechanism import Mechanism

_FAR = 300.0
"""A point so many times farther out than the others is probably in another unit."""


_SETTINGS = ("vincula", "name", "space", "units", "base", "precision")
"""Keys of the root that hold no elements."""


def record_entries(entry: NativeFile, report: LoadReport) -> None:
    """Record every element of the file; of a native file all are used."""
    for kind, named in (("body", entry.bodies), ("frame", entry.frames)):
        for name in named:
            report.used(kind, name)
    for joint in entry.joints:
        report.used("joint", joint.name, joint.type)
        _note_lengths(joint, report)
    for kind, typed in (("contact", entry.contacts), ("closure", entry.closures)):
        for part in typed:
            report.used(kind, part.name, part.type)
    for coupling in entry.couplings:
        report.used("coupling", coupling.name)
    for motor in entry.motors or ():
        report.used("motor", motor if isinstance(motor, str) else motor.name)
    names: dict[str, Iterable[str]] = {
        "keyframe": entry.keyframes,
        "parameter": entry.parameters,
        "lock": entry.lock or (),
        "configuration": entry.configuration,
        "reference": () if entry.reference is None else (entry.reference.body,),
        "weights": () if entry.weights is None else ("",),
        "setting": [key for key in _SETTINGS if key in entry.model_fields_set],
    }
    for kind, elements in names.items():
        for name in elements:
            report.used(kind, name)
    for note in entry.notes:
        report.used("note", "", note)


def _note_lengths(joint: JointEntry, report: LoadReport) -> None:
    """Note axes that were probably meant to be unit vectors and are not."""
    for axis in _directions(joint):
        size = math.hypot(*(number.value for number in axis))
        if not math.isclose(size, 1.0, abs_tol=1e-9) and _has_decimals(size):
            report.note(f"joint {joint.name}: an axis of length {size:.6g} was brought to length one")


def _directions(joint: object) -> list[list[Measured]]:
    given = [getattr(joint, "axis", None), *(getattr(joint, "axes", None) or ())]
    vectors = [place.xyz if isinstance(place, PlacedVector) else place for place in given]
    return [vector for vector in vectors if vector]


def _has_decimals(size: float) -> bool:
    """Whether a length is neither that of a small integer vector nor one at all: 0.98, not sqrt(2)."""
    return not math.isclose(size * size, round(size * size), rel_tol=1e-12)


def note_oddities(
    entry: NativeFile, mechanism: Mechanism, base: Mechanism | None, report: LoadReport
) -> None:
    """Note what is legal and yet probably not meant."""
    _note_similar_bodies(entry, mechanism, base, report)
    _note_far_points(entry, report)
    _note_coincident_joints(mechanism, report)
    if not mechanism.joints:
        report.note("there are no joints: every body is free or held by contacts only")
    if not mechanism.active:
        report.note("no motor is named: every joint is passive")
    if mechanism.reference is None and mechanism.bodies:
        names = ", ".join(body.name for body in mechanism.bodies[:12])
        report.note(f"no reference member is named; candidates: {names}")


def _note_similar_bodies(
    entry: NativeFile, mechanism: Mechanism, base: Mechanism | None, report: LoadReport
) -> None:
    """Note bodies that are named once and look like another one: bodies are declared by use."""
    if len(mechanism.bodies) > MOST_COMPARED:
        return
    member = mechanism.reference.body if mechanism.reference else ""
    parts: tuple[Joint | ContactPart, ...] = (*mechanism.joints, *mechanism.contacts)
    uses = Counter(name for part in parts for name in (part.first, part.second))
    old = set(base.body) if base else set()
    for body in mechanism.bodies:
        name = body.name
        if uses[name] != 1 or name in entry.bodies or name in old or name == member:
            continue
        similar = similar_name(name, [other for other in (*mechanism.body, GROUND) if other != name])
        if similar:
            report.note(f"body {name!r} is named once only; is it {similar!r}?")


def _note_far_points(entry: NativeFile, report: LoadReport) -> None:
    """Note points that are hundreds of times farther out than the rest: millimetres among metres."""
    named = [
        (part.name, [number.value for number in part.at])
        for part in (*entry.joints, *entry.contacts)
        if part.at is not None and not isinstance(part.at, PlacedVector)
    ]
    if len(named) < 3:
        return
    points = np.array([point for _, point in named])
    distances = np.linalg.norm(points - np.median(points, axis=0), axis=1)
    usual = float(np.median(distances))
    for (name, _), distance in zip(named, distances, strict=True):
        if usual > 0.0 and distance > _FAR * usual:
            report.note(
                f"{name} is {distance / usual:.0f} times farther out than the others: is it in another unit?"
            )


def _note_coincident_joints(mechanism: Mechanism, report: LoadReport) -> None:
    """Note two joints of one type between the same bodies at the same place."""
    seen: dict[tuple[object, ...], str] = {}
    for joint in mechanism.joints:
        pose = joint.frame_on_first
        key = (
            joint.type,
            frozenset((joint.first, joint.second)),
            tuple(np.round(pose.position, 12)),
            tuple(np.round(pose.rotation[:, -1], 12)),
        )
        if key in seen:
            report.note(f"joints {seen[key]} and {joint.name} connect the same bodies at the same place")
        seen.setdefault(key, joint.name)
