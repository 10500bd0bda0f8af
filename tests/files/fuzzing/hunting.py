"""Feeding damaged files to a reader: what it must not do, and the smallest input that makes it do so."""

from __future__ import annotations

import hashlib
import random
import signal
import time
import traceback
import warnings
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from types import FrameType

from tests.files.fuzzing.mutations import damaged_bytes, damaged_tree, damaged_xml
from tests.files.fuzzing.readers import Reader, Seed, reader

import vincula as vc

SLOWEST = 5.0
"""Seconds of computing after which a reader counts as hanging."""
MEMORY = 256 << 20
"""Growth of the process over one input that counts as too much [bytes]."""
_SHRINKING = 3.0


class HangError(BaseException):
    """A reader does not come back; no error handler of the library may catch it."""


@dataclass
class Finding:
    """An input that a reader does not survive as it should.

    Attributes:
        reader: Name of the reader.
        what: The exception and the place in the library where it came from.
        data: The smallest input found.
        path: The path that it was read under.
        trace: The traceback.
    """

    reader: str
    what: str
    data: bytes
    path: Path
    trace: str

    def save(self, folder: Path) -> Path:
        """Write input and traceback to a folder."""
        folder.mkdir(parents=True, exist_ok=True)
        digest = hashlib.sha256(self.what.encode()).hexdigest()[:10]
        path = folder / f"{self.reader}-{digest}{self.path.suffix or '.txt'}"
        path.write_bytes(self.data)
        path.with_name(path.name + ".why.txt").write_text(f"{self.what}\n\n{self.trace}", encoding="utf-8")
        return path


@dataclass
class Tally:
    """What came of many inputs.

    Attributes:
        inputs: How many there were.
        accepted: How many were read without an error.
        slowest: Computing time of the slowest [s].
        findings: One for every kind of failure.
    """

    inputs: int = 0
    accepted: int = 0
    slowest: float = 0.0
    findings: dict[str, Finding] = field(default_factory=dict)


def inputs(name: str, seed: int) -> Iterator[tuple[bytes, Path]]:
    """Damaged files for a reader, without end."""
    chance = random.Random(f"{name} {seed}")
    found = reader(name)
    others, good = [other.data for other in found.seeds], [other for other in found.seeds if other.good]
    while True:
        start = chance.choice(good if chance.random() < 0.8 else found.seeds)
        yield _damaged(found, start, chance, others), start.path


def _damaged(found: Reader, start: Seed, chance: random.Random, others: list[bytes]) -> bytes:
    if chance.random() < 0.5:
        text = None
        if found.kind == "xml":
            text = damaged_xml(start.data.decode("utf-8", "replace"), chance)
        elif start.tree is not None:
            text = damaged_tree(
                start.tree, chance, as_json=found.kind == "json" or start.path.suffix == ".json"
            )
        if text is not None:
            return text.encode("utf-8", "surrogatepass")
    return damaged_bytes(start.data, chance, others)


def hunt(name: str, count: int, seed: int = 0) -> Iterator[Tally]:
    """Feed `count` inputs to a reader; yields the tally after every input."""
    tally, found = Tally(), reader(name)
    for data, path in inputs(name, seed):
        start, before = time.process_time(), _resident()
        what, trace = outcome(found, data, path)
        tally.slowest = max(tally.slowest, time.process_time() - start)
        if _resident() - before > MEMORY:
            what, trace = "memory", f"the process grew by {(_resident() - before) >> 20} MiB"
        tally.inputs += 1
        tally.accepted += what == "read"
        if what not in ("read", "refused") and what not in tally.findings:
            small = data if what in ("memory", "hang") else smallest(found, data, path, what)
            tally.findings[what] = Finding(name, what, small, path, trace)
        yield tally
        if tally.inputs >= count:
            return


def outcome(found: Reader, data: bytes, path: Path) -> tuple[str, str]:
    """`read`, `refused`, or what else came of an input, with the traceback."""
    before = signal.signal(signal.SIGVTALRM, _hang)
    signal.setitimer(signal.ITIMER_VIRTUAL, SLOWEST)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            found.read(data, path)
    except vc.VinculaError as error:
        text = str(error)
        if len(text) > 100_000 or not text.replace("\n", "").isprintable():
            return f"unprintable message: {type(error).__name__}", text[:1000]
        return "refused", ""
    except HangError:
        return "hang", traceback.format_exc()
    except Exception as error:  # noqa: BLE001  (every other kind is what is looked for)
        frames = [f for f in traceback.extract_tb(error.__traceback__) if "vincula" in f.filename]
        where = f"{Path(frames[-1].filename).name}:{frames[-1].name}" if frames else "outside"
        return f"{type(error).__name__} in {where}", traceback.format_exc()
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
        signal.signal(signal.SIGVTALRM, before)
    return "read", ""


def _hang(_signal: int, _frame: FrameType | None) -> None:
    raise HangError


def smallest(found: Reader, data: bytes, path: Path, what: str) -> bytes:
    """The input without every piece that is not needed for the same failure; gives up after seconds."""
    end = time.process_time() + _SHRINKING
    size = max(1, len(data) // 2)
    while size >= 1 and time.process_time() < end:
        at = 0
        while at < len(data) and time.process_time() < end:
            shorter = data[:at] + data[at + size :]
            if outcome(found, shorter, path)[0] == what:
                data = shorter
            else:
                at += size
        size //= 2
    return data


def _resident() -> int:
    """Memory of this process [bytes]; 0 where the system does not say."""
    try:
        with Path("/proc/self/statm").open(encoding="ascii") as stream:
            return int(stream.read().split()[1]) * 4096
    except OSError:
        return 0
