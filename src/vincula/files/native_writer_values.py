"""Values of a mechanism as a native file has them: displacements from its home configuration."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from vincula.arrays import Matrix, Vector
from vincula.files.native_losses import drawn_axes
from vincula.mechanism.joint_types import motion, values_between
from vincula.mechanism.parts import Coupling, Joint, Limits
from vincula.mechanism.residuals import axis_values
from vincula.spatial.poses import Pose
from vincula.weights import QUANTITIES, Weights

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism


def numbers(values: Vector | Matrix) -> list[Any]:
    """An array as lists of numbers that read back to the same doubles; no negative zeros."""
    return (np.asarray(values, dtype=float) + 0.0).tolist()  # type: ignore[no-any-return]


def limits_entry(limit: Limits, home: float) -> dict[str, float]:
    """Limits of an axis whose value was `home` where it is drawn now."""
    entry: dict[str, float] = {}
    if limit.lower is not None:
        entry["lower"] = float(limit.lower - home)
    if limit.upper is not None:
        entry["upper"] = float(limit.upper - home)
    if limit.rate is not None:
        entry["rate"] = float(limit.rate)
    if limit.effort is not None:
        entry["effort"] = float(limit.effort)
    return entry


def coupling_entry(coupling: Coupling, mechanism: Mechanism) -> dict[str, Any]:
    """A coupling, its references counted from the home configuration."""
    home = axis_values(mechanism, mechanism.home)
    entry: dict[str, Any] = {"name": coupling.name, "rates": _plain(coupling.rates)}
    if coupling.driver:
        entry |= {"driver": _plain(coupling.driver), "polynomial": [float(a) for a in coupling.polynomial]}
    moved = {axis: float(value - home[axis]) for axis, value in coupling.references.items() if axis in home}
    references = {axis: value for axis, value in moved.items() if value != 0.0}
    return entry | ({"references": references} if references else {})


def _plain(named: Mapping[str, float]) -> dict[str, float]:
    return {name: float(value) for name, value in named.items()}


def weights_entry(weights: Weights) -> dict[str, Any]:
    """The weights that are given."""
    entry: dict[str, Any] = {}
    for quantity in QUANTITIES:
        spec = getattr(weights, quantity)
        if isinstance(spec, Mapping):
            entry[quantity] = _plain(spec)
        elif isinstance(spec, str):
            entry[quantity] = spec
        elif spec is not None:
            entry[quantity] = numbers(spec)
    return entry | ({"reciprocal": True} if weights.reciprocal else {})


def keyframe_entry(
    values: Mapping[str, Sequence[float]], mechanism: Mechanism, poses: Mapping[str, Pose]
) -> dict[str, Any]:
    """A named configuration as displacements; joints that stay at home are left out."""
    q = mechanism.configuration(dict(values))
    entry: dict[str, Any] = {}
    for joint in mechanism.joints:
        if joint.closure or np.array_equal(q[joint.name], mechanism.home[joint.name]):
            continue
        displaced = numbers(_displacement(joint, q[joint.name], mechanism, poses))
        entry[joint.name] = displaced[0] if len(displaced) == 1 else displaced
    return entry


def _displacement(joint: Joint, value: Vector, mechanism: Mechanism, poses: Mapping[str, Pose]) -> Vector:
    """Values of the joint drawn at home that bring its bodies where `value` has them."""
    kind = mechanism.type_of(joint)
    home = mechanism.home[joint.name]
    if kind.scalar_values and joint.type not in ("planar", "free"):
        return value - home
    first = poses[joint.first] @ joint.frame_on_first
    second = poses[joint.second] @ joint.frame_on_second
    drawn = Pose.at(second.position, drawn_axes(joint, first))
    carried = first @ motion(kind, value, joint.lead, joint.second_axis) @ second.inverse()
    return values_between(kind, drawn, carried @ drawn, joint.second_axis)
