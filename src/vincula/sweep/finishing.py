"""The end of a sweep: why points are not ok, gathered into the data set in an order of its own."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import TYPE_CHECKING, Final

from vincula.sweep.layout import with_reasons
from vincula.sweep.ledger import Ledger, Reason
from vincula.sweep.storage import DurableFolder

if TYPE_CHECKING:
    from vincula.sweep.running import Places

_NUMBER: Final = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w])")
TOLD: Final = 100
"""Different reasons that the data set tells; the ledger keeps more."""


def gathered(reasons: Iterable[Reason]) -> dict[str, int]:
    """Number of points by kind of reason, for the first hundred kinds.

    A kind is the first sentence with its numbers left out; the ledger has every text in full.
    """
    found: dict[str, int] = {}
    for reason in reasons:
        kind = _NUMBER.sub("...", reason.text.partition(". ")[0])
        if kind in found or len(found) < TOLD:
            found[kind] = found.get(kind, 0) + reason.last - reason.first + 1
    return found


def finish(places: Places, ledger: Ledger, folder: DurableFolder) -> bool:
    """Complete the description of a data set when all its chunks are there; whether they are.

    Shares of a sweep stay as they are: their reasons are gathered when they are merged.

    Raises:
        OSError: It cannot be written.
    """
    if ledger.count() < ledger.manifest["chunks"]:
        return False
    reasons = gathered(reason for record in ledger.records() for reason in record.reasons)
    if reasons:
        root, status = places.data / "zarr.json", places.data / "status" / "zarr.json"
        whole, own = with_reasons(root.read_bytes(), status.read_bytes(), reasons)
        folder.write("status/zarr.json", own)
        folder.write("zarr.json", whole)
    folder.sync(("", "status"))
    folder.tidy()
    return True
