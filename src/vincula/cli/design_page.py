"""What `vincula design` shows: progress while it searches, and the result in words."""

from __future__ import annotations

import sys
import time
from types import TracebackType
from typing import TYPE_CHECKING, Final

import click

if TYPE_CHECKING:
    from vincula.design.asking import Step
    from vincula.design.front import Front
    from vincula.design.judged import Judged
    from vincula.design.landscape import Landscape
    from vincula.design.optimum import Optimum

SECONDS: Final = 10.0
"""Between two lines, where there is no terminal."""


class ProgressLine:
    """One line on a terminal's stderr that is written over; elsewhere a line now and then.

    Args:
        quiet: Show nothing.
    """

    def __init__(self, *, quiet: bool = False) -> None:
        self._quiet, self._terminal = quiet, sys.stderr.isatty()
        self._told = time.monotonic()
        self._open = False

    def __enter__(self) -> ProgressLine:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._open:
            click.echo("", err=True)

    def __call__(self, step: Step) -> None:
        """Show it."""
        now = time.monotonic()
        if self._quiet or now - self._told < (0.2 if self._terminal else SECONDS):
            return
        self._told = now
        best = "none feasible yet" if step.best is None else f"best {step.best:.6g}"
        words = f"{step.stage}: {step.evaluated} of at most {step.total} designs, {best}"
        click.echo(f"\r{words}   " if self._terminal else words, err=True, nl=not self._terminal)
        self._open = self._terminal


def text_of(found: Optimum | Landscape | Front) -> str:
    """The result in words."""
    from vincula.design.landscape import Landscape
    from vincula.design.reporting import landscape_text

    return landscape_text(found) if isinstance(found, Landscape) else str(found)


def everything_of(found: Optimum | Landscape | Front) -> Judged:
    """Every design that was evaluated."""
    from vincula.design.landscape import Landscape

    return found.judged if isinstance(found, Landscape) else found.everything
