"""Numbers that remember how they were computed: a builder is run once, and its arithmetic kept.

A `Traced` number goes through a builder like a float.  Every operation on it is noted in its `Trace`, and
so is the outcome of every comparison (a guard): for other values of the parameters the same operations give
the same mechanism, as long as every comparison comes out as before.  What cannot be noted (`float(x)`,
`math.cos`, rounding) refuses a traced number with a TypeError.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np

INPUT, CONSTANT, ADD, SUBTRACT, MULTIPLY, DIVIDE, NEGATE, ABSOLUTE, ROOT, SINE, COSINE, TANGENT = range(12)
ARCTANGENT, ARCSINE, ARCCOSINE, EXPONENTIAL, LOGARITHM, POWER, HYPOTENUSE, ANGLE = range(12, 20)
LARGER, SMALLER, POWER_OF_TWO, NEAREST, IS_LESS, CHOICE, BELOW, NOT_ABOVE, EQUAL = range(20, 29)
"""Operations; the last three are guards."""


def nearest_power_of_two(x: float) -> float:
    """The power of two nearest to a positive number, in ratio."""
    return float(2.0 ** round(math.log2(x)))


VALUES: Final[dict[int, Callable[..., float]]] = {
    ADD: lambda a, b: a + b, SUBTRACT: lambda a, b: a - b, MULTIPLY: lambda a, b: a * b,
    DIVIDE: lambda a, b: a / b, NEGATE: lambda a: -a, ABSOLUTE: abs, ROOT: math.sqrt, SINE: math.sin,
    COSINE: math.cos, TANGENT: math.tan, ARCTANGENT: math.atan, ARCSINE: math.asin, ARCCOSINE: math.acos,
    EXPONENTIAL: math.exp, LOGARITHM: math.log, POWER: math.pow, HYPOTENUSE: math.hypot, ANGLE: math.atan2,
    LARGER: max, SMALLER: min, POWER_OF_TWO: nearest_power_of_two, IS_LESS: lambda a, b: float(a < b),
    NEAREST: lambda x: float(round(x)), CHOICE: lambda c, a, b: a if c else b,
}  # fmt: skip
"""What every operation does to floats."""
_GUARDS: Final[dict[int, Callable[[float, float], bool]]] = {
    BELOW: lambda a, b: a < b, NOT_ABOVE: lambda a, b: a <= b, EQUAL: lambda a, b: a == b,
}  # fmt: skip

Number = Any
"""A float or a traced number."""


@dataclass(eq=False)
class Trace:
    """Operations in order, each once, and guards.

    Attributes:
        names: Names of the parameters, the first nodes.
        nodes: Operation and operands (places of nodes) by node; of a constant its place in `constants`.
        constants: Numbers that are the same for all parameters.
        guards: Comparison, its two sides and how it came out.
    """

    names: list[str] = field(default_factory=list)
    nodes: list[tuple[int, ...]] = field(default_factory=list)
    constants: list[float] = field(default_factory=list)
    guards: dict[tuple[int, int, int], bool] = field(default_factory=dict)
    _known: dict[tuple[Any, ...], Traced] = field(default_factory=dict)

    def inputs(self, values: Mapping[str, float]) -> dict[str, Traced]:
        """Traced parameters at these values."""
        found = {}
        for name, value in values.items():
            self.names.append(name)
            found[name] = self._new((INPUT, len(self.names) - 1), float(value))
        return found

    def apply(self, operation: int, *operands: Number) -> Traced:
        """The result of an operation, noted unless it was before."""
        sides = [self.node(x) for x in operands]
        key = (operation, *(x.place for x in sides))
        if key not in self._known:
            value = VALUES[operation](*(x.value for x in sides))
            self._known[key] = self._new(key, value)
        return self._known[key]

    def guard(self, comparison: int, one: Number, two: Number) -> bool:
        """Whether a comparison holds; it has to come out the same wherever this trace is used."""
        a, b = self.node(one), self.node(two)
        holds = _GUARDS[comparison](a.value, b.value)
        self.guards[comparison, a.place, b.place] = holds
        return holds

    def guard_near(self, one: Number, two: float, most: float) -> None:
        """Guard that a number is nearly a constant; of this one it may hold or not."""
        distance = abs(one - two)
        if isinstance(distance, Traced):
            self.guards[NOT_ABOVE, distance.place, self.node(most).place] = True

    def node(self, x: Number) -> Traced:
        """The node of a number."""
        if isinstance(x, Traced):
            if x.trace is not self:
                raise TypeError("numbers of two traces in one operation")
            return x
        value = float(x)
        key = (CONSTANT, value, math.copysign(1.0, value))
        if key not in self._known:
            self.constants.append(value)
            self._known[key] = self._new((CONSTANT, len(self.constants) - 1), value)
        return self._known[key]

    def _new(self, node: tuple[int, ...], value: float) -> Traced:
        self.nodes.append(node)
        return Traced(self, len(self.nodes) - 1, value)


class Traced:
    """A number with its place in a trace; see the module.

    Attributes:
        trace: The trace.
        place: Place of its node.
        value: What it is for the parameters that the trace was made with.
    """

    __slots__ = ("place", "trace", "value")

    def __init__(self, trace: Trace, place: int, value: float) -> None:
        self.trace, self.place, self.value = trace, place, value

    def __repr__(self) -> str:
        return f"Traced({self.value!r})"

    def __format__(self, how: str) -> str:
        return format(self.value, how)

    def __hash__(self) -> int:
        return id(self)

    def __add__(self, other: Number) -> Number:
        return _sum(self, other) if _is_number(other) else NotImplemented

    def __radd__(self, other: Number) -> Number:
        return _sum(other, self) if _is_number(other) else NotImplemented

    def __sub__(self, other: Number) -> Number:
        return _difference(self, other) if _is_number(other) else NotImplemented

    def __rsub__(self, other: Number) -> Number:
        return _difference(other, self) if _is_number(other) else NotImplemented

    def __mul__(self, other: Number) -> Number:
        return _product(self, other) if _is_number(other) else NotImplemented

    def __rmul__(self, other: Number) -> Number:
        return _product(other, self) if _is_number(other) else NotImplemented

    def __truediv__(self, other: Number) -> Number:
        return _quotient(self, other) if _is_number(other) else NotImplemented

    def __rtruediv__(self, other: Number) -> Number:
        return _quotient(other, self) if _is_number(other) else NotImplemented

    def __pow__(self, other: Number) -> Number:
        if not _is_number(other):
            return NotImplemented
        return _product(self, self) if _is(other, 2.0) else self.trace.apply(POWER, self, other)

    def __rpow__(self, other: Number) -> Number:
        return self.trace.apply(POWER, other, self) if _is_number(other) else NotImplemented

    def __neg__(self) -> Traced:
        return self.trace.apply(NEGATE, self)

    def __pos__(self) -> Traced:
        return self

    def __abs__(self) -> Traced:
        return self.trace.apply(ABSOLUTE, self)

    # Comparisons are guards.

    def __lt__(self, other: Number) -> bool:
        return self.trace.guard(BELOW, self, other) if _is_number(other) else NotImplemented

    def __gt__(self, other: Number) -> bool:
        return self.trace.guard(BELOW, other, self) if _is_number(other) else NotImplemented

    def __le__(self, other: Number) -> bool:
        return self.trace.guard(NOT_ABOVE, self, other) if _is_number(other) else NotImplemented

    def __ge__(self, other: Number) -> bool:
        return self.trace.guard(NOT_ABOVE, other, self) if _is_number(other) else NotImplemented

    def __eq__(self, other: object) -> bool:
        return self.trace.guard(EQUAL, self, other) if _is_number(other) else NotImplemented

    def __ne__(self, other: object) -> bool:
        return not self.trace.guard(EQUAL, self, other) if _is_number(other) else NotImplemented

    def __bool__(self) -> bool:
        return not self.trace.guard(EQUAL, self, 0.0)

    # What numpy calls for `numpy.cos(x)` and so on, of one number or of the entries of an array.

    def sqrt(self) -> Traced:
        """Its square root."""
        self.trace.guard(NOT_ABOVE, 0.0, self)
        return self.trace.apply(ROOT, self)

    def log(self) -> Traced:
        """Its natural logarithm."""
        self.trace.guard(BELOW, 0.0, self)
        return self.trace.apply(LOGARITHM, self)

    def sin(self) -> Traced:
        """Its sine."""
        return self.trace.apply(SINE, self)

    def cos(self) -> Traced:
        """Its cosine."""
        return self.trace.apply(COSINE, self)

    def tan(self) -> Traced:
        """Its tangent."""
        return self.trace.apply(TANGENT, self)

    def arctan(self) -> Traced:
        """The angle with this tangent [rad]."""
        return self.trace.apply(ARCTANGENT, self)

    def arcsin(self) -> Traced:
        """The angle with this sine [rad]."""
        return self.trace.apply(ARCSINE, self)

    def arccos(self) -> Traced:
        """The angle with this cosine [rad]."""
        return self.trace.apply(ARCCOSINE, self)

    def exp(self) -> Traced:
        """The exponential function of it."""
        return self.trace.apply(EXPONENTIAL, self)

    def hypot(self, other: Number) -> Traced:
        """Length of the vector of both."""
        return self.trace.apply(HYPOTENUSE, self, other)

    def arctan2(self, other: Number) -> Traced:
        """Angle of the vector (other, self) [rad]."""
        return self.trace.apply(ANGLE, self, other)


def _is_number(x: object) -> bool:
    return isinstance(x, (Traced, int, float, np.floating, np.integer))


def _is(x: Number, value: float) -> bool:
    return not isinstance(x, Traced) and float(x) == value


def trace_of(one: Number, two: Number) -> Trace:
    """The trace of two numbers of which at least one is traced."""
    found: Trace = one.trace if isinstance(one, Traced) else two.trace
    return found


# What changes nothing is not noted: zeros and ones come from axes along ground axes.


def _sum(one: Number, two: Number) -> Number:
    if _is(one, 0.0) or _is(two, 0.0):
        return two if _is(one, 0.0) else one
    return trace_of(one, two).apply(ADD, one, two)


def _difference(one: Number, two: Number) -> Number:
    if one is two:
        return 0.0
    if _is(one, 0.0) or _is(two, 0.0):
        return -two if _is(one, 0.0) else one
    return trace_of(one, two).apply(SUBTRACT, one, two)


def _product(one: Number, two: Number) -> Number:
    if _is(one, 0.0) or _is(two, 0.0):
        return 0.0
    for unit, other in ((one, two), (two, one)):
        if _is(unit, 1.0) or _is(unit, -1.0):
            return other if _is(unit, 1.0) else -other
    return trace_of(one, two).apply(MULTIPLY, one, two)


def _quotient(one: Number, two: Number) -> Number:
    if isinstance(two, Traced) and not two:
        raise ZeroDivisionError("division by zero")
    if _is(one, 0.0) or _is(two, 1.0):
        return one if _is(two, 1.0) else 0.0
    return trace_of(one, two).apply(DIVIDE, one, two)


def holds_traced(values: object) -> bool:
    """Whether there are traced numbers among numbers, or in a nested list or array of them."""
    if isinstance(values, np.ndarray):
        return values.dtype == object and any(isinstance(x, Traced) for x in values.flat)
    if isinstance(values, (list, tuple)):
        return any(holds_traced(x) for x in values)
    return isinstance(values, Traced)
