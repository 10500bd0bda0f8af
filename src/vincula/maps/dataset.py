"""A map as one xarray data set, and as zarr."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from vincula.errors import MissingExtraError
from vincula.kernels.evaluation import STATUS_NAMES
from vincula.maps.loci import KINDS, TURN

if TYPE_CHECKING:
    import xarray

    from vincula.maps.map_data import SingularityMap

KIND_CODES: Final = ("", *KINDS, "limit", TURN, "lost")
"""Kinds of curves in the order of their codes in a data set; the first is none."""


def dataset(found: SingularityMap) -> xarray.Dataset:
    """Everything of a map as one data set; see `SingularityMap.to_xarray`.

    Args:
        found: The map.

    Raises:
        MissingExtraError: xarray is not installed.
    """
    try:
        import xarray
    except ImportError:
        raise MissingExtraError("xarray", "sweep", "a map as a data set") from None
    first, second = (v.name for v in found.variables)
    on = ("branch", first, second)
    sheets, curves = found.sheets, [(k, c) for k, s in enumerate(found.sheets) for c in s.curves]
    where = [np.full(len(c.points), n) for n, (_, c) in enumerate(curves)]
    points = np.vstack([np.zeros((0, 2)), *(c.points for _, c in curves)])
    data: dict[str, Any] = {
        "reached": (on, np.stack([s.reached for s in sheets])),
        "status": (on, np.stack([s.status for s in sheets]), {"meanings": list(STATUS_NAMES)}),
        "configurations": ((*on, "coordinate"), np.stack([s.configurations for s in sheets])),
        "distance": (on, np.stack([s.distance for s in sheets]), {"units": found.distance_unit}),
        "nearest": (on, _codes(np.stack([s.nearest for s in sheets])), {"meanings": list(KIND_CODES)}),
        f"curve_{first}": ("curve_point", points[:, 0], {"units": found.units[0]}),
        f"curve_{second}": ("curve_point", points[:, 1], {"units": found.units[1]}),
        "curve_of_point": ("curve_point", np.concatenate([np.zeros(0, dtype=int), *where])),
        "curve_kind": (
            "curve",
            _codes(np.array([c.kind for _, c in curves], dtype=str)),
            {"meanings": list(KIND_CODES)},
        ),
        "curve_is_edge": ("curve", np.array([c.edge for _, c in curves], dtype=bool)),
        "curve_is_closed": ("curve", np.array([c.closed for _, c in curves], dtype=bool)),
        "curve_branch": ("curve", np.array([k for k, _ in curves], dtype=int)),
    }
    for name in sheets[0].quantities:
        data[name] = (on, np.stack([s.quantities[name] for s in sheets]))
    coordinates = {
        v.name: (v.name, values, {"units": unit})
        for v, values, unit in zip(found.variables, found.grid, found.units, strict=True)
    }
    told = {"schema": "vincula/map/1", "mechanism": found.mechanism.name}
    return xarray.Dataset(data, coordinates, {**told, "active": " ".join(found.mechanism.active)})


def write_zarr(found: SingularityMap, path: str | Path) -> None:
    """Write a map as zarr; what stands there is replaced.

    Args:
        found: The map.
        path: The folder.

    Raises:
        MissingExtraError: xarray or zarr is not installed.
        OSError: It cannot be written.
    """
    try:
        import zarr  # noqa: F401
    except ImportError:
        raise MissingExtraError("xarray and zarr", "sweep", "a map as zarr") from None
    dataset(found).to_zarr(path, mode="w", consolidated=False, zarr_format=3)


def _codes(kinds: NDArray[np.str_]) -> NDArray[np.uint8]:
    """Kinds as places in `KIND_CODES`: texts are no arrays that every reader of zarr knows."""
    found = np.zeros(kinds.shape, dtype=np.uint8)
    for code, kind in enumerate(KIND_CODES):
        found[kinds == kind] = code
    return found
