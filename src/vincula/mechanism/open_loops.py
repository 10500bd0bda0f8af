"""What can be said of an open configuration: the closest closed one, or why there is none."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from vincula.errors import ClosureError
from vincula.mechanism.closed import ClosedConfiguration
from vincula.mechanism.closure import close
from vincula.mechanism.configuration import Configuration

if TYPE_CHECKING:
    from vincula.mechanism.mechanism import Mechanism

FAR: Final = 1.0
"""An axis that must move by more than this [rad, or lengths L] says that the start was no typing error."""
MOST: Final = 6
"""Axes that are named."""


def closest_closed(mechanism: Mechanism, q: Configuration) -> tuple[ClosedConfiguration | None, str]:
    """The closed configuration nearest to an open one that was found, and a sentence about it.

    Args:
        mechanism: The mechanism.
        q: An open configuration.

    Returns:
        The configuration, None where none was found, and what a user should know.
    """
    try:
        found = close(mechanism, q, attempts=5)
    except ClosureError as error:
        reasons = error.details.get("lengths")
        why = ". ".join(map(str, reasons)) if isinstance(reasons, tuple) and reasons else ""
        text = f"It cannot be closed from here: at best {error.gap:.3g} m are missing."
        return None, f"{text} {why}." if why else text
    moved = {name: value for name, value in found.moved.items() if abs(value) > 1e-9}
    order = sorted(moved, key=lambda name: -abs(moved[name]))
    shown = ", ".join(f"{name} by {moved[name]:+.4g}" for name in order[:MOST])
    more = f" and {len(order) - MOST} more" if len(order) > MOST else ""
    text = f"The closest closed configuration found moves {shown}{more}"
    if order and abs(moved[order[0]]) > FAR * max(1.0, mechanism.length):
        text += ": far away, perhaps another assembly mode is meant"
    return found, text + "."
