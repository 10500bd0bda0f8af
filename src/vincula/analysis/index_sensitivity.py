"""Derivatives of the familiar indices: volume, condition number, isotropy, smallest singular value.

All are functions of the squared semi-axes of a set's shadow on some components, stationary values of
u_C^T W u_C / q_a^T W_q q_a.  Volume and isotropy treat all of them alike, so they are smooth even where
several are equal; the others need their extremes apart from the rest.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from vincula.analysis.ellipsoid import Ellipsoid
from vincula.analysis.indices import Part, components_of_part
from vincula.analysis.sensitivity import CLUSTER, Semiaxis, Sensitivities, Sensitivity, alone
from vincula.arrays import Matrix, Vector
from vincula.numerics.lapack import svd


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


def efficiency_derivative(found: Sensitivities, ellipsoid: Ellipsoid, index: int) -> Derivative:
    """Derivative of one efficiency in the list of an ellipsoid."""
    value = float(ellipsoid.efficiencies[index])
    kind = ellipsoid.classes[index]
    if kind != "finite":
        return Derivative(value, None, f"the efficiency is {kind}: fixed as long as no rank changes")
    if not alone(ellipsoid, index):
        words = "several efficiencies are equal here: their sum has a derivative, a single one has none"
        return Derivative(value, None, words)
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
    if "infinite" in ellipsoid.classes:
        return Derivative(value, None, _UNBOUNDED.get(ellipsoid.kind, "the ellipsoid is unbounded"))
    if ellipsoid.kind != "kinematic" and found.model.ledger.summary.structural_wrenches > 0:
        return Derivative(value, None, _BESIDE_STRUCTURAL)
    axes = _SquaredAxes.of(ellipsoid, on)
    if axes is None:
        return Derivative(
            value, None, "the ellipsoid is flat in these components: the index has a kink or none"
        )
    slopes = _SLOPES[index](axes.values, value)
    # Over one component the extremes are one and the same: the index is constant.
    used = np.flatnonzero(slopes) if slopes.any() else np.zeros(1, dtype=np.intp)
    if slopes.any() and index not in _SYMMETRIC and not all(axes.alone(int(k)) for k in used):
        return Derivative(value, None, "the extreme semi-axis is one of several equal ones: no derivative")
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


def _volume(squares: Vector, value: float) -> Vector:
    return 0.5 * value / squares


def _isotropy(squares: Vector, value: float) -> Vector:
    count = len(squares)
    return np.asarray(value * (1.0 / squares - 1.0 / np.mean(squares)) / count)


def _smallest(squares: Vector, value: float) -> Vector:
    slopes = np.zeros(len(squares))
    slopes[-1] = 0.5 / value
    return slopes


def _condition(squares: Vector, value: float) -> Vector:
    slopes = np.zeros(len(squares))
    if len(squares) > 1:
        slopes[0], slopes[-1] = 0.5 * value / squares[0], -0.5 * value / squares[-1]
    return slopes


def _inverse_condition(squares: Vector, value: float) -> Vector:
    return -_condition(squares, 1.0 / value) * value * value


_SLOPES: dict[str, Callable[[Vector, float], Vector]] = {
    "yoshikawa_volume": _volume,
    "isotropy": _isotropy,
    "smallest_singular_value": _smallest,
    "condition_number": _condition,
    "inverse_condition_number": _inverse_condition,
}
_UNBOUNDED = {
    "kinematic": "the ellipsoid is unbounded: the member moves with all motors locked",
    "passive force": "the ellipsoid is unbounded: some wrenches are carried without motors",
}
_BESIDE_STRUCTURAL = (
    "some wrenches are carried without motors: the set lies beside them, and how its shadow turns with them "
    "is not known here"
)
_SYMMETRIC = ("yoshikawa_volume", "isotropy")
