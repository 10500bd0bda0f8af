"""What comes in at the door: configurations, motors or poses, starts, parameters, brought to lanes."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vincula.arrays import Matrix, Vector
from vincula.errors import ModelError, ShapeError, listing
from vincula.kernels.quantities import coordinates, pose_components
from vincula.mechanism.mechanism import Mechanism

Given = Literal["configuration", "motors", "reference"]
"""What the numbers of a batch are: whole configurations, motor values, poses of the reference member."""


@dataclass(frozen=True, slots=True, eq=False)
class Batch:
    """A batch with its dimensions flattened to lanes.

    Attributes:
        shape: Dimensions of the batch.
        given: What the values are.
        values: lanes x numbers; None for the home configuration of every lane.
        starts: lanes x coordinates, where closing starts in every lane; None when lanes follow each other.
        first: Where the first lane starts; None for home.
        parameters: Values a lane, by name.
        alike: Whether lanes with other ranks than usual may be computed together.
    """

    shape: tuple[int, ...]
    given: Given
    values: Matrix | None
    starts: Matrix | None
    first: Vector | None
    parameters: Mapping[str, Vector]
    alike: bool = False

    @property
    def lanes(self) -> int:
        """Number of configurations."""
        return int(np.prod(self.shape, dtype=np.int64))

    def one(self, lane: int) -> Batch:
        """The batch of one lane alone."""
        part = slice(lane, lane + 1)
        return Batch(
            shape=(),
            given=self.given,
            values=None if self.values is None else self.values[part],
            starts=None if self.starts is None else self.starts[part],
            first=self.first,
            parameters={name: values[part] for name, values in self.parameters.items()},
        )

    def parameters_at(self, lane: int) -> dict[str, float]:
        """Parameter values of one lane."""
        return {name: float(values[lane]) for name, values in self.parameters.items()}


def names_of(mechanism: Mechanism, given: Given) -> tuple[str, ...]:
    """Names of the numbers that describe one configuration.

    Raises:
        ModelError: Unknown `given`, or motors of a ball, which have no values of their own.
    """
    if given == "configuration":
        return coordinates(mechanism)
    if given == "reference":
        return pose_components(mechanism)
    if given != "motors":
        raise ModelError(f"given is {given!r}: choose {listing(get_args(Given))}")
    balls = {
        axis: joint.name
        for joint in mechanism.all_joints
        if not mechanism.type_of(joint).scalar_values
        for axis in mechanism.type_of(joint).axis_names(joint.name)
    }
    for motor in mechanism.active:
        if motor in balls:
            raise ModelError(
                f"motor {motor!r} turns the ball {balls[motor]!r}, which has no value a motor: give whole "
                "configurations instead"
            )
    return mechanism.active


def batch_of(
    mechanism: Mechanism,
    given: Given,
    values: ArrayLike | Mapping[str, Any] | None,
    start: ArrayLike | Mapping[str, Any] | None,
    parameters: Mapping[str, ArrayLike],
) -> Batch:
    """The batch of a call, with all its dimensions broadcast together.

    Raises:
        ShapeError: Not one number a name along the last axis, or dimensions that do not fit together.
        ModelError: Nothing given where motors or poses are needed, or a start where nothing is closed.
    """
    names = names_of(mechanism, given)
    if isinstance(values, Mapping):
        values = mechanism.configuration(values).flat if given == "configuration" else _named(values, names)
    if values is None and given != "configuration":
        raise ModelError(f"nothing is given: give an array with {listing(names)} along its last axis")
    if start is not None and given == "configuration":
        raise ModelError(
            "start says where closing starts, but whole configurations are given: nothing is closed"
        )
    if isinstance(start, Mapping):
        start = mechanism.configuration(start).flat
    rows = None if values is None else _table(values, "configurations", names)
    starts = None if start is None else _table(start, "start", coordinates(mechanism))
    per_lane = {name: _numbers(value, f"parameter {name!r}") for name, value in parameters.items()}
    shapes = [array.shape for array in per_lane.values()]
    shapes += [table.shape[:-1] for table in (rows, starts) if table is not None]
    try:
        shape = np.broadcast_shapes(*shapes)
    except ValueError:
        raise ShapeError(
            "the batch", (), f"dimensions that fit together, got {listing(map(str, shapes))}"
        ) from None
    own = None if starts is None or starts.ndim == 1 else _lanes(starts, shape)
    return Batch(
        shape=shape,
        given=given,
        values=None if rows is None else _lanes(rows, shape),
        starts=own,
        first=starts if own is None else None,
        parameters={name: np.broadcast_to(value, shape).reshape(-1) for name, value in per_lane.items()},
    )


def _named(values: Mapping[str, Any], names: tuple[str, ...]) -> list[Any]:
    missing = [name for name in names if name not in values]
    if missing or len(values) != len(names):
        raise ModelError(f"values are needed for exactly {listing(names)}, got {listing(map(str, values))}")
    return [values[name] for name in names]


def _table(values: ArrayLike, what: str, names: tuple[str, ...]) -> Matrix:
    array = _numbers(values, what)
    if array.ndim == 0 or array.shape[-1] != len(names):
        raise ShapeError(what, array.shape, f"(..., {len(names)}), in the order {listing(names)}")
    return array


def _numbers(values: ArrayLike, what: str) -> NDArray[np.float64]:
    try:
        if np.iscomplexobj(values):
            raise TypeError
        return (
            np.ascontiguousarray(values, dtype=np.float64)
            if np.ndim(values)
            else np.asarray(values, np.float64)
        )
    except (TypeError, ValueError):
        raise ShapeError(what, np.shape(np.asarray(values, dtype=object)), "an array of numbers") from None


def _lanes(table: Matrix, shape: tuple[int, ...]) -> Matrix:
    if table.shape[:-1] != shape:  # what is broadcast is read-only, and would be copied for the kernels
        table = np.broadcast_to(table, (*shape, table.shape[-1]))
    return np.ascontiguousarray(table).reshape(math.prod(shape), table.shape[-1])  # there may be no motors
