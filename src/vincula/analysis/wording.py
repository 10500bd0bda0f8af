"""Motions and forces in plain words: numbers, directions, axes, lists of joints."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from vincula.arrays import Vector
from vincula.errors import listing
from vincula.model import LinearModel
from vincula.numerics.rank import negligible


def number(value: float) -> str:
    """A number in at most four digits; what is zero to rounding is 0."""
    return f"{0.0 if negligible(abs(value), 1.0) else value:.4g}"


def point(values: Iterable[float]) -> str:
    """Coordinates as (x, y, z)."""
    return "(" + ", ".join(number(float(v)) for v in values) + ")"


def count_of(number_of: int, noun: str, several: str = "") -> str:
    """`1 motion`, `2 motions`; `several` is the plural where it is not noun + s."""
    return f"{number_of} {noun if number_of == 1 else several or noun + 's'}"


def joint_list(names: Iterable[str]) -> str:
    """`joint b3` or `joints b3, s3`, each named once."""
    unique = list(dict.fromkeys(names))
    return f"joint{'' if len(unique) == 1 else 's'} {listing(unique)}"


def components(values: Vector, names: Sequence[str]) -> str:
    """The components that are not zero, as `fy 0.894, mz -0.447`."""
    size = float(np.abs(values).max(initial=0.0))
    shown = [
        f"{name} {value:.4g}" for name, value in zip(names, values, strict=True)
        if not negligible(abs(float(value)), size)
    ]  # fmt: skip
    return ", ".join(shown) or "nothing"


def motion_of_body(model: LinearModel, twist: Vector, origin: Vector, doubt: float = 0.0) -> tuple[str, str]:
    """A rigid motion in words, as verb and path: `turn`, `about the axis through ... along ...`.

    Args:
        model: For its dimension and characteristic length.
        twist: Twist at `origin` in ground axes.
        origin: Point where the linear part is taken [m].
        doubt: Relative uncertainty of the twist.
    """
    length = model.length or 1.0
    s = len(origin)
    v, omega = twist[:s], twist[s:]
    speed, turning = float(np.linalg.norm(v)), float(np.linalg.norm(omega)) * length
    if negligible(turning, speed + turning, doubt):
        return "translate", f"along {point(_unit(v))}"
    if s == 2:
        centre = origin + np.array([-v[1], v[0]]) / omega[0]
        return "turn", f"about the point {point(centre)}"
    square = float(omega @ omega)
    centre = origin + np.cross(omega, v) / square
    pitch = float(v @ omega) / square
    axis = f"about the axis through {point(centre)} along {point(_unit(omega))}"
    if negligible(abs(pitch), length + speed * length / turning, doubt):
        return "turn", axis
    return "screw", f"{axis}, {number(pitch)} m per rad"


def _unit(vector: Vector) -> Vector:
    """Length one, largest component positive."""
    largest = float(vector[int(np.argmax(np.abs(vector)))])
    return np.asarray(vector / (np.linalg.norm(vector) * np.sign(largest)))
