"""Entries of a native file as drawn parts, in metres and radians."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from vincula.files import schema
from vincula.files.expressions import Measured
from vincula.files.schema_values import PlacedVector
from vincula.files.units import Scale
from vincula.mechanism.drawing import Contact, DrawnJoint, In, Place
from vincula.mechanism.parts import Coupling, Drive, Limits

if TYPE_CHECKING:
    from vincula.files.schema import ContactEntry, CouplingEntry, DriveEntry, LimitsEntry

Coordinates = list[Measured] | PlacedVector


def position(given: Coordinates, scale: Scale) -> Place:
    """A position [m]."""
    if isinstance(given, PlacedVector):
        return In(given.frame, scale.point(given.xyz))
    return scale.point(given)


def direction(given: Coordinates, scale: Scale) -> Place:
    """A direction, of any length."""
    if isinstance(given, PlacedVector):
        return In(given.frame, scale.direction(given.xyz))
    return scale.direction(given)


def drawn_joint(entry: Any, scale: Scale) -> DrawnJoint:
    """The drawn joint of a joint entry of any type.

    Args:
        entry: One of the joint entries of the schema.
        scale: Units of the file.
    """
    axis = second_axis = None
    if isinstance(entry, schema.UniversalEntry):
        axis, second_axis = (direction(given, scale) for given in entry.axes)
    elif getattr(entry, "axis", None) is not None:
        axis = direction(entry.axis, scale)
    return DrawnJoint(
        entry.name,
        entry.type,
        entry.bodies[0],
        entry.bodies[1],
        at=None if entry.at is None else position(entry.at, scale),
        axis=axis,
        second_axis=second_axis,
        lead=scale.length(entry.lead) if isinstance(entry, schema.ScrewEntry) else 0.0,
        limits=_limits(entry, scale),
    )


def _limits(entry: Any, scale: Scale) -> tuple[Limits, ...]:
    given = getattr(entry, "limits", None)
    if given is None:
        return ()
    if not isinstance(given, list):
        return (_limit(given, scale, entry.type == "prismatic"),)
    linear = [False, entry.type == "cylindrical"]
    return tuple(_limit(limit, scale, is_linear) for limit, is_linear in zip(given, linear, strict=False))


def _limit(given: LimitsEntry, scale: Scale, linear: bool) -> Limits:
    lower, upper, rate = (
        None if number is None else scale.units.inside(number.value, linear)
        for number in (given.lower, given.upper, given.rate)
    )
    return Limits(lower, upper, rate, None if given.effort is None else given.effort.value)


def drawn_contact(entry: ContactEntry, scale: Scale) -> Contact:
    """The drawn contact of an entry."""
    return Contact(
        entry.name,
        entry.bodies[0],
        entry.bodies[1],
        type=entry.type,
        at=position(entry.at, scale),
        normal=direction(entry.normal, scale),
        line=None if entry.line is None else direction(entry.line, scale),
        friction=None if entry.friction is None else entry.friction.value,
    )


def coupling(entry: CouplingEntry, scale: Scale, linear: Mapping[str, bool]) -> Coupling:
    """The coupling of an entry, its coefficients for rates in m/s and rad/s.

    The row is that of the file times a positive number, so that coefficients between axes of one
    kind stay as they are typed: with f_i the size of an axis' unit in m or rad and f, g those of the
    first rate and first driver, rates become c_i f / f_i, drivers c_j g / f_j, and the polynomial
    p(x) becomes f p(x / g).

    Args:
        entry: The entry.
        scale: Units of the file.
        linear: For every axis, whether its rate is a length a second.
    """
    units = scale.units
    rates, first = _coefficients(entry.rates, scale, linear)
    driver, inner = _coefficients(entry.driver, scale, linear)
    return Coupling(
        entry.name,
        rates,
        driver,
        tuple(a.value * first / inner**k for k, a in enumerate(entry.polynomial)),
        {axis: units.inside(number.value, linear[axis]) for axis, number in entry.references.items()},
    )


def drive(entry: DriveEntry, scale: Scale, linear: Mapping[str, bool]) -> Drive:
    """The motor of an entry; its rate is in the unit of the first axis that it drives."""
    drives, _ = _coefficients(entry.drives, scale, linear)
    return Drive(entry.name, drives, linear[next(iter(entry.drives))])


def _coefficients(
    given: Mapping[str, Measured], scale: Scale, linear: Mapping[str, bool]
) -> tuple[dict[str, float], float]:
    sizes = {axis: scale.units.size(linear[axis]) for axis in given}
    first = next(iter(sizes.values()), 1.0)
    result = {
        axis: number.value if sizes[axis] == first else number.value * (first / sizes[axis])
        for axis, number in given.items()
    }
    return result, first


def numbers_of(given: Measured | Sequence[Measured]) -> list[float]:
    """One value or several as a list."""
    return [number.value for number in given] if isinstance(given, Sequence) else [given.value]
