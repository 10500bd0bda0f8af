"""What the variables of a sweep are: motors, joint values, components of the member's pose, parameters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final, Literal, get_args

import numpy as np

from vincula.arrays import Matrix, Vector, frozen
from vincula.errors import DuplicateNameError, ModelError, UnknownNameError, listing
from vincula.kernels.compiled import CompiledMechanism
from vincula.kernels.inputs import Given, names_of
from vincula.kernels.quantities import pose_components
from vincula.kernels.variants import parameters_of
from vincula.mechanism.configuration import Configuration
from vincula.mechanism.holding import holding, problem_for
from vincula.mechanism.mechanism import Mechanism
from vincula.mechanism.residuals import CLOSED, axis_linear
from vincula.sweep.rotations import from_roll_pitch_yaw, roll_pitch_yaw

REFERENCE: Final = "reference."
"""What stands before a component of the reference member's pose."""
PARAMETER: Final = "parameter."
"""What may stand before a parameter, to tell it from a joint of the same name."""
TURNS: Final = ("roll", "pitch", "yaw")
"""Turns about the fixed x, y and z axes, in this order [rad]."""

Kind = Literal["number", "turn", "parameter"]


@dataclass(frozen=True, slots=True)
class Variable:
    """What one variable sets.

    Attributes:
        name: As the user wrote it.
        kind: A number of what is given, a turn of the reference member, or a parameter.
        target: Name of that number, turn or parameter.
        unit: m, rad, or empty where it is not known.
    """

    name: str
    kind: Kind
    target: str
    unit: str


@dataclass(frozen=True, slots=True, eq=False)
class Inputs:
    """How values of the variables become what a compiled mechanism is given.

    Attributes:
        given: What it is given: configurations, motor values or poses.
        variables: The variables, in order.
        names: Names of the numbers of one point.
        base: Those numbers where no variable sets them.
        start: The configuration that a sweep starts from.
    """

    given: Given
    variables: tuple[Variable, ...]
    names: tuple[str, ...]
    base: Vector
    start: Configuration

    def rows(self, values: Matrix) -> tuple[Matrix, dict[str, Vector]]:
        """What the points are given, and their parameters.

        Args:
            values: One row a point, one column a variable.
        """
        rows = np.tile(self.base, (len(values), 1))
        turns: dict[str, Vector] = {}
        parameters: dict[str, Vector] = {}
        for variable, column in zip(self.variables, values.T, strict=True):
            if variable.kind == "number":
                rows[:, self.names.index(variable.target)] = column
            elif variable.kind == "turn":
                turns[variable.target] = column
            else:
                parameters[variable.target] = np.ascontiguousarray(column)
        if turns:
            usual = roll_pitch_yaw(self.base[3:])
            about = [turns.get(name, np.full(len(values), usual[k])) for k, name in enumerate(TURNS)]
            rows[:, 3:] = from_roll_pitch_yaw(*about)
        return rows, parameters


def inputs_for(
    compiled: CompiledMechanism,
    variables: Sequence[str],
    given: Given | None = None,
    start: Mapping[str, Any] | None = None,
) -> Inputs:
    """What the variables of a sweep set, and what holds where they set nothing.

    Args:
        compiled: The mechanism.
        variables: Names of motors, joints, axes, `reference.x` ... `reference.yaw`, or parameters.
        given: What the points are; by default poses when a component of one is among the variables,
            motor values when there are loops to close, else configurations.
        start: Where the sweep starts: values by joint, home for the others; closed first when open.

    Raises:
        UnknownNameError: A name that is none of these.
        ModelError: Variables that do not go together, or a joint without motor where loops are closed.
        DuplicateNameError: Two variables that set the same number.
        ClosureError: The start cannot be closed.
    """
    mechanism = compiled.mechanism
    known = () if compiled.build is None else parameters_of(compiled.build)
    own = [name for name in variables if not _is_parameter(mechanism, name, known)]
    chosen = given or _given(mechanism, own, start)
    if chosen not in get_args(Given):
        raise ModelError(f"given is {chosen!r}: choose {listing(get_args(Given))}")
    names = names_of(mechanism, chosen)
    found = [
        _variable(mechanism, name, chosen, names) if name in own else _parameter(name) for name in variables
    ]
    _refuse_same_target(found)
    began = _started(mechanism, chosen, start)
    base = frozen(_numbers_at(compiled, chosen, began))
    return Inputs(chosen, tuple(found), names, base, began)


def _is_parameter(mechanism: Mechanism, name: str, known: Sequence[str] | None) -> bool:
    """Whether a variable is a parameter; `known` is None where the builder takes any name."""
    if name.startswith(PARAMETER):
        target = name.removeprefix(PARAMETER)
        if known is not None and target not in known:
            raise UnknownNameError("parameter", target, known)
        return True
    if known is None or name not in known:
        return False
    if name in mechanism.joint or name in mechanism.axis_names or name in mechanism.motors:
        raise ModelError(f"{name!r} is a parameter and a joint: write {PARAMETER}{name} for the parameter")
    return True


def _parameter(name: str) -> Variable:
    return Variable(name, "parameter", name.removeprefix(PARAMETER), "")


def _given(mechanism: Mechanism, own: Sequence[str], start: Mapping[str, Any] | None) -> Given:
    member = [name for name in own if name.startswith(REFERENCE)]
    if member:
        others = [name for name in own if name not in member]
        if others:
            raise ModelError(
                f"the pose of the reference member is given, so {listing(others)} cannot be given as well"
            )
        return "reference"
    if not mechanism.residuals():
        return "configuration"
    if not own:
        return "configuration" if start is None else "motors"
    motors = set(mechanism.active)
    passive = [name for name in own if not set(_targets(mechanism, name)) <= motors]
    if passive:
        raise ModelError(
            f"{listing(passive)}: no motors, and loops are closed with the motors held. Name motors "
            f"({listing(mechanism.active)}), make these joints motors, or say given='configuration' when the "
            "points are closed configurations already"
        )
    return "motors"


def _targets(mechanism: Mechanism, name: str) -> tuple[str, ...]:
    """Axes or drives of a motor, joint or axis name."""
    return mechanism.resolve_motors((name,))


def _variable(mechanism: Mechanism, name: str, given: Given, names: tuple[str, ...]) -> Variable:
    if given == "reference":
        return _of_pose(mechanism, name, names)
    if name in names:
        target = name
    elif given == "motors":
        found = _targets(mechanism, name)
        if len(found) != 1 or found[0] not in names:
            raise UnknownNameError("motor with one value", name, names)
        target = found[0]
    else:
        target = mechanism.motors.get(name, name)
        if target not in names:
            raise UnknownNameError("joint value", name, names)
    return Variable(name, "number", target, _unit(mechanism, target))


def _of_pose(mechanism: Mechanism, name: str, names: tuple[str, ...]) -> Variable:
    target = name.removeprefix(REFERENCE)
    spatial = mechanism.space.translations == 3
    choices = [REFERENCE + word for word in (*names, *(TURNS if spatial else ()))]
    if name not in choices:
        raise UnknownNameError("component of the pose", name, choices)
    if target in TURNS:
        return Variable(name, "turn", target, "rad")
    unit = "m" if target in ("x", "y", "z") else "rad" if target == "angle" else "1"
    return Variable(name, "number", target, unit)


def _unit(mechanism: Mechanism, target: str) -> str:
    linear = axis_linear(mechanism)
    if target in linear:
        return "m" if linear[target] else "rad"
    drive = next((drive for drive in mechanism.drives if drive.name == target), None)
    if drive is not None:
        guessed = any(linear[axis] for axis in drive.drives)
        return "m" if (guessed if drive.linear is None else drive.linear) else "rad"
    joint, _, part = target.rpartition(".")
    if joint in mechanism.joint and part in ("qw", "qx", "qy", "qz"):
        return "1"
    if joint in mechanism.joint and part in ("x", "y", "z"):
        return "m"
    return (
        "m" if target in mechanism.joint and all(mechanism.type_of(mechanism.joint[target]).linear) else "rad"
    )


def _refuse_same_target(found: Sequence[Variable]) -> None:
    seen: dict[tuple[bool, str], str] = {}
    for variable in found:
        key = (variable.kind == "parameter", variable.target)
        if key in seen:
            raise DuplicateNameError("variable", variable.target)
        seen[key] = variable.name
    turned = any(variable.kind == "turn" for variable in found)
    quaternion = [v.name for v in found if v.kind == "number" and v.name.startswith(f"{REFERENCE}q")]
    if turned and quaternion:
        raise ModelError(
            f"turns are given as roll, pitch and yaw, so {listing(quaternion)} cannot be given as well"
        )
    if quaternion and len(quaternion) < 4:
        raise ModelError(
            f"{listing(quaternion)}: give all four numbers of the quaternion, or roll, pitch and yaw"
        )


def _started(mechanism: Mechanism, given: Given, start: Mapping[str, Any] | None) -> Configuration:
    began = mechanism.configuration(start)
    if given == "configuration":
        return began
    if max((r.gap for r in mechanism.residuals(began)), default=0.0) > CLOSED * mechanism.length:
        return mechanism.close(began)
    return began


def _numbers_at(compiled: CompiledMechanism, given: Given, start: Configuration) -> Vector:
    """What a compiled mechanism would be given to arrive at the start."""
    mechanism = compiled.mechanism
    if given == "configuration":
        return start.flat.copy()
    if given == "motors":
        problem = problem_for(mechanism, holding(mechanism, None), mechanism.active)
        values = problem.variables.axis_values(problem.start(start))
        return np.array([values[motor] for motor in mechanism.active])
    pose = compiled.evaluate(start.flat, ("reference.pose",))["reference.pose"]
    if not np.isfinite(pose).all():
        raise ModelError(
            f"the reference member has no pose at the start ({listing(pose_components(mechanism))} unknown)"
        )
    return np.array(pose)
