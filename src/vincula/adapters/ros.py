"""A message like ROS's `sensor_msgs/JointState` as a configuration; ROS itself is not needed."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from vincula.arrays import Vector, checked
from vincula.errors import DuplicateNameError, ModelError, ShapeError, UnknownNameError
from vincula.mechanism.configuration import Configuration
from vincula.mechanism.mechanism import Mechanism


class JointState(Protocol):
    """What a message must have: the names of joints, and a position for each [rad or m]."""

    @property
    def name(self) -> list[str]:
        """Names of the joints."""

    @property
    def position(self) -> ArrayLike:
        """Their positions, in the same order."""


def configuration_of(mechanism: Mechanism, joint_state: JointState) -> Configuration:
    """The configuration that a joint state reports; joints it does not name keep their home values.

    A message has one number a joint.  A joint with several axes is given axis by axis (`wrist.1`,
    `wrist.2`), a ball or a free base cannot be.  Loops need not be closed by measured values:
    `mechanism.close(near=...)` finds the closed configuration near by.

    Args:
        mechanism: The mechanism.
        joint_state: Anything with `name` and `position`, such as a `sensor_msgs.msg.JointState`.

    Raises:
        UnknownNameError: A name that is no joint or axis with a value.
        DuplicateNameError: A joint or axis named twice.
        ShapeError: Not one position for every name.
        NonFiniteError: NaN or infinity.
        ModelError: A joint whose orientation is no single number.
    """
    names = [str(name) for name in joint_state.name]
    positions = checked(joint_state.position, "joint state: position", (None,))
    if len(positions) != len(names):
        raise ShapeError("joint state: position", positions.shape, f"({len(names)},): one number a name")
    places = _places(mechanism)
    values: dict[str, Vector] = {}
    seen: set[tuple[str, int]] = set()
    for name, position in zip(names, positions, strict=True):
        joint, index = _place(mechanism, places, name)
        if (joint, index) in seen:
            raise DuplicateNameError("joint of the joint state", name)
        seen.add((joint, index))
        values.setdefault(joint, np.array(mechanism.home[joint]))[index] = position
    return mechanism.configuration(values)


def _places(mechanism: Mechanism) -> dict[str, tuple[str, int]]:
    """Joint and index of the value of every axis that has a number of its own."""
    return {
        axis: (joint.name, index)
        for joint in mechanism.all_joints
        if not joint.closure and mechanism.type_of(joint).scalar_values
        for index, axis in enumerate(mechanism.type_of(joint).axis_names(joint.name))
    }


def _place(mechanism: Mechanism, places: dict[str, tuple[str, int]], name: str) -> tuple[str, int]:
    if name in places:
        return places[name]
    joint = mechanism.joint.get(name)
    if joint is None or joint.closure or name not in mechanism.home:
        raise UnknownNameError("joint", name, places)
    kind = mechanism.type_of(joint)
    raise ModelError(
        f"joint {name!r} is {kind.name} and has {kind.values} values, a joint state has one number a joint"
        + (f": name its axes {', '.join(kind.axis_names(name))}" if kind.scalar_values and kind.axes else "")
    )
