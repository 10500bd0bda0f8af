"""Sets of vectors: an ellipsoid of some dimension, plus straight lines along which it is unbounded.

Every ellipsoid of the theory page is such a set (section 5, "As sets").  Projection and section are
two different operations: the shadow of the set, and its cut by the plane of the chosen components.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from vincula.arrays import Matrix, Vector, checked, frozen
from vincula.errors import DuplicateNameError, ModelError, UnknownNameError
from vincula.numerics.lapack import svd
from vincula.numerics.rank import decide_rank, negligible


@dataclass(frozen=True, slots=True, eq=False)
class VectorSet:
    """The set {axes @ t + lines @ s : |t| <= 1, any s} in the space of named components.

    Attributes:
        components: Names of the n components.
        units: Their units.
        axes: n x r semi-axes; orthogonal in the metric that made the set.
        lines: n x l directions along which the set is unbounded, of length one.
        doubt: Relative uncertainty of the subspaces involved.
    """

    components: tuple[str, ...]
    units: tuple[str, ...]
    axes: Matrix
    lines: Matrix
    doubt: float = 0.0

    @property
    def bounded(self) -> bool:
        """Whether the set has no lines."""
        return int(self.lines.shape[1]) == 0

    def along(self, direction: ArrayLike) -> float:
        """The largest t with t * direction in the set: 0 outside its span, inf along its lines.

        Raises:
            ShapeError: Not one number a component.
            ModelError: The zero vector.
        """
        d = self._direction(direction)
        directions, radii = self._span
        coordinates, apart = _coordinates(directions, d)
        if not negligible(apart, float(np.linalg.norm(d)), self.doubt):
            return 0.0
        share = coordinates[: len(radii)]
        if all(negligible(abs(float(x)), float(np.linalg.norm(d)), self.doubt) for x in share):
            return float("inf")
        return float(1.0 / np.linalg.norm(share / radii))

    def support(self, direction: ArrayLike) -> float:
        """The largest component along a direction: max of direction . x over the set.

        Raises:
            ShapeError: Not one number a component.
            ModelError: The zero vector.
        """
        d = self._direction(direction)
        size = float(np.linalg.norm(d))
        if any(not negligible(abs(float(x)), size, self.doubt) for x in d @ self.lines):
            return float("inf")
        return float(np.linalg.norm(d @ self.axes))

    def project(self, components: Sequence[str | int]) -> VectorSet:
        """The shadow of the set on chosen components, as a set of its own.

        Raises:
            UnknownNameError: No such component.
        """
        chosen = self._indices(components)
        lines = _range(self.lines[chosen], self.doubt)
        axes = self.axes[chosen]
        axes = axes - lines @ (lines.T @ axes)
        largest = float(np.linalg.norm(self.axes, axis=0).max(initial=0.0))
        return self._restricted(chosen, _principal(axes, largest, self.doubt), lines)

    def section(self, components: Sequence[str | int]) -> VectorSet:
        """The cut of the set by the plane where all other components are zero.

        Raises:
            UnknownNameError: No such component.
        """
        chosen = self._indices(components)
        others = [i for i in range(len(self.components)) if i not in set(chosen)]
        directions, radii = self._span
        doubt = {"subspace": self.doubt}
        rank = decide_rank(directions[others], name="section", scale=1.0, uncertainty=doubt).rank
        inside = svd(directions[others])[2][:, rank:]
        shares = inside[: len(radii)]
        kept = decide_rank(shares, name="lines of a section", scale=1.0, uncertainty=doubt).rank
        turn = svd(shares)[2]
        lines = directions[chosen] @ inside @ turn[:, kept:]
        bounded = inside @ turn[:, :kept]
        _, values, right = svd(bounded[: len(radii)] / radii[:, None])
        axes = directions[chosen] @ bounded @ (right[:, :kept] / values[:kept])
        return self._restricted(chosen, axes[:, ::-1], _range(lines, self.doubt))

    def points(self, count: int = 100) -> Matrix:
        """Points on the boundary of the bounded part, one a column, for drawing.

        One semi-axis gives its two ends, two an ellipse of `count` points, three or more the
        ellipses in the planes of every pair of semi-axes.

        Raises:
            ModelError: The count is no whole number above zero.
        """
        n, r = self.axes.shape
        if r == 0:
            return np.zeros((n, 1))
        if r == 1:
            return np.hstack([self.axes, -self.axes])
        if not isinstance(count, (int, np.integer)) or count < 1:
            raise ModelError(f"count is {count!r}: give a whole number of points, one or more")
        angle = np.linspace(0.0, 2.0 * np.pi, count)
        circle = np.vstack([np.cos(angle), np.sin(angle)])
        pairs = [(i, j) for i in range(r) for j in range(i + 1, r)]
        return np.hstack([self.axes[:, pair] @ circle for pair in pairs])

    @property
    def _span(self) -> tuple[Matrix, Vector]:
        """Unit directions of semi-axes and lines together, and the lengths of the semi-axes."""
        radii = np.linalg.norm(self.axes, axis=0)
        return np.hstack([self.axes / radii, self.lines]), radii

    def _restricted(self, chosen: Sequence[int], axes: Matrix, lines: Matrix) -> VectorSet:
        return VectorSet(
            tuple(self.components[i] for i in chosen), tuple(self.units[i] for i in chosen),
            frozen(axes), frozen(lines), self.doubt,
        )  # fmt: skip

    def _direction(self, direction: ArrayLike) -> Vector:
        d = checked(direction, "direction", (len(self.components),))
        if not d.any():
            raise ModelError("direction is the zero vector: give a direction with a length")
        return d

    def _indices(self, components: Sequence[str | int]) -> list[int]:
        return component_indices(components, self.components)


def component_indices(components: Sequence[str | int], names: Sequence[str]) -> list[int]:
    """Indices of components given by name or index.

    Raises:
        UnknownNameError: No such component.
        DuplicateNameError: A component given twice.
    """
    found: list[int] = []
    for item in [components] if isinstance(components, str) else components:
        if isinstance(item, str) and item in names:
            index = list(names).index(item)
        elif isinstance(item, (int, np.integer)) and 0 <= item < len(names):
            index = int(item)
        else:
            raise UnknownNameError("component", str(item), names)
        if index in found:
            raise DuplicateNameError("component", names[index])
        found.append(index)
    return found


def _coordinates(directions: Matrix, d: Vector) -> tuple[Vector, float]:
    """Least-squares coordinates of d in independent unit directions, and the distance that is left."""
    if directions.shape[1] == 0:
        return np.empty(0), float(np.linalg.norm(d))
    q, r = np.linalg.qr(directions)
    coordinates = np.linalg.solve(r, q.T @ d)
    return coordinates, float(np.linalg.norm(d - directions @ coordinates))


def _range(columns: Matrix, doubt: float) -> Matrix:
    """Orthonormal basis of the range of columns of length one or less."""
    rank = decide_rank(columns, name="lines", scale=1.0, uncertainty={"subspace": doubt}).rank
    return svd(columns)[0][:, :rank]


def _principal(axes: Matrix, largest: float, doubt: float) -> Matrix:
    """Orthogonal semi-axes of the set spanned by any generators; `largest` is what they came from."""
    rank = decide_rank(axes, name="projection", scale=largest, uncertainty={"subspace": doubt}).rank
    left, values, _ = svd(axes)
    return left[:, :rank] * values[:rank]
