"""Pictures of sweeps: maps of an index, curves, and the borders between regions of other mobility."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Final

import numpy as np
import xarray

from vincula.errors import MissingExtraError, ModelError, UnknownNameError
from vincula.kernels.evaluation import NO_CLOSURE, OPEN
from vincula.sweep.layout import NOT_DONE

if TYPE_CHECKING:
    from vincula.sweep.accessor import SweepAccessor

_UNREACHED: Final = "#d9d9d9"
_BORDER: Final = "#b2182b"
_FOUND: Final = {OPEN: "open", NO_CLOSURE: "does not close", NOT_DONE: "not computed"}


def draw_map(
    accessor: SweepAccessor,
    data: xarray.Dataset,
    name: str,
    x: str | None,
    y: str | None,
    at: Mapping[str, float],
    ax: Any,
    logarithmic: bool,
    labels: Mapping[str, Any],
) -> Any:
    """A map of an index over two variables; see `SweepAccessor.map`."""
    x, y = _pair(data, x, y)
    ax = _axes(ax)
    array = _at(accessor.index(name, **labels), (x, y), at).transpose(y, x)
    values = np.asarray(array.values, dtype=float)
    values = np.where(np.isfinite(values), values, np.nan)
    across, up = _shown(data, x), _shown(data, y)
    ax.set_facecolor(_UNREACHED)
    norm = None
    if logarithmic:
        from matplotlib.colors import LogNorm

        positive = values[values > 0.0]
        if not positive.size:
            raise ModelError(f"{name} has no positive values here: a logarithmic map shows nothing")
        norm = LogNorm(float(positive.min()), float(positive.max()))
        values = np.where(values > 0.0, values, np.nan)
    mesh = ax.pcolormesh(across, up, values, shading="nearest", cmap="viridis", norm=norm, rasterized=True)
    bar = ax.figure.colorbar(mesh, ax=ax)
    bar.set_label(_titled(array, name))
    _borders(data, x, y, at, ax)
    _name_axes(data, x, y, ax)
    _note_missing(data, x, y, at, ax)
    return ax


def draw_curve(
    accessor: SweepAccessor,
    data: xarray.Dataset,
    name: str,
    x: str | None,
    at: Mapping[str, float],
    ax: Any,
    labels: Mapping[str, Any],
) -> Any:
    """An index along one variable; see `SweepAccessor.curve`."""
    dims = [str(dim) for dim in data["status"].dims]
    chosen = _known(x, dims) if x is not None else dims[-1]
    ax = _axes(ax)
    array = _at(accessor.index(name, **labels), (chosen,), at)
    values = np.asarray(array.values, dtype=float)
    ax.plot(_shown(data, chosen), np.where(np.isfinite(values), values, np.nan), lw=1.5)
    ax.set_xlabel(_axis_label(data, chosen))
    ax.set_ylabel(_titled(array, name))
    return ax


def draw_singularities(
    accessor: SweepAccessor,
    data: xarray.Dataset,
    x: str | None,
    y: str | None,
    at: Mapping[str, float],
    ax: Any,
) -> Any:
    """Borders between regions of other mobility; see `SweepAccessor.singularities`."""
    x, y = _pair(data, x, y)
    ax = _axes(ax)
    known = _at(accessor.known, (x, y), at).transpose(y, x)
    ax.set_facecolor(_UNREACHED)
    from matplotlib.colors import ListedColormap

    shown = np.where(known.values, 1.0, np.nan)
    ax.pcolormesh(_shown(data, x), _shown(data, y), shown, shading="nearest", cmap=ListedColormap(["white"]))
    _borders(data, x, y, at, ax)
    _name_axes(data, x, y, ax)
    _note_missing(data, x, y, at, ax)
    return ax


def _borders(data: xarray.Dataset, x: str, y: str, at: Mapping[str, float], ax: Any) -> None:
    """Lines between neighbours whose counts of motions differ, where the data set holds counts."""
    regions = _regions(data, x, y, at)
    if regions is None:
        return
    across, up = _edges(_shown(data, x)), _edges(_shown(data, y))
    from matplotlib.collections import LineCollection

    lines = []
    for i, j in np.argwhere(regions[:, 1:] != regions[:, :-1]):
        lines.append([(across[j + 1], up[i]), (across[j + 1], up[i + 1])])
    for i, j in np.argwhere(regions[1:, :] != regions[:-1, :]):
        lines.append([(across[j], up[i + 1]), (across[j + 1], up[i + 1])])
    if lines:
        ax.add_collection(LineCollection(lines, colors=_BORDER, linewidths=1.2, label="mobility changes"))


def _regions(data: xarray.Dataset, x: str, y: str, at: Mapping[str, float]) -> Any:
    """One number for every combination of counts and of reachable or not; None without counts."""
    for name in ("counts", "summary"):
        if name not in data:
            continue
        array = _at(data[name], (x, y, str(data[name].dims[-1])), at)
        rows = array.transpose(y, x, ...).values
        flat = rows.reshape(-1, rows.shape[-1])
        _, numbers = np.unique(flat, axis=0, return_inverse=True)
        return numbers.reshape(rows.shape[:2])
    return None


def _note_missing(data: xarray.Dataset, x: str, y: str, at: Mapping[str, float], ax: Any) -> None:
    """Say what the grey is."""
    status = _at(data["status"], (x, y), at).values
    words = [word for code, word in _FOUND.items() if (status == code).any()]
    if words:
        ax.set_title(f"grey: {', '.join(words)}", loc="right", fontsize="small", color="#595959")


def _pair(data: xarray.Dataset, x: str | None, y: str | None) -> tuple[str, str]:
    dims = [str(dim) for dim in data["status"].dims]
    if len(dims) < 2:
        raise ModelError("a map needs a grid over two variables or more; use curve() along one")
    first = _known(y, dims) if y is not None else next(dim for dim in dims if dim != x)
    second = _known(x, dims) if x is not None else next(dim for dim in dims if dim != first)
    if first == second:
        raise ModelError(f"x and y are both {first!r}: choose two variables")
    return second, first


def _known(name: str, dims: list[str]) -> str:
    if name not in dims:
        raise UnknownNameError("variable of the grid", name, dims)
    return name


def _at(array: xarray.DataArray, kept: tuple[str, ...], at: Mapping[str, float]) -> xarray.DataArray:
    """The array at given values of the other variables, at the middle of those that are not given."""
    for name in at:
        _known(name, [str(dim) for dim in array.dims])
    for dim in [str(dim) for dim in array.dims if dim not in kept]:
        if dim in at:
            array = array.sel({dim: at[dim]}, method="nearest")
        else:
            array = array.isel({dim: array.sizes[dim] // 2})
    return array


def _shown(data: xarray.Dataset, name: str) -> Any:
    """Values along a dimension as people read them: degrees instead of radians."""
    if name not in data.coords:
        return np.arange(data.sizes[name])
    values = np.asarray(data[name].values, dtype=float)
    return np.degrees(values) if data[name].attrs.get("units") == "rad" else values


def _axis_label(data: xarray.Dataset, name: str) -> str:
    unit = data[name].attrs.get("units", "") if name in data.coords else ""
    unit = "deg" if unit == "rad" else unit
    return f"{name} [{unit}]" if unit and unit != "1" else name


def _name_axes(data: xarray.Dataset, x: str, y: str, ax: Any) -> None:
    ax.set_xlabel(_axis_label(data, x))
    ax.set_ylabel(_axis_label(data, y))


def _titled(array: xarray.DataArray, name: str) -> str:
    unit = array.attrs.get("units", "")
    return f"{name} [{unit}]" if unit else name


def _edges(values: Any) -> Any:
    """Borders of the cells around grid values."""
    if len(values) == 1:
        return np.array([values[0] - 0.5, values[0] + 0.5])
    middle = 0.5 * (values[1:] + values[:-1])
    return np.concatenate(
        [[1.5 * values[0] - 0.5 * values[1]], middle, [1.5 * values[-1] - 0.5 * values[-2]]]
    )


def _axes(ax: Any) -> Any:
    if ax is not None:
        return ax
    try:
        from matplotlib import pyplot
    except ImportError:
        raise MissingExtraError("matplotlib", "plot", "drawing a map") from None
    return pyplot.subplots(layout="constrained")[1]
