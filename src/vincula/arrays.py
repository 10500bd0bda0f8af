"""Array types and the checks at the door: finite, right shape, read-only."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vincula.errors import NonFiniteError, ShapeError
from vincula.traced import holds_traced

Vector = NDArray[np.float64]
"""One-dimensional array of doubles."""

Matrix = NDArray[np.float64]
"""Two-dimensional array of doubles."""


def frozen(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """The same array, made read-only in place (for arrays that we own)."""
    values.setflags(write=False)
    return values


def checked(
    values: ArrayLike,
    name: str,
    shape: Sequence[int | None],
) -> NDArray[np.float64]:
    """A read-only double copy of `values`, checked for shape and for finite numbers.

    Args:
        values: Anything numpy can read as numbers.
        name: What the array is, for messages.
        shape: Expected shape; None stands for any size along that axis.

    Raises:
        ShapeError: The shape does not fit, or the values are not a table of numbers.
        NonFiniteError: A value is NaN or infinite.
    """
    expected = "(" + ", ".join("any" if n is None else str(n) for n in shape) + ")"
    try:
        if np.iscomplexobj(values):  # numpy would drop the imaginary part with no more than a warning
            raise TypeError
        array = np.array(values, dtype=np.float64)
    except (TypeError, ValueError):
        if holds_traced(values):
            return _traced(values, name, shape)
        raise ShapeError(name, np.shape(_as_object(values)), f"numbers of shape {expected}") from None
    fits = array.ndim == len(shape) and all(
        n is None or n == got for n, got in zip(shape, array.shape, strict=True)
    )
    if not fits:
        raise ShapeError(name, array.shape, expected)
    if not np.isfinite(array).all():
        where = tuple(int(i) for i in np.argwhere(~np.isfinite(array))[0])
        raise NonFiniteError(name, where, float(array[where]))
    return frozen(array)


def _traced(values: Any, name: str, shape: Sequence[int | None]) -> NDArray[Any]:
    """Traced numbers as a read-only array of objects; whether they are finite is seen where they are used."""
    array = np.array(values, dtype=object)
    if [n if n is not None else got for n, got in zip(shape, array.shape, strict=False)] != list(array.shape):
        raise ShapeError(name, array.shape, str(tuple(shape)))
    array.setflags(write=False)
    return array


def numbers(values: ArrayLike) -> NDArray[Any]:
    """A copy of numbers as an array of doubles; of objects where there are traced numbers among them."""
    return np.array(values, dtype=object if holds_traced(values) else np.float64)


def _as_object(values: Any) -> NDArray[np.object_]:
    try:
        return np.array(values, dtype=object)
    except ValueError:
        return np.empty(0, dtype=object)
