"""Zeros of many functions at once, each in its own bracket: secants with Anderson's and Bjoerck's weights.

A bracket is halved where secants gain little, so every function is done after a few tens of values whatever
its shape; a smooth one takes six to eight.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np
from numpy.typing import NDArray

from vincula.arrays import Vector

NARROW: Final = 1e-13
"""Arguments nearer than this share of the first bracket are one."""
EXACT: Final = 1e-16
"""A value below this share of those at the ends is zero."""
MOST: Final = 60
"""Most values of one function."""
Values = Callable[[NDArray[np.intp], Vector], Vector]
"""Values of some of the functions, by their numbers, at one argument each; NaN where there is none."""


def roots(values: Values, low: Vector, high: Vector, at_low: Vector, at_high: Vector) -> None:
    """Call functions until each was called at its zero, as near as rounding allows.

    What a function finds there is its own to keep.  One that gives NaN is left where it is.

    Args:
        values: The functions.
        low: Lower ends of the brackets.
        high: Upper ends.
        at_low: Values there.
        at_high: Values there, of the other sign.
    """
    low, high, at_low, at_high = (x.astype(float).copy() for x in (low, high, at_low, at_high))
    width = np.maximum(np.abs(high - low), 1e-300)
    last, before = np.zeros(len(low)), np.full(len(low), np.inf)
    zero = EXACT * np.maximum(np.abs(at_low), np.abs(at_high))
    going = np.arange(len(low))
    for turn in range(MOST):
        going = going[np.abs(high - low)[going] > NARROW * width[going]]
        if not len(going):
            return
        a, b, fa, fb = low[going], high[going], at_low[going], at_high[going]
        share = np.clip(fa / (fa - fb), 1e-3 * NARROW, 1.0 - 1e-3 * NARROW)
        # Every fifth value halves the bracket: secants alone may creep up from one side.
        middle = a + (0.5 if turn % 5 == 4 else share) * (b - a)
        found = values(going, middle)
        same = found * fa > 0.0
        side = np.where(same, 1.0, -1.0)
        weight = 1.0 - found / np.where(same, fa, fb)
        weight = np.where(side == last[going], np.where(weight > 0.0, weight, 0.5), 1.0)
        at_low[going], at_high[going] = np.where(same, found, fa * weight), np.where(same, fb * weight, found)
        low[going], high[going] = np.where(same, middle, a), np.where(same, b, middle)
        last[going] = side
        still = np.abs(middle - before[going]) > NARROW * width[going]
        before[going] = middle
        going = going[np.isfinite(found) & (np.abs(found) > zero[going]) & still]
