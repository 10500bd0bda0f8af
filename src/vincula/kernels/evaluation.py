"""The result of a batch: named arrays, a status for every configuration, and its reason in words."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from vincula.errors import ModelError, UnknownNameError, listing
from vincula.kernels.quantities import NO_COUNT, Quantity

OK: Final = 0
"""Certain; a configuration that is certainly singular is ok too, its integers say so."""
DOUBTFUL: Final = 1
"""A rank that the numbers asked for rest on is not decided."""
OPEN: Final = 2
"""The configuration given leaves a loop open."""
NO_CLOSURE: Final = 3
"""No closed configuration was found for the motors or the pose asked for."""
FAILED: Final = 4
"""Something else, said in words: numbers that are not finite, a geometry that cannot be built."""
STATUS_NAMES: Final = ("ok", "doubtful", "open", "no-closure", "failed")
"""Names of the status codes, in order."""

Reason = Callable[[int], str]
"""From the index of a configuration, counted through the whole batch, to why it is not ok."""


class Evaluation(Mapping[str, NDArray[Any]]):
    """Named arrays over a batch of configurations: an immutable mapping by quantity.

    Every array has the batch's dimensions first, then those of its quantity.  What is not there is NaN
    (`NO_COUNT` in integers, -1 in classes and iterations); whether a configuration was evaluated is
    said by its status alone.

    Attributes:
        shape: Dimensions of the batch.
        quantities: What was asked for, with meaning, axis names and units, by name.
        status: Status code of every configuration, uint8.
    """

    status_names = STATUS_NAMES

    __slots__ = ("_arrays", "_reason", "quantities", "shape", "status")

    def __init__(
        self,
        shape: tuple[int, ...],
        quantities: Mapping[str, Quantity],
        arrays: Mapping[str, NDArray[Any]],
        reason: Reason,
    ) -> None:
        self.shape, self.quantities = shape, quantities
        self._arrays, self._reason = arrays, reason
        self.status: NDArray[np.uint8] = arrays["status"]

    def __getitem__(self, name: str) -> NDArray[Any]:
        if name not in self._arrays:
            raise UnknownNameError("quantity in this evaluation", name, self._arrays)
        return self._arrays[name]

    def __contains__(self, name: object) -> bool:
        return name in self._arrays

    def __iter__(self) -> Iterator[str]:
        return iter(self._arrays)

    def __len__(self) -> int:
        return len(self._arrays)

    def __repr__(self) -> str:
        told = ", ".join(f"{count} {name}" for name, count in self.status_counts.items())
        size = " x ".join(map(str, self.shape)) or "one"
        return f"Evaluation({size}: {told or 'nothing'}; {listing(self, 6)})"

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the arrays, `status` first."""
        return tuple(self._arrays)

    @property
    def status_counts(self) -> dict[str, int]:
        """How many configurations have each status, those that occur."""
        counts = np.bincount(self.status.ravel(), minlength=len(STATUS_NAMES))
        return {name: int(count) for name, count in zip(STATUS_NAMES, counts, strict=True) if count}

    def reason(self, index: int | tuple[int, ...] = ()) -> str:
        """Why a configuration is not ok, in words; empty when it is.

        Args:
            index: Where in the batch it is; one number counts through a batch of one dimension.

        Raises:
            ModelError: No such configuration.
        """
        place = (int(index),) if isinstance(index, (int, np.integer)) else tuple(index)
        try:
            inside = [k + n if -n <= k < 0 else k for k, n in zip(place, self.shape, strict=True)]
            flat = int(np.ravel_multi_index(inside, self.shape)) if inside else 0
        except ValueError:
            raise ModelError(f"index {place} is not in a batch of shape {self.shape}") from None
        return self._reason(flat) if self.status.ravel()[flat] != OK else ""

    def to_dict(self) -> dict[str, Any]:
        """Everything as nested lists for JSON: infinity is "inf", what is not there is null."""
        return {
            "shape": list(self.shape),
            "status_names": list(STATUS_NAMES),
            **{name: _plain(array, self.quantities[name]) for name, array in self._arrays.items()},
        }


def plain_floats(array: NDArray[np.float64]) -> Any:
    """Numbers as nested lists for JSON: infinity is "inf", NaN is null."""
    plain = array.astype(object)
    plain[np.isnan(array)] = None
    plain[np.isposinf(array)] = "inf"
    return plain.tolist()


def _plain(array: NDArray[Any], quantity: Quantity) -> Any:
    if array.dtype.kind == "f":
        return plain_floats(array)
    if quantity.fill == NO_COUNT:
        plain = array.astype(object)
        plain[array == NO_COUNT] = None
        return plain.tolist()
    return array.tolist()
