"""Progress of a sweep on stderr: a bar with rate and time left, or a line now and then."""

from __future__ import annotations

import time
from types import TracebackType
from typing import TYPE_CHECKING, Any, Final

import click

if TYPE_CHECKING:
    from vincula.sweep.progress import Progress, Stage

SECONDS: Final = 10.0
"""Between two lines, where there is no terminal."""
_WORDS: Final[dict[Stage, str]] = {
    "checking": "checking what is there",
    "starts": "starts of chunks",
    "computing": "points",
    "done": "points",
}


class ProgressOnStderr:
    """Shows how far a sweep is; use it as a context manager and hand it to `Sweep.run`.

    Args:
        quiet: Show nothing.
    """

    def __init__(self, *, quiet: bool = False) -> None:
        self._quiet = quiet
        self._bar: Any = None
        self._task: Any = None
        self._stage = ""
        self._began = self._told = 0.0

    def __enter__(self) -> ProgressOnStderr:
        from rich.console import Console
        from rich.progress import BarColumn, Progress, TextColumn

        console = Console(stderr=True)
        if not self._quiet and console.is_terminal:
            columns = (TextColumn("{task.description}"), BarColumn(), TextColumn("{task.fields[words]}"))
            self._bar = Progress(*columns, console=console)
            self._bar.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._bar is not None:
            self._bar.stop()

    def __call__(self, progress: Progress) -> None:
        """Show it."""
        if self._quiet:
            return
        now = time.monotonic()
        fresh = progress.stage != self._stage
        if fresh:
            self._stage = progress.stage
            self._began = self._began if progress.stage == "done" else now
        words = self._sentence(progress, now - self._began)
        if self._bar is None:
            if (fresh and progress.stage in ("computing", "done")) or now - self._told > SECONDS:
                self._told = now
                click.echo(f"{_WORDS[progress.stage]}: {words}", err=True)
            return
        if self._task is None or fresh:
            if self._task is not None:
                self._bar.remove_task(self._task)
            self._task = self._bar.add_task(_WORDS[progress.stage], words=words)
        self._bar.update(self._task, completed=progress.done, total=max(progress.total, 1), words=words)

    def _sentence(self, progress: Progress, seconds: float) -> str:
        share = 100.0 * progress.done / progress.total if progress.total else 100.0
        parts = [f"{progress.done} of {progress.total} ({share:.3g} %)"]
        fresh = progress.done - progress.before
        if fresh > 0 and seconds > 0.0 and progress.stage != "checking":
            rate = fresh / seconds
            parts.append(f"{rate:.4g} a second")
            if progress.done < progress.total:
                parts.append(f"{_duration((progress.total - progress.done) / rate)} left")
        if progress.failed:
            parts.append(f"{progress.failed} chunks failed")
        if progress.stopping:
            parts.append(f"finishing {progress.running} chunks; Ctrl-C again drops them")
        return ", ".join(parts)


def _duration(seconds: float) -> str:
    whole = round(seconds)
    hours, minutes = whole // 3600, whole // 60 % 60
    return f"{hours}:{minutes:02d}:{whole % 60:02d}" if hours else f"{minutes}:{whole % 60:02d}"
