"""MuJoCo's parser in a process of its own: hostile bytes may stop, starve or kill that one only.

The process is started when the first MJCF file is read and serves the following ones.  It gets texts
and gives back a compiled model, as frames of a length and that many bytes on its standard input and
output.  It may use `Limits.seconds` of computing time a file (twice that by the clock) and 512 MiB
of memory beyond what it starts with; if it passes them or dies, the file is refused and the next file
gets a new process.  The limits on time of computing and on memory are those of Linux.
"""

from __future__ import annotations

import atexit
import json
import math
import os
import signal
import struct
import subprocess
import sys
import threading
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any, Final

from vincula.errors import FileError

MEMORY: Final = 512 << 20
"""Memory that reading one file may cost the process [bytes]."""

_LENGTH: Final = struct.Struct("<Q")
_SERVE: Final = "from vincula.files.mjcf_child import serve; serve()"


@dataclass(frozen=True, slots=True)
class Answer:
    """What the process gives back.

    Attributes:
        model: The compiled model as MuJoCo's own binary file; empty when it refuses.
        warnings: MuJoCo's warnings.
        error: MuJoCo's words of refusal.
        bare: Whether the bare version is what it refused.
    """

    model: bytes
    warnings: list[str]
    error: str
    bare: bool


class StoppedError(Exception):
    """The process was stopped, or stopped by itself; says why."""


class Child:
    """The process of this process; `ask` starts it when there is none."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._process: subprocess.Popen[bytes] | None = None
        self._owner = 0

    def start(self) -> None:
        """Start the process, so that it is ready when it is asked.

        Raises:
            FileError: It cannot be started.
        """
        with self._lock:
            self._started()

    def ask(self, texts: Mapping[str, object], seconds: float) -> Answer:
        """Have MuJoCo read texts.

        Args:
            texts: The arguments of `mjcf_parser.parse`.
            seconds: Computing time that it may take [s].

        Raises:
            StoppedError: It took too long, or died.
            FileError: The process cannot be started.
        """
        with self._lock:
            process = self._started()
            late = threading.Event()
            timer = threading.Timer(2.0 * seconds, _stop, (process, late))
            timer.daemon = True
            timer.start()
            try:
                found = _exchange(process, {"seconds": seconds, **texts})
            finally:
                timer.cancel()
            if found is None:
                code = process.wait()
                self._forget()
                raise StoppedError(_why(code, seconds, late=late.is_set()))
            return found

    def stop(self) -> None:
        """End the process, if there is one."""
        with self._lock:
            self._forget()

    def _started(self) -> subprocess.Popen[bytes]:
        if self._process is not None and (self._owner != os.getpid() or self._process.poll() is not None):
            self._forget()
        if self._process is None:
            self._process, self._owner = _new_process(), os.getpid()
        return self._process

    def _forget(self) -> None:
        process, self._process = self._process, None
        if process is None:
            return
        if self._owner == os.getpid():
            process.kill()
        for stream in (process.stdin, process.stdout):
            if stream is not None:
                try:
                    stream.close()
                except BrokenPipeError:
                    continue  # what was not sent yet is of no interest any more
        if self._owner == os.getpid():
            process.wait()


CHILD: Final = Child()
"""The one process that reads the MJCF files of this one."""

atexit.register(CHILD.stop)


def _new_process() -> subprocess.Popen[bytes]:
    paths = [str(Path(path).absolute()) for path in sys.path if path]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(paths), "OPENBLAS_NUM_THREADS": "1"}
    try:
        # -P: the folder that a user works in is never searched for modules.
        return subprocess.Popen(  # noqa: S603  (our own interpreter on our own words)
            [sys.executable, "-P", "-c", _SERVE],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            env=environment,
        )
    except OSError as error:
        raise FileError(
            f"MuJoCo's parser runs in a process of its own, which cannot be started ({error.strerror}); "
            "Limits(isolated=False) reads files that you trust without one"
        ) from error


def _stop(process: subprocess.Popen[bytes], late: threading.Event) -> None:
    late.set()
    process.kill()


def _exchange(process: subprocess.Popen[bytes], question: Mapping[str, object]) -> Answer | None:
    """One question and its answer; None when the process dies over it."""
    if process.stdin is None or process.stdout is None:
        return None
    try:
        _send(process.stdin, json.dumps(question).encode())
    except BrokenPipeError:
        return None
    head, model = _receive(process.stdout), _receive(process.stdout)
    if head is None or model is None:
        return None
    said = json.loads(head)
    return Answer(model, list(map(str, said["warnings"])), str(said["error"]), bool(said["bare"]))


def _why(code: int, seconds: float, *, late: bool) -> str:
    if late or code == -getattr(signal, "SIGXCPU", 0):
        return f"MuJoCo took more than {seconds:g} s to read it; the file is too complex"
    how = f"signal {-code}" if code < 0 else f"exit code {code}"
    return f"MuJoCo's parser died over it ({how}); the file is damaged, or needs more than {MEMORY >> 20} MiB"


def _send(stream: IO[bytes], data: bytes) -> None:
    stream.write(_LENGTH.pack(len(data)))
    stream.write(data)
    stream.flush()


def _receive(stream: IO[bytes]) -> bytes | None:
    """One frame, None at the end of the stream or where there is none."""
    head = stream.read(_LENGTH.size)
    if len(head) < _LENGTH.size:
        return None
    (length,) = _LENGTH.unpack(head)
    data = stream.read(length) if length <= MEMORY else b""
    return data if len(data) == length else None


def serve() -> None:
    """Answer questions until the standard input ends: what the process does."""
    questions, answers = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    nowhere = os.open(os.devnull, os.O_RDWR)
    os.dup2(nowhere, 0)
    os.dup2(nowhere, 1)  # MuJoCo prints now and then
    if hasattr(signal, "SIGINT"):
        signal.signal(signal.SIGINT, signal.SIG_IGN)  # an interrupt is the other process's business
    import mujoco
    import numpy as np

    from vincula.files.mjcf_parser import parse

    _limit_memory()
    while (question := _receive(questions)) is not None:
        texts: dict[str, Any] = json.loads(question)
        _limit_time(float(texts.pop("seconds")))
        found = parse(**texts)
        model = b""
        if found.model is not None:
            buffer = np.zeros(mujoco.mj_sizeModel(found.model), np.uint8)
            mujoco.mj_saveModel(found.model, None, buffer)
            model = buffer.tobytes()
        said = {"warnings": found.warnings, "error": found.error, "bare": found.bare}
        _send(answers, json.dumps(said).encode())
        _send(answers, model)


def _limit_memory() -> None:
    """Allow this process `MEMORY` beyond what it has now."""
    if sys.platform == "linux":
        import resource

        pages = Path("/proc/self/statm").read_text(encoding="ascii").split()
        most = int(pages[5]) * resource.getpagesize() + MEMORY
        resource.setrlimit(resource.RLIMIT_DATA, (most, most))


def _limit_time(seconds: float) -> None:
    """Allow this process so much more computing time."""
    if sys.platform == "linux":
        import resource

        usage = resource.getrusage(resource.RUSAGE_SELF)
        until = math.ceil(usage.ru_utime + usage.ru_stime + seconds)
        resource.setrlimit(resource.RLIMIT_CPU, (until, resource.RLIM_INFINITY))
