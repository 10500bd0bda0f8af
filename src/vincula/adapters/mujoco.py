"""A live MuJoCo model and data as a linear model, contacts on request."""

from __future__ import annotations

import copy
from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Literal

from vincula.adapters.members import member_named
from vincula.errors import MissingExtraError, ModelError
from vincula.mechanism.mechanism import Mechanism
from vincula.mechanism.parts import _All
from vincula.model import LinearModel
from vincula.spatial.poses import Pose
from vincula.weights import Weights

if TYPE_CHECKING:
    from vincula.adapters.mujoco_actuators import ActuatorJacobian

SOFTNESS = 1e-2
"""How far a simulated loop may be open, times the characteristic length: simulated loops are soft."""


def linear_model(
    model: Any,
    data: Any,
    reference: str,
    *,
    active: Iterable[str] | str | _All | None = None,
    lock: Iterable[str] | str = (),
    contacts: bool = False,
    axes: Literal["ground", "body"] = "ground",
    softness: float = SOFTNESS,
) -> LinearModel:
    """J_a, J_p and G of a simulation at `data.qpos`.

    The equalities that are active in `data` close loops.  A simulation holds them up to a small gap:
    every loop is taken to be closed where its first body has it, and the largest gap counts as
    uncertainty of the result.  Neither `model` nor `data` is changed.

    Args:
        model: A `mujoco.MjModel`.
        data: Its `mujoco.MjData`.
        reference: The reference member: a body, a site, or `BODY@SITE`.
        active: Motors, joints or axes that are active; by default the actuators of the model.
        lock: Joints or axes held still.
        contacts: Whether the touching geoms are contacts: condim 1 is a point without friction, 3 a hard
            finger, 4 a soft finger, 6 a complete constraint.
        axes: Axes of twist and wrench.
        softness: How far a loop may be open, times the characteristic length.

    Raises:
        UnknownNameError: A name that the model does not have.
        ClosureError: A loop is open by more than `softness` allows; tells which.
        UnsupportedFeatureError: An active equality that cannot be represented.
        ModelError: No `mujoco.MjModel` and `mujoco.MjData`, or a member that cannot be one.
        MissingExtraError: MuJoCo is not installed.
    """
    mechanism = _prepared(model, data, reference, active, lock, contacts, axes)
    return _linearized(mechanism, softness)[1]


def actuator_jacobian(
    model: Any,
    data: Any,
    body: str,
    *,
    hold: Iterable[str] | str = (),
    springs: Literal["free", "held"] = "free",
    active: Iterable[str] | str | _All | None = None,
    contacts: bool = False,
    axes: Literal["ground", "body"] = "ground",
    weights: Weights | None = None,
    softness: float = SOFTNESS,
) -> ActuatorJacobian:
    """How the actuators of a simulation move a body and carry a load on it, through all loops.

    Loops, couplings and redundant rows are those of `linear_model`; the two matrices are those of
    `vincula.analyze`.  A spring is no constraint: the joint it acts on may move (`springs="free"`), or
    is taken to stand still (`springs="held"`: every sprung joint that no motor drives).

    Args:
        model: A `mujoco.MjModel`.
        data: Its `mujoco.MjData`; the configuration is `data.qpos`.
        body: The body that moves and carries: a body, a site, or `BODY@SITE`.
        hold: Joints or axes that stand still.
        springs: Whether joints with a spring and without a motor are free or held.
        active: Motors, joints or axes that count as motors; by default the actuators of the model.
        contacts: Whether the touching geoms are contacts, as in `linear_model`.
        axes: Axes of twist and wrench.
        weights: Weights for rates or torques that are projected (redundant motors); identity by default.
        softness: How far a loop may be open, times the characteristic length.

    Raises:
        UnknownNameError: A name that the model does not have.
        ClosureError: A loop is open by more than `softness` allows; tells which.
        UnsupportedFeatureError: An active equality that cannot be represented.
        ModelError: No `mujoco.MjModel` and `mujoco.MjData`, a member that cannot be one, or another word
            than free or held.
        WeightError: A weight that does not fit the motors or the twist.
        MissingExtraError: MuJoCo is not installed.
    """
    if springs not in ("free", "held"):
        raise ModelError(f"springs is {springs!r}: choose free or held")
    mechanism = _prepared(model, data, body, active, hold, contacts, axes)
    from vincula.adapters.mujoco_actuators import jacobian_of, springs_without_motor

    sprung = springs_without_motor(model, mechanism)
    if springs == "held":
        mechanism = mechanism.with_lock((*mechanism.lock, *sprung))
    closed, linear = _linearized(mechanism, softness)
    return jacobian_of(model, closed, linear, sprung if springs == "free" else (), weights)


def _prepared(
    model: Any,
    data: Any,
    reference: str,
    active: Iterable[str] | str | _All | None,
    lock: Iterable[str] | str,
    contacts: bool,
    axes: Literal["ground", "body"],
) -> Mechanism:
    """The mechanism of a simulation with motors, locks, contacts and reference member as asked for."""
    body, frame = member_named(mechanism := simulation(model, data), reference)
    if contacts:
        mechanism = _with_contacts(mechanism, model, data, body)
    mechanism = mechanism.with_lock(lock)
    if active is not None:
        mechanism = mechanism.with_active(active)
    return mechanism.with_reference(body, frame=frame, axes=axes)


def _linearized(mechanism: Mechanism, softness: float) -> tuple[Mechanism, LinearModel]:
    """The mechanism closed where it stands, and its linear model with the gap as uncertainty."""
    from vincula.adapters.mujoco_softness import closed_where_it_stands

    closed, residual, note = closed_where_it_stands(mechanism, softness)
    linear = closed.linearize()
    if not note:
        return closed, linear
    uncertainty = replace(linear.uncertainty, residual=residual)
    return closed, replace(linear, uncertainty=uncertainty, notes=(*linear.notes, note))


def simulation(model: Any, data: Any) -> Mechanism:
    """The mechanism of a simulation, its home configuration being `data.qpos`.

    Joints have MuJoCo's names and values; contacts are left out (`linear_model` adds them).

    Raises:
        ModelError: No `mujoco.MjModel` and `mujoco.MjData`, or they do not belong together.
        UnsupportedFeatureError: An active equality that cannot be represented.
        MissingExtraError: MuJoCo is not installed.
    """
    _check(model, data)
    from vincula.adapters.mujoco_graph import configuration_of, mechanism_of
    from vincula.adapters.mujoco_names import ModelNames
    from vincula.files.report import LoadReport

    names = ModelNames(model)
    title = bytes(model.names).split(b"\0", 1)[0].decode("utf-8", "replace") or "simulation"
    mocap = {
        body: Pose.from_quaternion_wxyz(data.mocap_quat[index], data.mocap_pos[index])
        for body, index in enumerate(int(i) for i in model.body_mocapid)
        if index >= 0
    }
    report = LoadReport(title, "MuJoCo simulation")
    mechanism = mechanism_of(
        model,
        names,
        report,
        name=title,
        active_equalities=[bool(flag) for flag in data.eq_active],
        mocap=mocap,
    )
    mechanism = replace(mechanism, notes=(*mechanism.notes, *report.notes))
    return mechanism.with_configuration(configuration_of(model, names, data.qpos))


def _check(model: Any, data: Any) -> None:
    try:
        import mujoco
    except ImportError:
        raise MissingExtraError("MuJoCo", "mujoco", "a live simulation") from None
    if not isinstance(model, mujoco.MjModel) or not isinstance(data, mujoco.MjData):
        raise ModelError(
            f"expected a mujoco.MjModel and its mujoco.MjData, got {type(model).__name__} and "
            f"{type(data).__name__}"
        )
    if len(data.qpos) != model.nq:
        raise ModelError(
            f"the data belongs to another model: it has {len(data.qpos)} positions, the model {model.nq}"
        )


def _with_contacts(mechanism: Mechanism, model: Any, data: Any, member: str) -> Mechanism:
    """The mechanism with the contacts of geoms that touch at `data.qpos`, found on a copy of the data."""
    import mujoco

    from vincula.adapters.mujoco_contacts import touching
    from vincula.adapters.mujoco_names import ModelNames

    current = copy.copy(data)
    mujoco.mj_fwdPosition(model, current)
    found, notes = touching(model, current, ModelNames(model), mechanism, member)
    return replace(mechanism, contacts=tuple(found), notes=(*mechanism.notes, *notes))
