"""One return type for the five ellipsoids: efficiencies, classes, directions, and the set itself."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from vincula.analysis.vectorset import VectorSet
from vincula.arrays import Matrix, Vector, checked
from vincula.errors import ModelError, listing
from vincula.numerics.metric import Metric
from vincula.numerics.rank import negligible

Viewpoint = Literal["efficiency", "accuracy"]
Convention = Literal["invariant", "printed"]
Class = Literal["infinite", "finite", "zero", "undefined"]
Kind = Literal["kinematic", "active force", "passive force", "internal force", "dual force"]


@dataclass(frozen=True, slots=True, eq=False)
class Ellipsoid:
    """What a unit of motor effort gives, direction by direction (eqs. 8-13 and 20-24).

    Attributes:
        kind: Which of the five.
        efficiencies: Generalised eigenvalues, descending: infinite, finite, zero; NaN for undefined.
        classes: infinite, finite, zero or undefined, one an efficiency.
        task_directions: Twists, wrenches or contact forces of length one in the metric; None where
            the task side is zero.
        motor_directions: Rates or torques, paired with the task directions; None where the motors
            are at rest or unloaded.
        components: Names of the task components.
        units: Their units.
        motors: Names of the motor components.
        motor_units: Their units.
        task_weight: Metric of the task side.
        motor_weight: Metric of the motor side.
        set: The set of twists, wrenches or contact forces that a unit of motor effort gives.
        angle_error: How far the uncertainties of the model (rounding, closure, digits, tolerance) may
            turn the relation in the metrics [rad]; see `bounds`.
        weights_chosen: False when nobody chose the weights.
        viewpoint: efficiency (Yoshikawa) or accuracy (Salisbury and Craig); changes no number.
        convention: invariant, or printed for the regression against the paper.
    """

    kind: Kind
    efficiencies: Vector
    classes: tuple[Class, ...]
    task_directions: tuple[Vector | None, ...]
    motor_directions: tuple[Vector | None, ...]
    components: tuple[str, ...]
    units: tuple[str, ...]
    motors: tuple[str, ...]
    motor_units: tuple[str, ...]
    task_weight: Metric
    motor_weight: Metric
    set: VectorSet
    angle_error: float = 0.0
    weights_chosen: bool = True
    viewpoint: Viewpoint = "efficiency"
    convention: Convention = "invariant"

    @property
    def semi_axes(self) -> Vector:
        """Roots of the efficiencies: lengths in the task metric per unit of motor effort."""
        return np.sqrt(self.efficiencies)

    @property
    def finite(self) -> Vector:
        """The finite efficiencies above zero, descending."""
        return self.efficiencies[[c == "finite" for c in self.classes]]

    @property
    def bounds(self) -> tuple[tuple[float, float], ...]:
        """Smallest and largest value of every efficiency within the uncertainties of the model.

        An efficiency is tan^2 of an angle between the relation and the motors; the angle is known to
        `angle_error`.  Infinite and zero ones are decided by rank and have no range of their own.
        """
        return tuple(
            (_turned(value, -self.angle_error), _turned(value, self.angle_error))
            if kind == "finite"
            else (float(value), float(value))
            for value, kind in zip(self.efficiencies, self.classes, strict=True)
        )

    @property
    def clusters(self) -> tuple[tuple[int, ...], ...]:
        """Indices of efficiencies that cannot be told apart: inside a cluster directions are free to turn."""
        found: list[list[int]] = []
        bounds = self.bounds
        for i, kind in enumerate(self.classes):
            same = found and self.classes[found[-1][-1]] == kind
            if same and (kind != "finite" or bounds[i][1] >= bounds[found[-1][-1]][0]):
                found[-1].append(i)
            else:
                found.append([i])
        return tuple(tuple(cluster) for cluster in found)

    @property
    def best(self) -> int:
        """Index of the best task direction: the largest efficiency, or the smallest for accuracy.

        Raises:
            ModelError: There is no direction at all.
        """
        return self._extreme(first=self.viewpoint == "efficiency")

    @property
    def worst(self) -> int:
        """Index of the worst task direction: the other end.

        Raises:
            ModelError: There is no direction at all.
        """
        return self._extreme(first=self.viewpoint == "accuracy")

    def along(self, direction: ArrayLike) -> float:
        """The largest t with t * direction in the set: 0 outside its span, inf along its lines.

        Components with weight zero are ignored.

        Raises:
            ShapeError: Not one number a component.
            ModelError: The zero vector, or a direction that the weights ignore.
        """
        d = checked(direction, "direction", (len(self.components),))
        weighted = self.task_weight.without_ignored(d)
        if d.any() and negligible(float(np.linalg.norm(weighted)), float(np.linalg.norm(d))):
            raise ModelError("the weights ignore this direction: there is nothing to measure along it")
        return self.set.along(weighted)

    def support(self, direction: ArrayLike) -> float:
        """The largest component along a direction: max of direction . x over the set."""
        return self.set.support(direction)

    def project(self, components: Sequence[str | int]) -> VectorSet:
        """The shadow of the set on chosen components."""
        return self.set.project(components)

    def section(self, components: Sequence[str | int]) -> VectorSet:
        """The cut of the set by the plane where all other components are zero."""
        return self.set.section(components)

    def points(self, count: int = 100) -> Matrix:
        """Boundary points of the bounded part, one a column, for drawing."""
        return self.set.points(count)

    def with_viewpoint(self, viewpoint: Viewpoint) -> Ellipsoid:
        """The same ellipsoid read the other way."""
        return replace(self, viewpoint=viewpoint)

    def __str__(self) -> str:
        values = ", ".join(
            "undefined" if c == "undefined" else f"{value:.6g}"
            for value, c in zip(self.efficiencies, self.classes, strict=True)
        )
        over = listing(self.components)
        return f"{self.kind} ellipsoid ({self.viewpoint}): efficiencies {values or '(none)'} over {over}"

    def _extreme(self, first: bool) -> int:
        defined = [i for i, d in enumerate(self.task_directions) if d is not None]
        if not defined:
            raise ModelError(f"the {self.kind} ellipsoid has no direction: nothing moves or pushes")
        return defined[0] if first else defined[-1]


def _turned(efficiency: float, error: float) -> float:
    """tan^2 of the angle of an efficiency, turned by an error within 0 and 90 degrees."""
    root = float(np.sqrt(efficiency))
    # Above 45 degrees the complement of the angle has the digits.
    small = min(root, 1.0 / root)
    angle = np.arctan(small) + (error if root <= 1.0 else -error)
    tangent = float(np.tan(max(angle, 0.0))) if angle < np.pi / 2.0 else float("inf")
    if root <= 1.0:
        return tangent**2
    return float("inf") if tangent == 0.0 else tangent**-2
