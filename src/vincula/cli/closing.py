"""`--close`: the loops closed before anything is computed, and what that moved told on stderr."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from vincula.cli.output import tell
from vincula.errors import ClosureError

if TYPE_CHECKING:
    from vincula.mechanism.closed import ClosedConfiguration
    from vincula.mechanism.configuration import Configuration
    from vincula.mechanism.mechanism import Mechanism

MOST: Final = 8
"""Axes that are named as moved."""


def closed_near(
    mechanism: Mechanism, start: Configuration, drawn: Mechanism, at: str | None
) -> Configuration:
    """A closed configuration near the start; the start itself where it is closed.

    Joints named in an `--at NAME=VALUE` text are held where they were put; where it cannot be closed
    like that they are let go, and that is told.

    Args:
        mechanism: What is closed.
        start: Where to start.
        drawn: The mechanism of the file, before another body became its ground.
        at: CONFIG as it was written.

    Raises:
        ClosureError: It cannot be closed at all.
    """
    named = [name for name in _named(drawn, at) if name in mechanism.home]
    try:
        q = mechanism.close(start, motors={name: start[name] for name in named})
    except ClosureError as error:
        if not named:
            raise
        q = mechanism.close(start)
        tell([f"{', '.join(named)} could not stay at the values of --at, closed near them instead: {error}"])
    moved = _moved(q)
    if moved:
        tell([f"closing moved {moved}"])
    return q


def _named(mechanism: Mechanism, at: str | None) -> list[str]:
    """Joints of a `name=value,...` text; none for a file or keyframe, which are starts as a whole."""
    from vincula.files.configuration import assignments, is_text
    from vincula.files.joint_values import JointValues
    from vincula.files.units import SI

    if at is None or not is_text(at):
        return []
    values = JointValues(mechanism, SI)
    return list(dict.fromkeys(values.joint_of(name)[0].name for name in assignments(at)))


def _moved(q: ClosedConfiguration) -> str:
    """The axes that closing moved most."""
    moved = {name: value for name, value in q.moved.items() if abs(value) > 1e-9}
    order = sorted(moved, key=lambda name: -abs(moved[name]))
    shown = [f"{name} by {moved[name]:.4g}" for name in order[:MOST]]
    more = f" and {len(order) - MOST} more" if len(order) > MOST else ""
    return ", ".join(shown) + more
