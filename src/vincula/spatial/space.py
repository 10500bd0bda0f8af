"""The two spaces: the plane (s = 2, d = 3) and ordinary space (s = 3, d = 6).

Twists are (linear velocity, angular velocity), wrenches (force, moment): linear part first.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Space:
    """Dimensions and component names of a space.

    Attributes:
        name: `planar` or `spatial`.
        translations: Number of translations s.
        rotations: Number of rotations (1 or 3).
        twist_components: Names of the components of a twist.
        wrench_components: Names of the components of a wrench.
    """

    name: str
    translations: int
    rotations: int
    twist_components: tuple[str, ...]
    wrench_components: tuple[str, ...]

    def __reduce__(self) -> tuple[object, ...]:
        """A pickle or copy is the same object again: there is one plane, and tests ask `is PLANAR`."""
        return space_named, (self.name,)

    @property
    def dimension(self) -> int:
        """Number of components d of a twist: 3 in the plane, 6 in space."""
        return self.translations + self.rotations

    @property
    def twist_units(self) -> tuple[str, ...]:
        """Units of the twist components."""
        return ("m/s",) * self.translations + ("rad/s",) * self.rotations

    @property
    def wrench_units(self) -> tuple[str, ...]:
        """Units of the wrench components."""
        return ("N",) * self.translations + ("N m",) * self.rotations


PLANAR = Space("planar", 2, 1, ("vx", "vy", "wz"), ("fx", "fy", "mz"))
SPATIAL = Space("spatial", 3, 3, ("vx", "vy", "vz", "wx", "wy", "wz"), ("fx", "fy", "fz", "mx", "my", "mz"))


def space_named(name: str) -> Space:
    """The space called `planar` or `spatial`.

    Raises:
        UnknownNameError: Any other name.
    """
    if name == "planar":
        return PLANAR
    if name == "spatial":
        return SPATIAL
    from vincula.errors import UnknownNameError

    raise UnknownNameError("space", name, ("planar", "spatial"))
