"""Running a sweep: every chunk is written, synced, then recorded as done; never the other way round."""

from __future__ import annotations

import json
import shutil
import signal
import threading
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from vincula.errors import SweepError
from vincula.kernels.evaluation import FAILED, STATUS_NAMES
from vincula.sweep.executors import Executor, Outcome, Task
from vincula.sweep.finishing import finish
from vincula.sweep.ledger import Ledger, Reason, Record
from vincula.sweep.lock import SweepLock
from vincula.sweep.progress import Progress, Tell, silent
from vincula.sweep.recorded import differences, refuse_differences, trusted
from vincula.sweep.starts import coarse_path
from vincula.sweep.storage import DurableFolder, StorageRoom, checksum
from vincula.sweep.work import Block

if TYPE_CHECKING:
    from vincula.sweep.dataset import SweepData
    from vincula.sweep.sweep import Sweep

GRACE: Final = 10.0
"""Seconds that running chunks are given to finish after an interrupt."""
STARTS_AT_ONCE: Final = 16
"""Starts of chunks that are recorded together."""


@dataclass(frozen=True, slots=True)
class Places:
    """The files of a sweep.

    Attributes:
        data: The data set, a folder.
    """

    data: Path

    @property
    def ledger(self) -> Path:
        """The ledger."""
        return self.data.with_name(self.data.name + ".ledger")

    @property
    def lock(self) -> Path:
        """The lock."""
        return self.data.with_name(self.data.name + ".lock")

    @property
    def aside(self) -> Path:
        """Where a file is while it is being written."""
        return self.data.with_name(self.data.name + ".partial")

    def shard(self, share: tuple[int, int]) -> Places:
        """The files of one share."""
        return Places(self.data.with_name(f"{self.data.name}.shard-{share[0]}-of-{share[1]}"))


def run(
    sweep: Sweep,
    target: Path,
    executor: Executor,
    *,
    shard: tuple[int, int] | None = None,
    resume: bool = False,
    overwrite: bool = False,
    tell: Tell | None = None,
) -> SweepData:
    """Compute a sweep and store it; see `Sweep.run`."""
    from vincula.sweep.dataset import SweepData

    places = Places(target.absolute())
    if shard is not None:
        _refuse_bad_share(shard, sweep.chunking.count)
        places = places.shard(shard)
    if not places.data.parent.is_dir():
        raise SweepError(f"{places.data.parent}: there is no such folder", kind="usage")
    try:
        with SweepLock(places.lock, places.data):
            room = StorageRoom(places.data)
            with room.guarded():
                ledger = _opened(sweep, places, shard, resume=resume, overwrite=overwrite)
            with ledger:
                _Run(sweep, places, ledger, room, executor, shard, tell or silent).whole()
    finally:
        executor.close()
    return SweepData(places.data)


def _refuse_bad_share(share: tuple[int, int], chunks: int) -> None:
    i, n = share
    if not 1 <= i <= n:
        raise SweepError(f"share {i}/{n}: say i/n with i from 1 to n", kind="usage")
    if n > chunks:
        raise SweepError(
            f"share {i}/{n}: the sweep has {chunks} chunks only; give fewer shares or smaller chunks",
            kind="usage",
        )


def _opened(
    sweep: Sweep, places: Places, shard: tuple[int, int] | None, *, resume: bool, overwrite: bool
) -> Ledger:
    """The ledger to work with: a new one, or that of the sweep to go on with."""
    manifest = {**sweep.manifest, "shard": list(shard) if shard else None}
    there = places.ledger.exists()
    if overwrite and there:
        shutil.rmtree(places.data, ignore_errors=True)
        places.ledger.unlink()
        there = False
    if resume and there:
        ledger = Ledger(places.ledger)
        try:
            refuse_differences(places.data, differences(ledger.manifest, manifest))
        except SweepError:
            ledger.close()
            raise
        return ledger
    if there:
        raise SweepError(
            f"{places.data}: there is a sweep already; go on with it (resume), or replace it (overwrite)",
            kind="usage",
        )
    if places.data.exists():
        raise SweepError(
            f"{places.data}: there is something already that is no sweep of vincula; choose another output",
            kind="usage",
        )
    return Ledger.create(places.ledger, {**manifest, "source": dict(sweep.source)})


class _Run:
    """One run over the chunks that are not done yet."""

    def __init__(
        self,
        sweep: Sweep,
        places: Places,
        ledger: Ledger,
        room: StorageRoom,
        executor: Executor,
        shard: tuple[int, int] | None,
        tell: Tell,
    ) -> None:
        self._sweep, self._ledger, self._room, self._executor, self._tell = (
            sweep,
            ledger,
            room,
            executor,
            tell,
        )
        self._places = places
        self._folder = DurableFolder(places.data, places.aside)
        self._counts = dict.fromkeys(STATUS_NAMES, 0)
        self._done = self._before = self._failed = 0
        i, n = shard or (1, 1)
        self._own = range(i - 1, sweep.chunking.count, n)
        self._total = sum(self._points(chunk) for chunk in self._own)

    def whole(self) -> None:
        """Everything from the description of the data set to its last chunk."""
        with self._room.guarded():
            self._folder.tidy()
            for name, content in self._sweep.layout.metadata().items():
                self._folder.write(name, content)
            done = self._checked()
            todo = [chunk for chunk in self._own if chunk not in done]
            self._room.needed = len(todo) * self._sweep.layout.chunk_bytes()
            starts = self._starts()
            with _Interrupts(self._executor) as interrupts:
                self._compute(todo, starts, interrupts)
            if interrupts.seen:
                raise KeyboardInterrupt
            finish(self._places, self._ledger, self._folder)
        self._say("done")

    def _checked(self) -> set[int]:
        """Chunks whose files are what the ledger says; the others, and those that failed, are forgotten."""
        kept, gone = set(), []
        count = self._ledger.count()
        for k, record in enumerate(self._ledger.records()):
            if record.state == "done" and trusted(self._places.data, record):
                kept.add(record.chunk)
                self._count(record)
            else:
                gone.append(record.chunk)
            if k % 16 == 0:
                self._tell(Progress("checking", k, count))
        if gone:
            self._ledger.forget(gone)
        self._before = self._done
        return kept

    def _starts(self) -> dict[int, Any]:
        """Starts of all chunks; those that are not fixed yet are found now, in order, and fixed."""
        if not self._sweep.work.closes:
            return {}
        found: dict[int, Any] = dict(self._ledger.starts())
        count = self._sweep.chunking.count
        while len(found) < count:
            begin = len(found)
            last = found[begin - 1] if begin else None
            more = dict(coarse_path(self._sweep, last, range(begin, min(begin + STARTS_AT_ONCE, count))))
            self._ledger.put_starts(more)
            found |= more
            self._tell(Progress("starts", len(found), count))
        return found

    def _compute(self, todo: list[int], starts: dict[int, Any], interrupts: _Interrupts) -> None:
        self._say("computing")
        for outcomes in self._executor.outcomes(self._tasks(todo, starts)):
            records = [self._stored(outcome) for outcome in outcomes]
            if records:
                self._ledger.put(records)
                for record in records:
                    self._count(record)
                    self._room.needed -= self._sweep.layout.chunk_bytes()
            self._say("computing", stopping=interrupts.seen)
            if interrupts.over():
                return

    def _tasks(self, todo: list[int], starts: dict[int, Any]) -> Iterator[Task]:
        for chunk in todo:
            yield Task(
                chunk, self._sweep.values(chunk), self._sweep.chunking.extent(chunk), starts.get(chunk)
            )

    def _stored(self, outcome: Outcome) -> Record:
        """Write the files of a chunk; what is returned is for the ledger."""
        task, block = outcome.task, outcome.block
        if block is None:
            block = self._failed_block(outcome)
        sums: dict[str, str] = {}
        for name, data in self._sweep.layout.encoded(task.chunk, block, task.values):
            self._folder.write(name, data)
            sums[name] = checksum([data])
        self._folder.sync(tuple(dict.fromkeys(name.rpartition("/")[0] for name in sums)))
        counts = np.bincount(block.arrays["status"].ravel(), minlength=len(STATUS_NAMES))
        told = dict(zip(STATUS_NAMES, map(int, counts), strict=True))
        reasons = tuple(Reason(*entry) for entry in block.reasons)
        if outcome.block is None:
            return Record(
                task.chunk, "failed", sums, told, outcome.error, _inputs_of(self._sweep, task), reasons
            )
        return Record(task.chunk, "done", sums, told, reasons=reasons)

    def _failed_block(self, outcome: Outcome) -> Block:
        count = len(outcome.task.values)
        arrays = {quantity.name: quantity.empty(count) for quantity in self._sweep.quantities}
        arrays["status"][:] = FAILED
        return Block(arrays, ((0, count - 1, outcome.error),))

    def _points(self, chunk: int) -> int:
        return int(np.prod(self._sweep.chunking.extent(chunk)))

    def _count(self, record: Record) -> None:
        self._done += self._points(record.chunk)
        self._failed += record.state == "failed"
        for name, count in record.counts.items():
            self._counts[name] += count

    def _say(self, stage: Any, *, stopping: bool = False) -> None:
        self._tell(
            Progress(
                stage, self._done, self._total, self._before, self._executor.running, self._failed,
                dict(self._counts), stopping,
            )
        )  # fmt: skip


def _inputs_of(sweep: Sweep, task: Task) -> str:
    """What a failed chunk was given, for repeating it: `Sweep.block(chunk)` does."""
    names = sweep.points.variables
    low, high = task.values.min(axis=0), task.values.max(axis=0)
    ranges = {name: [float(a), float(b)] for name, a, b in zip(names, low, high, strict=True)}
    start = None if task.start is None else [float(value) for value in task.start]
    return json.dumps({"chunk": task.chunk, "points": len(task.values), "ranges": ranges, "start": start})


class _Interrupts:
    """Ctrl-C ends a run in order: no new chunks, a few seconds for the running ones, the ledger whole."""

    def __init__(self, executor: Executor) -> None:
        self._executor = executor
        self._deadline = float("inf")
        self._old: Any = None
        self.seen = False

    def __enter__(self) -> _Interrupts:
        if threading.current_thread() is threading.main_thread():
            self._old = signal.signal(signal.SIGINT, self._interrupted)
        return self

    def __exit__(self, *_: object) -> None:
        if self._old is not None:
            signal.signal(signal.SIGINT, self._old)

    def _interrupted(self, _number: int, _frame: FrameType | None) -> None:
        # A second one drops what runs; the ledger is written in one piece all the same.
        self._deadline = time.monotonic() + (0.0 if self.seen else GRACE)
        self.seen = True
        self._executor.stop()

    def over(self) -> bool:
        """Whether running chunks have had their time."""
        return time.monotonic() > self._deadline
