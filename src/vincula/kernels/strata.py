"""Lanes with other ranks than usual, together: singular designs of a landscape lie on lines and are many.

A program is certain of the ranks that the mechanism has in general.  Where many lanes of a batch have others,
one of them is looked at by the reference path, and a program with its ranks computes those that are alike.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from vincula.arrays import Matrix, Vector
from vincula.errors import VinculaError
from vincula.kernels.inputs import Batch
from vincula.kernels.lane_path import LaneWriters, empty_arrays
from vincula.kernels.plans import Plan
from vincula.kernels.reference_path import Arrays
from vincula.kernels.variants import Variants

FEWEST: Final = 6
"""Lanes from which on a program of their own pays."""
TRIES: Final = 6
"""Lanes of a batch that are looked at."""


def evaluate_alike(
    writers: LaneWriters, variants: Variants, plan: Plan, batch: Batch, values: Matrix, constants: Matrix,
    lanes: NDArray[np.intp], arrays: Arrays, threads: int,
) -> NDArray[np.intp]:  # fmt: skip
    """Evaluate lanes that have other ranks than usual; those that are left for the reference path.

    Args:
        writers: The quantities in lanes.
        variants: The mechanisms by parameter values.
        plan: The quantities.
        batch: The batch.
        values: Values of all lanes.
        constants: Constants of all lanes.
        lanes: The lanes.
        arrays: One array a quantity, holding fill values in these lanes.
        threads: Threads to use.
    """
    left, alone = lanes, []
    for _ in range(TRIES):
        if len(left) < FEWEST:
            break
        made = _writers_at(writers, variants, plan, batch.parameters_at(int(left[0])), values[left[0]])
        found = empty_arrays(plan.quantities, len(left))
        done = np.zeros(len(left), dtype=bool)
        if made is not None:
            done[:] = True
            for others in made.evaluate(values[left], constants[left], found, threads):
                done[others] = False
        for name in ("status", *(name for name, _ in made.writers)) if made is not None else ():
            arrays[name][left[done]] = found[name][done]
        if not done[0]:
            alone.append(left[0])
            done[0] = True
        left = left[~done]
    return np.sort(np.concatenate([left, np.array(alone, dtype=left.dtype)]))


def _writers_at(
    writers: LaneWriters, variants: Variants, plan: Plan, parameters: dict[str, float], flat: Vector
) -> LaneWriters | None:
    """The quantities with the ranks of one lane; None where these are not certain."""
    from vincula.kernels.lanes import tables as t
    from vincula.kernels.lanes.flatten import flatten
    from vincula.kernels.lanes.plan import make_plan

    variant = variants.tried(parameters)
    if isinstance(variant, str):
        return None
    program = writers.path.program
    where = {"metric": int(program.code[t.METRIC]), "doubt": int(program.code[t.DOUBT])}
    try:
        model = variant.linearize(variant.home.from_flat(flat))
        if not model.ledger.summary or model.ledger.status != "certain":
            return None
        made = make_plan(flatten(variant, general=True), program.mechanism.layout, [model.ledger], where)
        own: Any = replace(program, plan=made, code=made.code)
        found = replace(writers.path, program=own, model=model).writers(plan.quantities)
    except VinculaError:
        return None
    return None if isinstance(found, str) else found
