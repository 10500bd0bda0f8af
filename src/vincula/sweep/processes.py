"""Worker processes that may die or hang: each chunk gets a second try, with another worker."""

from __future__ import annotations

import contextlib
import os
import pickle
import queue
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

from vincula.errors import ModelError
from vincula.sweep.executors import TICK, Executor, Outcome, Task
from vincula.sweep.work import Work
from vincula.sweep.worker import HEAD, receive

TRIES: Final = 2
"""How often a chunk is tried before it counts as failed."""
PATIENCE: Final = 300.0
"""Seconds that any chunk may take, by default, beside twenty times the slowest one so far."""


class _Worker:
    """One process, the threads that speak and listen to it, and the task it is at."""

    def __init__(self, payload: bytes, answers: queue.SimpleQueue[tuple[_Worker, Any]]) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-m", "vincula.sweep.worker"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env=_environment(),
            cwd=os.path.sep if os.name == "posix" else None,
        )
        self.task: Task | None = None
        self.began = 0.0
        self._answers = answers
        self._said: queue.SimpleQueue[bytes | None] = queue.SimpleQueue()
        self._said.put(payload)
        # A pipe to a worker that hangs takes no more bytes: only a thread of its own may wait for it.
        threading.Thread(target=self._speak, daemon=True, name="sweep-speaker").start()
        threading.Thread(target=self._listen, daemon=True, name="sweep-listener").start()

    def begin(self, task: Task) -> None:
        """Hand it a task."""
        self.task, self.began = task, time.monotonic()
        self._said.put(pickle.dumps(task, protocol=5))

    def end(self) -> None:
        """Kill it, whatever it does."""
        self._said.put(None)
        with contextlib.suppress(OSError):
            self._process.kill()
        self._process.wait()

    def death(self) -> str:
        """How it died."""
        try:
            code = self._process.wait(timeout=10.0)
        except subprocess.TimeoutExpired:
            return "its worker stopped answering"
        return f"its worker was ended by signal {-code}" if code < 0 else f"its worker ended with code {code}"

    def _speak(self) -> None:
        stream: Any = self._process.stdin
        with contextlib.suppress(OSError, ValueError):  # its death is noticed by the listener
            while (message := self._said.get()) is not None:
                stream.write(HEAD.pack(len(message)))
                stream.write(message)
                stream.flush()
        with contextlib.suppress(OSError, ValueError):
            stream.close()

    def _listen(self) -> None:
        stream: Any = self._process.stdout
        while True:
            try:
                answer = receive(stream)
            except (OSError, ValueError, EOFError, pickle.UnpicklingError):
                answer = None
            self._answers.put((self, answer))
            if answer is None:
                stream.close()
                return


def _environment() -> dict[str, str]:
    """This process's environment, one thread for linear algebra, and the same places to import from."""
    paths = dict.fromkeys(str(Path(path).absolute()) for path in sys.path)
    one_thread = dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"), "1")
    return {**os.environ, **one_thread, "PYTHONPATH": os.pathsep.join(paths)}


class ProcessExecutor(Executor):
    """Worker processes of this machine.

    Args:
        work: What all chunks have in common.
        jobs: Number of processes.
        hang_after: Seconds after which a worker counts as hung; by default five minutes and twenty
            times the slowest chunk so far.

    Raises:
        ModelError: The mechanism is built by a function that other processes cannot import.
    """

    def __init__(self, work: Work, jobs: int, hang_after: float | None = None) -> None:
        self._payload = payload_of(work)
        self._jobs, self._hang_after = jobs, hang_after
        self._answers: queue.SimpleQueue[tuple[_Worker, Any]] = queue.SimpleQueue()
        self._workers: list[_Worker] = []
        self._again: list[Task] = []
        self._tries: dict[int, int] = {}
        self._slowest = 0.0
        self._stopped = False

    def outcomes(self, tasks: Iterator[Task]) -> Iterator[list[Outcome]]:
        """See `Executor`."""
        more = True
        while True:
            more = self._fill(tasks, more)
            busy = [worker for worker in self._workers if worker.task is not None]
            self.running = len(busy)
            if not busy and not more and not self._again:
                return
            yield self._collect()

    def _fill(self, tasks: Iterator[Task], more: bool) -> bool:
        """Hand tasks to idle workers, new ones where some died; whether there may be more tasks."""
        if self._stopped:
            self._again.clear()
            return False
        while sum(worker.task is not None for worker in self._workers) < self._jobs:
            task = self._again.pop() if self._again else next(tasks, None) if more else None
            if task is None:
                return False
            idle = next((worker for worker in self._workers if worker.task is None), None)
            if idle is None:
                idle = _Worker(self._payload, self._answers)
                self._workers.append(idle)
            idle.begin(task)
        return more

    def _collect(self) -> list[Outcome]:
        found: list[Outcome] = []
        timeout = TICK
        while True:
            try:
                worker, answer = self._answers.get(timeout=timeout)
            except queue.Empty:
                break
            timeout = 0.0
            if worker not in self._workers:
                continue  # its task was given up already
            found += self._died(worker, worker.death()) if answer is None else self._answered(worker, answer)
        for worker in [worker for worker in self._workers if self._hangs(worker)]:
            worker.end()
            seconds = time.monotonic() - worker.began
            found += self._died(worker, f"its worker gave no answer for {seconds:.0f} s")
        return found

    def _answered(self, worker: _Worker, answer: Any) -> list[Outcome]:
        chunk, block, error = answer
        task, worker.task = worker.task, None
        if task is None or task.chunk != chunk:
            return []
        self._slowest = max(self._slowest, time.monotonic() - worker.began)
        return [Outcome(task, block, error)]

    def _died(self, worker: _Worker, how: str) -> list[Outcome]:
        self._workers.remove(worker)
        worker.end()
        task = worker.task
        if task is None:
            return []
        tries = self._tries[task.chunk] = self._tries.get(task.chunk, 0) + 1
        if tries < TRIES and not self._stopped:
            self._again.append(task)
            return []
        return [Outcome(task, None, f"{how}, {tries} times")] if tries >= TRIES else []

    def _hangs(self, worker: _Worker) -> bool:
        if worker.task is None:
            return False
        limit = self._hang_after or PATIENCE + 20.0 * self._slowest
        return time.monotonic() - worker.began > limit

    def stop(self) -> None:
        """See `Executor`."""
        self._stopped = True

    def close(self) -> None:
        """See `Executor`."""
        for worker in self._workers:
            worker.end()
        self._workers.clear()


def payload_of(work: Work) -> bytes:
    """The work as bytes for another process.

    Raises:
        ModelError: The mechanism is built by a function that other processes cannot import.
    """
    build = work.compiled.build
    try:
        data = pickle.dumps(work, protocol=5)
    except (pickle.PicklingError, AttributeError, TypeError) as error:
        raise ModelError(
            f"other processes cannot be given this mechanism ({error}): define the function that builds it "
            "at the top of a module that they can import, or use threads"
        ) from None
    if build is not None and getattr(build, "__module__", "") == "__main__":
        raise ModelError(
            "the function that builds the mechanism is defined in the program itself, which other processes "
            "cannot import: put it into a module, or use threads"
        )
    return data
