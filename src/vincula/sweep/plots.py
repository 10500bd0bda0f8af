"""Pictures of sweeps: maps of an index, curves along one variable, singular curves over two."""

from __future__ import annotations

from collections.abc import Mapping
from textwrap import fill
from typing import TYPE_CHECKING, Any, Final

import numpy as np
import xarray

from vincula.errors import MissingExtraError, ModelError, UnknownNameError
from vincula.kernels.evaluation import NO_CLOSURE, OPEN
from vincula.kernels.quantities import in_words
from vincula.sweep.layout import NOT_DONE
from vincula.sweep.singular_lines import Plane, draw_lines, missing_measures

if TYPE_CHECKING:
    from vincula.sweep.accessor import SweepAccessor

_UNREACHED: Final = "#d9d9d9"
_LONGEST: Final = 36
"""Characters of a line beside a colour bar or an axis."""
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
    ax, own = _axes(ax)
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
    _explain(ax, own, draw_lines(_plane(accessor, data, x, y, at), ax))
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
    ax, _ = _axes(ax)
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
    """Singular curves by type and the edge of what is reached; see `SweepAccessor.singularities`."""
    x, y = _pair(data, x, y)
    missing = missing_measures(data)
    if missing and not {"counts", "summary"} & set(data.data_vars):
        raise ModelError(f"nothing here tells of singularities: {missing}")
    ax, own = _axes(ax)
    plane = _plane(accessor, data, x, y, at)
    ax.set_facecolor(_UNREACHED)
    from matplotlib.colors import ListedColormap

    shown = np.where(plane.cut(plane.known).values, 1.0, np.nan)
    ax.pcolormesh(plane.across, plane.up, shown, shading="nearest", cmap=ListedColormap(["white"]))
    _explain(ax, own, draw_lines(plane, ax), missing)
    if own and data[x].attrs.get("units") == data[y].attrs.get("units") == "m":
        ax.set_aspect("equal")
    _name_axes(data, x, y, ax)
    _note_missing(data, x, y, at, ax)
    return ax


def _plane(accessor: SweepAccessor, data: xarray.Dataset, x: str, y: str, at: Mapping[str, float]) -> Plane:
    points = {str(dim) for dim in data["status"].dims}

    def cut(array: xarray.DataArray) -> xarray.DataArray:
        others = [str(dim) for dim in array.dims if dim not in points]
        return _at(array, (x, y, *others), at).transpose(y, x, ...)

    return Plane(data, accessor.known, cut, _shown(data, x), _shown(data, y))


def _explain(ax: Any, own: bool, handles: list[Any], note: str = "") -> None:
    """Say what the lines are: below axes of our own, inside those of others."""
    if not handles and not note:
        return
    look = {"fontsize": "small", "title_fontsize": "small", "title": fill(note, 60) or None}
    if own:
        ax.figure.legend(handles=handles, loc="outside lower left", frameon=False, **look)
    else:
        ax.legend(handles=handles, loc="best", framealpha=0.9, **look)


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
    """A quantity in words, which of its numbers, and their unit; no line too long for its place."""
    what, _, of = in_words(array.attrs.get("quantity", name)).partition("\n")
    chosen = [_which(dim, value) for dim, value in array.attrs.get("chosen", {}).items()]
    unit = array.attrs.get("units", "")
    lines = [f"{what} [{unit}]" if unit else what, ", ".join([part for part in (of, *chosen) if part])]
    return "\n".join(fill(line, _LONGEST) for line in lines if line)


def _which(dim: str, value: Any) -> str:
    """Which number along a dimension: its name, or `entry 0`."""
    return str(value) if isinstance(value, str) else f"{dim.rsplit(' ', maxsplit=1)[-1]} {value}"


def _axes(ax: Any) -> tuple[Any, bool]:
    """Axes to draw into, and whether they are made here."""
    if ax is not None:
        return ax, False
    try:
        from matplotlib import pyplot
    except ImportError:
        raise MissingExtraError("matplotlib", "plot", "drawing a map") from None
    return pyplot.subplots(layout="constrained")[1], True
