"""Killing sweeps at random moments: forked children that know nothing of it."""

from __future__ import annotations

import contextlib
import os
import signal
import time
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np


def run_in_child(action: Callable[[], object]) -> int:
    """Fork; the child does the action and ends at once with 0, or 1 after an error; its process id."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # newer Pythons warn of threads
        child = os.fork()
    if child:
        return child
    code = 1
    with contextlib.suppress(BaseException):  # whatever happens, the child must not go on with the tests
        os.setpgid(0, 0)
        action()
        code = 0
    os._exit(code)


def ended(child: int, seconds: float) -> int | None:
    """Wait status of a child; None when it is still running after some seconds."""
    deadline = time.monotonic() + seconds
    while time.monotonic() < deadline:
        pid, status = os.waitpid(child, os.WNOHANG)
        if pid:
            return status
        time.sleep(0.001)
    return None


def kill(child: int) -> None:
    """kill -9, and wait."""
    with contextlib.suppress(ProcessLookupError):
        os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)


def kill_until_done(
    action: Callable[[], object], rng: np.random.Generator, kills: int, longest: float
) -> tuple[int, int]:
    """Run an action again and again, each time killed after a random time; the last time undisturbed.

    Args:
        action: What a child does.
        rng: Random times.
        kills: How often it is killed at most.
        longest: Longest time before a kill [s].

    Returns:
        How often it was killed, and how often it ended before.
    """
    killed = finished = 0
    for _ in range(kills):
        child = run_in_child(action)
        status = ended(child, float(rng.uniform(0.0, longest)))
        if status is None:
            kill(child)
            killed += 1
        else:
            assert status == 0, status
            finished += 1
    child = run_in_child(action)
    assert ended(child, 300.0) == 0
    return killed, finished


def children_of(parent: int) -> list[int]:
    """Process ids of the children of a process (Linux)."""
    found = []
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            with contextlib.suppress(OSError, ValueError, IndexError):
                fields = (entry / "stat").read_text().rpartition(")")[2].split()
                if int(fields[1]) == parent:
                    found.append(int(entry.name))
    return found


@contextmanager
def process_group(child: int) -> Iterator[int]:
    """Whatever happens, the child and its children are gone afterwards."""
    try:
        yield child
    finally:
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(child, signal.SIGKILL)
