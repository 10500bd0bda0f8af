"""Threads for kernels, which release the interpreter's lock."""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache


def cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else (os.cpu_count() or 1)


def in_shares(work: Callable[[int, int], object], count: int, threads: int | None, least: int = 1) -> None:
    """Call `work(first, last)` on contiguous shares of 0 ... count - 1, a thread a share.

    Args:
        work: What is done.
        count: Number of pieces in all.
        threads: Threads to use; None for one a core.
        least: Pieces that are worth a thread.
    """
    shares = max(1, min(threads or cores(), count // least))
    if shares == 1:
        work(0, count)
        return
    cuts = [count * k // shares for k in range(shares + 1)]
    for _ in pool(shares).map(work, cuts[:-1], cuts[1:]):
        pass


@lru_cache(maxsize=8)
def pool(count: int) -> ThreadPoolExecutor:
    """Threads that stay; tasks must not wait for tasks of the same pool.

    Args:
        count: How many.
    """
    return ThreadPoolExecutor(count, thread_name_prefix="vincula-lanes")


if hasattr(os, "register_at_fork"):
    # A forked process has the pools but none of their threads: whatever it handed them would wait for ever.
    os.register_at_fork(after_in_child=pool.cache_clear)
