"""Motions and equilibria of a linear model by plain numpy, to hold the library's answers against.

Rows are named, so that models with other cuts, orders or signs can be compared: what is compared are
spans, as sines of angles, in units in which metres are divided by the characteristic length.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from vincula.analysis.manipulability import (
    active_force_ellipsoid,
    kinematic_ellipsoid,
    passive_force_ellipsoid,
)
from vincula.arrays import Matrix, Vector
from vincula.model import LinearModel
from vincula.weights import Weights

RANK = 1e-9
"""Relative size below which a singular value of these well-scaled matrices is zero."""

SAME = 1e-6
"""Largest sine between spans that are the same."""


def kernel(matrix: Matrix) -> Matrix:
    """Orthonormal kernel."""
    _, sigma, right = np.linalg.svd(matrix)
    rank = int(np.count_nonzero(sigma > RANK * max(sigma.max(initial=0.0), 1.0)))
    return right[rank:].T


def span(columns: Matrix) -> Matrix:
    """Orthonormal basis of a range."""
    if not columns.size:
        return np.zeros((columns.shape[0], 0))
    left, sigma, _ = np.linalg.svd(columns, full_matrices=False)
    return left[:, sigma > RANK * max(sigma.max(initial=0.0), 1.0)]


def apart(one: Matrix, two: Matrix) -> float:
    """Sine of the largest angle between the ranges of two matrices; 1 if their dimensions differ."""
    one, two = span(one), span(two)
    if one.shape[1] != two.shape[1]:
        return 1.0
    rest = two - one @ (one.T @ two)
    return float(np.linalg.norm(rest, 2)) if rest.size else 0.0


@dataclass(frozen=True)
class Motions:
    """The kernel of eq. (1) with named rows, in units of the characteristic length."""

    rows: Mapping[str, int]
    basis: Matrix

    def of(self, names: Sequence[str]) -> Matrix:
        """The rows of some names."""
        return self.basis[[self.rows[name] for name in names]]


@lru_cache(maxsize=512)
def motions(model: LinearModel) -> Motions:
    """All motions of a model: motor, passive and twist rows, by name."""
    scaled = model.scaled
    basis = kernel(np.hstack([scaled.active, scaled.passive, -scaled.member]))
    names = [c.name for c in model.columns] + [f"u.{c}" for c in model.twist_components]
    return Motions({name: k for k, name in enumerate(names)}, basis)


def equilibria(model: LinearModel) -> Matrix:
    """Span of (tau, w) over all f with J_p^T f = 0, from eq. (15), in dual scaled units."""
    scaled = model.scaled
    forces = kernel(scaled.passive.T)
    return np.vstack([-scaled.active.T @ forces, scaled.member.T @ forces])


@lru_cache(maxsize=512)
def relation(model: LinearModel) -> Matrix:
    """Span of (q_a, u) over all motions: the relation M of a model."""
    found = motions(model)
    names = [c.name for c in model.motors] + [f"u.{c}" for c in model.twist_components]
    return found.of(names)


@lru_cache(maxsize=512)
def efficiencies(model: LinearModel) -> dict[str, Vector]:
    """Efficiencies of ellipsoids that do not depend on cuts, unit weights."""
    unit = Weights()
    return {
        "kinematic": kinematic_ellipsoid(model, unit).efficiencies,
        "active force": active_force_ellipsoid(model, unit).efficiencies,
        "passive force": passive_force_ellipsoid(model, unit).efficiencies,
    }


def assert_same_numbers(one: LinearModel, two: LinearModel, *, factor: float = 1.0) -> None:
    """The summary counts and all efficiencies agree (where finite ones are not lost in rounding)."""
    assert one.ledger.summary == two.ledger.summary
    for name, expected in efficiencies(one).items():
        found = efficiencies(two)[name]
        assert len(found) == len(expected), name
        plain = np.isfinite(expected) & (expected > 0)
        assert (plain == (np.isfinite(found) & (found > 0))).all(), name
        assert np.allclose(np.log(found[plain] * factor), np.log(expected[plain]), atol=1e-6), name


def assert_same_relation(
    one: LinearModel,
    two: LinearModel,
    *,
    motors: Mapping[str, tuple[str, float]] | None = None,
    twist: Matrix | None = None,
) -> None:
    """Motions of motors and member agree, and so do equilibria, being their annihilator.

    Args:
        one: A model.
        two: The other.
        motors: For motors that have another name or unit in `two`: name and factor there.
        twist: The twist in `two` for one in `one`.
    """
    turn = np.eye(one.dimension) if twist is None else twist
    scale_one, scale_two = one.scaled, two.scaled
    found = motions(two)
    rows = []
    for motor, own in zip(one.motors, scale_one.active_column, strict=True):
        name, factor = (motors or {}).get(motor.name, (motor.name, 1.0))
        index = [c.name for c in two.motors].index(name)
        rows.append(found.of([name]) * (scale_two.active_column[index] / (factor * own)))
    member = scale_two.twist[:, None] * found.of([f"u.{c}" for c in two.twist_components])
    rows.append(np.linalg.solve(turn, member) / scale_one.twist[:, None])
    assert apart(relation(one), np.vstack(rows)) < SAME
