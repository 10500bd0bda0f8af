"""Derivatives of the familiar indices: volume, condition number, isotropy, smallest singular value.

All are functions of the squared semi-axes of a set's shadow on some components, stationary values of
u_C^T W u_C / q_a^T W_q q_a.  Volume and isotropy treat all of them alike, so they are smooth even where
several are equal; the others need their extremes apart from the rest.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from vincula.analysis.ellipsoid import Class, Ellipsoid
from vincula.analysis.indices import Part, components_of_part
from vincula.analysis.sensitivity import CLUSTER, Semiaxis, Sensitivities, Sensitivity, alone
from vincula.arrays import Matrix, Vector
from vincula.numerics.lapack import svd

FLAT: Final = "the ellipsoid is flat in these components: the index has a kink or none"
EQUAL: Final = "several efficiencies are equal here: their sum has a derivative, a single one has none"
EQUAL_AXES: Final = "the extreme semi-axis is one of several equal ones: no derivative"
NO_FINITE: Final = "there is no finite efficiency"
_UNBOUNDED: Final = {
    "kinematic": "the ellipsoid is unbounded: the member moves with all motors locked",
    "passive force": "the ellipsoid is unbounded: some wrenches are carried without motors",
}
_UNWEIGHED: Final = (
    "some wrenches are carried without motors, and the weights leave components out: which forces are "
    "orthogonal to them is not defined"
)
SYMMETRIC = ("yoshikawa_volume", "isotropy")
"""Indices that treat all semi-axes alike."""

Slopes = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Derivative:
    """One number that depends on the matrices, and how.

    Attributes:
        value: The number.
        sensitivity: Its derivative; None where it has none.
        reason: Why it has none.
    """

    value: float
    sensitivity: Sensitivity | None
    reason: str = ""


def fixed(kind: Class) -> str:
    """Why an efficiency that is not finite has no derivative."""
    return f"the efficiency is {kind}: fixed as long as no rank changes"


def no_shadow(ellipsoid: Ellipsoid, classes: Sequence[Class], structural: int) -> str:
    """Why the shadow of an ellipsoid has no derivatives; empty where it may have some.

    Args:
        ellipsoid: The ellipsoid, for its kind and weights.
        classes: Classes that it lists.
        structural: Number of structural wrenches.
    """
    if "infinite" in classes:
        return _UNBOUNDED.get(ellipsoid.kind, "the ellipsoid is unbounded")
    if ellipsoid.kind != "kinematic" and structural > 0 and not ellipsoid.task_weight.definite:
        return _UNWEIGHED
    return ""


def index_slopes(index: str, squares: Slopes, value: Slopes) -> Slopes:
    """Derivatives of an index by the squared semi-axes (last axis, descending).

    Args:
        index: Name of a function in `vincula.analysis.indices`.
        squares: ... x axes.
        value: The index.
    """
    return _SLOPES[index](squares, value)


def efficiency_derivative(found: Sensitivities, ellipsoid: Ellipsoid, index: int) -> Derivative:
    """Derivative of one efficiency in the list of an ellipsoid."""
    value = float(ellipsoid.efficiencies[index])
    kind = ellipsoid.classes[index]
    if kind != "finite":
        return Derivative(value, None, fixed(kind))
    if not alone(ellipsoid, index):
        return Derivative(value, None, EQUAL)
    return Derivative(value, found.efficiency(ellipsoid, index))


def index_derivative(found: Sensitivities, ellipsoid: Ellipsoid, index: str, on: Part) -> Derivative:
    """Derivative of an index of an ellipsoid on some components.

    Args:
        found: The model's sensitivities.
        ellipsoid: One of its five, viewpoint efficiency.
        index: Name of a function in `vincula.analysis.indices`.
        on: Components.
    """
    from vincula.analysis import indices

    value = float(getattr(indices, index)(ellipsoid, on))
    why = no_shadow(ellipsoid, ellipsoid.classes, found.model.ledger.summary.structural_wrenches)
    if why:
        return Derivative(value, None, why)
    axes = _SquaredAxes.of(ellipsoid, on)
    if axes is None:
        return Derivative(value, None, FLAT)
    slopes = index_slopes(index, axes.values, np.array(value))
    # Over one component the extremes are one and the same: the index is constant.
    used = np.flatnonzero(slopes) if slopes.any() else np.zeros(1, dtype=np.intp)
    if slopes.any() and index not in SYMMETRIC and not all(axes.alone(int(k)) for k in used):
        return Derivative(value, None, EQUAL_AXES)
    total = [axes.sensitivity(found, ellipsoid, int(k)).times(float(slopes[k])) for k in used]
    result = total[0]
    for more in total[1:]:
        result = result + more
    return Derivative(value, result)


@dataclass(frozen=True, slots=True, eq=False)
class _SquaredAxes:
    """Squared semi-axes of a shadow, descending, with the pairs that reach them (physical).

    Attributes:
        values: The squares.
        motors: Motor sides of cost one, one a column.
        tasks: Their task sides.
        chosen: 1 for components that the shadow is cast on, 0 for the others.
    """

    values: Vector
    motors: Matrix
    tasks: Matrix
    chosen: Vector

    @staticmethod
    def of(ellipsoid: Ellipsoid, on: Part) -> _SquaredAxes | None:
        """The axes, or None for a shadow that is flat."""
        finite = [k for k, name in enumerate(ellipsoid.classes) if name == "finite"]
        chosen = components_of_part(ellipsoid, on)
        factor = ellipsoid.task_weight.factor[:, chosen]
        count = int(svd(factor)[1].size)
        if not finite or ellipsoid.set.project(chosen).axes.shape[1] < count:
            return None
        # Pairs of cost one, orthogonal in the metric of the motors; what moves nothing casts no shadow.
        motors = np.array([ellipsoid.motor_directions[k] for k in finite], dtype=float).T
        tasks = np.array([ellipsoid.task_directions[k] for k in finite], dtype=float).T
        tasks = tasks * np.sqrt(ellipsoid.efficiencies[finite])
        _, lengths, right = svd(factor @ tasks[chosen])
        mask = np.zeros(len(tasks))
        mask[chosen] = 1.0
        basis = right[:, :count]
        return _SquaredAxes(lengths[:count] ** 2, motors @ basis, tasks @ basis, mask)

    def alone(self, k: int) -> bool:
        """Whether one of them is apart from all others."""
        near = np.abs(self.values - self.values[k]) <= 2.0 * CLUSTER * self.values[k]
        return int(np.count_nonzero(near)) == 1

    def sensitivity(self, found: Sensitivities, ellipsoid: Ellipsoid, k: int) -> Sensitivity:
        """Derivative of one of them."""
        axis = Semiaxis(
            ellipsoid.kind, float(self.values[k]), self.tasks[:, k], self.motors[:, k], self.chosen
        )
        return found.semiaxis(ellipsoid, axis)


def _volume(squares: Slopes, value: Slopes) -> Slopes:
    return np.asarray(0.5 * value[..., None] / squares)


def _isotropy(squares: Slopes, value: Slopes) -> Slopes:
    count, mean = squares.shape[-1], np.mean(squares, axis=-1, keepdims=True)
    return np.asarray(value[..., None] * (1.0 / squares - 1.0 / mean) / count)


def _smallest(squares: Slopes, value: Slopes) -> Slopes:
    slopes = np.zeros_like(squares)
    slopes[..., -1] = 0.5 / value
    return slopes


def _condition(squares: Slopes, value: Slopes) -> Slopes:
    slopes = np.zeros_like(squares)
    if squares.shape[-1] > 1:
        slopes[..., 0], slopes[..., -1] = 0.5 * value / squares[..., 0], -0.5 * value / squares[..., -1]
    return slopes


def _inverse_condition(squares: Slopes, value: Slopes) -> Slopes:
    return np.asarray(-_condition(squares, 1.0 / value) * (value * value)[..., None])


_SLOPES: dict[str, Callable[[Slopes, Slopes], Slopes]] = {
    "yoshikawa_volume": _volume,
    "isotropy": _isotropy,
    "smallest_singular_value": _smallest,
    "condition_number": _condition,
    "inverse_condition_number": _inverse_condition,
}
