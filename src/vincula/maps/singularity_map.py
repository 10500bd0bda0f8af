"""`vincula.map_over`: workspace, indices and singular curves of a mechanism over two variables."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Final, Literal

import numpy as np
from numpy.typing import NDArray

from vincula.arrays import Matrix, Vector
from vincula.errors import ClosureError, ModelError, listing
from vincula.kernels.compiled import compile_mechanism
from vincula.kernels.evaluation import NO_CLOSURE, STATUS_NAMES, plain_floats
from vincula.maps.curves import Curve, curves, distances, outline
from vincula.maps.loci import KINDS, between, crossings, outer_edge
from vincula.maps.sheet import Sheet, mask
from vincula.maps.variables import Plane, Variable
from vincula.mechanism.configuration import Configuration
from vincula.mechanism.mechanism import Mechanism
from vincula.mechanism.modes import joint_points
from vincula.weights import Weights

Progress = Callable[[str, int, int], None]
"""Called with what is being done, how much of it is done, and how much there is."""
SAME: Final = 1e-6
"""Configurations whose joint points agree to this times L are one."""


@dataclass(frozen=True, slots=True, eq=False)
class MapSheet:
    """One branch of a map.

    Attributes:
        start: The configuration that it was filled from.
        reached: For every point of the grid, whether the branch reaches it.
        configurations: Joint values at every point, NaN where it is not reached [m, rad].
        quantities: The indices asked for, NaN where not reached.
        status: Status of every point (see `status_names`); not reached counts as no closure.
        curves: Singular curves on the sheet, and the pieces of its edge.
        distance: Distance from every point to the nearest singular curve, in the unit of the variables,
            or in shares of their ranges where these differ.
        outline: The edge as closed loops; none where the region runs out of the grid.
    """

    start: Configuration
    reached: NDArray[np.bool_]
    configurations: NDArray[np.float64]
    quantities: Mapping[str, NDArray[np.float64]]
    status: NDArray[np.uint8]
    curves: tuple[Curve, ...]
    distance: NDArray[np.float64]
    outline: tuple[Matrix, ...] = ()


@dataclass(frozen=True, eq=False)
class SingularityMap:
    """A map over two variables.

    Attributes:
        mechanism: The mechanism.
        variables: What it is drawn over.
        units: Units of the variables.
        grid: Values of the variables.
        sheets: One a branch.
        distance_unit: Unit of distances: that of the variables, or `share of the range`.
    """

    mechanism: Mechanism
    variables: tuple[Variable, ...]
    units: tuple[str, str]
    grid: tuple[Vector, ...]
    sheets: tuple[MapSheet, ...]
    distance_unit: str
    status_names = STATUS_NAMES

    @property
    def curves(self) -> tuple[Curve, ...]:
        """The curves of all sheets."""
        return tuple(curve for sheet in self.sheets for curve in sheet.curves)

    def lengths(self) -> dict[str, float]:
        """Total length of the singular curves by kind, in `distance_unit`; a quick summary."""
        size = _size(self.variables, self.units)
        total: dict[str, float] = {}
        for curve in self.curves:
            steps = np.diff(curve.points / size, axis=0)
            length = float(np.sqrt((steps * steps).sum(axis=1)).sum())
            total[curve.kind] = total.get(curve.kind, 0.0) + length
        return total

    def to_dict(self) -> dict[str, Any]:
        """Everything for JSON: schema `vincula/map/1`; null where nothing is reached."""
        reference = self.mechanism.reference
        return {
            "schema": "vincula/map/1",
            "mechanism": self.mechanism.name,
            "reference": None if reference is None else reference.body,
            "active": list(self.mechanism.active),
            "variables": [
                {"name": v.name, "unit": unit, "values": values.tolist()}
                for v, unit, values in zip(self.variables, self.units, self.grid, strict=True)
            ],
            "distance_unit": self.distance_unit,
            "sheets": [_sheet_dict(sheet) for sheet in self.sheets],
        }


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
    compiled: Any,
    asked: tuple[str, ...],
    progress: Progress | None,
    words: str,
) -> MapSheet:
    shape = (len(sheet.grid[0]), len(sheet.grid[1]))
    edge = outer_edge(sheet)
    found: list[Curve] = []
    for block, of_block in crossings(sheet).items():
        found += [_smoothed(sheet, block, curve) for curve in curves(of_block, shape, edge=False)]
    found += curves(edge, shape, edge=True)
    if progress is not None:
        progress(f"{words}: curves", 1, 1)
    reached = mask(sheet)
    values = np.full((*shape, len(compiled.coordinates)), np.nan)
    for node, point in sheet.points.items():
        values[node] = sheet.configuration(point).flat
    indices = {name: np.full(shape, np.nan) for name in asked}
    status = np.full(shape, NO_CLOSURE, dtype=np.uint8)
    # Closing took far longer than this will; kernels would first have to be loaded.
    result = compiled.evaluate(values[reached], asked, path="reference")
    status[reached] = result.status
    for name in asked:
        indices[name][reached] = result[name]
    plane = sheet.plane
    places = np.stack(np.meshgrid(*sheet.grid, indexing="ij"), axis=-1)
    singular = [curve for curve in found if curve.kind in KINDS]
    distance = distances(places, singular, _size(plane.variables, plane.units))
    distance = np.where(reached, distance, np.nan)
    return MapSheet(begin, reached, values, indices, status, tuple(found), distance, outline(edge, shape))


def _smoothed(sheet: Sheet, block: str, curve: Curve) -> Curve:
    """The curve with a point more between any two."""
    ends = [*curve.crossings, curve.crossings[0]] if curve.closed else list(curve.crossings)
    found = [ends[0]]
    for one, two in pairwise(ends):
        middle = between(sheet, block, one, two)
        found += [two] if middle is None or middle.kind != curve.kind else [middle, two]
    if curve.closed:
        found.pop()
    points = np.array([crossing.values for crossing in found])
    return Curve(curve.kind, curve.edge, points, curve.closed, tuple(found))


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
    node, point = sheet.entry()
    own = joint_points(mechanism, sheet.configuration(point))
    for other in filled:
        if node in other.points:
            there = joint_points(mechanism, other.configuration(other.points[node]))
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


def _size(variables: Sequence[Variable], units: Sequence[str]) -> Vector:
    """What counts as one unit along each variable."""
    if units[0] == units[1]:
        return np.ones(2)
    return np.array([v.high - v.low for v in variables])


def _sheet_dict(sheet: MapSheet) -> dict[str, Any]:
    return {
        "start": {name: value.tolist() for name, value in sheet.start.items()},
        "reached": sheet.reached.tolist(),
        "status": sheet.status.tolist(),
        "quantities": {name: plain_floats(values) for name, values in sheet.quantities.items()},
        "distance": plain_floats(sheet.distance),
        "curves": [
            {
                "kind": curve.kind,
                "edge": curve.edge,
                "closed": curve.closed,
                "points": curve.points.tolist(),
                "words": curve.crossings[len(curve.crossings) // 2].words,
            }
            for curve in sheet.curves
        ],
    }
