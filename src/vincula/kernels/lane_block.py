"""A block of configurations in lanes, for what is computed from the results of a kernel."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from vincula.arrays import Matrix

if TYPE_CHECKING:
    from vincula.kernels.lanes.program import LaneProgram, RawLanes

T = TypeVar("T")


class LaneBlock:
    """What a kernel gave for some configurations, and what was made of it so far.

    Args:
        program: The program of the kernel.
        raw: What it gave.
        values: N x coordinates.
        constants: N x constants where dimensions differ from lane to lane.

    Attributes:
        sure: N: lanes that count; who finds another one in doubt clears it here.
    """

    def __init__(self, program: LaneProgram, raw: RawLanes, values: Matrix, constants: Matrix | None) -> None:
        self.program, self.raw, self.values, self.constants = program, raw, values, constants
        self.sure: NDArray[np.bool_] = np.array(raw.certain)
        self._kept: dict[Any, Any] = {}

    def once(self, key: Any, make: Callable[[], T]) -> T:
        """What `make` gives, made once for all quantities of the block."""
        if key not in self._kept:
            self._kept[key] = make()
        found: T = self._kept[key]
        return found

    @property
    def of_one_length(self) -> NDArray[np.bool_]:
        """Lanes whose characteristic length, the unit of scaled matrices, is that of the program."""
        if self.constants is None:
            return np.ones(len(self.values), dtype=bool)
        # The first constant is one over the characteristic length.
        return np.asarray(self.constants[:, 0] == self.program.constants[0])

    def matrices(self, first: int, last: int) -> NDArray[np.float64]:
        """A = [J_a J_p -G^T] in scaled units of configurations first ... last - 1."""
        constants = None if self.constants is None else self.constants[first:last]
        return self.program.matrices(self.values[first:last], constants)
