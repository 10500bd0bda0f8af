"""Weights that a mechanism itself gives: from its limits, and for the motors that it has just now."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from vincula.errors import UnknownNameError, WeightError, listing
from vincula.weights import Quantity, Weights, metric_of

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism
    from vincula.mechanism.parts import Limits


def weights_from_limits(mechanism: Mechanism) -> Weights:
    """Weights 1/limit^2: rates from rate limits, torques from effort limits.

    A motor at its limit then counts as one, so that efficiencies compare motors of different size.
    A motor that drives several axes, r = sum of c_i q_i, reaches at most the rate sum of |c_i| times the
    limits of the axes, and at most the torque with which none of them passes its effort limit, the
    smallest limit / |c_i|.
    Every joint axis with a limit is weighed, so that the weights stay right for other motors.  A kind
    of limit that no motor has leaves its weights at one.

    Raises:
        WeightError: No motor has a limit, or some have one and others have not, or a limit is zero.
    """
    limits = axis_limits(mechanism)
    rate = {name: limit.rate for name, limit in limits.items() if limit.rate is not None}
    effort = {name: limit.effort for name, limit in limits.items() if limit.effort is not None}
    for drive in mechanism.drives:
        shares = {axis: abs(share) for axis, share in drive.drives.items() if share}
        if shares.keys() <= rate.keys():
            rate[drive.name] = sum(share * rate[axis] for axis, share in shares.items())
        if shares.keys() <= effort.keys():
            effort[drive.name] = min(effort[axis] / share for axis, share in shares.items())
    if not set(mechanism.active) & (rate.keys() | effort.keys()):
        raise WeightError(
            f"weights from limits: the file gives no rate and no effort limit for {listing(mechanism.active)}"
        )
    return Weights(
        rate=_inverse_squares(rate, mechanism.active, "rate"),
        torque=_inverse_squares(effort, mechanism.active, "effort"),
    )


def axis_limits(mechanism: Mechanism) -> dict[str, Limits]:
    """Limits of every joint axis that has some."""
    return {
        axis: limits
        for joint in mechanism.joints
        if joint.limits
        for axis, limits in zip(mechanism.type_of(joint).axis_names(joint.name), joint.limits, strict=False)
    }


def refuse_misfit(weights: Weights, quantity: Quantity, mechanism: Mechanism) -> None:
    """Refuse a weight that fits no configuration and no choice of motors of a mechanism.

    Names of rates and torques may be those of any axis, joint or motor; lists of rates and torques are
    checked later, with the motors that there are then.

    Raises:
        WeightError: Wrong size, not symmetric, negative or indefinite.
        UnknownNameError: A name that the mechanism does not have.
    """
    spec = getattr(weights, quantity)
    if quantity in ("twist", "wrench") and spec is not None:
        space = mechanism.space
        components = space.twist_components if quantity == "twist" else space.wrench_components
        metric_of(spec, quantity, [(name,) for name in components])
    elif isinstance(spec, np.ndarray) and spec.ndim == 2:
        metric_of(spec, quantity, [(str(index),) for index in range(len(spec))])
    elif isinstance(spec, Mapping) and quantity != "contact_force":
        known = _names_of_motors(mechanism)
        for name in spec:
            if name not in known:
                raise UnknownNameError(f"{quantity} component", name, known)


def _names_of_motors(mechanism: Mechanism) -> dict[str, None]:
    """Everything that may be the name of a motor: motors, drives, axes, joints."""
    axes = {axis: None for j in mechanism.all_joints for axis in mechanism.type_of(j).axis_names(j.name)}
    joints = {joint.name: None for joint in mechanism.all_joints}
    return {
        **dict.fromkeys(mechanism.motors),
        **{drive.name: None for drive in mechanism.drives},
        **axes,
        **joints,
    }


def weights_of_motors(mechanism: Mechanism) -> Weights | None:
    """The mechanism's weights without names that carry no motor just now.

    A file may weigh every joint that may ever be a motor; those that are passive in this design have
    no rate to weigh.  Names that the mechanism does not have at all stay, and are refused later.
    """
    weights = mechanism.weights
    if weights is None:
        return None
    changed = {
        name: kept
        for name, spec in (("rate", weights.rate), ("torque", weights.torque))
        if isinstance(spec, Mapping) and (kept := _of_motors(mechanism, spec)) != dict(spec)
    }
    return replace(weights, **changed) if changed else weights  # type: ignore[arg-type]


def _of_motors(mechanism: Mechanism, spec: Mapping[str, float]) -> dict[str, float]:
    joints = {axis: joint.name for joint in mechanism.all_joints
              for axis in mechanism.type_of(joint).axis_names(joint.name)}  # fmt: skip
    active = {*mechanism.active, *(joints[name] for name in mechanism.active if name in joints)}
    known = _names_of_motors(mechanism)
    by_axis = {mechanism.motors.get(name, name): value for name, value in spec.items()}
    return {name: value for name, value in by_axis.items() if name in active or name not in known}


def _inverse_squares(
    limits: Mapping[str, float], active: Sequence[str], what: str
) -> dict[str, float] | None:
    missing = [name for name in active if name not in limits]
    if len(missing) == len(active):
        return None
    if missing:
        raise WeightError(
            f"weights from limits: no {what} limit for {listing(missing)}; give weights by name "
            "(a motor that drives several axes has a limit when all of them have one)"
        )
    zero = [name for name, limit in limits.items() if limit == 0.0]
    if zero:
        raise WeightError(f"weights from limits: the {what} limit of {listing(zero)} is zero")
    return {name: 1.0 / (limit * limit) for name, limit in limits.items()}
