"""The function of closing that Python calls: stretches of configurations, one stretch a lane."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numba
import numpy as np

from vincula.kernels.lanes import closing_tables as c
from vincula.kernels.lanes import tables as t
from vincula.kernels.lanes.closing_walk import walk
from vincula.kernels.lanes.entries import fingerprint
from vincula.kernels.lanes.jit import Code, Slots, kernel
from vincula.kernels.lanes.vector import load, store, zeros
from vincula.kernels.lanes.workspace import aligned

CLOSING = (
    "closing_entries closing_gaps closing_newton closing_scalar_gaps closing_steps closing_tables "
    "closing_walk frames jit tables trigonometry vector workspace"
)
"""Sources that the entry of this file is made of."""

_OPTIONS = {"error_model": "numpy", "nogil": True, "cache": True}


@lru_cache(maxsize=4)
def closing_entry(width: int) -> Any:
    """Close stretches: each lane carries a closed configuration along its stretch.

    The function takes: starts (stretches x values), what is given there (stretches x inputs), first
    configuration and number of configurations of every stretch, inputs (N x inputs), code, plan, constants,
    scales of values and inputs, first and last group of `width` stretches; it writes values, steps, squared
    gaps, and whether a lane arrived (1), jumped (2) or neither (0).
    """
    stamp = fingerprint(CLOSING)

    @numba.njit(**_OPTIONS)
    def run(
        starts: Slots, at_start: Slots, first: Code, count: Code, inputs: Slots,
        code: Code, plan: Code, constants: Slots, value_scale: Slots, input_scale: Slots,
        from_group: int, to_group: int, values: Slots, steps: Any, gaps: Slots, closed: Any,
    ) -> str:  # fmt: skip
        z = zeros(width)
        w = aligned(plan[c.SLOTS], width)
        target = plan[c.STATE] + 2 * plan[c.STATE_VALUES] + 2 * plan[c.INPUTS]
        slot = plan[c.SIDE]  # free between walks: carries what is wanted in, and what arrived out
        for group in range(from_group, to_group):
            longest = _enter_starts(
                w, code, plan, starts, at_start, count, value_scale, input_scale, group, width
            )
            for step in range(longest):
                _enter_inputs(w, plan, inputs, first, count, input_scale, group, step, width)
                arrived, taken, gap = walk(w, code, plan, constants, 0, target, load(w, slot, z), z)
                store(w, slot, arrived)
                store(w, plan[c.STEP], taken)
                store(w, plan[c.STEP] + 1, gap)
                _write(w, plan, first, count, value_scale, group, step, width, values, steps, gaps, closed)
        return stamp

    return run


@kernel
def _enter_starts(
    w: Slots, code: Code, plan: Code, starts: Slots, at_start: Slots, count: Code,
    value_scale: Slots, input_scale: Slots, group: int, width: int,
) -> int:  # fmt: skip
    """Starts of a group of stretches, one a lane (the last is repeated); length of the longest stretch."""
    saved, number, given = plan[c.STATE], plan[c.STATE_VALUES], plan[c.INPUTS]
    here, longest = saved + 2 * number, 0
    for lane in range(width):
        stretch = min(group * width + lane, len(count) - 1)
        longest = max(longest, count[stretch])
        for k in range(number):
            value = starts[stretch, k] * value_scale[k]
            w[(saved + k) * width + lane] = value
            w[(saved + number + k) * width + lane] = 0.0
            w[(code[t.VALUE_SLOT] + k) * width + lane] = value
        for k in range(given):
            value = at_start[stretch, k] * input_scale[k]
            w[(here + k) * width + lane] = value
            w[(here + given + k) * width + lane] = 0.0
            w[(plan[c.INPUT] + k) * width + lane] = value
    return longest


@kernel
def _enter_inputs(
    w: Slots, plan: Code, inputs: Slots, first: Code, count: Code, input_scale: Slots,
    group: int, step: int, width: int,
) -> None:  # fmt: skip
    """What is asked for in the next configuration of every lane; quaternions normalised, sign as before."""
    given, here = plan[c.INPUTS], plan[c.STATE] + 2 * plan[c.STATE_VALUES]
    target, quaternion = here + 2 * given, given == 7 and plan[c.POSE] >= 0
    for lane in range(width):
        stretch = min(group * width + lane, len(first) - 1)
        wanted = group * width + lane < len(first) and step < count[stretch]
        w[plan[c.SIDE] * width + lane] = 1.0 if wanted else 0.0
        source = first[stretch] + min(step, count[stretch] - 1)
        for k in range(given):
            w[(target + k) * width + lane] = inputs[source, k] * input_scale[k]
        if quaternion:
            size, same = 0.0, 0.0
            for k in range(3, 7):
                size += inputs[source, k] * inputs[source, k]
                same += inputs[source, k] * w[(here + k) * width + lane]
            factor = 1.0 / np.sqrt(size)
            if same < 0.0:
                factor = -factor
            for k in range(3, 7):
                w[(target + k) * width + lane] *= factor


@kernel
def _write(
    w: Slots, plan: Code, first: Code, count: Code, value_scale: Slots, group: int, step: int, width: int,
    values: Slots, steps: Any, gaps: Slots, closed: Any,
) -> None:  # fmt: skip
    """Results of one configuration of every lane."""
    saved, number = plan[c.STATE], plan[c.STATE_VALUES]
    for lane in range(width):
        stretch = group * width + lane
        if stretch < len(first) and step < count[stretch]:
            out = first[stretch] + step
            closed[out] = int(w[plan[c.SIDE] * width + lane] + 0.5)
            steps[out] = int(w[plan[c.STEP] * width + lane])
            gaps[out] = w[(plan[c.STEP] + 1) * width + lane]
            for k in range(number):
                values[out, k] = w[(saved + k) * width + lane] / value_scale[k]
