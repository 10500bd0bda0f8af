"""How far a sweep is, for whoever shows it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Literal

Stage = Literal["checking", "starts", "computing", "done"]


@dataclass(frozen=True, slots=True)
class Progress:
    """How far a sweep is.

    Attributes:
        stage: `checking` what is there, finding `starts`, `computing`, or `done`.
        done: Points computed, or starts found, or chunks checked.
        total: Of how many.
        before: How many were there before this run.
        running: Chunks that are being computed.
        failed: Chunks that failed.
        counts: Points by status.
        stopping: Whether an interrupt has been seen and running chunks are being finished.
    """

    stage: Stage
    done: int
    total: int
    before: int = 0
    running: int = 0
    failed: int = 0
    counts: Mapping[str, int] = field(default_factory=dict)
    stopping: bool = False


Tell = Callable[[Progress], None]
"""Shows progress."""


def silent(_: Progress) -> None:
    """Shows nothing."""
