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
from vincula.kernels.lanes.jit import Code, Slots
from vincula.kernels.lanes.vector import load, store, zero_of
from vincula.kernels.lanes.workspace import aligned

_OPTIONS = {"error_model": "numpy", "nogil": True, "cache": True}


@lru_cache(maxsize=4)
def closing_entry(width: int) -> Any:
    """Close stretches: each lane carries a closed configuration along its stretch.

    The function takes: starts (stretches x values), what is given there (stretches x inputs), first configuration
    and number of configurations of every stretch, inputs (N x inputs), code, plan, constants, scales of values and
    inputs, first and last group of `width` stretches, and writes values, steps, squared gaps, and whether it closed.
    """
    zero, stamp = zero_of(width), fingerprint()

    @numba.njit(**_OPTIONS)  # type: ignore[untyped-decorator,unused-ignore]
    def run(
        starts: Slots, at_start: Slots, first: Code, count: Code, inputs: Slots,
        code: Code, plan: Code, constants: Slots, value_scale: Slots, input_scale: Slots,
        from_group: int, to_group: int, values: Slots, steps: Any, gaps: Slots, closed: Any,
    ) -> str:  # fmt: skip
        z = zero()
        w = aligned(plan[c.SLOTS], width)
        number, given = plan[c.STATE_VALUES], plan[c.INPUTS]
        saved, here = plan[c.STATE], plan[c.STATE] + 2 * plan[c.STATE_VALUES]
        target = here + 2 * given
        quaternion = given == 7 and plan[c.POSE] >= 0
        wanted = np.empty(width)
        slot = plan[c.SIDE]  # free between walks: carries the mask in, results out
        for group in range(from_group, to_group):
            longest = 0
            for lane in range(width):
                stretch = min(group * width + lane, len(first) - 1)
                if group * width + lane < len(first):
                    longest = max(longest, count[stretch])
                for k in range(number):
                    w[(saved + k) * width + lane] = starts[stretch, k] * value_scale[k]
                    w[(saved + number + k) * width + lane] = 0.0
                    w[(code[t.VALUE_SLOT] + k) * width + lane] = starts[stretch, k] * value_scale[k]
                for k in range(given):
                    w[(here + k) * width + lane] = at_start[stretch, k] * input_scale[k]
                    w[(here + given + k) * width + lane] = 0.0
                    w[(plan[c.INPUT] + k) * width + lane] = at_start[stretch, k] * input_scale[k]
            for step in range(longest):
                for lane in range(width):
                    stretch = min(group * width + lane, len(first) - 1)
                    wanted[lane] = 1.0 if group * width + lane < len(first) and step < count[stretch] else 0.0
                    source = first[stretch] + min(step, count[stretch] - 1)
                    factor = 1.0
                    if quaternion:
                        size, same = 0.0, 0.0
                        for k in range(3, 7):
                            size += inputs[source, k] * inputs[source, k]
                            same += inputs[source, k] * w[(here + k) * width + lane]
                        factor = 1.0 / np.sqrt(size)
                        if same < 0.0:
                            factor = -factor
                    for k in range(given):
                        value = inputs[source, k] * input_scale[k]
                        if quaternion and k >= 3:
                            value = inputs[source, k] * factor
                        w[(target + k) * width + lane] = value
                for lane in range(width):
                    w[slot * width + lane] = wanted[lane]
                arrived, taken, gap = walk(w, code, plan, constants, 0, target, load(w, slot, z), z)
                store(w, slot, arrived)
                store(w, plan[c.STEP], taken)
                store(w, plan[c.STEP] + 1, gap)
                for lane in range(width):
                    if wanted[lane] > 0.5:
                        out = first[group * width + lane] + step
                        closed[out] = w[slot * width + lane] > 0.5
                        steps[out] = int(w[plan[c.STEP] * width + lane])
                        gaps[out] = w[(plan[c.STEP] + 1) * width + lane]
                        for k in range(number):
                            values[out, k] = w[(saved + k) * width + lane] / value_scale[k]
        return stamp

    return run


