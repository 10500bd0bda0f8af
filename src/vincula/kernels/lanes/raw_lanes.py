"""What lanes give before it is sorted into quantities: sections side by side in one array."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vincula.arrays import Matrix, Vector
from vincula.kernels.lanes.outputs import BOUNDS, EFFORTS, MOTIONS, REST, Section


@dataclass(frozen=True, slots=True, eq=False)
class RawLanes:
    """What lanes give, one row a configuration.

    Attributes:
        certain: Whether everything else in the row holds, and the counts of the program; other rows are for
            the reference path.
        residual: Largest gap of a loop in units of the characteristic length.
        angle: Uncertainty of the motions as an angle [rad].
        efficiencies: N x f finite kinematic efficiencies, largest first.  The finite efficiencies of the
            force ellipsoids under the reciprocal metrics are their reciprocals in the opposite order.
        bounds: N x f bounds on the errors of the efficiencies; None unless wanted.
        twists: N x f x d unit directions paired with the efficiencies; None unless wanted.
        rates: N x f x n_a their motor side.
        wrenches: N x f x d unit directions of the finite force efficiencies, largest first; or None.
        torques: N x f x n_a their motor side.
        free: N x free x d orthonormal twists, in lengths of the metric; None unless wanted.
        idle: N x idle x n_a orthonormal rates, in lengths of the metric.
    """

    certain: NDArray[np.bool_]
    residual: Vector
    angle: Vector
    efficiencies: Matrix
    bounds: Matrix | None
    twists: NDArray[np.float64] | None
    rates: NDArray[np.float64] | None
    wrenches: NDArray[np.float64] | None
    torques: NDArray[np.float64] | None
    free: NDArray[np.float64] | None
    idle: NDArray[np.float64] | None


def wanted(want: int) -> list[str]:
    """Names of the sections that `run` gives."""
    found = ["residual", "angle", "efficiencies"]
    for flag, names in (
        (BOUNDS, ("bounds",)), (MOTIONS, ("twists", "rates")), (EFFORTS, ("wrenches", "torques")),
        (REST, ("free", "idle")),
    ):  # fmt: skip
        found += names if want & flag else ()
    return found


def named(sections: Mapping[str, Section], raw: Matrix, status: NDArray[np.uint8], want: int) -> RawLanes:
    """Rows of one array by name; views, no copies.

    Args:
        sections: Where results stand.
        raw: N x outputs, the sections of `wanted` one after the other.
        status: N, 0 where a lane is certain.
        want: What is wanted.
    """
    found: dict[str, NDArray[np.float64]] = {}
    column = 0
    for name in wanted(want):
        section = sections[name]
        found[name] = raw[:, column : column + section.size].reshape(len(raw), *section.shape)
        column += section.size
    return RawLanes(
        status == 0, found["residual"], found["angle"], found["efficiencies"], found.get("bounds"),
        *(found.get(name) for name in ("twists", "rates", "wrenches", "torques", "free", "idle")),
    )  # fmt: skip
