"""What the matrices of a reduced mechanism look like, before any number: rows, columns, signs.

Everything here depends on structure alone (graph, reduction, motors), so it is made once a mechanism;
at a configuration only frames move (see `jacobians`).  The heart is one sign matrix: for every row
and column +1 or -1 where the column's joint lies on the way to the first or the second side of the
row, 0 elsewhere.
"""

from __future__ import annotations

from dataclasses import dataclass

from vincula.arrays import Matrix, Vector
from vincula.labels import Column, Cut, Row
from vincula.mechanism.frames import FrameTable, Indices
from vincula.mechanism.parts import Coupling
from vincula.mechanism.reduction import CutJoint


@dataclass(frozen=True, slots=True, eq=False)
class ScrewArrays:
    """The screws of all columns: see `joint_types.Screw`.

    Attributes:
        frame: Frame that carries the axis, by column.
        centre: Frame whose origin the axis goes through.
        axis: columns x s axes in their frames.
        turn: 1 where the axis turns.
        slide: Advance for a unit of the rate.
    """

    frame: Indices
    centre: Indices
    axis: Matrix
    turn: Vector
    slide: Vector


@dataclass(frozen=True, slots=True, eq=False)
class RowArrays:
    """The blocked directions of all rows that come from geometry: see `blocked.BlockedRow`.

    Attributes:
        frame: Frame whose axes the row is written in, by row.
        point: Frame at whose origin it holds.
        push: rows x s directions in their frames.
        turn: rows x (1 or 3) directions in their frames.
        across: Rows with an axis carried by the second side: row, its frame B, the axis.
    """

    frame: Indices
    point: Indices
    push: Matrix
    turn: Matrix
    across: tuple[tuple[int, int, Vector], ...]


@dataclass(frozen=True, slots=True, eq=False)
class Layout:
    """Rows, columns and signs of a mechanism's matrices.

    Attributes:
        frames: All frames, declared cut points included.
        columns: Names of all columns, drives last.
        active: Columns with motors, in the order of the motors.
        passive: The other columns.
        screws: Screws of the columns; drives have none.
        rows: Names of all rows; those from geometry first, then couplings, then drives.
        blocked: Directions of the rows from geometry.
        signs: Those rows x columns, entries -1, 0, 1.
        carried: For those rows +1, -1 or 0: how the member's twist enters.
        constant: The remaining rows, as far as they do not depend on the configuration.
        polynomials: Couplings whose row does: index into `constant`, coupling.
        cuts: Cuts with the frame of their point.
        longest: Most axes (the member counting as one) that move one row.
        groups: Names of the rigid groups of bodies.
        path: groups x columns in the order (active, passive): signs of the columns on the way to each.
        group_carried: For every group, whether it hangs from the member.
    """

    frames: FrameTable
    columns: tuple[Column, ...]
    active: Indices
    passive: Indices
    screws: ScrewArrays
    rows: tuple[Row, ...]
    blocked: RowArrays
    signs: Matrix
    carried: Vector
    constant: Matrix
    polynomials: tuple[tuple[int, Coupling], ...]
    cuts: tuple[tuple[CutJoint, int], ...]
    longest: int
    groups: tuple[str, ...]
    path: Matrix
    group_carried: tuple[bool, ...]

    @property
    def index(self) -> dict[str, int]:
        """Column by name."""
        return {column.name: k for k, column in enumerate(self.columns)}

    def labels(self, positions: Matrix) -> tuple[Cut, ...]:
        """The cuts with their points at one configuration, for results."""
        return tuple(
            Cut(cut.joint.name, cut.kind, cut.role, tuple(map(float, positions[point])))
            for cut, point in self.cuts
        )
