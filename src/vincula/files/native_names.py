"""What a native file says about named parts: couplings, motors, locks, member, weights, values."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

from vincula.errors import ModelError, listing
from vincula.files.joint_values import JointValues
from vincula.files.native_parts import coupling, drive, numbers_of, position
from vincula.files.problems import shown
from vincula.files.schema import DriveEntry, NamedMotorEntry, ReferenceEntry
from vincula.files.sketch import Sketch
from vincula.files.tree import Location
from vincula.files.units import Scale
from vincula.files.weights import weight_problems, weights_of_entry
from vincula.mechanism.drawing import Reference
from vincula.mechanism.motor_weights import weights_from_limits
from vincula.mechanism.parts import GROUND, Coupling, Cut, Drive
from vincula.mechanism.residuals import axis_linear

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism


def with_couplings(sketch: Sketch, mechanism: Mechanism) -> Mechanism:
    """The mechanism with the couplings and the combining motors of the file."""
    linear = axis_linear(mechanism)
    couplings: list[Coupling] = []
    for index, entry in enumerate(sketch.entry.couplings):
        tables = (("rates", entry.rates), ("driver", entry.driver), ("references", entry.references))
        named = [_known_axes(sketch, ["couplings", index, key], table, linear) for key, table in tables]
        if bool(entry.driver) != bool(entry.polynomial):
            sketch.problem(["couplings", index], "`driver` and `polynomial` belong together")
        elif all(named):
            couplings.append(coupling(entry, sketch.scale, linear))
    drives: list[Drive] = []
    for index, motor in enumerate(sketch.entry.motors or ()):
        if not isinstance(motor, DriveEntry):
            continue
        if motor.name in {*linear, *mechanism.joint, *(d.name for d in mechanism.drives)}:
            sketch.problem(
                ["motors", index, "name"], f"{shown(motor.name)} is the name of a joint or motor already"
            )
        elif _known_axes(sketch, ["motors", index, "drives"], motor.drives, linear):
            drives.append(drive(motor, sketch.scale, linear))
    every, motors = (*mechanism.couplings, *couplings), (*mechanism.drives, *drives)
    try:
        return replace(mechanism, couplings=every, drives=motors)
    except ModelError:
        _try_one_by_one(sketch, mechanism, couplings, drives)
        return mechanism


def _try_one_by_one(
    sketch: Sketch, mechanism: Mechanism, couplings: list[Coupling], drives: list[Drive]
) -> None:
    """Tell which of the couplings and motors cannot be used."""
    places = {entry.name: index for index, entry in enumerate(sketch.entry.couplings)}
    for one in couplings:
        sketch.attempt(["couplings", places[one.name]], partial(replace, mechanism, couplings=(one,)))
    motors = [motor if isinstance(motor, str) else motor.name for motor in sketch.entry.motors or ()]
    for motor in drives:
        sketch.attempt(["motors", motors.index(motor.name)], partial(replace, mechanism, drives=(motor,)))
    if not sketch.document.problems:
        sketch.attempt(["couplings"], partial(replace, mechanism, couplings=couplings, drives=drives))


def _known_axes(sketch: Sketch, location: Location, named: Iterable[str], linear: Mapping[str, bool]) -> bool:
    missing = [name for name in named if name not in linear]
    for name in missing:
        sketch.unknown([*location, name], "joint axis", name, linear)
    return not missing


def with_locks_and_motors(sketch: Sketch, mechanism: Mechanism) -> Mechanism:
    """The mechanism with the locks and motors of the file instead of those of the base."""
    entry = sketch.entry
    if entry.lock is not None:
        names = [
            name for index, name in enumerate(entry.lock) if _axes(sketch, mechanism, ["lock", index], name)
        ]
        mechanism = mechanism.with_lock(names)
    if entry.motors is None:
        return mechanism
    active: dict[str, int] = {}
    motors = dict(mechanism.motors)
    for index, motor in enumerate(entry.motors):
        if isinstance(motor, NamedMotorEntry):
            found = sketch.attempt(["motors", index, "axis"], partial(_one_axis, mechanism, motor.axis))
            motors.update({motor.name: found[0]} if found else {})
        else:
            name = motor if isinstance(motor, str) else motor.name
            if not isinstance(motor, str) and name not in {drive.name for drive in mechanism.drives}:
                continue  # already told
            found = sketch.attempt(["motors", index], partial(mechanism.resolve_motors, [name]))
        for axis in found or ():
            if axis in active:
                sketch.problem(["motors", index], f"{shown(axis)} is a motor already: motors[{active[axis]}]")
            elif axis in mechanism.lock:
                sketch.problem(
                    ["motors", index], f"{shown(axis)} is locked; take it out of `lock` or of `motors`"
                )
            else:
                active[axis] = index
    return replace(mechanism, active=tuple(active), motors=motors)


def _one_axis(mechanism: Mechanism, name: str) -> tuple[str, ...]:
    found = mechanism.resolve_axes([name])
    if len(found) != 1:
        raise ModelError(f"{shown(name)} has {len(found)} axes, expected one of {listing(found)}")
    return found


def _axes(sketch: Sketch, mechanism: Mechanism, location: Location, name: str) -> bool:
    return sketch.attempt(location, partial(mechanism.resolve_axes, [name])) is not None


def with_reference(sketch: Sketch, mechanism: Mechanism) -> Mechanism:
    """The mechanism with the reference member of the file."""
    entry = sketch.entry.reference
    if entry is None:
        return mechanism
    scale = Scale(sketch.scale.units)
    cuts = _cuts(sketch, mechanism, entry, scale)
    if entry.body == GROUND or (entry.body == "world" and "world" not in mechanism.body):
        members = ", ".join(list(mechanism.body)[:12])
        sketch.problem(
            ["reference", "body"], f"the ground does not move, expected a body that does, one of {members}"
        )
        return mechanism
    if entry.body not in mechanism.body:
        sketch.unknown(["reference", "body"], "body", entry.body, mechanism.body)
        return mechanism
    origin = None if entry.origin is None else position(entry.origin, scale)
    drawn = Reference(entry.body, origin, entry.axes, cuts)
    member = sketch.attempt(["reference"], partial(sketch.drawing.reference, drawn, mechanism))
    return mechanism if member is None else replace(mechanism, reference=member)


def _cuts(sketch: Sketch, mechanism: Mechanism, entry: ReferenceEntry, scale: Scale) -> dict[str, Cut]:
    """How joints are cut; what cannot be used is told at its place."""
    cuts: dict[str, Cut] = {}
    for name, cut in entry.cuts.items():
        location: Location = ["reference", "cuts", name]
        if name not in mechanism.joint:
            sketch.unknown(location, "joint", name, mechanism.joint)
            continue
        point = None
        if cut.kind == "contact" and cut.at is not None and mechanism.type_of(mechanism.joint[name]).axes:
            sketch.problem(
                [*location, "at"],
                "a joint cut as a contact is cut at its centre: leave `at` out, or say kind: kept",
            )
        elif cut.at is not None:
            point = sketch.attempt(
                [*location, "at"], partial(sketch.drawing.point, position(cut.at, scale), "cut point")
            )
        cuts[name] = Cut(cut.kind, None if point is None else tuple(float(x) for x in point))
    return cuts


def with_weights(sketch: Sketch, mechanism: Mechanism) -> Mechanism:
    """The mechanism with the weights of the file."""
    entry = sketch.entry.weights
    if entry is None:
        return mechanism
    if isinstance(entry, str):
        weights = sketch.attempt(["weights"], partial(weights_from_limits, mechanism))
    elif wrong := list(weight_problems(entry, mechanism)):
        for key, message in wrong:
            sketch.problem(["weights", key], message)
        return mechanism
    else:
        weights = sketch.attempt(["weights"], partial(weights_of_entry, entry))
    return mechanism if weights is None else mechanism.with_weights(weights)


def joint_values(
    sketch: Sketch, mechanism: Mechanism, location: Location, given: Mapping[str, Any]
) -> JointValues:
    """Values by joint, in metres and radians; what cannot be used is told at its place.

    Args:
        sketch: The file.
        mechanism: Whose joints are named.
        location: Where the table of values is.
        given: Its content.
    """
    values = JointValues(mechanism, sketch.scale.units)
    for name, numbers in given.items():
        sketch.attempt([*location, name], partial(values.put, name, numbers_of(numbers)))
    return values


def with_keyframes(sketch: Sketch, mechanism: Mechanism) -> Mechanism:
    """The mechanism with the named configurations of the file."""
    keyframes = dict(mechanism.keyframes)
    for name, given in sketch.entry.keyframes.items():
        values = joint_values(sketch, mechanism, ["keyframes", name], given).values
        keyframes[name] = {joint: tuple(map(float, value)) for joint, value in values.items()}
    return replace(mechanism, keyframes=keyframes) if sketch.entry.keyframes else mechanism
