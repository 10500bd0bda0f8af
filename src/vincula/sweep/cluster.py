"""Workers of a dask cluster: chunks handed out in waves, so that the scheduler never sees the whole sweep."""

from __future__ import annotations

import pickle
import queue
import time
from collections.abc import Iterator
from functools import lru_cache
from importlib import import_module
from typing import Any, Final

from vincula.errors import MissingExtraError, SweepError
from vincula.sweep.executors import TICK, Executor, Outcome, Task
from vincula.sweep.processes import TRIES, payload_of
from vincula.sweep.sweep import code_version
from vincula.sweep.work import Block, Work

WAVE: Final = 3
"""Chunks handed out for every thread of a worker."""
PATIENCE: Final = 30.0
"""Seconds to wait for a scheduler, and for its first worker."""


class ClusterExecutor(Executor):
    """Workers of `dask.distributed`.

    The mechanism travels with every chunk (some kilobytes) and is unpacked once a worker, so that workers
    may come and go.

    Args:
        work: What all chunks have in common.
        scheduler: Address of the scheduler, `tcp://host:8786`.
        hang_after: Seconds after which a chunk that runs counts as hung; without it only the scheduler
            decides that a worker is lost.

    Raises:
        MissingExtraError: dask.distributed is not installed.
        SweepError: The scheduler does not answer.
    """

    def __init__(self, work: Work, scheduler: str, hang_after: float | None = None) -> None:
        try:
            self._dask: Any = import_module("distributed")
        except ImportError:
            raise MissingExtraError("distributed", "dask", "a sweep on a dask cluster") from None
        self._payload = payload_of(work)
        self._hang_after = hang_after
        try:
            self._client = self._dask.Client(scheduler, timeout=PATIENCE, set_as_default=False)
            self._client.wait_for_workers(1, timeout=PATIENCE)
        except (OSError, TimeoutError, ValueError) as error:
            raise SweepError(
                f"{scheduler}: no dask scheduler with workers answers there ({error})", kind="usage"
            ) from None
        self._stopped = False
        self._flying: dict[Any, Task] = {}
        self._began: dict[Any, float] = {}
        self._tries: dict[int, int] = {}
        self._done: queue.SimpleQueue[Any] = queue.SimpleQueue()

    def outcomes(self, tasks: Iterator[Task]) -> Iterator[list[Outcome]]:
        """See `Executor`."""
        more = True
        while more or self._flying:
            more = self._fill(tasks, more)
            self.running = len(self._flying)
            if not self._flying:
                break
            yield [found for future in self._ended() if (found := self._outcome(future)) is not None]
            if hung := self._hung():
                yield hung

    def _ended(self) -> Iterator[Any]:
        """Futures that have ended and are still ours, after a moment at most."""
        timeout = TICK
        while True:
            try:
                future = self._done.get(timeout=timeout)
            except queue.Empty:
                return
            timeout = 0.0
            if future in self._flying:
                yield future

    def _fill(self, tasks: Iterator[Task], more: bool) -> bool:
        if self._stopped:
            return False
        threads = sum(self._client.nthreads().values()) if more else 0
        while more and len(self._flying) < max(2, WAVE * threads):
            task = next(tasks, None)
            if task is None:
                return False
            self._submit(task)
        return more

    def _submit(self, task: Task) -> None:
        future = self._client.submit(
            _computed, self._payload, task, pure=False, key=f"chunk-{task.chunk}-{time.monotonic_ns()}"
        )
        self._flying[future], self._began[future] = task, time.monotonic()
        future.add_done_callback(self._done.put)

    def _outcome(self, future: Any) -> Outcome | None:
        task = self._flying.pop(future)
        self._began.pop(future)
        if future.status == "finished":
            try:
                version, block = future.result()
            except (OSError, TimeoutError) as lost:  # its worker died with the answer
                return self._again(task, str(lost))
            if version != code_version():
                raise SweepError(
                    f"a worker of the cluster computes with other versions: {version}, here {code_version()}"
                )
            return Outcome(task, block)
        if future.status == "cancelled" or self._stopped:
            return None if self._stopped else self._again(task, "the scheduler lost it")
        error = future.exception()
        if type(error).__name__ == "KilledWorker":
            # The scheduler has tried it several times already, each with another worker.
            return Outcome(task, None, f"the workers that tried it died: {error}")
        return self._again(task, f"{type(error).__name__}: {error}")

    def _again(self, task: Task, why: str) -> Outcome | None:
        tries = self._tries[task.chunk] = self._tries.get(task.chunk, 0) + 1
        if tries >= TRIES:
            return Outcome(task, None, f"{why}, {tries} times")
        self._submit(task)
        return None

    def _hung(self) -> list[Outcome]:
        if self._hang_after is None:
            return []
        found = []
        now = time.monotonic()
        running = {key for keys in self._client.processing().values() for key in keys}
        for future in [f for f, began in self._began.items() if now - began > self._hang_after]:
            if future.key in running:
                task = self._flying.pop(future)
                self._began.pop(future)
                future.cancel()
                outcome = self._again(task, f"no answer for {self._hang_after:.0f} s")
                found += [outcome] if outcome is not None else []
        return found

    def stop(self) -> None:
        """See `Executor`."""
        self._stopped = True

    def close(self) -> None:
        """See `Executor`."""
        if self._flying:
            self._client.cancel(list(self._flying))
        self._client.close()


@lru_cache(maxsize=4)
def _unpacked(payload: bytes) -> Work:
    work: Work = pickle.loads(payload)  # noqa: S301  packed by the process that gave us the task
    return work


def _computed(payload: bytes, task: Task) -> tuple[str, Block]:
    """What a worker does; its versions come with the answer."""
    block = _unpacked(payload).evaluate(task.values, task.extent, task.start)
    return code_version(), block
