"""What a map holds: its sheets with indices, curves and distances, as arrays, for JSON and for xarray."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from vincula.arrays import Matrix, Vector
from vincula.kernels.evaluation import STATUS_NAMES, plain_floats
from vincula.maps.curves import Curve
from vincula.maps.variables import Variable
from vincula.mechanism.configuration import Configuration
from vincula.mechanism.mechanism import Mechanism

if TYPE_CHECKING:
    import xarray


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
        distance: Distance from every point to the nearest singular curve on the map, edges that are singular
            among them: straight in the plane of the variables, in their unit, or in shares of their ranges
            where the units differ; infinite where there is none, NaN where not reached.
        nearest: The kind of that curve; empty where there is none.
        outline: The edge as closed loops, along the grid's border where the region runs out of it.
        everywhere: What is singular at every point, by kind, in words.
    """

    start: Configuration
    reached: NDArray[np.bool_]
    configurations: NDArray[np.float64]
    quantities: Mapping[str, NDArray[np.float64]]
    status: NDArray[np.uint8]
    curves: tuple[Curve, ...]
    distance: NDArray[np.float64]
    nearest: NDArray[np.str_]
    outline: tuple[Matrix, ...] = ()
    everywhere: Mapping[str, str] = field(default_factory=dict)


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
        """Total length of the curves by kind, in `distance_unit`; a quick summary."""
        size = size_of(self.variables, self.units)
        total: dict[str, float] = {}
        for curve in self.curves:
            points = np.vstack([curve.points, curve.points[:1]]) if curve.closed else curve.points
            steps = np.diff(points / size, axis=0)
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

    def to_xarray(self) -> xarray.Dataset:
        """Everything as one xarray data set, to be kept as zarr or netCDF.

        Dimensions: `branch`, the two variables, `coordinate` (joint values), `curve`, and `curve_point`: the
        points of all curves one after the other, each with the number of its curve.

        Raises:
            MissingExtraError: xarray is not installed.
        """
        from vincula.maps.dataset import dataset

        return dataset(self)


def size_of(variables: Sequence[Variable], units: Sequence[str]) -> Vector:
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
        "nearest": sheet.nearest.tolist(),
        "everywhere": dict(sheet.everywhere),
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
