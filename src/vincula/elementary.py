"""Elementary functions of floats and of traced numbers: builders that use them need no second form.

Of floats they are those of `math`, to the last bit.
"""

from __future__ import annotations

import math

from vincula.traced import (
    CHOICE,
    HYPOTENUSE,
    IS_LESS,
    LARGER,
    NEAREST,
    POWER_OF_TWO,
    SMALLER,
    Number,
    Traced,
    holds_traced,
    nearest_power_of_two,
    trace_of,
)


def cos(x: Number) -> Number:
    """Cosine."""
    return x.cos() if isinstance(x, Traced) else math.cos(x)


def sin(x: Number) -> Number:
    """Sine."""
    return x.sin() if isinstance(x, Traced) else math.sin(x)


def tan(x: Number) -> Number:
    """Tangent."""
    return x.tan() if isinstance(x, Traced) else math.tan(x)


def sqrt(x: Number) -> Number:
    """Square root.

    Raises:
        ValueError: A negative number.
    """
    return x.sqrt() if isinstance(x, Traced) else math.sqrt(x)


def hypot(*components: Number) -> Number:
    """Length of a vector."""
    if not any(isinstance(x, Traced) for x in components):
        return math.hypot(*components)
    found = components[0]
    for x in components[1:]:
        traced = holds_traced((found, x))
        found = trace_of(found, x).apply(HYPOTENUSE, found, x) if traced else math.hypot(found, x)
    return found


def is_finite(x: Number) -> bool:
    """Whether a float is finite; of traced numbers that is seen where they are used."""
    return isinstance(x, Traced) or math.isfinite(x)


def nearest(x: Number) -> Number:
    """The nearest whole number, as a float; of two equally near ones the even one."""
    return x.trace.apply(NEAREST, x) if isinstance(x, Traced) else float(round(x))


def larger(one: Number, two: Number) -> Number:
    """The larger of two numbers, whichever it is for other parameters."""
    return trace_of(one, two).apply(LARGER, one, two) if holds_traced((one, two)) else max(one, two)


def smaller(one: Number, two: Number) -> Number:
    """The smaller of two numbers, whichever it is for other parameters."""
    return trace_of(one, two).apply(SMALLER, one, two) if holds_traced((one, two)) else min(one, two)


def power_of_two(x: Number) -> Number:
    """The power of two nearest to a positive number, in ratio."""
    return x.trace.apply(POWER_OF_TWO, x) if isinstance(x, Traced) else nearest_power_of_two(x)


def choice(condition: Number, one: Number, two: Number) -> Number:
    """The first number where the condition is not zero, else the second: no guard."""
    if not isinstance(condition, Traced):
        return one if condition else two
    return one if one is two else condition.trace.apply(CHOICE, condition, one, two)


def is_less(one: Number, two: Number) -> Number:
    """1 where the first number is below the second, else 0: no guard."""
    return trace_of(one, two).apply(IS_LESS, one, two) if holds_traced((one, two)) else float(one < two)
