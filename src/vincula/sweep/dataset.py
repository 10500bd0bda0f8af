"""A stored sweep: opened with xarray, asked how complete it is and why points are not ok."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from vincula.errors import MissingExtraError, ModelError
from vincula.kernels.evaluation import OK, STATUS_NAMES
from vincula.sweep.chunks import Chunking
from vincula.sweep.finishing import gathered
from vincula.sweep.foreign import refuse_foreign
from vincula.sweep.layout import NOT_DONE
from vincula.sweep.ledger import MOST_REASONS, Ledger, Reason, Record
from vincula.sweep.running import Places

if TYPE_CHECKING:
    import xarray

    from vincula.sweep.sweep import Sweep


@dataclass(frozen=True, slots=True)
class SweepStatus:
    """How complete a sweep is.

    Attributes:
        chunks: Number of chunks.
        done: Chunks that are done.
        failed: Chunks that failed, with their errors and inputs.
        points: Number of points.
        points_done: Points that are stored, those of failed chunks included.
        counts: Points by status.
        manifest: What the sweep is.
    """

    chunks: int
    done: int
    failed: tuple[Record, ...]
    points: int
    points_done: int
    counts: Mapping[str, int]
    manifest: Mapping[str, Any]

    @property
    def complete(self) -> bool:
        """Whether every chunk is done."""
        return self.done == self.chunks


class SweepData:
    """The data set of a sweep with its ledger; `vincula.open_sweep` makes one.

    Args:
        path: The folder of the data set.

    Attributes:
        path: The folder of the data set.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = Path(path)

    def __repr__(self) -> str:
        return f"SweepData({str(self.path)!r})"

    def status(self) -> SweepStatus:
        """How complete it is.

        Raises:
            SweepError: There is no ledger, or it is damaged.
        """
        counts = dict.fromkeys(STATUS_NAMES, 0)
        failed: list[Record] = []
        done = points_done = 0
        with Ledger(Places(self.path).ledger) as ledger:
            manifest = ledger.manifest
            chunking = Chunking(tuple(manifest["shape"]), tuple(manifest["block"]))
            for record in ledger.records():
                done += record.state == "done"
                failed += [record] if record.state == "failed" else []
                points_done += math.prod(chunking.extent(record.chunk))
                for name, count in record.counts.items():
                    counts[name] += count
        share = manifest.get("shard") or [1, 1]
        own = range(share[0] - 1, manifest["chunks"], share[1])
        every = math.prod(manifest["shape"])
        points = every if share[1] == 1 else sum(math.prod(chunking.extent(k)) for k in own)
        return SweepStatus(len(own), done, tuple(failed), points, points_done, counts, manifest)

    def reason(self, index: int | tuple[int, ...]) -> str:
        """Why a point is not ok, in words; empty when it is, or is not computed.

        Args:
            index: Where it is along every dimension.

        Raises:
            SweepError: There is no ledger, or it is damaged.
            ModelError: No such point.
        """
        place = (index,) if isinstance(index, (int, np.integer)) else tuple(index)
        with Ledger(Places(self.path).ledger) as ledger:
            shape, block = tuple(ledger.manifest["shape"]), tuple(ledger.manifest["block"])
            if len(place) != len(shape) or not all(0 <= k < n for k, n in zip(place, shape, strict=False)):
                raise ModelError(
                    f"there is no point {place}: the sweep has {' x '.join(map(str, shape))} points"
                )
            chunking = Chunking(shape, block)
            at = [k // b for k, b in zip(place, block, strict=True)]
            chunk = int(np.ravel_multi_index(at, chunking.numbers))
            record = ledger.record(chunk)
        inside = [k - s.start for k, s in zip(place, chunking.slices(chunk), strict=True)]
        own = int(np.ravel_multi_index(inside, chunking.extent(chunk)))
        for reason in record.reasons if record else ():
            if reason.first <= own <= reason.last:
                return reason.text
        if record is None or len(record.reasons) < MOST_REASONS or own < record.reasons[-1].last:
            return ""
        if int(self.to_xarray()["status"][place]) in (OK, NOT_DONE):
            return ""
        return f"only the first {MOST_REASONS} reasons of a chunk are kept: evaluate this point alone"

    def to_xarray(self) -> xarray.Dataset:
        """The data set, opened lazily where dask is installed.

        Points that are not computed yet have status 255; whatever the other arrays hold there means
        nothing.

        Raises:
            SweepError: It is no data set of a sweep.
            MissingExtraError: xarray or zarr is not installed.
        """
        refuse_foreign(self.path)
        return _labelled(_opened(self.path))


def open_sweep(path: str | os.PathLike[str]) -> SweepData:
    """A stored sweep.

    Args:
        path: The folder of the data set.

    Raises:
        SweepError: It is no data set of a sweep.
    """
    data = SweepData(path)
    refuse_foreign(data.path)
    return data


def _opened(path: Path) -> xarray.Dataset:
    xr = _xarray()
    try:
        import dask.array  # noqa: F401  chunks are then read when they are needed
    except ImportError:
        chunks: dict[str, int] | None = None
    else:
        chunks = {}
    found: xarray.Dataset = xr.open_zarr(path, consolidated=False, chunks=chunks, zarr_format=3)
    return found


def _xarray() -> Any:
    try:
        import xarray
        import zarr  # noqa: F401
    except ImportError:
        raise MissingExtraError("xarray and zarr", "sweep", "opening a sweep") from None
    import vincula.sweep.accessor  # noqa: F401  registers `.vincula`

    return xarray


def _labelled(found: xarray.Dataset) -> xarray.Dataset:
    """In the order of the sweep, with the names of motors, components and counts along their dimensions."""
    found = found[[name for name in found.attrs.get("arrays", list(found.data_vars)) if name in found]]
    labels: dict[str, list[str]] = {}
    for array in found.data_vars.values():
        labels |= {str(dim): names for dim, names in array.attrs.get("labels", {}).items()}
    return found.assign_coords({dim: names for dim, names in labels.items() if dim not in found.coords})


def in_memory(sweep: Sweep) -> xarray.Dataset:
    """A whole sweep computed here and now.

    Raises:
        MissingExtraError: xarray is not installed.
    """
    from vincula.sweep.starts import all_starts

    xr = _xarray()
    layout, chunking = sweep.layout, sweep.chunking
    starts = all_starts(sweep, chunking.count - 1) if sweep.work.closes else {}
    shape = sweep.points.shape
    arrays = {f.name: np.full((*shape, *f.shape), f.fill, dtype=f.dtype) for f in layout.fields}
    told: list[Reason] = []
    for chunk in range(chunking.count):
        values, extent = sweep.values(chunk), chunking.extent(chunk)
        block = sweep.work.evaluate(values, extent, starts.get(chunk), None)
        told += [Reason(*entry) for entry in block.reasons]
        for f in layout.fields:
            source = block.arrays[f.source] if f.column is None else values[:, f.column]
            arrays[f.name][chunking.slices(chunk)] = source.reshape(*extent, *f.shape)
    variables = {f.name: ((*layout.dims, *f.dims), arrays[f.name], dict(f.attributes)) for f in layout.fields}
    axes = {name: ((name,), values, dict(words)) for name, (values, words) in layout.axes.items()}
    about = {name: value for name, value in layout.attributes.items() if name != "coordinates"}
    found = xr.Dataset({**variables, **axes}, attrs=about)
    if told:
        found["status"].attrs["reasons"] = gathered(told)
    return _labelled(found.set_coords(layout.attributes["coordinates"].split()))


def not_done(status: Any) -> Any:
    """Which points have not been computed.

    Args:
        status: Status codes.
    """
    return status == NOT_DONE
