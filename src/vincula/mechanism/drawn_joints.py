"""The joints that people draw with, one constructor a type, in ground axes."""

from __future__ import annotations

from vincula.mechanism.drawing import DrawnJoint, Place
from vincula.mechanism.parts import Limits


def Revolute(
    name: str, first: str, second: str, at: Place, axis: Place = (0, 0, 1), *, limits: Limits | None = None
) -> DrawnJoint:
    """A revolute joint about `axis` through `at` (in the plane about its normal)."""
    return DrawnJoint(name, "revolute", first, second, at, axis, limits=_one(limits))


def Prismatic(
    name: str, first: str, second: str, axis: Place, at: Place | None = None, *, limits: Limits | None = None
) -> DrawnJoint:
    """A prismatic joint along `axis`; `at` (any point on it) only places it in pictures."""
    return DrawnJoint(name, "prismatic", first, second, at, axis, limits=_one(limits))


def Screw(
    name: str, first: str, second: str, at: Place, axis: Place, lead: float, *, limits: Limits | None = None
) -> DrawnJoint:
    """A screw about `axis` through `at`; `lead` is its advance a turn [m], right-handed if positive."""
    return DrawnJoint(name, "screw", first, second, at, axis, lead=lead, limits=_one(limits))


def Cylindrical(name: str, first: str, second: str, at: Place, axis: Place) -> DrawnJoint:
    """A cylindrical joint: rotation about and translation along `axis`."""
    return DrawnJoint(name, "cylindrical", first, second, at, axis)


def Universal(name: str, first: str, second: str, at: Place, axes: tuple[Place, Place]) -> DrawnJoint:
    """A universal joint: first axis on the first body, second axis on the second."""
    return DrawnJoint(name, "universal", first, second, at, axes[0], second_axis=axes[1])


def Spherical(name: str, first: str, second: str, at: Place) -> DrawnJoint:
    """A spherical joint (ball) at `at`."""
    return DrawnJoint(name, "spherical", first, second, at)


def PlanarJoint(name: str, first: str, second: str, at: Place, axis: Place = (0, 0, 1)) -> DrawnJoint:
    """A planar joint: two translations normal to `axis`, one rotation about it."""
    return DrawnJoint(name, "planar", first, second, at, axis)


def Fixed(name: str, first: str, second: str, at: Place | None = None) -> DrawnJoint:
    """A fixed joint: the two bodies move as one."""
    return DrawnJoint(name, "fixed", first, second, at)


def Free(name: str, first: str, second: str, at: Place | None = None) -> DrawnJoint:
    """A free joint: the second body floats (a floating base when the first is the ground)."""
    return DrawnJoint(name, "free", first, second, at)


def _one(limits: Limits | None) -> tuple[Limits, ...]:
    return () if limits is None else (limits,)
