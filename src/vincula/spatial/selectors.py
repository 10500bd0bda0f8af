"""Selectors: which directions of relative velocity a contact or a joint prohibits.

Tables I and II of the paper, every row derived from the physics (which relative velocities are
blocked) because the printed tables are damaged.  A selector is a (rows x d) matrix on the components
of a relative twist in the contact (or joint) frame, linear part first.

Frames: in space the normal (contacts) or the axis (joints) is z, the tangents x and y; for line
contacts x is along the line.  In the plane the frame is (tangent, normal), the tangent being the
normal turned by -90 degrees.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vincula.arrays import Matrix, frozen
from vincula.errors import TopologyError, UnknownNameError, listing
from vincula.spatial.space import PLANAR, Space


@dataclass(frozen=True, slots=True)
class ContactType:
    """One row of Table I.

    Attributes:
        name: Name in files.
        meaning: In words.
        spatial: Blocked components in space (0-2 forces x y z, 3-5 moments x y z).
        planar: Blocked components in the plane (0 tangent, 1 normal, 2 moment), None if it has no
            planar form.
        unilateral: Whether it can only push.
        frictional: Whether it carries tangential forces.
    """

    name: str
    meaning: str
    spatial: tuple[int, ...]
    planar: tuple[int, ...] | None
    unilateral: bool
    frictional: bool


CONTACT_TYPES: dict[str, ContactType] = {
    kind.name: kind
    for kind in (
        ContactType("point", "point without friction", (2,), (1,), True, False),
        ContactType("hard-finger", "point with friction", (0, 1, 2), (0, 1), True, True),
        ContactType("line", "line along x without friction", (2, 4), None, True, False),
        ContactType("line-friction", "line along x with friction", (0, 1, 2, 4, 5), None, True, True),
        ContactType("plane", "plane without friction", (2, 3, 4), None, True, False),
        ContactType(
            "complete", "plane with friction, complete constraint", tuple(range(6)), (0, 1, 2), False, True
        ),
        ContactType("soft-finger", "point with friction and spin resistance", (0, 1, 2, 5), None, True, True),
    )
}
"""The seven contact types of Table I by name."""

_SPATIAL_COMPONENTS = ("fx", "fy", "fz", "mx", "my", "mz")
_PLANAR_COMPONENTS = ("ft", "fn", "mz")


def contact_type(name: str) -> ContactType:
    """The contact type called `name`.

    Raises:
        UnknownNameError: No such type.
    """
    try:
        return CONTACT_TYPES[name]
    except KeyError:
        raise UnknownNameError("contact type", name, CONTACT_TYPES) from None


def contact_components(name: str, space: Space) -> tuple[int, ...]:
    """Indices of the blocked components of a contact type in a space.

    Raises:
        UnknownNameError: No such type.
        TopologyError: The type does not exist in the plane.
    """
    kind = contact_type(name)
    if space is not PLANAR:
        return kind.spatial
    if kind.planar is None:
        planar = [k.name for k in CONTACT_TYPES.values() if k.planar is not None]
        raise TopologyError(f"contact type {name!r} exists in space only; in the plane use {listing(planar)}")
    return kind.planar


def selector(components: tuple[int, ...], space: Space) -> Matrix:
    """The (rows x d) selector that keeps the given components."""
    return frozen(np.eye(space.dimension)[list(components)])


def component_names(components: tuple[int, ...], space: Space) -> tuple[str, ...]:
    """Names of the force components of a contact frame (fx ... mz; ft, fn, mz in the plane)."""
    names = _PLANAR_COMPONENTS if space is PLANAR else _SPATIAL_COMPONENTS
    return tuple(names[index] for index in components)
