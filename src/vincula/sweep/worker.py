"""A worker process: reads tasks, answers with blocks, ends when nobody listens any more.

Started by `processes` as `python -m vincula.sweep.worker`; it speaks pickles over its standard input and
output with the process that started it, and with nobody else.
"""

from __future__ import annotations

import io
import os
import pickle
import signal
import struct
import sys
import warnings
from concurrent.futures import ThreadPoolExecutor
from typing import Any, BinaryIO, Final

HEAD: Final = struct.Struct("<Q")
"""Length of the message that follows."""


def send(stream: BinaryIO, message: object) -> None:
    """One message.

    Raises:
        OSError: Nobody listens.
    """
    data = pickle.dumps(message, protocol=5)
    stream.write(HEAD.pack(len(data)))
    stream.write(data)
    stream.flush()


def receive(stream: BinaryIO) -> Any:
    """The next message; None at the end of the stream, also in the middle of a message."""
    head = _exactly(stream, HEAD.size)
    data = None if head is None else _exactly(stream, HEAD.unpack(head)[0])
    return None if data is None else pickle.loads(data)  # noqa: S301  from our own process only


def _exactly(stream: BinaryIO, size: int) -> bytes | None:
    data = bytearray()
    while len(data) < size:
        part = stream.read(size - len(data))
        if not part:
            return None
        data += part
    return bytes(data)


def main() -> None:
    """Compute until the tasks end."""
    if hasattr(signal, "SIGINT"):
        signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the process that we work for
    tasks, answers = sys.stdin.buffer, os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())  # what libraries print must not mix with answers
    sys.stdout = io.TextIOWrapper(os.fdopen(sys.stderr.fileno(), "wb", closefd=False))
    warnings.simplefilter("ignore")  # told by the process that we work for
    work = receive(tasks)
    with ThreadPoolExecutor(
        1
    ) as pool:  # a future keeps whatever goes wrong, to be told instead of dying of it
        while (task := receive(tasks)) is not None:
            future = pool.submit(work.evaluate, task.values, task.extent, task.start)
            error = future.exception()
            block = None if error is not None else future.result()
            try:
                send(
                    answers, (task.chunk, block, "" if error is None else f"{type(error).__name__}: {error}")
                )
            except OSError:
                return


if __name__ == "__main__":
    main()
