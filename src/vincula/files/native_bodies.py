"""Bodies and named frames of a native file, drawn before the parts that use them."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from vincula.arrays import Matrix
from vincula.errors import TopologyError
from vincula.files.native_parts import direction, position
from vincula.files.problems import shown
from vincula.files.schema_values import PlacedVector
from vincula.files.sketch import Sketch
from vincula.files.tree import Location
from vincula.files.units import Scale
from vincula.mechanism.drawing import Drawing, DrawnBody, Place
from vincula.mechanism.parts import GROUND, Frame
from vincula.spatial.poses import Pose, frame_with_z
from vincula.spatial.space import PLANAR

if TYPE_CHECKING:
    from vincula.files.schema import FrameEntry


def new_bodies(sketch: Sketch) -> Iterator[tuple[str, Location]]:
    """Names of bodies that the base does not have, declared ones first, each with its first place.

    A joint to the `world` leads to the ground, unless a body of that name is declared.
    """
    seen = {GROUND, *(sketch.base.body if sketch.base else ())}
    seen |= set() if "world" in sketch.entry.bodies else {"world"}
    uses: list[tuple[str, Location]] = [(name, ["bodies", name]) for name in sketch.entry.bodies]
    for key, parts in (("joints", sketch.entry.joints), ("contacts", sketch.entry.contacts)):
        for index, part in enumerate(parts):
            uses += [(name, [key, index, "bodies", k]) for k, name in enumerate(part.bodies)]
    for name, location in uses:
        if name not in seen:
            seen.add(name)
            yield name, location


def declare_bodies(sketch: Sketch) -> None:
    """Make the new bodies: free ones first, then those fixed to others, in the order of need."""
    declared = sketch.entry.bodies
    for name in declared:
        if name == GROUND or (sketch.base and name in sketch.base.body):
            there = "the fixed body" if name == GROUND else "a body of the base"
            sketch.problem(["bodies", name], f"{shown(name)} is {there}; it cannot be declared here")
    waiting: dict[str, Location] = {}
    for name, location in new_bodies(sketch):
        sketch.first_use[name] = location
        entry = declared.get(name)
        if entry is not None and entry.fixed_to is not None:
            waiting[name] = location
            continue
        at = _origin(sketch, name)
        if entry is not None and entry.at is not None:
            at = position(entry.at, sketch.scale)
        _declare(sketch, location, DrawnBody(name, at=at))
    _fix_bodies(sketch, waiting)


def _fix_bodies(sketch: Sketch, waiting: dict[str, Location]) -> None:
    known = dict.fromkeys([GROUND, *(body.name for body in sketch.drawing.bodies)])
    while waiting:
        ready = {}
        for name, location in waiting.items():
            entry = sketch.entry.bodies[name]
            if entry is not None and entry.fixed_to in known:
                ready[name] = (location, entry)
        for name, (location, entry) in ready.items():
            at = None if entry.at is None else position(entry.at, sketch.scale)
            _declare(sketch, location, DrawnBody(name, entry.fixed_to, at))
            known[name] = None
            del waiting[name]
        if not ready:
            break
    for name, location in waiting.items():
        target = getattr(sketch.entry.bodies[name], "fixed_to", "")
        if target in waiting:
            sketch.problem([*location, "fixed_to"], "bodies are fixed to each other in a circle")
        else:
            sketch.unknown([*location, "fixed_to"], "body", str(target), known)
        _declare(sketch, location, DrawnBody(name))
    sketch.doubt(*waiting)


def _declare(sketch: Sketch, location: Location, body: DrawnBody) -> None:
    """Make a body; one that is refused is made without what was wrong, so that its parts can be read."""
    sketch.attempt(location, partial(sketch.drawing.add, bodies=[body]))
    if body.name not in (known.name for known in sketch.drawing.bodies):
        sketch.drawing.add(bodies=[DrawnBody(body.name)])


def _origin(sketch: Sketch, name: str) -> Place | None:
    """Origin of a new body's frame: the ground's, in an overlay the reference point of the new member."""
    reference = sketch.entry.reference
    if sketch.base is None or reference is None or reference.body != name or reference.origin is None:
        return None
    given = reference.origin
    if isinstance(given, PlacedVector) and given.frame not in sketch.base.body:
        return None
    return position(given, Scale(sketch.scale.units))


def add_frame(sketch: Sketch, name: str, entry: FrameEntry) -> None:
    """Add a named frame to the drawing; what is wrong with it is told at its place."""
    location: Location = ["frames", name]
    drawing = sketch.drawing
    carrier = drawing.body_name(entry.body)
    if carrier not in {GROUND, *(body.name for body in drawing.bodies)}:
        bodies = [body.name for body in drawing.bodies]
        sketch.unknown([*location, "body"], "body", entry.body, bodies)
        return
    closing = any(name in closure.frames for closure in sketch.entry.closures)
    # Where a frame stands is a dimension of the mechanism only if a loop closes there.
    scale = sketch.scale if closing else Scale(sketch.scale.units)

    def make() -> Frame:
        point = drawing.point(position(entry.at, scale), f"frame {name!r}: at")
        on_body = drawing.frame_pose(carrier).inverse() @ Pose.at(point, _axes(drawing, name, entry, scale))
        return Frame(name, carrier, on_body)

    frame = sketch.attempt(location, make)
    if frame is not None:
        drawing.frames += (frame,)


def _axes(drawing: Drawing, name: str, entry: FrameEntry, scale: Scale) -> Matrix:
    what = f"frame {name!r}"
    x = None if entry.x is None else drawing.direction(direction(entry.x, scale), f"{what}: x")
    if drawing.space is PLANAR:
        if entry.z is not None:
            raise TopologyError(f"{what}: in the plane z is the normal; give x alone")
        return np.eye(2) if x is None else np.array([[x[0], -x[1]], [x[1], x[0]]])
    if entry.z is None and x is None:
        return np.eye(3)
    z = np.array([0.0, 0.0, 1.0])
    if entry.z is not None:
        z = drawing.direction(direction(entry.z, scale), f"{what}: z")
    if x is not None and math.isclose(abs(float(x @ z)), 1.0, abs_tol=1e-12):
        raise TopologyError(f"{what}: x and z are parallel")
    return frame_with_z(z, x)
