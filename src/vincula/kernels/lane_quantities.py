"""From what lanes give to the quantities of a batch: how every quantity is written.

Lanes give the finite efficiencies with their pairs of directions; how many infinite and zero ones there
are is the same in all lanes that are certain.  So most numbers go straight from a kernel to their place in
the result, and integers are the same in all lanes; the others are computed from these, block by block (see
`lane_spectra` and `lane_indices`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from vincula.analysis.ellipsoid import Ellipsoid, Kind
from vincula.kernels.lanes import outputs as o
from vincula.kernels.quantities import CLASS_CODES, INDICES, NO_CLASS, SUMMARY, Quantity
from vincula.numerics.counts import SummaryCounts, TwelveCounts

if TYPE_CHECKING:
    from vincula.kernels.lane_block import LaneBlock
    from vincula.kernels.lane_spectra import LaneRelation

Block = NDArray[Any]
Writer = Callable[["LaneBlock", Block], None]
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


@dataclass(frozen=True, eq=False)
class Listing:
    """What an ellipsoid lists in every lane that is certain: infinite, finite, zero, undefined efficiencies.

    Attributes:
        sample: The ellipsoid at a configuration that stands for all.
        direct: Whether kernels give its finite efficiencies.
        relation: What gives everything about it; or why lanes do not.
    """

    sample: Ellipsoid
    direct: bool
    relation: Callable[[], LaneRelation | str]

    @property
    def kind(self) -> Kind:
        """Which of the five ellipsoids."""
        return self.sample.kind

    @cached_property
    def infinite(self) -> int:
        """Number of infinite efficiencies, which come first."""
        return self.sample.classes.count("infinite")

    @cached_property
    def finite(self) -> int:
        """Number of finite ones."""
        return self.sample.classes.count("finite")

    @cached_property
    def zero(self) -> int:
        """Number of zeros."""
        return self.sample.classes.count("zero")

    @cached_property
    def codes(self) -> list[int]:
        """Classes of all entries."""
        return [CLASS_CODES[name] for name in self.sample.classes]

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


def written(
    quantity: Quantity, counts: SummaryCounts, twelve: TwelveCounts | None, listing: Listing | None
) -> Written | str:
    """How lanes write a quantity; or why only the reference path does.

    Args:
        quantity: The quantity.
        counts: The summary counts of all lanes that are certain.
        twelve: All twelve counts of lanes that are certain of them; None where none is.
        listing: What its ellipsoid lists; None for quantities of no ellipsoid.
    """
    if quantity.name == "counts" and twelve is not None:
        return Written(o.COUNTS, same=list(twelve.as_dict().values()))
    if listing is None:
        return _of_model(quantity, counts)
    if quantity.part == "classes":
        return Written(same=listing.codes + [NO_CLASS] * (quantity.shape[0] - len(listing.codes)))
    if quantity.part in INDICES:
        from vincula.kernels.lane_indices import index_written  # numba is there: this is for lanes

        return index_written(quantity, listing)
    if not listing.codes:
        size = int(np.prod(quantity.shape, dtype=np.int64))
        return Written(pieces=(Piece("nothing", 0, size, 0),) if size else ())
    straight = _straight(quantity, listing) if listing.direct else None
    if straight is not None:
        return straight
    relation = listing.relation()
    return relation if isinstance(relation, str) else _of_relation(quantity, listing, relation)


def _straight(quantity: Quantity, listing: Listing) -> Written | None:
    """What a kernel writes by itself; None for the rest."""
    if quantity.part in ("task_directions", "motor_directions"):
        return _of_directions(quantity, listing)
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
    return "it is not computed in lanes"


def _of_directions(quantity: Quantity, listing: Listing) -> Written | None:
    """Directions of finite efficiencies; None where others have this side, too."""
    if listing.infinite if quantity.part == "task_directions" else listing.zero:
        return None
    entries, size = quantity.shape
    pieces = (
        Piece("nothing", 0, listing.infinite * size, 0),
        Piece(listing.sides(quantity.part), 0, listing.finite * size, listing.infinite * size),
        Piece("nothing", 0, (entries - listing.last) * size, listing.last * size),
    )
    return Written(listing.want, tuple(piece for piece in pieces if piece.count))


def _of_relation(quantity: Quantity, listing: Listing, relation: LaneRelation) -> Written:
    """A quantity of an ellipsoid from the spectra of its relation."""
    want = 0 if relation.squeezing is not None else o.MOTIONS | o.REST
    finite = slice(listing.infinite, listing.last)

    def efficiencies(block: LaneBlock, out: Block) -> None:
        out[...] = _LISTED[listing.codes + [NO_CLASS] * (out.shape[1] - len(listing.codes))]
        out[:, finite] = relation.spectra(block).ratios ** 2

    def extreme(block: LaneBlock, out: Block) -> None:
        ratios = relation.spectra(block).ratios
        out[:] = ratios[:, 0 if quantity.part == "largest" else -1] ** 2 if listing.finite else np.nan

    def directions(block: LaneBlock, out: Block) -> None:
        found, task = relation.spectra(block), quantity.part == "task_directions"
        out[...] = np.nan
        out[:, finite] = found.task if task else found.motor
        if task:
            out[:, : listing.infinite] = found.infinite[:, : listing.infinite]
        elif listing.zero:
            out[:, listing.last : listing.last + listing.zero] = found.zero

    def bounds(block: LaneBlock, out: Block) -> None:
        efficiencies(block, out)
        out[np.isinf(out)] = 0.0
        out[:, finite] = relation.bounds(block)

    writers: dict[str, Writer] = {
        "efficiencies": efficiencies, "smallest": extreme, "largest": extreme, "task_directions": directions,
        "motor_directions": directions, "bounds": bounds,
    }  # fmt: skip
    return Written(want, writer=writers[quantity.part])


_LISTED: Final = np.array([0.0, np.nan, np.inf, np.nan, np.nan])
"""Efficiencies by class code, without the finite ones; the last is for no class."""
