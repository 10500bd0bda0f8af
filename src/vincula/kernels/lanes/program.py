"""A mechanism made ready for lanes, and what comes out of them.

    program = LaneProgram.prepare(mechanism)
    raw = program.run(values)

What lanes cannot do, or cannot do with certainty, is not done: `prepare` raises `Unsupported` with the
reason, and `run` marks the configurations that the reference path must look at.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from vincula.arrays import Matrix, Vector
from vincula.kernels.lanes import tables as t
from vincula.kernels.lanes.flatten import Flat, flatten

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism


@dataclass(frozen=True, eq=False)
class LaneProgram:
    """A mechanism as flat arrays.

    Attributes:
        mechanism: The mechanism.
        flat: Its arrays.
        code: `flat.code` with a list of all columns behind it, writable as kernels want it.
        constants: The constants, writable.
        general: Whether constants may differ from lane to lane.
    """

    mechanism: Mechanism
    flat: Flat
    code: NDArray[np.int64]
    constants: Vector
    general: bool

    @staticmethod
    def prepare(mechanism: Mechanism, *, general: bool = False) -> LaneProgram:
        """A program for a mechanism with a reference member.

        Args:
            mechanism: The mechanism, with its motors.
            general: Whether dimensions are going to differ from lane to lane.

        Raises:
            Unsupported: Something that the reference path alone does.
        """
        flat = flatten(mechanism, general=general)
        columns = np.arange(flat.code[t.COLUMNS])
        return LaneProgram(
            mechanism, flat, np.concatenate([flat.code, columns]), flat.constants.copy(), general
        )

    def matrices(self, values: Matrix, constants: Matrix | None = None) -> NDArray[np.float64]:
        """A = [J_a J_p -G^T] in scaled units, N x m x (n_a + n_p + d), at any values, closed or not.

        Args:
            values: N x values, in the order of the configuration [m, rad].
            constants: N x constants for dimensions that differ from lane to lane.
        """
        from vincula.kernels.lanes.entries import dense_entry, lanes_of_this_machine

        m, n = int(self.code[t.ROWS]), int(self.code[t.COLUMNS] + self.code[t.TWIST])
        out = np.zeros((len(values), m, n))
        if len(values):
            width = 1 if len(values) == 1 else lanes_of_this_machine()
            base, given = self._geometry(constants)
            slots = base + int(self.code[t.SLOTS]) + m * n
            run = dense_entry(width)
            run(_rows(values), self.code, given, base, len(self.flat.code), slots, out)
        return out

    def _geometry(self, constants: Matrix | None) -> tuple[int, Any]:
        """First slot after constants, and the constants."""
        return (0, self.constants) if constants is None else (constants.shape[1], _rows(constants))


def _rows(array: Matrix) -> Any:
    """Contiguous and writable, as the kernels are compiled for."""
    return np.require(array, dtype=np.float64, requirements=["C", "W"])
