"""What the rows and columns of a linear model are called, and what is known beside the matrices."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np

from vincula.arrays import Matrix, Vector

RowKind = Literal["contact", "member cut", "loop cut", "coupling", "drive"]


class _All:
    """The type of `ALL`."""

    def __repr__(self) -> str:
        return "ALL"


ALL: Final = _All()
"""Every unlocked joint axis that is not part of a free joint; of bare matrices every column."""


def power_of_two(length: float) -> float:
    """The power of two nearest to a positive length (in ratio): scaling by it is exact."""
    return float(2.0 ** round(math.log2(length)))


@dataclass(frozen=True, slots=True)
class Row:
    """One constraint row.

    Attributes:
        name: Unique name, `contact.component` or `joint.component`.
        kind: contact, member cut, loop cut, coupling or drive.
        source: Name of the contact, joint, coupling or motor that gives the row.
        linear: True when the row is a velocity in m/s (its force in N), False for rad/s (N m).
    """

    name: str
    kind: RowKind
    source: str
    linear: bool


@dataclass(frozen=True, slots=True)
class Column:
    """One joint axis or motor.

    Attributes:
        name: Unique name of the axis or motor.
        joint: Joint (or motor) that it belongs to.
        linear: True when the rate is in m/s (its effort in N), False for rad/s (N m).
    """

    name: str
    joint: str
    linear: bool


@dataclass(frozen=True, slots=True)
class Cut:
    """Where a joint was cut to open the graph.

    Attributes:
        joint: Name of the joint.
        kind: `kept` (its columns stay, complete rows) or `contact` (its selector gives the rows).
        role: `member cut` or `loop cut`.
        at: Cut point at this configuration, ground axes [m].
    """

    joint: str
    kind: Literal["kept", "contact"]
    role: Literal["member cut", "loop cut"]
    at: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class Uncertainty:
    """What is known about the errors of the matrices, apart from rounding.

    Attributes:
        residual: Largest closure residual, metres with angles times `length`; 0 for a mechanism
            drawn in place.
        digits_length: Half a unit of the last typed digit over all lengths [m].
        digits_angle: The same over angles and directions [rad].
        tolerance_length: Manufacturing tolerance on lengths [m].
        tolerance_angle: Manufacturing tolerance on angles [rad].
        curvature: Bound K on the second derivatives of the loop equations, in scaled units: how much
            the matrices change per unit of configuration error.
    """

    residual: float = 0.0
    digits_length: float = 0.0
    digits_angle: float = 0.0
    tolerance_length: float = 0.0
    tolerance_angle: float = 0.0
    curvature: float = 1.0


@dataclass(frozen=True, slots=True, eq=False)
class BodyMotions:
    """How bodies move when joints and reference member do; for verdicts in plain words.

    Body b moves with twist  screws @ (path[b] * rates) + carried[b] * u, all twists being taken at
    the reference point in ground axes.

    Attributes:
        names: Names of the bodies.
        screws: d x n twists of every column of [J_a J_p] at the reference point.
        path: bodies x n matrix of -1, 0, 1: the columns on the path from each body's root.
        carried: For every body, True when it hangs from the reference member.
        origin: The reference point in ground axes [m].
    """

    names: tuple[str, ...]
    screws: Matrix
    path: Matrix
    carried: tuple[bool, ...]
    origin: Vector

    def twists(self, rates: Vector, twist: Vector) -> Matrix:
        """d x bodies twists (at the reference point) of every body for joint rates and a member twist."""
        joint_part: Matrix = self.screws @ (self.path * rates).T
        return joint_part + np.outer(twist, np.array(self.carried, dtype=float))


@dataclass(frozen=True, slots=True, eq=False)
class ScaledMatrices:
    """The three matrices in scaled units; powers of two only, so no rank changes.

    jacobian' = row * jacobian * column;  f = row * f',  rate = column * rate',  u = twist * u'.

    Attributes:
        active: Scaled J_a, m x n_a.
        passive: Scaled J_p, m x n_p.
        member: Scaled G^T, m x d.
        row: Row factors, m.
        active_column: Factors of the active columns, n_a.
        passive_column: Factors of the passive columns, n_p.
        twist: Factors of the twist components, d.
    """

    active: Matrix
    passive: Matrix
    member: Matrix
    row: Vector
    active_column: Vector
    passive_column: Vector
    twist: Vector
