"""A configuration: the values of every joint, in the units metre and radian."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from vincula.arrays import Vector, checked, frozen
from vincula.errors import ModelError, UnknownNameError, listing


class Configuration(Mapping[str, Vector]):
    """Joint values by joint name: an immutable mapping.

    Revolute, prismatic and screw joints have one value [rad, m, rad]; cylindrical (rotation,
    translation); universal two angles; spherical a quaternion (w, x, y, z); planar (x, y, rotation);
    free (x, y, z, then quaternion w, x, y, z), in the plane (x, y, rotation).
    """

    __slots__ = ("_values",)

    def __init__(self, values: Mapping[str, Vector]) -> None:
        self._values = {name: frozen(np.array(value, dtype=float)) for name, value in values.items()}

    def __getitem__(self, joint: str) -> Vector:
        return self._values[joint]

    def __iter__(self) -> Iterator[str]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    def __repr__(self) -> str:
        inner = ", ".join(f"{name}={np.round(value, 6).tolist()}" for name, value in self.items())
        return f"Configuration({inner})"

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Mapping) or set(self) != set(other):
            return False
        return all(np.array_equal(self[name], other[name]) for name in self)

    __hash__ = None  # type: ignore[assignment]

    @property
    def flat(self) -> Vector:
        """All values one after the other, in the order of the joints [m, rad, quaternions w x y z]."""
        return np.concatenate([*self._values.values(), np.empty(0)])

    def from_flat(self, flat: Vector) -> Configuration:
        """A configuration of the same joints from all values one after the other.

        Raises:
            ShapeError: The wrong number of values.
            NonFiniteError: NaN or infinity.
            ModelError: A quaternion of length zero.
        """
        values = checked(flat, "configuration", (sum(map(len, self._values.values())),))
        found, start = {}, 0
        for joint, old in self._values.items():
            found[joint] = _normalised(joint, values[start : start + len(old)], len(old))
            start += len(old)
        return Configuration(found)

    def replaced(self, values: Mapping[str, float | Sequence[float] | Vector]) -> Configuration:
        """The same configuration with some joints at other values.

        Raises:
            UnknownNameError: A joint that has no value here.
            ShapeError: The wrong number of values.
            NonFiniteError: NaN or infinity.
            ModelError: A quaternion of length zero, or no mapping at all.
        """
        if not isinstance(values, Mapping):
            raise ModelError(
                f"a configuration maps joint names to values, got {type(values).__name__}: "
                f"give {{joint: value}} for {listing(self)}"
            )
        merged = dict(self._values)
        for joint, value in values.items():
            if joint not in merged:
                raise UnknownNameError("joint with a configuration value", joint, merged)
            old = merged[joint]
            what = f"value of joint {joint!r}"
            new = np.atleast_1d(checked(value, what, (None,) * min(np.ndim(value), 1)))
            new = checked(new, what, (len(old),))
            merged[joint] = _normalised(joint, new, len(old))
        return Configuration(merged)


def _normalised(joint: str, value: Vector, count: int) -> Vector:
    """Quaternion parts brought to length one; everything else as it is."""
    if count not in (4, 7):
        return value
    quaternion = value[-4:]
    size = math.hypot(*quaternion)  # which does not overflow
    if size < 1e-6:
        raise ModelError(
            f"value of joint {joint!r}: the quaternion (w, x, y, z) {quaternion.tolist()} has length zero"
        )
    if abs(size - 1.0) < 1e-14:
        return value
    return np.concatenate([value[:-4], quaternion / size])
