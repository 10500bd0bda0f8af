"""The kernel that evaluates traced arithmetic in lanes: a list of instructions, walked once a block.

An instruction is an operation, its target and up to three operands, all slots.  Constants are in the first
slots; an input's operand is its column.  A guard has its two sides and, as target, how it has to come out.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Any

import numba

from vincula.kernels.lanes.entries import fingerprint
from vincula.kernels.lanes.jit import Code, Lane, Slots, kernel
from vincula.kernels.lanes.vector import (
    absolute,
    at_most,
    first_of,
    less,
    load,
    nearest,
    neg,
    select,
    sqrt,
    store,
    zeros,
)
from vincula.kernels.lanes.workspace import aligned
from vincula.traced import (
    ABSOLUTE,
    ADD,
    ANGLE,
    ARCCOSINE,
    ARCSINE,
    ARCTANGENT,
    BELOW,
    CHOICE,
    COSINE,
    DIVIDE,
    EXPONENTIAL,
    HYPOTENUSE,
    INPUT,
    IS_LESS,
    LARGER,
    LOGARITHM,
    MULTIPLY,
    NEAREST,
    NEGATE,
    NOT_ABOVE,
    POWER,
    ROOT,
    SINE,
    SMALLER,
    SUBTRACT,
    TANGENT,
)

WIDTH = 16
"""Sets of parameters that one block goes through together."""


@kernel
def _arithmetic(op: int, x: Lane, y: Lane) -> Lane:
    if op == MULTIPLY:
        return x * y
    if op == ADD:
        return x + y
    if op == SUBTRACT:
        return x - y
    if op == DIVIDE:
        return x / y
    if op == NEGATE:
        return neg(x)
    if op == ABSOLUTE:
        return absolute(x)
    if op == LARGER:
        return select(less(x, y), y, x)
    if op == SMALLER:
        return select(less(y, x), y, x)
    if op == NEAREST:
        return nearest(x)
    return sqrt(x)


@kernel
def _of_one(op: int, x: float) -> float:
    if op == SINE:
        return math.sin(x)
    if op == COSINE:
        return math.cos(x)
    if op == TANGENT:
        return math.tan(x)
    if op == ARCTANGENT:
        return math.atan(x)
    if op == ARCSINE:
        return math.asin(x)
    if op == ARCCOSINE:
        return math.acos(x)
    if op == EXPONENTIAL:
        return math.exp(x)
    if op == LOGARITHM:
        return math.log(x)
    return 2.0 ** round(math.log2(x)) if x > 0.0 else math.nan


@kernel
def _of_two(op: int, x: float, y: float) -> float:
    if op == POWER:
        return math.pow(x, y)
    if op == HYPOTENUSE:
        return math.hypot(x, y)
    return math.atan2(x, y)


@kernel
def _guard(w: Slots, op: int, wanted: int, a: int, b: int, holds: int, z: Lane) -> None:
    """Note in which lanes a comparison does not come out as wanted."""
    x, y = load(w, a, z), load(w, b, z)
    before = load(w, holds, z)
    if op == BELOW:
        mask = less(x, y)
    elif op == NOT_ABOVE:
        mask = at_most(x, y)
    else:
        mask = at_most(absolute(x - y), z)
    store(w, holds, select(mask, before, z) if wanted else select(mask, z, before))


@kernel
def _step(w: Slots, op: int, target: int, a: int, b: int, c: int, holds: int, width: int, z: Lane) -> None:
    """One instruction that is no input."""
    if op >= BELOW:
        _guard(w, op, target, a, b, holds, z)
    elif op == CHOICE:
        mask = at_most(absolute(load(w, a, z)), z)
        store(w, target, select(mask, load(w, c, z), load(w, b, z)))
    elif op == IS_LESS:
        one = load(w, holds + 1, z)
        store(w, target, select(less(load(w, a, z), load(w, b, z)), one, z))
    elif op <= ROOT or op in (LARGER, SMALLER, NEAREST):
        store(w, target, _arithmetic(op, load(w, a, z), load(w, b, z)))
    elif op in (POWER, HYPOTENUSE, ANGLE):
        for lane in range(width):
            w[target * width + lane] = _of_two(op, w[a * width + lane], w[b * width + lane])
    else:
        for lane in range(width):
            w[target * width + lane] = _of_one(op, w[a * width + lane])


@kernel
def _write(
    w: Slots,
    fixed: Slots,
    columns: Code,
    places: Code,
    start: int,
    holds: int,
    width: int,
    out: Slots,
    kept: Any,
) -> None:
    """Results of one block, row by row; rows with a number that is not finite are not kept."""
    for lane in range(min(width, out.shape[0] - start)):
        row, total = start + lane, 0.0
        for k in range(out.shape[1]):
            out[row, k] = fixed[k]
        for k in range(len(columns)):
            x = w[places[k] * width + lane]
            out[row, columns[k]] = x
            total += x * 0.0
        kept[row] = w[holds * width + lane] == 1.0 and total == 0.0


@lru_cache(maxsize=1)
def formula_entry() -> Any:
    """Evaluate blocks first ... last - 1 of `WIDTH` rows of `inputs`.

    The function takes: code, constants, number of slots, all results (right where they are the same
    everywhere), columns of the others and their slots, inputs, first and last block; it writes results, and
    whether all guards came out as they should.
    """
    stamp = fingerprint("formulas jit tables vector workspace")
    width = WIDTH

    @numba.njit(error_model="numpy", nogil=True, cache=True)
    def run(
        code: Code, constants: Slots, slots: int, fixed: Slots, columns: Code, places: Code, inputs: Slots,
        first: int, last: int, out: Slots, kept: Any,
    ) -> str:  # fmt: skip
        z = zeros(width)
        room = aligned(slots + 2, width)
        w, holds = first_of(room), slots
        for k in range(len(constants)):
            for lane in range(width):
                w[k * width + lane] = constants[k]
        for block in range(first, last):
            for lane in range(width):
                w[holds * width + lane] = 1.0
                w[(holds + 1) * width + lane] = 1.0
            for k in range(code.shape[0]):
                op, target, a, b, c = code[k]
                if op == INPUT:
                    for lane in range(width):
                        source = min(block * width + lane, inputs.shape[0] - 1)
                        w[target * width + lane] = inputs[source, a]
                else:
                    _step(w, op, target, a, b, c, holds, width, z)
            _write(w, fixed, columns, places, block * width, holds, width, out, kept)
        room[0] = 0.0  # alive until here
        return stamp

    return run
