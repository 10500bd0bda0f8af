"""One batch through the lanes, and the rest of it through the reference path: one result, one status."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from vincula.arrays import Matrix, Vector
from vincula.errors import VinculaError
from vincula.kernels.evaluation import FAILED, OPEN
from vincula.kernels.inputs import Batch
from vincula.kernels.lane_branches import asks_for_branches, write_branches
from vincula.kernels.lane_path import LaneWriters
from vincula.kernels.lane_poses import poses_in_lanes
from vincula.kernels.layouts import spectra_layout
from vincula.kernels.one_by_one import Reasons, evaluate_one_by_one
from vincula.kernels.plans import Plan
from vincula.kernels.quantities import quaternion_places
from vincula.kernels.reference_path import Arrays
from vincula.kernels.strata import evaluate_alike
from vincula.kernels.traced_geometry import REFUSED, UNKNOWN
from vincula.kernels.variants import Variants
from vincula.mechanism.mechanism import Mechanism


def evaluate_in_lanes(
    writers: LaneWriters,
    variants: Variants,
    plan: Plan,
    batch: Batch,
    arrays: Arrays,
    reasons: Reasons,
    threads: int,
) -> None:
    """Evaluate a batch of whole configurations in lanes and what they hand back one by one.

    Args:
        writers: The quantities in lanes.
        variants: The mechanisms by parameter values.
        plan: The quantities in the reference path.
        batch: The batch.
        arrays: One array a quantity, with anything in it.
        reasons: Where reasons go.
        threads: Threads to use.
    """
    values, constants, refused = geometry(writers, variants, batch, threads)
    unknown, opened = writers.evaluate(values, constants, arrays, threads)
    write_places(writers, values, constants, arrays)
    if asks_for_branches(arrays):
        ready = np.setdiff1d(np.arange(batch.lanes), np.concatenate([unknown, opened]), assume_unique=True)
        unknown = np.sort(
            np.concatenate([unknown, write_branches(writers.path, values, ready, arrays, threads)])
        )
    for lanes in (unknown, opened):
        for quantity in plan.quantities:
            if quantity.name != "configuration" and not (
                lanes is opened and quantity.name == "closure.residual"
            ):
                arrays[quantity.name][lanes] = quantity.fill
    arrays["status"][opened] = OPEN
    if "configuration" in arrays and len(unknown):
        arrays["configuration"][unknown] = np.nan
    arrays["status"][refused] = FAILED
    left = unknown[~refused[unknown]]
    if batch.alike and constants is not None:
        left = evaluate_alike(writers, variants, plan, batch, values, constants, left, arrays, threads)
    evaluate_one_by_one(variants, plan, batch, arrays, left.tolist(), reasons)


def write_places(writers: LaneWriters, values: Matrix, constants: Matrix | None, arrays: Arrays) -> None:
    """Write what every configuration has, closed or not: its values and the pose of the member."""
    if "configuration" in arrays:
        arrays["configuration"][...] = with_unit_quaternions(writers.path.mechanism, values)
    if "reference.pose" in arrays:
        with np.errstate(all="ignore"):
            arrays["reference.pose"][...] = poses_in_lanes(writers.path.program, values, constants)


def geometry(
    writers: LaneWriters, variants: Variants, batch: Batch, threads: int
) -> tuple[Matrix, Matrix | None, NDArray[np.bool_]]:
    """Values of all lanes, and constants where dimensions differ; NaN in lanes that cannot be built.

    Returns:
        Values; constants; lanes of which it is certain that nothing can be built.
    """
    home = variants.nominal.home.flat
    nothing = np.zeros(batch.lanes, dtype=bool)
    values = batch.values
    if values is None:
        values = np.broadcast_to(home, (batch.lanes, len(home)))
    if not batch.parameters:
        return values, None, nothing
    constants, known = variants.constants("spectra", spectra_layout(writers.path), batch.parameters, threads)
    left = np.flatnonzero(known == UNKNOWN)
    if len(left):
        values = np.array(values)
        _one_by_one(writers, variants, batch, left, values, constants)
    return values, constants, known == REFUSED


def _one_by_one(
    writers: LaneWriters,
    variants: Variants,
    batch: Batch,
    lanes: NDArray[np.intp],
    values: Matrix,
    constants: Matrix,
) -> None:
    """Build variants that are not traced."""
    kept: dict[tuple[float, ...], tuple[Vector, Vector]] = {}
    table = np.column_stack([column[lanes] for column in batch.parameters.values()])
    for lane, row in zip(lanes, table, strict=True):
        key = tuple(row.tolist())
        if key not in kept:
            kept[key] = _one_geometry(writers, variants.tried(batch.parameters_at(int(lane))))
        constants[lane], own = kept[key]
        if batch.values is None:
            values[lane] = own


def _one_geometry(writers: LaneWriters, variant: Mechanism | str) -> tuple[Vector, Vector]:
    """Constants and home of one variant; NaN where lanes cannot have it."""
    program, path = writers.path.program, writers.path
    nothing = np.full(len(program.constants), np.nan)
    if isinstance(variant, str):
        return nothing, np.full(len(path.mechanism.home.flat), np.nan)
    try:
        if not path.same_weights(variant):
            return nothing, variant.home.flat
        return program.constants_of(variant, path.program_weights), variant.home.flat
    except VinculaError:
        return nothing, variant.home.flat


def with_unit_quaternions(mechanism: Mechanism, values: Matrix) -> Matrix:
    """Configurations with quaternions of length one, as a `Configuration` has them."""
    places = quaternion_places(mechanism)
    if not places:
        return values
    found: NDArray[Any] = np.array(values)
    for place in places:
        part = found[:, place : place + 4]
        with np.errstate(all="ignore"):
            size = np.sqrt(np.einsum("ni,ni->n", part, part))
            found[:, place : place + 4] = np.where(
                np.abs(size - 1.0)[:, None] < 1e-14, part, part / size[:, None]
            )
    return found
