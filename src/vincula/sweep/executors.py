"""Who computes the chunks: threads of this process, or whatever else can be handed a work unit."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from dataclasses import dataclass
from typing import Final

from vincula.arrays import Matrix, Vector
from vincula.errors import ModelError
from vincula.kernels.lanes.threads import cores
from vincula.sweep.work import Block, Work

TICK: Final = 0.2
"""Seconds between looks at interrupts and progress."""


@dataclass(frozen=True, slots=True, eq=False)
class Task:
    """One chunk to be computed.

    Attributes:
        chunk: Its number.
        values: Its points, one row a point.
        extent: Points along every dimension.
        start: Where closing starts.
    """

    chunk: int
    values: Matrix
    extent: tuple[int, ...]
    start: Vector | None


@dataclass(frozen=True, slots=True, eq=False)
class Outcome:
    """What became of a task.

    Attributes:
        task: The task.
        block: Its numbers; None when it failed.
        error: Why it failed.
    """

    task: Task
    block: Block | None
    error: str = ""


class Executor(ABC):
    """Computes tasks, a few at a time."""

    running: int = 0
    """Tasks that are being computed or wait for it."""

    @abstractmethod
    def outcomes(self, tasks: Iterator[Task]) -> Iterator[list[Outcome]]:
        """What becomes of the tasks, in any order; an empty list now and then, to look around.

        Tasks are asked for as workers become free, so that only a few exist at any time.  After `stop`
        no more are asked for, and those that run are finished.
        """

    @abstractmethod
    def stop(self) -> None:
        """Begin no more tasks."""

    @abstractmethod
    def close(self) -> None:
        """Drop what still runs and let go of all workers."""


class ThreadExecutor(Executor):
    """Threads of this process: compiled kernels let them run side by side.

    Args:
        work: What all chunks have in common.
        threads: How many; by default one a core.
    """

    def __init__(self, work: Work, threads: int | None = None) -> None:
        self._work = work
        self._threads = threads or cores()
        self._pool = ThreadPoolExecutor(self._threads, thread_name_prefix="sweep")
        self._stopped = False

    def outcomes(self, tasks: Iterator[Task]) -> Iterator[list[Outcome]]:
        """See `Executor`."""
        flying: dict[Future[Block], Task] = {}
        more = True
        while more or flying:
            # One more than there are threads, so that none waits while results are written.
            while more and not self._stopped and len(flying) <= self._threads:
                task = next(tasks, None)
                if task is None:
                    more = False
                    break
                flying[self._pool.submit(self._work.evaluate, task.values, task.extent, task.start)] = task
            if self._stopped:
                more = False
                flying = {future: task for future, task in flying.items() if not future.cancel()}
            self.running = len(flying)
            done, _ = wait(flying, timeout=TICK, return_when=FIRST_COMPLETED)
            yield [_outcome(flying.pop(future), future) for future in done]

    def stop(self) -> None:
        """See `Executor`."""
        self._stopped = True

    def close(self) -> None:
        """Threads cannot be dropped: those that still run are left to themselves."""
        self._pool.shutdown(wait=False, cancel_futures=True)


def _outcome(task: Task, future: Future[Block]) -> Outcome:
    error = future.exception()
    if error is None:
        return Outcome(task, future.result())
    return Outcome(task, None, f"{type(error).__name__}: {error}")


def executor_for(
    work: Work,
    jobs: int | None = None,
    threads: int | None = None,
    scheduler: str | None = None,
    hang_after: float | None = None,
) -> Executor:
    """The executor that was asked for.

    Args:
        work: What all chunks have in common.
        jobs: Worker processes.
        threads: Threads of this process.
        scheduler: Address of a dask scheduler.
        hang_after: Seconds after which a worker counts as hung.

    Raises:
        ModelError: More than one of them, or a number that is none.
        MissingExtraError: dask is not installed.
        SweepError: The scheduler does not answer.
    """
    asked = {"jobs": jobs, "threads": threads, "scheduler": scheduler}
    given = [name for name, value in asked.items() if value is not None]
    if len(given) > 1:
        raise ModelError(f"{' and '.join(given)}: choose one of worker processes, threads and a scheduler")
    for name, count in (("jobs", jobs), ("threads", threads)):
        if count is not None and (isinstance(count, bool) or not isinstance(count, int) or count < 1):
            raise ModelError(f"{name} is {count!r}: give a whole number, 1 or more")
    if hang_after is not None and not hang_after > 0.0:
        raise ModelError(f"hang_after is {hang_after!r}: give a number of seconds")
    if scheduler is not None:
        from vincula.sweep.cluster import ClusterExecutor

        return ClusterExecutor(work, scheduler, hang_after)
    if jobs is not None:
        from vincula.sweep.processes import ProcessExecutor

        return ProcessExecutor(work, jobs, hang_after)
    return ThreadExecutor(work, threads)
