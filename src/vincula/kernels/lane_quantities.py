"""From what lanes give to the quantities of a batch: every quantity as a writer of blocks.

Lanes give the finite efficiencies with their pairs of directions; how many infinite and zero ones there
are is the same in all lanes that are certain.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from vincula.analysis.ellipsoid import Kind
from vincula.arrays import Vector
from vincula.kernels.quantities import CLASS_CODES, INDICES, NO_CLASS, SUMMARY, Quantity
from vincula.numerics.counts import SummaryCounts, TwelveCounts
from vincula.numerics.subspaces import settled

if TYPE_CHECKING:
    from vincula.kernels.lanes.program import RawLanes

Block = NDArray[Any]
Writer = Callable[["RawLanes", Block], None]
"""Writes one quantity of a block of lanes at its place."""
MOTIONS: Final = 1
"""Directions of the kinematic ellipsoid are needed."""
EFFORTS: Final = 2
"""Directions of the force ellipsoids are needed."""
REST: Final = 4
"""Directions of infinite and zero kinematic efficiencies are needed."""
COUNTS: Final = 8
"""All twelve counts must be certain."""


@dataclass(frozen=True, slots=True, eq=False)
class Listing:
    """What an ellipsoid lists in every lane that is certain.

    Attributes:
        kind: Which of the five.
        infinite: Number of infinite efficiencies, which come first.
        finite: Number of finite ones.
        zero: Number of zeros, which come last.
        roots: Roots of the weights of the task components.
        motor_roots: Roots of the weights of the motors.
    """

    kind: Kind
    infinite: int
    finite: int
    zero: int
    roots: Vector
    motor_roots: Vector

    @staticmethod
    def of(kind: Kind, counts: SummaryCounts, roots: Vector, motor_roots: Vector) -> Listing:
        """The listing of one ellipsoid (house page) by the summary counts."""
        infinite = {"kinematic": counts.indeterminacy, "passive force": counts.structural_wrenches}
        zero = {"kinematic": counts.redundancy, "active force": counts.internal_torques}
        return Listing(kind, infinite.get(kind, 0), counts.coordinated, zero.get(kind, 0), roots, motor_roots)

    @property
    def last(self) -> int:
        """Place after the last finite efficiency."""
        return self.infinite + self.finite

    @property
    def want(self) -> int:
        """Which directions this ellipsoid needs."""
        return MOTIONS if self.kind == "kinematic" else EFFORTS

    def values(self, raw: RawLanes) -> NDArray[np.float64]:
        """Lanes x finite efficiencies, largest first."""
        found = raw.efficiencies
        return found if self.kind == "kinematic" else 1.0 / found[:, ::-1]

    def directions(self, raw: RawLanes, side: str) -> NDArray[np.float64]:
        """Lanes x finite x components: directions of the finite efficiencies."""
        if self.kind == "kinematic":
            found = raw.twists if side == "task_directions" else raw.rates
        else:
            found = raw.wrenches if side == "task_directions" else raw.torques
        return np.empty(0) if found is None else found


def writer_of(
    quantity: Quantity, counts: SummaryCounts, twelve: TwelveCounts | None, listing: Listing | None
) -> tuple[Writer, int] | str:
    """How lanes write a quantity and what that needs; or why only the reference path does.

    Args:
        quantity: The quantity.
        counts: The summary counts of all lanes that are certain.
        twelve: All twelve counts of lanes that are certain of them; None where none is.
        listing: What its ellipsoid lists; None where lanes do not know it.
    """
    if quantity.name == "counts" and twelve is not None:
        return _constant(list(twelve.as_dict().values())), COUNTS
    if quantity.kind is None:
        return _of_model(quantity, counts)
    if listing is None:
        return f"{quantity.name} is not computed in lanes"
    if quantity.part in INDICES:
        return _of_index(quantity, listing)
    if quantity.part in ("task_directions", "motor_directions"):
        return _of_directions(quantity, listing)
    plain: dict[str, Callable[[Listing], Writer]] = {
        "efficiencies": _efficiencies,
        "classes": _classes,
        "smallest": _smallest,
        "largest": _largest,
        "bounds": _bounds,
    }
    return plain[quantity.part](listing), 0


def _of_model(quantity: Quantity, counts: SummaryCounts) -> tuple[Writer, int] | str:
    if quantity.name == "status":
        return _constant(0), 0
    if quantity.name == "summary":
        return _constant(list(counts.as_dict().values())), 0
    if quantity.name in SUMMARY:
        return _constant(getattr(counts, quantity.name)), 0
    if quantity.name == "closure.iterations":
        return _constant(-1), 0
    return f"{quantity.name} is not computed in lanes"


def _constant(value: Any) -> Writer:
    def write(raw: RawLanes, out: Block) -> None:
        out[...] = value

    return write


def _efficiencies(listing: Listing) -> Writer:
    def write(raw: RawLanes, out: Block) -> None:
        out[:, : listing.infinite] = np.inf
        out[:, listing.infinite : listing.last] = listing.values(raw)
        out[:, listing.last : listing.last + listing.zero] = 0.0
        out[:, listing.last + listing.zero :] = np.nan

    return write


def _bounds(listing: Listing) -> Writer:
    def write(raw: RawLanes, out: Block) -> None:
        out[:, : listing.infinite] = 0.0
        out[:, listing.infinite : listing.last] = raw.bounds
        out[:, listing.last : listing.last + listing.zero] = 0.0
        out[:, listing.last + listing.zero :] = np.nan

    return write


def _classes(listing: Listing) -> Writer:
    def write(raw: RawLanes, out: Block) -> None:
        out[:, : listing.infinite] = CLASS_CODES["infinite"]
        out[:, listing.infinite : listing.last] = CLASS_CODES["finite"]
        out[:, listing.last : listing.last + listing.zero] = CLASS_CODES["zero"]
        out[:, listing.last + listing.zero :] = NO_CLASS

    return write


def _smallest(listing: Listing) -> Writer:
    def write(raw: RawLanes, out: Block) -> None:
        out[:] = listing.values(raw)[:, -1] if listing.finite else np.nan

    return write


def _largest(listing: Listing) -> Writer:
    def write(raw: RawLanes, out: Block) -> None:
        out[:] = listing.values(raw)[:, 0] if listing.finite else np.nan

    return write


def _of_directions(quantity: Quantity, listing: Listing) -> tuple[Writer, int] | str:
    side = quantity.part
    rest = listing.infinite if side == "task_directions" else listing.zero
    if rest and listing.kind != "kinematic":
        return f"{quantity.name}: lanes give the directions of finite force efficiencies only"
    # Infinite ones come before the finite ones and have no motor side, zeros behind them and no task side.
    of_rest = slice(0, rest) if side == "task_directions" else slice(listing.last, listing.last + rest)

    def write(raw: RawLanes, out: Block) -> None:
        out[:, : listing.infinite] = np.nan
        out[:, listing.infinite : listing.last] = listing.directions(raw, side)
        out[:, listing.last :] = np.nan
        if rest:
            bases = raw.free if side == "task_directions" else raw.idle
            roots = listing.roots if side == "task_directions" else listing.motor_roots
            out[:, of_rest] = _rest_directions(raw, bases, roots)

    return write, listing.want | (REST if rest else 0)


def _rest_directions(raw: RawLanes, bases: NDArray[np.float64] | None, roots: Vector) -> NDArray[np.float64]:
    """Settled directions of one subspace a lane, as the spectrum of one configuration gives them."""
    found = np.array(bases, dtype=np.float64)
    if found.shape[1] > 1:
        for lane in np.flatnonzero(raw.certain):
            found[lane] = settled(found[lane].T).T
    found /= roots
    size = np.abs(found)
    first = (size >= size.max(axis=2, keepdims=True) * (1.0 - 1e-9)).argmax(axis=2)
    signs = np.where(np.take_along_axis(found, first[:, :, None], axis=2) < 0.0, -1.0, 1.0)
    return np.asarray(found * signs + 0.0)


def _of_index(quantity: Quantity, listing: Listing) -> tuple[Writer, int] | str:
    if listing.infinite:
        return f"{quantity.name}: lanes take indices of bounded ellipsoids only"
    s = 2 if len(listing.roots) == 3 else 3
    chosen = {"translation": slice(0, s), "rotation": slice(s, None), "all": slice(None)}[quantity.on]
    roots = listing.roots[chosen]
    index = _INDEX[quantity.part]
    from vincula.kernels.semi_axes import singular_values  # numba is there: this is for lanes

    def of_all(raw: RawLanes, out: Block) -> None:
        out[:] = index(_padded(np.sqrt(listing.values(raw)), len(roots)))

    def of_part(raw: RawLanes, out: Block) -> None:
        sides = listing.directions(raw, "task_directions")[:, :, chosen] * roots
        axes = sides * np.sqrt(listing.values(raw))[:, :, None]
        certain = raw.certain if raw.certain.all() else raw.certain & np.isfinite(axes).all(axis=(1, 2))
        found = np.full((len(axes), min(axes.shape[1:])), np.nan)
        found[certain] = singular_values(axes[certain])
        out[:] = index(_padded(found, len(roots)))

    return (of_all, 0) if quantity.on == "all" else (of_part, listing.want)


def _padded(axes: NDArray[np.float64], size: int) -> NDArray[np.float64]:
    """Semi-axes, zero in the directions that a set does not reach."""
    if axes.shape[1] == size:
        return axes
    return np.concatenate([axes, np.zeros((len(axes), size - axes.shape[1]))], axis=1)


def _volume(axes: NDArray[np.float64]) -> Vector:
    return np.asarray(np.where(axes[:, -1] == 0.0, 0.0, np.prod(axes, axis=1)))


def _condition(axes: NDArray[np.float64]) -> Vector:
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(np.where(axes[:, -1] == 0.0, np.inf, axes[:, 0] / axes[:, -1]))


def _isotropy(axes: NDArray[np.float64]) -> Vector:
    squares = axes**2
    with np.errstate(divide="ignore", invalid="ignore"):
        found = np.exp(np.mean(np.log(squares), axis=1)) / np.mean(squares, axis=1)
    return np.asarray(np.where(squares[:, -1] == 0.0, 0.0, found))


_INDEX: Final[dict[str, Callable[[NDArray[np.float64]], Vector]]] = {
    "yoshikawa_volume": _volume,
    "condition": _condition,
    "condition_number": _condition,
    "inverse_condition_number": lambda axes: 1.0 / _condition(axes),
    "isotropy": _isotropy,
    "smallest_singular_value": lambda axes: np.asarray(axes[:, -1]),
}
