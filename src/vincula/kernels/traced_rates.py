"""Exact rates of what a builder draws: its arithmetic is traced, and every operation differentiated.

Where something cannot be traced, or has a kink just there, nothing is said: the numbers are differenced.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from vincula import traced as t
from vincula.arrays import Vector
from vincula.errors import VinculaError
from vincula.kernels.traced_geometry import ROUNDING, UNTRACED
from vincula.kernels.twin import Twin
from vincula.mechanism.drawn_mechanism import Outline
from vincula.mechanism.mechanism import Mechanism
from vincula.mechanism.placement_rates import Numbers
from vincula.traced import Trace, Traced

_Slopes = Callable[..., tuple[float, ...]]

SLOPES: Final[dict[int, _Slopes]] = {
    t.ADD: lambda v, a, b: (1.0, 1.0),
    t.SUBTRACT: lambda v, a, b: (1.0, -1.0),
    t.MULTIPLY: lambda v, a, b: (b, a),
    t.DIVIDE: lambda v, a, b: (1.0 / b, -v / b),
    t.NEGATE: lambda v, a: (-1.0,),
    t.ABSOLUTE: lambda v, a: (a / v,),
    t.ROOT: lambda v, a: (0.5 / v,),
    t.SINE: lambda v, a: (math.cos(a),),
    t.COSINE: lambda v, a: (-math.sin(a),),
    t.TANGENT: lambda v, a: (1.0 + v * v,),
    t.ARCTANGENT: lambda v, a: (1.0 / (1.0 + a * a),),
    t.ARCSINE: lambda v, a: (1.0 / math.sqrt(1.0 - a * a),),
    t.ARCCOSINE: lambda v, a: (-1.0 / math.sqrt(1.0 - a * a),),
    t.EXPONENTIAL: lambda v, a: (v,),
    t.LOGARITHM: lambda v, a: (1.0 / a,),
    t.POWER: lambda v, a, b: (b * a ** (b - 1.0), v * math.log(a) if a > 0.0 else math.nan),
    t.HYPOTENUSE: lambda v, a, b: (a / v, b / v),
    t.ANGLE: lambda v, a, b: (b / (a * a + b * b), -a / (a * a + b * b)),
    t.LARGER: lambda v, a, b: (0.0, 1.0) if b > a else (1.0, 0.0) if a > b else (math.nan, math.nan),
    t.SMALLER: lambda v, a, b: (0.0, 1.0) if b < a else (1.0, 0.0) if a < b else (math.nan, math.nan),
    t.POWER_OF_TWO: lambda v, a: (0.0,),
    t.NEAREST: lambda v, a: (0.0,),
    t.IS_LESS: lambda v, a, b: (0.0, 0.0),
    t.CHOICE: lambda v, c, a, b: (0.0, 1.0, 0.0) if c else (0.0, 0.0, 1.0),
}
"""Derivatives of every operation by its operands, from its value and theirs; NaN or an error at a kink."""


def traced_rates(
    mechanism: Mechanism, build: Callable[..., Any], names: Sequence[str], at: Mapping[str, float]
) -> list[Numbers] | None:
    """Rates of the numbers of a mechanism by parameters of its builder; None where they are not exact.

    Couplings, motors over several axes and weights of its own are not traced: mechanisms that have any are
    left to differences.

    Args:
        mechanism: The mechanism at these values.
        build: Makes an outline from traced parameters.
        names: The parameters that change.
        at: Values of parameters.
    """
    if mechanism.couplings or mechanism.drives:
        return None
    trace = Trace()
    inputs = trace.inputs({name: at[name] for name in names})
    try:
        outline = build(**{**at, **inputs})
        if not isinstance(outline, Outline):
            return None
        twin = Twin(mechanism, outline, trace)
        frames, reference = twin.layout.frames, twin.reference
        parts = [
            frames.rotation,
            frames.position,
            np.zeros(0) if reference is None else reference.origin,
            np.array([joint.second_axis for joint in twin.all_joints], dtype=object).reshape(-1, 3),
        ]
        tangents = _tangents(trace, [at[name] for name in names])
    except (*UNTRACED, ArithmeticError, ValueError, VinculaError):
        return None
    if not _same(mechanism, parts):
        return None
    found = []
    for k in range(len(names)):
        rotation, position, origin, second = (_rates(part, tangents[:, k]) for part in parts)
        rate = Numbers(rotation, position, origin, np.zeros(len(twin.all_joints)), second)
        if not all(np.isfinite(part).all() for part in (rotation, position, origin, second)):
            return None
        found.append(rate)
    return found


def _tangents(trace: Trace, values: Sequence[float]) -> NDArray[np.float64]:
    """Derivatives of all nodes by all parameters, nodes x parameters."""
    size = len(values)
    numbers: list[float] = []
    tangents = np.zeros((len(trace.nodes), size))
    for place, (operation, *sides) in enumerate(trace.nodes):
        if operation == t.INPUT:
            numbers.append(values[sides[0]])
            tangents[place, sides[0]] = 1.0
            continue
        if operation == t.CONSTANT:
            numbers.append(trace.constants[sides[0]])
            continue
        given = [numbers[side] for side in sides]
        value = t.VALUES[operation](*given)
        numbers.append(value)
        own = [side for side in sides if tangents[side].any()]
        if own:
            for side, slope in zip(sides, SLOPES[operation](value, *given), strict=True):
                if tangents[side].any():
                    tangents[place] += slope * tangents[side]
    return tangents


def _rates(part: NDArray[Any], tangent: Vector) -> NDArray[np.float64]:
    """Rates of numbers, traced or not."""
    flat = [float(tangent[x.place]) if isinstance(x, Traced) else 0.0 for x in part.ravel()]
    return np.array(flat, dtype=float).reshape(part.shape)


def _same(mechanism: Mechanism, parts: Sequence[NDArray[Any]]) -> bool:
    """Whether what was traced is what was built."""
    own = Numbers.of(mechanism)
    for part, built in zip(parts, (own.rotation, own.position, own.origin, own.second_axis), strict=True):
        drawn = np.array([x.value if isinstance(x, Traced) else float(x) for x in part.ravel()])
        if drawn.size != built.size:
            return False
        if not (np.abs(drawn - built.ravel()) <= ROUNDING * (1.0 + np.abs(built.ravel()))).all():
            return False
    return True
