"""The data set on disk: zarr arrays over the points, one chunk of each a work unit.

Chunks are plain little-endian numbers without compression: indices of mechanisms hardly compress, and
their bytes then depend on nothing but the numbers.  What describes the arrays is written by
zarr-python; nothing in it tells of a clock, a host or a number of threads.
"""

from __future__ import annotations

import json
import math
import re
import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from vincula.errors import MissingExtraError
from vincula.kernels.evaluation import STATUS_NAMES
from vincula.kernels.quantities import Quantity
from vincula.sweep.chunks import Chunking
from vincula.sweep.inputs import Variable
from vincula.sweep.points import Points
from vincula.sweep.work import Array, Block

NOT_DONE: Final = 255
"""Status of points that nobody has computed yet."""
SCHEMA: Final = "vincula/sweep/1"
"""What the data set calls its own form."""


@dataclass(frozen=True, slots=True)
class Field:
    """One array over all points.

    Attributes:
        name: Its name in the data set.
        source: The quantity or variable that it holds.
        dims: Names of the dimensions behind those of the points.
        shape: Their lengths.
        dtype: Type of its numbers.
        fill: What stands where nothing was computed; there the status says `not done`.
        attributes: Meaning, units, labels.
        column: For the values of a variable: which one; None for what is computed.
    """

    name: str
    source: str
    dims: tuple[str, ...]
    shape: tuple[int, ...]
    dtype: str
    fill: float | int
    attributes: Mapping[str, Any]
    column: int | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Layout:
    """Arrays, dimensions and attributes of a data set.

    Attributes:
        points: Where the sweep goes.
        dims: Names of the dimensions of the points, as they are in the data set.
        chunking: How they are cut.
        fields: Arrays over all points, in chunks.
        axes: For grids the values along every dimension, whole.
        attributes: What the data set says about itself.
    """

    points: Points
    dims: tuple[str, ...]
    chunking: Chunking
    fields: tuple[Field, ...]
    axes: Mapping[str, tuple[Array, Mapping[str, Any]]]
    attributes: Mapping[str, Any]

    def chunk_bytes(self) -> int:
        """Bytes of one chunk, all arrays together."""
        each = sum(np.dtype(f.dtype).itemsize * math.prod(f.shape) for f in self.fields)
        return each * math.prod(self.chunking.block)

    def encoded(self, chunk: int, block: Block, values: Array) -> Iterator[tuple[str, bytes]]:
        """File name and content of a chunk, array by array.

        Args:
            chunk: Its number.
            block: What was computed.
            values: Its points, one row a point, for the arrays that hold variables.
        """
        extent = self.chunking.extent(chunk)
        for field in self.fields:
            source = block.arrays[field.source] if field.column is None else values[:, field.column]
            yield self.file(field, chunk), self._filled(field, extent, source)

    def file(self, field: Field, chunk: int) -> str:
        """Name of the file of one array's chunk."""
        return self._file(field, self.chunking.place(chunk))

    def _file(self, field: Field, place: Sequence[int]) -> str:
        return f"{field.name}/c.{'.'.join(map(str, (*place, *(0 for _ in field.shape))))}"

    def _filled(self, field: Field, extent: tuple[int, ...], numbers: Array) -> bytes:
        shaped = numbers.reshape(*extent, *field.shape)
        if extent == self.chunking.block:
            return np.ascontiguousarray(shaped, dtype=field.dtype).tobytes()
        whole = np.full((*self.chunking.block, *field.shape), field.fill, dtype=field.dtype)
        whole[tuple(slice(n) for n in extent)] = shaped
        return whole.tobytes()

    def metadata(self) -> dict[str, bytes]:
        """Every file that describes the data set, with the values along the dimensions of a grid.

        Raises:
            MissingExtraError: zarr is not installed.
        """
        store: dict[str, Any] = {}
        group = _group(store, self.attributes)
        shape, block = self.points.shape, self.chunking.block
        for f in self.fields:
            whole, chunk, dims = (*shape, *f.shape), (*block, *f.shape), (*self.dims, *f.dims)
            _array(group, f.name, whole, chunk, f.dtype, f.fill, dims, f.attributes)
        for name, (values, about) in self.axes.items():
            _array(group, name, values.shape, values.shape, "<f8", float("nan"), (name,), about)
        _consolidate(group)
        files = {name: bytes(content.to_bytes()) for name, content in sorted(store.items())}
        for name, (values, _) in self.axes.items():
            files[f"{name}/c.0"] = np.ascontiguousarray(values, dtype="<f8").tobytes()
        return files


def with_reasons(root: bytes, status: bytes, reasons: Mapping[str, int]) -> tuple[bytes, bytes]:
    """The descriptions of the whole and of `status` with the reasons of points that are not ok.

    Args:
        root: Content of `zarr.json`.
        status: Content of `status/zarr.json`.
        reasons: Number of points by reason.
    """
    whole, own = json.loads(root), json.loads(status)
    own["attributes"]["reasons"] = dict(reasons)
    whole["consolidated_metadata"]["metadata"]["status"]["attributes"]["reasons"] = dict(reasons)
    return json.dumps(whole, indent=2).encode(), json.dumps(own, indent=2).encode()


def layout_of(
    points: Points,
    chunking: Chunking,
    variables: Sequence[Variable],
    quantities: Sequence[Quantity],
    attributes: Mapping[str, Any],
) -> Layout:
    """The data set of a sweep.

    Args:
        points: Where it goes.
        chunking: How the points are cut.
        variables: What changes from point to point.
        quantities: What is computed, `status` among them.
        attributes: What the data set says about itself.
    """
    taken: set[str] = set()
    results = [_of_quantity(quantity, _free(quantity.name, taken)) for quantity in quantities]
    taken.update(dim for quantity in quantities for dim in quantity.dims)
    names = {variable.name: _free(variable.name, taken) for variable in variables}
    told = {variable.name: _about(variable) for variable in variables}
    grid = points.dims == points.variables
    axes: dict[str, tuple[Array, Mapping[str, Any]]] = {}
    columns: list[Field] = []
    for k, variable in enumerate(variables):
        about = told[variable.name]
        if grid:
            steps = np.arange(points.shape[k], dtype=np.int64) * math.prod(points.shape[k + 1 :])
            axes[names[variable.name]] = points.at(steps)[:, k], about
        else:
            columns.append(
                Field(names[variable.name], variable.name, (), (), "<f8", float("nan"), about, column=k)
            )
    dims = tuple(names.get(dim, dim) for dim in points.dims)
    order = {"variables": list(names.values()), "arrays": [field.name for field in results]}
    about_all = {"coordinates": " ".join(names.values()), **attributes, **order}
    return Layout(points, dims, chunking, (*results, *columns), axes, about_all)


def _of_quantity(quantity: Quantity, name: str) -> Field:
    dtype = np.dtype(quantity.dtype).newbyteorder("<").str
    told: dict[str, Any] = {"long_name": quantity.meaning, "quantity": quantity.name}
    if quantity.unit:
        told["units"] = quantity.unit
    if quantity.dims:
        told["labels"] = {
            d: list(names) for d, names in zip(quantity.dims, quantity.labels, strict=True) if names
        }
    fill: float | int = quantity.fill if np.dtype(quantity.dtype).kind == "f" else int(quantity.fill)
    if quantity.name == "status":
        fill = NOT_DONE
        told["long_name"] = "status of the point"
        told["flag_values"] = [*range(len(STATUS_NAMES)), NOT_DONE]
        told["flag_meanings"] = " ".join((*STATUS_NAMES, "not-done"))
    return Field(name, quantity.name, quantity.dims, quantity.shape, dtype, fill, told)


def _about(variable: Variable) -> dict[str, Any]:
    told = {"long_name": variable.name}
    if variable.unit:
        told["units"] = variable.unit
    return told


def _free(name: str, taken: set[str]) -> str:
    """A name for a folder that is free: letters, digits and a few signs, never a way out of the data set."""
    plain = re.sub(r"[^\w.+@-]", "_", name.replace(":", ".")).strip(".") or "_"
    plain = f"_{plain}" if plain.startswith("__") or plain == "zarr.json" else plain
    while plain in taken:
        plain = f"{plain}_"
    taken.add(plain)
    return plain


def _group(store: dict[str, Any], attributes: Mapping[str, Any]) -> Any:
    try:
        import zarr
    except ImportError:
        raise MissingExtraError("zarr", "sweep", "writing a sweep") from None
    from zarr.storage import MemoryStore

    return zarr.create_group(
        store=MemoryStore(store), zarr_format=3, attributes=json.loads(json.dumps(attributes))
    )


def _array(
    group: Any,
    name: str,
    shape: tuple[int, ...],
    chunks: tuple[int, ...],
    dtype: str,
    fill: float | int,
    dims: tuple[str, ...],
    attributes: Mapping[str, Any],
) -> None:
    group.create_array(
        name,
        shape=shape,
        chunks=chunks,
        dtype=dtype,
        compressors=None,
        filters=None,
        fill_value=fill,
        dimension_names=dims,
        attributes=json.loads(json.dumps(dict(attributes))),
        chunk_key_encoding={"name": "default", "separator": "."},
    )


def _consolidate(group: Any) -> None:
    """All descriptions in one file, for readers over a network."""
    import zarr

    with warnings.catch_warnings():
        warnings.simplefilter(
            "ignore"
        )  # that other readers may not know consolidated descriptions: they need not
        zarr.consolidate_metadata(group.store)
