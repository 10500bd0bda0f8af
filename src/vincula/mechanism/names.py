"""From the names people give to axes, motors and points.

A text is first looked up as a whole name, then split at its last dot, so that `left.arm` works.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from vincula.arrays import Vector, checked
from vincula.errors import DuplicateNameError, ModelError, TopologyError, UnknownNameError
from vincula.mechanism.parts import GROUND, ContactPart, Joint, _All

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism


def split_names(text: str) -> list[str]:
    """Names of a comma-separated list; a name with a comma is put in double quotes."""
    import csv

    rows = list(csv.reader([text], skipinitialspace=True)) if text.strip() else []
    return [name.strip() for name in rows[0]] if rows else []


def free_axes(mechanism: Mechanism) -> tuple[str, ...]:
    """Every unlocked joint axis that is not part of a free joint (what `all` means)."""
    return tuple(
        axis
        for joint in mechanism.joints
        if joint.type != "free" and not (joint.closure and joint.cut == "contact")
        for axis in mechanism.type_of(joint).axis_names(joint.name)
        if axis not in mechanism.lock
    )


def resolve_motors(mechanism: Mechanism, names: Iterable[str] | str | _All) -> tuple[str, ...]:
    """Axis and drive names for motor, joint and axis names, in the order given."""
    if isinstance(names, _All) or (isinstance(names, str) and names.strip().lower() == "all"):
        return free_axes(mechanism)
    drives = {drive.name for drive in mechanism.drives}
    result: list[str] = []
    for name in split_names(names) if isinstance(names, str) else _listed(names):
        if name in drives:
            found: tuple[str, ...] = (name,)
        elif name in mechanism.motors:
            target = mechanism.motors[name]
            found = (target,) if target in drives else _axes_of(mechanism, target, "axis", ())
        else:
            found = _axes_of(mechanism, name, "motor, joint or axis", (*drives, *mechanism.motors))
        for axis in found:
            if axis in result:
                raise DuplicateNameError("active axis", axis)
            result.append(axis)
    return tuple(result)


def resolve_axes(mechanism: Mechanism, names: Iterable[str] | str) -> tuple[str, ...]:
    """Axis names for joint and axis names; each once, in the order given."""
    found: list[str] = []
    for name in split_names(names) if isinstance(names, str) else _listed(names):
        found.extend(_axes_of(mechanism, name, "joint or axis", ()))
    return tuple(dict.fromkeys(found))


def _listed(names: object) -> list[str]:
    listed: list[str] = []
    for name in names if isinstance(names, Iterable) else [names]:
        if not isinstance(name, str):
            raise ModelError(f"got {name!r}, expected names of joints, axes or motors, or vc.ALL")
        listed.append(name)
    return listed


def _axes_of(mechanism: Mechanism, name: str, kind: str, also: Iterable[str]) -> tuple[str, ...]:
    joint = mechanism.joint.get(name)
    if joint is not None:
        return mechanism.type_of(joint).axis_names(joint.name)
    if name in mechanism.axis_names:
        return (name,)
    raise UnknownNameError(kind, name, [*also, *(j.name for j in mechanism.joints)])


def reference_point(
    mechanism: Mechanism, body: str, origin: Sequence[float] | Vector | None, frame: str | None
) -> tuple[Vector, str]:
    """The reference point in the body's frame, and how to call it.

    Raises:
        UnknownNameError: No such body or frame.
        TopologyError: The ground, or a frame on another body.
    """
    if body in (GROUND, "world") and body not in mechanism.body:
        raise TopologyError(
            "the ground cannot be the reference member: it does not move; name one of "
            + ", ".join(b.name for b in mechanism.bodies[:12])
        )
    if body not in mechanism.body:
        raise UnknownNameError("body", body, mechanism.body)
    if frame is not None:
        frames = {f.name: f for f in mechanism.frames if f.body == body}
        if frame not in frames:
            raise UnknownNameError(f"frame on body {body!r}", frame, frames)
        return frames[frame].pose.position, f"{body}@{frame}"
    if origin is not None:
        point = checked(origin, "reference point", (mechanism.space.translations,))
        return point, f"{body}@{','.join(f'{x:g}' for x in point)}"
    return default_point(mechanism, body), body


def default_point(mechanism: Mechanism, body: str) -> Vector:
    """The body's origin; for a drawn body the mean of its joint and contact points."""
    zero = np.zeros(mechanism.space.translations)
    if not mechanism.body[body].drawn:
        return zero
    parts: tuple[Joint | ContactPart, ...] = (*mechanism.joints, *mechanism.contacts)
    points = [
        (part.frame_on_first if part.first == body else part.frame_on_second).position
        for part in parts
        if body in (part.first, part.second) and part.type not in ("free", "fixed")
    ]
    return np.asarray(np.mean(points, axis=0)) if points else zero
