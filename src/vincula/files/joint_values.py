"""Joint values as files and people write them, brought to the form of a configuration."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from vincula.arrays import Vector
from vincula.errors import ModelError, UnknownNameError
from vincula.files.limits import LARGEST_NUMBER
from vincula.files.units import Units
from vincula.mechanism.configuration import Configuration

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism
    from vincula.mechanism.parts import Joint


class JointValues:
    """Collects values by joint, in metres and radians.

    Args:
        mechanism: The mechanism whose joints are named.
        units: Units of the numbers; quaternions have none.
    """

    def __init__(self, mechanism: Mechanism, units: Units) -> None:
        self._mechanism, self._units = mechanism, units
        self.values: dict[str, Vector] = {}

    def joint_of(self, name: str) -> tuple[Joint, int | None]:
        """The joint that a name means, and which of its values: None for all of them.

        Raises:
            UnknownNameError: Neither a joint nor an axis with a value of its own.
        """
        mechanism = self._mechanism
        if name in mechanism.home:
            return mechanism.joint[name], None
        for joint in mechanism.all_joints:
            kind = mechanism.type_of(joint)
            if joint.name in mechanism.home and kind.scalar_values and name in kind.axis_names(joint.name):
                return joint, kind.axis_names(joint.name).index(name)
        raise UnknownNameError("joint with a configuration value", name, mechanism.home)

    def linear(self, name: str) -> tuple[bool | None, ...]:
        """For every value that a name means: True for a length, False for an angle, None for neither."""
        joint, index = self.joint_of(name)
        kind = self._mechanism.type_of(joint)
        flags: list[bool | None] = list(kind.value_linear)
        if not kind.scalar_values:
            flags[-4:] = [None] * 4
        return tuple(flags) if index is None else (flags[index],)

    def put(self, name: str, numbers: Sequence[float]) -> None:
        """Set the values of a joint, or one value by the name of its axis, in the units of the file.

        Raises:
            UnknownNameError: No such joint or axis.
            ModelError: The wrong number of values, an angle in degrees, a quaternion of length zero.
        """
        flags = self.linear(name)
        if len(numbers) != len(flags):
            raise ModelError(f"{name} has {len(flags)} value{'s' * (len(flags) > 1)}, got {len(numbers)}")
        for number, flag in zip(numbers, flags, strict=True):
            if flag is False:
                self._refuse_degrees(name, number)
        self.put_inside(
            name,
            [
                number if flag is None else self._units.inside(number, flag)
                for number, flag in zip(numbers, flags, strict=True)
            ],
        )

    def put_inside(self, name: str, numbers: Sequence[float]) -> None:
        """Set values that are in metres and radians already.

        Raises:
            ModelError: Values that the joint cannot have.
        """
        for number in numbers:
            if not abs(number) <= LARGEST_NUMBER:
                raise ModelError(
                    f"{name} is {number:g}, expected a number of at most {LARGEST_NUMBER:g} in size"
                )
        joint, index = self.joint_of(name)
        before = self.values.get(joint.name, self._mechanism.home[joint.name])
        new = list(before)
        if index is None:
            new = list(numbers)
        else:
            new[index] = numbers[0]
        alone = Configuration({joint.name: before})
        self.values[joint.name] = alone.replaced({joint.name: new})[joint.name]

    def _refuse_degrees(self, name: str, angle: float) -> None:
        """Angles beyond a full turn under `rad` are degrees by mistake, but for screws, gears and limits."""
        if self._units.angle != "rad" or abs(angle) <= 2.0 * math.pi * (1.0 + 1e-12):
            return
        joint, index = self.joint_of(name)
        turning = {axis for coupling in self._mechanism.couplings for axis in coupling.axes}
        turning.update(axis for drive in self._mechanism.drives for axis in drive.drives)
        axes = set(self._mechanism.type_of(joint).axis_names(joint.name))
        limits = joint.limits[index or 0 : (index or 0) + 1]
        allowed = any(limit.upper is not None and abs(angle) <= limit.upper for limit in limits)
        if joint.type == "screw" or axes & turning or allowed:
            return
        raise ModelError(
            f"{name} is {angle:g}: angles are in radians here and this is more than a full turn; say that "
            "it is in degrees (`units: {angle: deg}` in a file, 30deg in a text) or take full turns off"
        )
