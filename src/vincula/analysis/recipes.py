"""How an ellipsoid is made: which quantities, which classes are listed, which spectrum (house page)."""

from __future__ import annotations

from dataclasses import dataclass
from types import NoneType
from weakref import WeakKeyDictionary

import numpy as np

from vincula.analysis.ellipsoid import Class, Convention, Ellipsoid, Kind, Viewpoint
from vincula.analysis.relation import force_relation, internal_relation, kinematic_relation
from vincula.analysis.spectrum import Spectrum, dual_spectrum, spectrum
from vincula.analysis.vectorset import VectorSet
from vincula.arrays import Matrix, Vector, frozen
from vincula.errors import ModelError, WeightError
from vincula.model import LinearModel
from vincula.numerics.metric import Metric
from vincula.weights import UNIT, Quantity, Weights


@dataclass(frozen=True, slots=True)
class _Recipe:
    """What one ellipsoid is made of, and which classes it lists (house page)."""

    task: Quantity
    motor: Quantity
    listed: tuple[Class, ...]


_RECIPES: dict[Kind, _Recipe] = {
    "kinematic": _Recipe("twist", "rate", ("infinite", "finite", "zero", "undefined")),
    "active force": _Recipe("wrench", "torque", ("finite", "zero")),
    "passive force": _Recipe("wrench", "torque", ("infinite", "finite")),
    "internal force": _Recipe("contact_force", "torque", ("infinite", "finite")),
    "dual force": _Recipe("wrench", "torque", ("finite",)),
}


def ellipsoid_of_kind(
    kind: Kind,
    model: LinearModel,
    weights: Weights,
    viewpoint: Viewpoint = "efficiency",
    convention: Convention = "invariant",
) -> Ellipsoid:
    """One of the five ellipsoids, without warnings.

    Raises:
        ModelError: Unknown viewpoint or convention.
    """
    _refuse_unknown(viewpoint, ("efficiency", "accuracy"), "viewpoint")
    _refuse_unknown(convention, ("invariant", "printed"), "convention")
    recipe = _RECIPES[kind]
    task, motor = weights.metric(recipe.task, model), weights.metric(recipe.motor, model)
    listed = recipe.listed
    if convention == "printed" and kind in ("active force", "passive force"):
        from vincula.analysis.printed import printed_spectrum

        found = printed_spectrum(model, kind, task, motor)
        listed = tuple(c for c in listed if c != "zero")
    else:
        found = spectrum_of_kind(kind, model, weights, task, motor)
    return _assembled(model, kind, listed, found, task, motor, weights.explicit, viewpoint, convention)


def spectrum_of_kind(
    kind: Kind, model: LinearModel, weights: Weights, task: Metric, motor: Metric
) -> Spectrum:
    """The spectrum of an ellipsoid; forces under reciprocal metrics share that of the motions.

    Args:
        kind: Which of the five.
        model: The mechanism at one configuration.
        weights: All weights.
        task: Metric of the task side, `weights.metric(task_quantity(kind), model)`.
        motor: Metric of the motor side.
    """
    if kind == "internal force":
        return spectrum(internal_relation(model), task, motor)
    if kind == "kinematic":
        return _motion_spectrum(model, weights)
    if not weights.dual:
        return spectrum(force_relation(model), task, motor)
    twist, rate = weights.metric("twist", model), weights.metric("rate", model)
    return dual_spectrum(_motion_spectrum(model, weights), twist, rate)


_LAST_MOTIONS: WeakKeyDictionary[LinearModel, tuple[Weights, Spectrum]] = WeakKeyDictionary()


def _motion_spectrum(model: LinearModel, weights: Weights) -> Spectrum:
    """The kinematic spectrum of a model, kept for the last weights: four ellipsoids share it."""
    kept = _LAST_MOTIONS.get(model)
    if kept is not None and kept[0] is weights:
        return kept[1]
    found = spectrum(kinematic_relation(model), weights.metric("twist", model), weights.metric("rate", model))
    _LAST_MOTIONS[model] = weights, found
    return found


def task_quantity(kind: Kind) -> Quantity:
    """The quantity on the task side of an ellipsoid."""
    return _RECIPES[kind].task


def motor_quantity(kind: Kind) -> Quantity:
    """The quantity on the motor side of an ellipsoid."""
    return _RECIPES[kind].motor


def resolved_weights(model: LinearModel, weights: Weights | None) -> Weights:
    """The weights given, else those of the model, else the identity that nobody chose.

    Raises:
        ModelError: Something else than a `LinearModel` and `Weights`.
    """
    if not isinstance(model, LinearModel):
        raise ModelError(
            f"an analysis needs a LinearModel, got {type(model).__name__}: mechanism.linearize() makes one "
            "at a configuration, LinearModel.from_matrices one from J and G"
        )
    if not isinstance(weights, (Weights, NoneType)):
        raise WeightError(f"weights are {weights!r}: give Weights(twist=..., rate=...)")
    return weights or model.weights or UNIT


def _assembled(
    model: LinearModel,
    kind: Kind,
    listed: tuple[Class, ...],
    found: Spectrum,
    task: Metric,
    motor: Metric,
    chosen: bool,
    viewpoint: Viewpoint,
    convention: Convention,
) -> Ellipsoid:
    """An ellipsoid with the listed classes of a spectrum."""
    efficiencies: list[float] = []
    classes: list[Class] = []
    task_side: list[Vector | None] = []
    motor_side: list[Vector | None] = []

    def add(name: Class, values: list[float], tasks: Matrix | None, motors: Matrix | None) -> None:
        if values and name in listed:
            classes.extend([name] * len(values))
            efficiencies.extend(values)
            task_side.extend([None] * len(values) if tasks is None else frozen(tasks.T.copy()))
            motor_side.extend([None] * len(values) if motors is None else frozen(motors.T.copy()))

    add("infinite", [np.inf] * found.infinite.shape[1], found.infinite, None)
    add("finite", (found.ratios**2).tolist(), found.task, found.motor)
    add("zero", [0.0] * found.zero.shape[1], None, found.zero)
    add("undefined", [np.nan] * found.undefined, None, None)
    components, units = _components(model, kind)
    lines = found.infinite if "infinite" in listed else found.infinite[:, :0]
    axes, doubt = found.task * found.ratios, model.ledger.subspace_doubt
    return Ellipsoid(
        kind=kind,
        efficiencies=frozen(np.array(efficiencies)),
        classes=tuple(classes),
        task_directions=tuple(task_side),
        motor_directions=tuple(motor_side),
        components=components,
        units=units,
        motors=tuple(column.name for column in model.motors),
        motor_units=motor_units(model, "rate" if kind == "kinematic" else "torque"),
        task_weight=task,
        motor_weight=motor,
        set=VectorSet(components, units, axes, _unit(lines), doubt),
        angle_error=min(float(np.pi / 2.0), doubt * magnification(model, task, motor)),
        weights_chosen=chosen,
        viewpoint=viewpoint,
        convention=convention,
    )


def motor_units(model: LinearModel, quantity: Quantity) -> tuple[str, ...]:
    """Units of the active rates or of the motor torques."""
    linear, angular = ("m/s", "rad/s") if quantity == "rate" else ("N", "N m")
    return tuple(linear if column.linear else angular for column in model.motors)


def _components(model: LinearModel, kind: Kind) -> tuple[tuple[str, ...], tuple[str, ...]]:
    if kind == "kinematic":
        return model.twist_components, model.twist_units
    if kind == "internal force":
        names = tuple(row.name for row in model.rows)
        return names, tuple("N" if row.linear else "N m" for row in model.rows)
    return model.wrench_components, model.wrench_units


def magnification(model: LinearModel, task: Metric, motor: Metric) -> float:
    """How much scaling and weights may magnify an angle of a relation: the spread of their sizes."""
    length = model.length or 1.0
    spread = max(length, 1.0 / length)
    if task.unit and motor.unit:
        return spread
    sizes = [np.linalg.norm(part) for metric in (task, motor) for part in (metric.factor, metric.inverse)]
    return spread * float(max(sizes[0], sizes[2]) * max(sizes[1], sizes[3]))


def _unit(columns: Matrix) -> Matrix:
    return columns / np.linalg.norm(columns, axis=0) if columns.shape[1] else columns


def _refuse_unknown(value: str, known: tuple[str, ...], what: str) -> None:
    if value not in known:
        raise ModelError(f"{what} is {value!r}: choose {' or '.join(known)}")
