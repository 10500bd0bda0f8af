"""Both readings of a file: its numbers as typed, and as what they probably mean."""

from __future__ import annotations

import io
from collections.abc import Callable
from contextlib import redirect_stderr
from dataclasses import replace
from typing import TYPE_CHECKING

from vincula.errors import ClosureError, VinculaError
from vincula.numerics.evidence import Reading

if TYPE_CHECKING:
    from vincula.cli.subject import Subject
    from vincula.model import LinearModel

MOST = 4
"""Numbers that the refusal of an open loop names."""


def model_with_readings(subject: Subject, meant: Callable[[], Subject]) -> LinearModel:
    """The linear model of a subject that knows what other readings of its numbers lead to.

    Args:
        subject: What is analysed.
        meant: Reads the same with numbers as what they probably mean.

    Raises:
        BadOptionError: No reference member.
        ClosureError: A loop is open; tells whether it is closed with the numbers as they may be meant.
    """
    if subject.report.snapped:
        model = subject.linearize()
        return replace(model, evidence=replace(model.evidence, snapped=tuple(subject.report.snapped)))
    try:
        model = subject.linearize()
    except ClosureError as error:
        raise _with_other_reading(error, _other_reading(meant)) from None
    known = subject.mechanism.precision
    # Where every number of the file is exact there is nothing else to be meant.
    reading = _other_reading(meant) if known.digits_length or known.digits_angle else None
    return model if reading is None else replace(model, evidence=replace(model.evidence, reading=reading))


def closed_subject(read: Callable[[bool], Subject], *, snap: bool) -> Subject:
    """The subject; where it cannot be closed, whether it can with numbers as they may be meant is told.

    Args:
        read: Reads it, with numbers as typed (False) or as meant (True).
        snap: Which of the two is asked for.

    Raises:
        ClosureError: It cannot be closed.
    """
    try:
        return read(snap)
    except ClosureError as error:
        raise (error if snap else _with_other_reading(error, _other_reading(lambda: read(True)))) from None


def _other_reading(meant: Callable[[], Subject]) -> Reading | None:
    """What the numbers as they may be meant lead to; None where they mean what they say."""
    try:
        # What the first reading told of closing need not be told again.
        with redirect_stderr(io.StringIO()):
            other = meant()
            if not other.report.snapped:
                return None
            numbers = tuple(other.report.snapped)
            return Reading(numbers, other.linearize().ledger.summary)
    except VinculaError as error:
        return Reading((), None, str(error))


def _with_other_reading(error: ClosureError, reading: Reading | None) -> ClosureError:
    if reading is None or reading.summary is None:
        return error
    numbers = "; ".join(reading.snapped[:MOST])
    more = f"; and {len(reading.snapped) - MOST} more" if len(reading.snapped) > MOST else ""
    text = (
        f"{error} With the numbers as typed it is open; it is closed, with mobility "
        f"{reading.summary.mobility}, if {numbers}{more}: --snap reads them so."
    )
    return ClosureError(text, loop=error.loop, gap=error.gap, **error.details)
