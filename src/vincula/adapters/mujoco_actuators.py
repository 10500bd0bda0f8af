"""From the actuators of a MuJoCo model to the motion of a body and the load on it, and back.

The two matrices are the rate map and the torque map of `analysis.maps`; here they get the names of the
actuators, their gears, and what is singular about them.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import mujoco
import numpy as np

from vincula.adapters.mujoco_joints import joint_type_of
from vincula.adapters.mujoco_names import ModelNames
from vincula.analysis.maps import LinearMap
from vincula.analysis.recipes import resolved_weights
from vincula.analysis.result import Analysis
from vincula.arrays import Matrix, frozen
from vincula.errors import listing
from vincula.mechanism.joint_types import joint_type
from vincula.mechanism.mechanism import Mechanism
from vincula.model import LinearModel
from vincula.spatial.space import SPATIAL
from vincula.weights import Weights

if TYPE_CHECKING:
    from vincula.mechanism.singularities import Singularity


@dataclass(frozen=True, eq=False)
class ActuatorJacobian:
    """What the actuators of a simulation do to one body at one configuration.

    Attributes:
        twist_from_rates: 6 x n map from motor rates to the twist (vx vy vz wx wy wz) of the body at the
            reference point; its `matrix` is None, with a `reason`, where the motors do not determine it.
        torque_from_wrench: n x 6 map from a wrench that acts on the body to the motor torques that
            balance it; None, with a `reason`, where some wrench cannot be balanced.
        actuators: Names of the actuators of the model that are motors here.
        actuator_ids: Their indices in the arrays of the simulation.
        transmission: actuators x n: `data.actuator_velocity` of these actuators is transmission @ rates,
            and the motor torques are transmission.T @ `data.actuator_force`.
        held: Axes that were held still.
        free_springs: Joints with a spring that are taken to move freely.
        mechanism: The mechanism, closed where the simulation stands.
        model: Its linear model behind both maps; `vincula.analyze(model)` tells all of it.
    """

    twist_from_rates: LinearMap
    torque_from_wrench: LinearMap
    actuators: tuple[str, ...]
    actuator_ids: tuple[int, ...]
    transmission: Matrix
    held: tuple[str, ...]
    free_springs: tuple[str, ...]
    mechanism: Mechanism
    model: LinearModel

    @property
    def motors(self) -> tuple[str, ...]:
        """Names of the n motors: joint axes, or actuators that pull tendons."""
        return self.twist_from_rates.columns

    @cached_property
    def singularities(self) -> tuple[Singularity, ...]:
        """What is singular here and is not at closed configurations near by; looked for when asked."""
        from vincula.mechanism.singularities import singularities_at

        return singularities_at(self.mechanism, self.mechanism.home)

    @property
    def singular(self) -> bool:
        """Whether the configuration is singular: the maps lose rank here, or do not exist only here.

        A body that the motors never determine (springs taken as free, say) is not singular: then only
        `reason` is not empty.
        """
        return bool(self.singularities)

    @property
    def certain(self) -> bool:
        """Whether every rank behind the maps is decided; near a singularity it is not."""
        return self.model.ledger.status == "certain"

    @property
    def reason(self) -> str:
        """Why a map does not exist; empty when both do."""
        reasons = dict.fromkeys(
            m.reason for m in (self.twist_from_rates, self.torque_from_wrench) if m.reason
        )
        if reasons and self.free_springs:
            held = (
                f"springs are no constraints: {listing(self.free_springs)} can move; hold them if they do not"
            )
            return "; ".join((*reasons, held))
        return "; ".join(reasons)


def jacobian_of(
    model: Any,
    mechanism: Mechanism,
    linear: LinearModel,
    free_springs: tuple[str, ...],
    weights: Weights | None,
) -> ActuatorJacobian:
    """The maps of a linear model with the names and gears of the actuators.

    Args:
        model: The `mujoco.MjModel`.
        mechanism: The mechanism, closed at home.
        linear: Its linear model at home.
        free_springs: Joints with a spring that are taken to move freely.
        weights: Weights for rates or torques that are projected.

    Raises:
        WeightError: A weight that does not fit.
    """
    found = Analysis(linear, resolved_weights(linear, weights))
    names = ModelNames(model)
    columns = [motor.name for motor in linear.motors]
    used = [i for i, name in enumerate(names.actuators) if mechanism.motors.get(name) in columns]
    transmission = np.zeros((len(used), len(columns)))
    for row, index in enumerate(used):
        column = columns.index(mechanism.motors[names.actuators[index]])
        transmission[row, column] = _gear(model, index)
    return ActuatorJacobian(
        twist_from_rates=found.twist_from_rates,
        torque_from_wrench=found.torque_from_wrench,
        actuators=tuple(names.actuators[i] for i in used),
        actuator_ids=tuple(used),
        transmission=frozen(transmission),
        held=mechanism.lock,
        free_springs=free_springs,
        mechanism=mechanism,
        model=linear,
    )


def springs_without_motor(model: Any, mechanism: Mechanism) -> tuple[str, ...]:
    """Unlocked joints with a spring that no motor drives."""
    driven = set(mechanism.active)
    for drive in mechanism.drives:
        if drive.name in driven:
            driven |= set(drive.drives)
    names = ModelNames(model).joints
    still = driven | set(mechanism.lock)
    return tuple(
        name
        for index, name in enumerate(names)
        if model.jnt_stiffness[index] > 0
        and not still & set(mechanism.type_of(mechanism.joint[name]).axis_names(name))
    )


def _gear(model: Any, actuator: int) -> float:
    """Actuator velocity a unit of the motor's rate; drives along a gear direction have unit length."""
    gear = np.array(model.actuator_gear[actuator], dtype=float)
    if int(model.actuator_trntype[actuator]) == int(mujoco.mjtTrn.mjTRN_TENDON):
        return float(gear[0])
    joint = int(model.actuator_trnid[actuator][0])
    along = gear[: len(joint_type(joint_type_of(model, joint), SPATIAL).axes)]
    turned = along[along != 0.0]
    return float(turned[0]) if len(turned) == 1 else float(np.linalg.norm(turned))
