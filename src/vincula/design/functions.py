"""Functions of the variables of a design, for many designs at once.

A function is given one design at a time where it has to be; where it can be traced (it uses plain arithmetic
and the functions of numpy) it is run once, and its arithmetic done on arrays.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from vincula.arrays import Vector
from vincula.traced import (
    ABSOLUTE,
    ADD,
    BELOW,
    CHOICE,
    CONSTANT,
    DIVIDE,
    EQUAL,
    INPUT,
    IS_LESS,
    LARGER,
    MULTIPLY,
    NEAREST,
    NEGATE,
    NOT_ABOVE,
    ROOT,
    SMALLER,
    SUBTRACT,
    VALUES,
    Number,
    Trace,
    Traced,
)  # fmt: skip

Function = Callable[[Mapping[str, Any]], Number]
MANY: Final = 16
"""Designs from which on tracing pays."""


def of_many(function: Function, columns: Mapping[str, Vector]) -> Vector:
    """Values of a function, one a design; NaN where it has none.

    Args:
        function: From the values of the variables by name to a number.
        columns: Values of the variables by name, one a design.
    """
    table = np.column_stack(list(columns.values()))
    found = np.full(len(table), np.nan)
    left = np.arange(len(table))
    if len(table) >= MANY:
        left = _traced(function, list(columns), table, found)
    for k in left:
        found[k] = _value(function, dict(zip(columns, table[k].tolist(), strict=True)))
    return found


def _traced(function: Function, names: list[str], table: Any, found: Vector) -> Any:
    """Write the values of designs for which every comparison comes out as for the first one; the others."""
    trace = Trace()
    try:
        result = function(trace.inputs(dict(zip(names, table[0].tolist(), strict=True))))
    except (TypeError, AttributeError, LookupError, ArithmeticError, ValueError):
        return np.arange(len(table))
    values, holds = _on_table(trace, result, table)
    holds &= np.isfinite(values)
    found[holds] = values[holds]
    return np.flatnonzero(~holds)


def _value(function: Function, row: Mapping[str, float]) -> float:
    """The value for one design; NaN, which no mechanism can be built from, where there is none."""
    try:
        return float(function(row))
    except (ArithmeticError, ValueError):
        return math.nan


_EXACT: Final[dict[int, Callable[..., Any]]] = {
    ADD: np.add, SUBTRACT: np.subtract, MULTIPLY: np.multiply, DIVIDE: np.divide, NEGATE: np.negative,
    ABSOLUTE: np.abs, ROOT: np.sqrt, LARGER: lambda a, b: np.where(b > a, b, a),
    SMALLER: lambda a, b: np.where(b < a, b, a), IS_LESS: lambda a, b: np.where(a < b, 1.0, 0.0),
    CHOICE: lambda c, a, b: np.where(c != 0.0, a, b), NEAREST: np.rint,
    BELOW: np.less, NOT_ABOVE: np.less_equal, EQUAL: np.equal,
}  # fmt: skip
"""Operations that numpy does to the last bit as Python does."""


def _on_table(
    trace: Trace, result: Number, table: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """A traced result for many sets of parameters, with the bits that one by one gives; and where it holds.

    Args:
        trace: The trace.
        result: A number of the trace, or a float.
        table: N x parameters, in the order of the trace.
    """
    values: list[Any] = []
    with np.errstate(all="ignore"):
        for operation, *operands in trace.nodes:
            if operation == INPUT:
                values.append(table[:, operands[0]])
            elif operation == CONSTANT:
                values.append(np.float64(trace.constants[operands[0]]))
            else:
                values.append(_operate(operation, [values[k] for k in operands]))
        holds = np.ones(len(table), dtype=bool)
        for (comparison, a, b), outcome in trace.guards.items():
            holds &= _EXACT[comparison](values[a], values[b]) == outcome
    last = values[result.place] if isinstance(result, Traced) else float(result)
    return np.broadcast_to(np.asarray(last, dtype=np.float64), len(table)).copy(), holds


def _operate(operation: int, sides: Sequence[Any]) -> Any:
    if operation in _EXACT:
        return _EXACT[operation](*sides)
    one_by_one = np.frompyfunc(_or_nan(VALUES[operation]), len(sides), 1)
    return np.asarray(one_by_one(*sides), dtype=np.float64)


def _or_nan(function: Callable[..., float]) -> Callable[..., float]:
    def found(*sides: float) -> float:
        try:
            return function(*sides)
        except (ArithmeticError, ValueError):
            return math.nan

    return found
