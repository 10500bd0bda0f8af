"""From what lanes give to the quantities of a batch: how every quantity is written.

Lanes give the finite efficiencies with their pairs of directions; how many infinite and zero ones there
are is the same in all lanes that are certain.  So most numbers go straight from a kernel to their place in
the result, and integers are the same in all lanes; a few quantities are computed from others, block by block.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from vincula.analysis.ellipsoid import Kind
from vincula.arrays import Vector
from vincula.kernels.lanes import outputs as o
from vincula.kernels.quantities import CLASS_CODES, INDICES, NO_CLASS, SUMMARY, Quantity
from vincula.numerics.counts import SummaryCounts, TwelveCounts
from vincula.numerics.subspaces import settled

if TYPE_CHECKING:
    from vincula.kernels.lanes.program import RawLanes

Block = NDArray[Any]
Writer = Callable[["RawLanes", Block], None]
"""Writes one quantity of a block of lanes at its place."""


@dataclass(frozen=True, slots=True)
class Piece:
    """Consecutive numbers that a kernel writes into every row of a quantity.

    Attributes:
        section: Where they come from, see `lanes.outputs`.
        start: First number of the section.
        count: How many.
        column: Where in the row they begin.
    """

    section: str
    start: int
    count: int
    column: int


@dataclass(frozen=True, slots=True, eq=False)
class Written:
    """How a quantity is written.

    Attributes:
        want: What the kernel must compute for it, see `lanes.outputs`.
        pieces: What the kernel writes.
        same: A row that is the same in all lanes.
        writer: What computes the rest from other results of a block, afterwards.
    """

    want: int = 0
    pieces: tuple[Piece, ...] = ()
    same: Any = None
    writer: Writer | None = None


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
        return o.MOTIONS if self.kind == "kinematic" else o.EFFORTS

    @property
    def section(self) -> str:
        """Where its finite efficiencies stand, largest first."""
        return "efficiencies" if self.kind == "kinematic" else "reciprocals"

    @property
    def needed(self) -> int:
        """What gives its finite efficiencies."""
        return 0 if self.kind == "kinematic" else o.RECIPROCALS

    def sides(self, part: str) -> str:
        """Where directions of its finite efficiencies stand."""
        if self.kind == "kinematic":
            return "twists" if part == "task_directions" else "rates"
        return "wrenches" if part == "task_directions" else "torques"

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


def written(
    quantity: Quantity, counts: SummaryCounts, twelve: TwelveCounts | None, listing: Listing | None
) -> Written | str:
    """How lanes write a quantity; or why only the reference path does.

    Args:
        quantity: The quantity.
        counts: The summary counts of all lanes that are certain.
        twelve: All twelve counts of lanes that are certain of them; None where none is.
        listing: What its ellipsoid lists; None where lanes do not know it.
    """
    if quantity.name == "counts" and twelve is not None:
        return Written(o.COUNTS, same=list(twelve.as_dict().values()))
    if quantity.kind is None:
        return _of_model(quantity, counts)
    if listing is None:
        return f"{quantity.name} is not computed in lanes"
    if quantity.part in INDICES:
        return _of_index(quantity, listing)
    if quantity.part in ("task_directions", "motor_directions"):
        return _of_directions(quantity, listing)
    if quantity.part == "classes":
        codes = [CLASS_CODES["infinite"]] * listing.infinite + [CLASS_CODES["finite"]] * listing.finite
        codes += [CLASS_CODES["zero"]] * listing.zero
        return Written(same=codes + [NO_CLASS] * (quantity.shape[0] - len(codes)))
    if quantity.part in ("smallest", "largest"):
        if not listing.finite:
            return Written(pieces=(Piece("nothing", 0, 1, 0),))
        place = 0 if quantity.part == "largest" else listing.finite - 1
        return Written(listing.needed, (Piece(listing.section, place, 1, 0),))
    if quantity.part == "bounds":
        return Written(o.BOUNDS, _row(listing, "bounds", "zero", quantity.shape[0]))
    return Written(listing.needed, _row(listing, listing.section, "infinity", quantity.shape[0]))


def _row(listing: Listing, section: str, of_infinite: str, width: int) -> tuple[Piece, ...]:
    """Entries of an ellipsoid: infinite, finite, zero, none."""
    last = listing.last + listing.zero
    pieces = (
        Piece(of_infinite, 0, listing.infinite, 0),
        Piece(section, 0, listing.finite, listing.infinite),
        Piece("zero", 0, listing.zero, listing.last),
        Piece("nothing", 0, width - last, last),
    )
    return tuple(piece for piece in pieces if piece.count)


def _of_model(quantity: Quantity, counts: SummaryCounts) -> Written | str:
    if quantity.name == "summary":
        return Written(same=list(counts.as_dict().values()))
    if quantity.name in SUMMARY:
        return Written(same=getattr(counts, quantity.name))
    if quantity.name == "closure.iterations":
        return Written(same=-1)
    if quantity.name == "closure.residual":
        return Written(pieces=(Piece("residual", 0, 1, 0),))
    return f"{quantity.name} is not computed in lanes"


def _of_directions(quantity: Quantity, listing: Listing) -> Written | str:
    side = quantity.part
    rest = listing.infinite if side == "task_directions" else listing.zero
    if rest and listing.kind != "kinematic":
        return f"{quantity.name}: lanes give the directions of finite force efficiencies only"
    entries, size = quantity.shape
    pieces = (
        Piece("nothing", 0, listing.infinite * size, 0),
        Piece(listing.sides(side), 0, listing.finite * size, listing.infinite * size),
        Piece("nothing", 0, (entries - listing.last) * size, listing.last * size),
    )
    kept = tuple(piece for piece in pieces if piece.count)
    if not rest:
        return Written(listing.want, kept)
    # Infinite ones come before the finite ones and have no motor side, zeros behind them and no task side.
    of_rest = slice(0, rest) if side == "task_directions" else slice(listing.last, listing.last + rest)

    def write(raw: RawLanes, out: Block) -> None:
        bases = raw.free if side == "task_directions" else raw.idle
        roots = listing.roots if side == "task_directions" else listing.motor_roots
        out[:, of_rest] = _rest_directions(raw, bases, roots)

    return Written(listing.want | o.REST, kept, writer=write)


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


def _of_index(quantity: Quantity, listing: Listing) -> Written | str:
    if listing.infinite:
        return f"{quantity.name}: lanes take indices of bounded ellipsoids only"
    s = 2 if len(listing.roots) == 3 else 3
    chosen = {"translation": slice(0, s), "rotation": slice(s, None), "all": slice(None)}[quantity.on]
    roots = listing.roots[chosen]
    index = INDEX_OF_AXES[quantity.part]
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

    return Written(0, writer=of_all) if quantity.on == "all" else Written(listing.want, writer=of_part)


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


INDEX_OF_AXES: Final[dict[str, Callable[[NDArray[np.float64]], Vector]]] = {
    "yoshikawa_volume": _volume,
    "condition": _condition,
    "condition_number": _condition,
    "inverse_condition_number": lambda axes: 1.0 / _condition(axes),
    "isotropy": _isotropy,
    "smallest_singular_value": lambda axes: np.asarray(axes[:, -1]),
}
"""Indices of N x semi-axes, longest first."""
