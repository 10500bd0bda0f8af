"""What a design may change: variables with bounds, and the parameters of the mechanism that they set."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from vincula.arrays import Matrix, Vector
from vincula.design.functions import of_many
from vincula.errors import DuplicateNameError, ModelError, UnknownNameError, listing

Tie = Callable[[Mapping[str, float]], float]
"""Value of one parameter of the mechanism from the values of the variables, by name."""
MOST: Final = 200
"""Most variables of one problem."""


@dataclass(frozen=True, slots=True)
class DesignVariable:
    """One number that a design chooses.

    Attributes:
        name: Its name.
        low: Smallest value, in the units of the parameter that it sets (examples: m and rad).
        high: Largest value.
        start: Value of the design to compare with; None for what the mechanism declares, else the middle.
        tolerance: Largest manufacturing error, 0 for none; used by the tolerance analysis.
        unit: Unit in reports, such as `deg`; empty for none.
        scale: One unit of the report in the variable's own units (deg: pi/180).
    """

    name: str
    low: float
    high: float
    start: float | None = None
    tolerance: float = 0.0
    unit: str = ""
    scale: float = 1.0

    def __post_init__(self) -> None:
        if not (math.isfinite(self.low) and math.isfinite(self.high) and self.low < self.high):
            raise ModelError(
                f"variable {self.name!r}: the bounds {self.shown(self.low)} and {self.shown(self.high)} are "
                "crossed or no numbers: give the smaller one first"
            )
        if self.start is not None and not math.isfinite(self.start):
            raise ModelError(f"variable {self.name!r}: start is {self.start}: give a finite number")
        if not (math.isfinite(self.tolerance) and self.tolerance >= 0.0):
            raise ModelError(f"variable {self.name!r}: tolerance is {self.tolerance}: give 0 or more")
        if not (math.isfinite(self.scale) and self.scale > 0.0):
            raise ModelError(f"variable {self.name!r}: scale is {self.scale}: give a positive number")

    def shown(self, value: float) -> str:
        """A value with its unit, six digits."""
        return f"{value / self.scale:.6g}{' ' + self.unit if self.unit else ''}"


class DesignSpace:
    """The variables of a problem, and how they become parameters of the mechanism.

    Args:
        variables: The variables, in order.
        ties: Functions of the variables by parameter; a variable that is named as a parameter and
            stands in no tie for it sets that parameter itself.
        parameters: Parameters that the mechanism has, with their declared values; None: any name.

    Raises:
        ModelError: No variables, or a variable that sets nothing because nothing is tied.
        DuplicateNameError: Two variables of one name.
        UnknownNameError: A tie to a parameter that does not exist.
    """

    def __init__(
        self,
        variables: Sequence[DesignVariable],
        ties: Mapping[str, Tie],
        parameters: Mapping[str, float] | None,
    ) -> None:
        if not variables:
            raise ModelError("no variables: name at least one number that the design may change")
        if len(variables) > MOST:
            raise ModelError(f"{len(variables)} variables: a problem has at most {MOST}")
        self.variables = tuple(variables)
        self.names = tuple(variable.name for variable in variables)
        for name in self.names:
            if self.names.count(name) > 1:
                raise DuplicateNameError("variable", name)
        self.ties = dict(ties)
        known = parameters if parameters is not None else dict.fromkeys((*self.names, *ties), 0.0)
        for name in self.ties:
            if name not in known:
                raise UnknownNameError("parameter of the mechanism", name, known)
        self.direct = tuple(n for n in self.names if n in known and n not in self.ties)
        loose = [name for name in self.names if name not in self.direct]
        if loose and not self.ties:
            raise UnknownNameError("parameter of the mechanism", loose[0], known)
        self.declared = dict(parameters or {})
        self.low = np.array([variable.low for variable in variables])
        self.high = np.array([variable.high for variable in variables])

    @property
    def start(self) -> Vector:
        """The design to compare with: given, else declared by the mechanism, else the middle."""
        found = []
        for v in self.variables:
            value = v.start if v.start is not None else self.declared.get(v.name)
            found.append(0.5 * (v.low + v.high) if value is None else value)
        return np.array(found)

    def named(self, design: Vector) -> dict[str, float]:
        """The values of one design by variable."""
        return {name: float(value) for name, value in zip(self.names, design, strict=True)}

    def parameters(self, designs: Matrix) -> dict[str, Vector]:
        """Parameters of the mechanism, one number a design; NaN where a tie has no value.

        Args:
            designs: One row a design, one column a variable.
        """
        found = {n: np.ascontiguousarray(designs[:, self.names.index(n)]) for n in self.direct}
        columns = self.columns(designs)
        for name, tie in self.ties.items():
            found[name] = of_many(tie, columns)
        return found

    def columns(self, designs: Matrix) -> dict[str, Vector]:
        """Values of many designs by variable."""
        return {name: np.ascontiguousarray(designs[:, k]) for k, name in enumerate(self.names)}

    def unused(self) -> tuple[str, ...]:
        """Variables that change no parameter, found by moving each of them."""
        middle = np.tile(0.5 * (self.low + self.high), (2 * len(self.names) + 1, 1))
        for k in range(len(self.names)):
            middle[2 * k + 1, k] += 0.125 * (self.high[k] - self.low[k])
            middle[2 * k + 2, k] -= 0.25 * (self.high[k] - self.low[k])
        values = np.column_stack(list(self.parameters(middle).values()))
        return tuple(
            name
            for k, name in enumerate(self.names)
            if not (_differ(values[0], values[2 * k + 1]) or _differ(values[0], values[2 * k + 2]))
        )

    def refuse_outside(self, designs: Matrix) -> Matrix:
        """Designs as a table of finite numbers with one column a variable.

        Raises:
            ModelError: Another size, or numbers that are not finite.
        """
        table = np.atleast_2d(np.asarray(designs, dtype=float))
        if table.ndim != 2 or table.shape[1] != len(self.names):
            raise ModelError(
                f"designs have shape {np.shape(designs)}: give one column a variable, {listing(self.names)}"
            )
        if not np.isfinite(table).all():
            raise ModelError("designs hold numbers that are not finite")
        return table


def _differ(one: Vector, other: Vector) -> bool:
    return not np.array_equal(one, other, equal_nan=True)
