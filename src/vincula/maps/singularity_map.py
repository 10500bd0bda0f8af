"""`vincula.map_over`: workspace, indices and singular curves of a mechanism over two variables."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Final, Literal

import numpy as np
from numpy.typing import NDArray

from vincula.errors import ClosureError, ModelError, listing
from vincula.kernels.compiled import CompiledMechanism, compile_mechanism
from vincula.kernels.evaluation import NO_CLOSURE, OK
from vincula.maps.curves import GRID, Chain, Curve, chains, curves_of, distances, outline
from vincula.maps.loci import KINDS, crossings, outer_edge, singularity
from vincula.maps.map_data import MapSheet, SingularityMap, size_of
from vincula.maps.minima import hidden
from vincula.maps.refining import crossed_cells, extended, refined
from vincula.maps.sheet import Sheet, mask
from vincula.maps.sides import singular_everywhere
from vincula.maps.variables import Plane, Variable
from vincula.mechanism.configuration import Configuration
from vincula.mechanism.mechanism import Mechanism
from vincula.mechanism.modes import joint_points
from vincula.weights import Weights

Progress = Callable[[str, int, int], None]
"""Called with what is being done, how much of it is done, and how much there is."""
SAME: Final = 1e-6
"""Configurations whose joint points agree to this times L are one."""
REGULAR: Final = 1e-3
"""Where all watched measures are above this, no rank is in question that was not at other such points."""


def map_over(
    mechanism: Mechanism,
    variables: Sequence[Variable],
    *,
    start: Mapping[str, Any] | None = None,
    quantities: Iterable[str] = (),
    modes: Literal["start", "all"] = "start",
    limits: bool = True,
    weights: Weights | None = None,
    progress: Progress | None = None,
) -> SingularityMap:
    """Workspace, indices and singular curves over two variables.

    Over two motors the mechanism is driven by them; over coordinates of the reference member its pose is
    given (its point alone where it has no more freedoms).  Everything else stands where it starts.
    Singular curves are told apart by type: the member becomes free with the motors locked, motors lose
    authority, inner degeneracy; and so are the edges of the region that is reached.

    Args:
        mechanism: The mechanism, with its motors and reference member.
        variables: The two variables.
        start: A closed configuration that says which branch is meant; home by default.
        quantities: Indices to evaluate, as in `CompiledMechanism.evaluate`: one number each.
        modes: `start` for the branch of the start; `all` for every branch found at the start values.
        limits: Whether joint limits bound the region.
        weights: Weights of the indices.
        progress: Called now and then.

    Raises:
        UnknownNameError: A variable or quantity that does not exist.
        ModelError: Variables that do not determine the mechanism, or ranges that are none.
        ClosureError: The start is open and cannot be closed.
    """
    began = mechanism.configuration(start)
    q = mechanism.close(near=began, limits=limits)
    plane = Plane(mechanism, variables, q)
    compiled = compile_mechanism(mechanism, weights=weights)
    asked = tuple(quantities)
    _refuse_tables(compiled.quantities, asked)
    starts = [Configuration(dict(q))] if modes == "start" else _branches(mechanism, plane, limits)
    sheets: list[MapSheet] = []
    filled: list[Sheet] = []
    for k, begin in enumerate(starts):
        words = f"branch {k + 1} of {len(starts)}" if len(starts) > 1 else "branch"
        sheet = Sheet(Plane(mechanism, variables, begin), limits=limits)
        if _is_known(sheet, begin, filled):
            continue
        sheet.fill(None if progress is None else lambda n, m, w=words: progress(w, n, m))  # type: ignore[misc]
        filled.append(sheet)
        sheets.append(_finished(sheet, begin, compiled, asked, progress, words))
    units = plane.units
    return SingularityMap(
        mechanism,
        plane.variables,
        units,
        tuple(v.values for v in plane.variables),
        tuple(sheets),
        units[0] if units[0] == units[1] else "share of the range",
    )


def _finished(
    sheet: Sheet,
    begin: Configuration,
    compiled: CompiledMechanism,
    asked: tuple[str, ...],
    progress: Progress | None,
    words: str,
) -> MapSheet:
    edge = outer_edge(sheet)
    reached = mask(sheet)
    loops = refined(sheet, outline(edge, reached, sheet.grid), None)
    found = _singular(sheet) + _bounds(loops)
    if progress is not None:
        progress(f"{words}: curves", 1, 1)
    values = np.full((*sheet.shape, len(compiled.coordinates)), np.nan)
    values[reached] = sheet.branch.equations.configurations(sheet.states[sheet.reached], sheet.plane.start)
    status, indices = _evaluated(sheet, compiled, values, asked)
    distance, nearest = _distances(sheet, found)
    lines = tuple(np.array([point.values for point in loop.crossings]) for loop in loops)
    return MapSheet(
        begin, reached, values, indices, status, tuple(found), distance, nearest, lines, _everywhere(sheet)
    )


def _evaluated(
    sheet: Sheet, compiled: CompiledMechanism, values: NDArray[np.float64], asked: tuple[str, ...]
) -> tuple[NDArray[np.uint8], dict[str, NDArray[np.float64]]]:
    """Status of every point, and the indices asked for."""
    reached = mask(sheet)
    status = np.full(sheet.shape, NO_CLOSURE, dtype=np.uint8)
    indices = {name: np.full(sheet.shape, np.nan) for name in asked}
    status[reached] = OK
    near = reached.copy()
    if not asked:
        # Far from all curves ranks are as certain as at one such point.
        far = (sheet.smallest > REGULAR).all(axis=1).reshape(sheet.shape) & reached
        sample = values[far][:1]
        if len(sample) and compiled.evaluate(sample, (), path="reference").status[0] == OK:
            near &= ~far
    if near.any():
        result = compiled.evaluate(values[near], asked)
        status[near] = result.status
        for name in asked:
            indices[name][near] = result[name]
    return status, indices


def _distances(sheet: Sheet, found: Sequence[Curve]) -> tuple[NDArray[np.float64], NDArray[np.str_]]:
    """Distance of every point reached from the nearest singular curve, and of which kind that is."""
    plane, reached = sheet.plane, mask(sheet)
    places = np.stack(np.meshgrid(*sheet.grid, indexing="ij"), axis=-1)[reached]
    size = size_of(plane.variables, plane.units)
    everywhere = _everywhere(sheet)
    away = np.array([
        np.zeros(len(places)) if kind in everywhere
        else distances(places, [curve for curve in found if curve.kind == kind], size)
        for kind in KINDS
    ])  # fmt: skip
    distance = np.full(sheet.shape, np.nan)
    distance[reached] = away.min(axis=0)
    nearest = np.full(sheet.shape, "", dtype=f"<U{max(map(len, KINDS))}")
    nearest[reached] = np.where(np.isfinite(away.min(axis=0)), np.array(KINDS)[away.argmin(axis=0)], "")
    return distance, nearest


def _everywhere(sheet: Sheet) -> dict[str, str]:
    """What is singular all over a sheet, by kind, in words."""
    state = sheet.states[int(np.flatnonzero(sheet.reached)[0])]
    found = [singularity(sheet, state, k, ()) for k in singular_everywhere(sheet)]
    return {one.kind: str(one) for one in found}


def _singular(sheet: Sheet) -> list[Curve]:
    """The singular curves that cross a sheet, loops and points between the lines of the grid among them."""
    found = []
    everywhere = singular_everywhere(sheet)
    on_edges = crossings(sheet)
    for k, watch in enumerate(sheet.branch.watching):
        if sheet.branch.kept[k] == 0 or k in everywhere or k == sheet.branch.followed:
            continue
        known = on_edges.get(watch.name, {})
        crossed = crossed_cells(sheet, known, k)
        lines = [*chains(known, sheet.shape[1], crossed), *hidden(sheet, k, known)]
        for line in extended(sheet, refined(sheet, lines, k), k):
            found += curves_of(line, edge=False)
    return found


def _bounds(loops: Sequence[Chain]) -> list[Curve]:
    """The pieces of the edge, without those where the sheet goes on beyond the grid."""
    return [curve for loop in loops for curve in curves_of(loop, edge=True) if curve.kind != GRID]


def _branches(mechanism: Mechanism, plane: Plane, limits: bool, starts: int = 60) -> list[Configuration]:
    """Configurations on all branches found at the values of the start."""
    held = plane.held_at(plane.at_start())
    motors: dict[str, Any] | None = {**held.joints, **held.axes, **held.drives} or None
    pose = held.pose if held.pose is not None else held.point
    rng = np.random.default_rng(0)
    found = [Configuration(dict(plane.start))]
    known = [joint_points(mechanism, plane.start)]
    for _ in range(starts):
        near = {
            name: value + rng.uniform(-math.pi, math.pi, len(value))
            if len(value) < 4
            else rng.normal(size=len(value))
            for name, value in plane.start.items()
        }
        try:
            q = mechanism.close(near, motors=motors, pose=pose, limits=limits, attempts=1)
        except ClosureError:
            continue
        points = joint_points(mechanism, q)
        if all(np.abs(points - other).max() > SAME * mechanism.length for other in known):
            known.append(points)
            found.append(Configuration(dict(q)))
    return found


def _is_known(sheet: Sheet, begin: Configuration, filled: list[Sheet]) -> bool:
    """Whether a branch is one that was filled already, seen at the grid point nearest to the start."""
    mechanism = sheet.plane.mechanism
    number, point = sheet.entry()
    own = joint_points(mechanism, sheet.configuration(point.states[0]))
    for other in filled:
        if other.reached[number]:
            there = joint_points(mechanism, other.configuration(other.states[number]))
            if np.abs(own - there).max() < SAME * mechanism.length:
                return True
    return False


def _refuse_tables(known: Mapping[str, Any], asked: Sequence[str]) -> None:
    wide = [name for name in asked if name in known and known[name].shape]
    if wide:
        scalar = [name for name, quantity in known.items() if not quantity.shape]
        raise ModelError(
            f"{listing(wide)}: a map shows one number a point; choose from {listing(scalar, 12)}"
        )
