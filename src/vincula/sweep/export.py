"""A stored sweep as netCDF, CSV or Parquet, written slab by slab so that memory stays flat."""

from __future__ import annotations

import csv
import json
import os
from collections.abc import Iterator
from contextlib import suppress
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from vincula.errors import MissingExtraError, SweepError
from vincula.kernels.evaluation import STATUS_NAMES
from vincula.sweep.dataset import SweepData
from vincula.sweep.layout import NOT_DONE
from vincula.sweep.storage import StorageRoom

if TYPE_CHECKING:
    import xarray

SLAB: Final = 2**17
"""Points that are in memory at a time."""
FORMATS: Final = (".nc", ".csv", ".parquet")
"""Endings of the files that can be written."""


def export(data: SweepData, target: str | os.PathLike[str], *, overwrite: bool = False) -> Path:
    """Write a sweep in another format.

    Args:
        data: The sweep.
        target: A file that ends in `.nc` (netCDF), `.csv` or `.parquet`.
        overwrite: Replace a file that is there.

    Returns:
        The file.

    Raises:
        SweepError: Another ending, a file that is there already, no room.
        MissingExtraError: Parquet without pyarrow.
    """
    path = Path(target)
    ending = path.suffix.lower()
    if ending not in FORMATS:
        raise SweepError(f"{path}: expected a file that ends in {', '.join(FORMATS)}", kind="usage")
    if path.exists() and not overwrite:
        raise SweepError(
            f"{path}: there is a file already; choose another name, or overwrite it", kind="usage"
        )
    writer = {".nc": _netcdf, ".csv": _csv, ".parquet": _parquet}[ending]
    aside = path.with_name(path.name + ".partial")
    try:
        with StorageRoom(path.absolute()).guarded():
            writer(data.to_xarray(), aside)
            aside.replace(path)
    finally:
        with suppress(OSError):
            aside.unlink(missing_ok=True)
    return path


def columns(data: xarray.Dataset) -> list[str]:
    """Names of the columns of a table: variables, status, then every number of every quantity."""
    return [name for name, _ in _columns(data)]


def tables(data: xarray.Dataset) -> Iterator[dict[str, np.ndarray[Any, Any]]]:
    """The points as tables of some rows each, in row-major order."""
    found = _columns(data)
    for slab in _slabs(data):
        part = data.isel(slab).load()
        dims = [str(dim) for dim in data["status"].dims]
        rows: dict[str, np.ndarray[Any, Any]] = {}
        for name, (source, place) in found:
            array = part[source]
            if place is None:
                array = array.broadcast_like(part["status"])
            own = [str(dim) for dim in array.dims if dim not in dims]
            values = array.isel(dict(zip(own, place or (), strict=True))).transpose(*dims).values
            rows[name] = _words(values.ravel()) if source == "status" else values.ravel()
        yield rows


def _columns(data: xarray.Dataset) -> list[tuple[str, tuple[str, tuple[int, ...] | None]]]:
    dims = data["status"].dims
    found: list[tuple[str, tuple[str, tuple[int, ...] | None]]] = []
    own = [str(name) for name, array in data.coords.items() if set(array.dims) <= set(dims)]
    for name in data.attrs.get("variables", own):
        found.append((name, (name, None)))  # noqa: PERF401
    found.append(("status", ("status", ())))
    for name, array in data.data_vars.items():
        if name == "status":
            continue
        inner = [str(dim) for dim in array.dims if dim not in dims]
        for place in np.ndindex(*(array.sizes[dim] for dim in inner)):
            labels = [
                str(data[dim].values[k]) if dim in data.coords else str(k)
                for dim, k in zip(inner, place, strict=True)
            ]
            told = f"{name}[{','.join(labels)}]" if labels else str(name)
            found.append((told, (str(name), place)))
    return found


def _slabs(data: xarray.Dataset) -> Iterator[dict[str, slice]]:
    """Blocks of whole rows that follow each other in row-major order."""
    dims = [str(dim) for dim in data["status"].dims]
    sizes = [data.sizes[dim] for dim in dims]
    axis = next(k for k in range(len(sizes)) if np.prod(sizes[k + 1 :], dtype=float) <= SLAB)
    step = max(1, int(SLAB // np.prod(sizes[axis + 1 :], dtype=float)))
    for outer in np.ndindex(*sizes[:axis]):
        fixed = {dim: slice(k, k + 1) for dim, k in zip(dims, outer, strict=False)}
        for begin in range(0, sizes[axis], step):
            yield {**fixed, dims[axis]: slice(begin, begin + step)}


def _words(status: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    names: np.ndarray[Any, Any] = np.full(256, "unknown", dtype="<U10")
    names[: len(STATUS_NAMES)] = STATUS_NAMES
    names[NOT_DONE] = "not-done"
    found: np.ndarray[Any, Any] = names[status]
    return found


def _csv(data: xarray.Dataset, path: Path) -> None:
    with path.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(columns(data))
        for table in tables(data):
            writer.writerows(zip(*(column.tolist() for column in table.values()), strict=True))


def _parquet(data: xarray.Dataset, path: Path) -> None:
    try:
        pyarrow: Any = import_module("pyarrow")
        parquet: Any = import_module("pyarrow.parquet")
    except ImportError:
        raise MissingExtraError("pyarrow", "parquet", "writing Parquet") from None
    writer = None
    try:
        for table in tables(data):
            part = pyarrow.table(table)
            writer = writer or parquet.ParquetWriter(path, part.schema)
            writer.write_table(part)
    finally:
        if writer is not None:
            writer.close()


_FREE = {"variables": "sweep_variables", "dimensions": "sweep_dimensions"}


def _netcdf(data: xarray.Dataset, path: Path) -> None:
    plain = data.copy()
    for name in list(plain.variables):
        variable = plain[name]
        # netCDF 3 has no unsigned bytes, and as signed ones the mark of what is not done would wrap round.
        told = {key: _plain(value) for key, value in variable.attrs.items()}
        plain[name] = variable.astype(np.int16) if variable.dtype.kind == "u" else variable
        plain[name].attrs = told
        plain[name].encoding = {}
    # scipy keeps attributes of the file as attributes of its own object, beside its own `variables`.
    plain.attrs = {_FREE.get(key, key): _plain(value) for key, value in data.attrs.items()}
    if find_spec("h5netcdf") is None:
        plain.to_netcdf(path, engine="scipy", format="NETCDF3_64BIT")
    else:
        plain.to_netcdf(path, engine="h5netcdf")


def _plain(value: Any) -> Any:
    """An attribute that netCDF can hold: texts, numbers and lists of numbers; others as JSON."""
    numbers = isinstance(value, list) and all(isinstance(entry, (int, float)) for entry in value)
    return value if isinstance(value, (str, int, float)) or numbers else json.dumps(value)
