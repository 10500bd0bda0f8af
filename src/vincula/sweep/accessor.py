"""The accessor `.vincula` of xarray data sets: what is ok, index maps, slices, singularity curves.

data = vincula.open_sweep("five-bar.zarr").to_xarray()
data.vincula.map("kinematic.inverse_condition_number:translation")
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import xarray

from vincula.errors import ModelError, UnknownNameError, listing
from vincula.kernels.evaluation import DOUBTFUL, OK, STATUS_NAMES
from vincula.sweep.layout import NOT_DONE


@xarray.register_dataset_accessor("vincula")  # type: ignore[no-untyped-call]
class SweepAccessor:
    """What people ask of a sweep.

    Args:
        data: The data set of a sweep.
    """

    def __init__(self, data: xarray.Dataset) -> None:
        self._data = data

    @property
    def status(self) -> xarray.DataArray:
        """Status of every point in words: ok, doubtful, open, no-closure, failed, not-done."""
        self._refuse_other()
        names = dict(enumerate(STATUS_NAMES)) | {NOT_DONE: "not-done"}
        return xarray.apply_ufunc(  # type: ignore[no-any-return]
            _named, self._data["status"], kwargs={"names": names}, dask="parallelized", output_dtypes=["<U10"]
        )

    @property
    def known(self) -> xarray.DataArray:
        """Which points have numbers: those that are ok or doubtful."""
        self._refuse_other()
        return (self._data["status"] == OK) | (self._data["status"] == DOUBTFUL)

    @property
    def counts(self) -> dict[str, int]:
        """Points by status."""
        status = self._data["status"].values
        found = {name: int((status == code).sum()) for code, name in enumerate(STATUS_NAMES)}
        return {**found, "not-done": int((status == NOT_DONE).sum())}

    def index(self, name: str, **labels: Any) -> xarray.DataArray:
        """One number for every point, NaN where there is none.

        Args:
            name: A quantity, as it was asked for or as it is called in the data set.
            **labels: For quantities with several numbers, which one: `entry=0` along its own dimension,
                or a name along it (`count="t"`).

        Raises:
            UnknownNameError: No such quantity in the data set.
            ModelError: Several numbers a point, and none of them chosen.
        """
        self._refuse_other()
        array = self._array(name)
        chosen: dict[str, Any] = {}
        for dim in [str(dim) for dim in array.dims if dim not in self._data["status"].dims]:
            wanted = labels.pop(dim, labels.pop(dim.split(" ")[-1], None))
            if wanted is None:
                raise ModelError(
                    f"{name} has {array.sizes[dim]} numbers a point along {dim!r}: choose one, for example "
                    f"{dim.split(' ')[-1]}=0"
                )
            array = array.sel({dim: wanted}) if isinstance(wanted, str) else array.isel({dim: int(wanted)})
            chosen[dim] = array.coords[dim].item() if dim in array.coords else int(wanted)
        if labels:
            raise ModelError(f"{name} has no dimension {listing(labels)}")
        return array.where(self.known).assign_attrs(array.attrs, chosen=chosen)

    def on_branch(self, assembly: str = "", working: str = "") -> xarray.DataArray:
        """Which points are on a branch: `data.where(data.vincula.on_branch("+"))`.

        Args:
            assembly: Wanted signs of `branch.assembly`, one a group in order: + as at home, - the other
                side, 0 singular, ? no sign, * any.  Empty: not looked at.
            working: The same for `branch.working`.

        Raises:
            UnknownNameError: The data set has not got the measures that are looked at.
            ModelError: Not one sign a group, or a character that is none.
        """
        self._refuse_other()
        found = self.known
        for name, signs in (("branch.assembly", assembly), ("branch.working", working)):
            if signs:
                found = found & self._has_signs(name, signs)
        return found

    def _has_signs(self, name: str, signs: str) -> xarray.DataArray:
        array = self._array(name)
        dim = str(array.dims[-1])
        if len(signs) != array.sizes[dim] or set(signs) - set("+-0?*"):
            groups = listing(array[dim].values) if dim in array.coords else str(array.sizes[dim])
            raise ModelError(
                f"signs {signs!r} do not fit {name}: give one of + - 0 ? * for each of its groups ({groups})"
            )
        here = xarray.ones_like(self.known)
        for k, sign in enumerate(signs):
            one = array.isel({dim: k}, drop=True)
            if sign != "*":
                here = here & {"+": one > 0.0, "-": one < 0.0, "0": one == 0.0, "?": one.isnull()}[sign]
        return here

    def _array(self, name: str) -> xarray.DataArray:
        for found, array in self._data.data_vars.items():
            if name in (found, array.attrs.get("quantity")):
                return array
        raise UnknownNameError("quantity in this data set", name, [str(key) for key in self._data.data_vars])

    def slice(self, **values: float) -> xarray.Dataset:
        """The data set where some variables of the grid are nearest to given values [m, rad].

        Args:
            **values: Values by variable; names that are no words go as `slice(**{"reference.x": 0.1})`.

        Raises:
            UnknownNameError: No such dimension.
        """
        self._refuse_other()
        for name in values:
            if name not in self._data.dims:
                raise UnknownNameError("dimension", name, [str(dim) for dim in self._data["status"].dims])
        return self._data.sel(values, method="nearest")

    def map(
        self,
        name: str,
        x: str | None = None,
        y: str | None = None,
        *,
        at: Mapping[str, float] | None = None,
        ax: Any = None,
        logarithmic: bool = False,
        **labels: Any,
    ) -> Any:
        """A map of an index over two variables, with singular curves and what is unknown in grey.

        Singular curves need `branch.assembly` and `branch.working` in the data set; without them, borders
        between regions where the counts of motions differ are drawn, if counts are there.

        Args:
            name: The quantity.
            x: Variable to the right; by default the second one of the grid.
            y: Variable upwards; by default the first one.
            at: Values of the other variables [m, rad]; by default the middle ones.
            ax: Axes of matplotlib to draw into.
            logarithmic: Colours by the logarithm.
            **labels: As in `index`.

        Returns:
            The axes.

        Raises:
            ModelError: No grid of two variables or more.
            MissingExtraError: matplotlib is not installed.
        """
        from vincula.sweep.plots import draw_map

        return draw_map(self, self._data, name, x, y, at or {}, ax, logarithmic, labels)

    def curve(
        self,
        name: str,
        x: str | None = None,
        *,
        at: Mapping[str, float] | None = None,
        ax: Any = None,
        **labels: Any,
    ) -> Any:
        """An index along one variable, or along a path, with gaps where it is unknown.

        Args:
            name: The quantity.
            x: The variable; by default the last one of the grid.
            at: Values of the other variables [m, rad]; by default the middle ones.
            ax: Axes of matplotlib to draw into.
            **labels: As in `index`.

        Returns:
            The axes.

        Raises:
            ModelError: No such variable.
            MissingExtraError: matplotlib is not installed.
        """
        from vincula.sweep.plots import draw_curve

        return draw_curve(self, self._data, name, x, at or {}, ax, labels)

    def singularities(
        self,
        x: str | None = None,
        y: str | None = None,
        *,
        at: Mapping[str, float] | None = None,
        ax: Any = None,
    ) -> Any:
        """Singular curves over two variables by type, and the edge of what is reached.

        The curves are the zeros of `branch.assembly` (the member becomes free with the motors locked) and
        `branch.working` (motors lose authority), interpolated between grid points: as exact as the grid is
        fine (`vincula map` locates them).  Where a measure jumps to another sign instead of passing zero,
        because the next point is on another branch, a dotted line says so.  A data set without these
        quantities shows the borders where the counts of motions differ, and says what to ask for.

        Args:
            x: Variable to the right.
            y: Variable upwards.
            at: Values of the other variables [m, rad].
            ax: Axes of matplotlib to draw into.

        Returns:
            The axes.

        Raises:
            ModelError: No grid of two variables or more, or nothing that tells of singularities.
            MissingExtraError: matplotlib is not installed.
        """
        from vincula.sweep.plots import draw_singularities

        return draw_singularities(self, self._data, x, y, at or {}, ax)

    def _refuse_other(self) -> None:
        if "status" not in self._data:
            raise ModelError("this data set has no array 'status': it is no sweep of vincula")


def _named(codes: Any, names: Mapping[int, str]) -> Any:
    import numpy as np

    table = np.full(256, "unknown", dtype="<U10")
    for code, name in names.items():
        table[code] = name
    return table[codes]
