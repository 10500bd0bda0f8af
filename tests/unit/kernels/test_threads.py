"""Threads that are kept between calls."""

from __future__ import annotations

import os
import signal
import warnings

import pytest

from vincula.kernels.lanes.threads import in_shares, pool


@pytest.mark.skipif(not hasattr(os, "fork"), reason="forks")
def test_a_forked_process_has_threads_of_its_own() -> None:
    """`multiprocessing` forks by default on Linux: a copied pool has no threads and waits for ever."""
    done: list[tuple[int, int]] = []
    in_shares(lambda first, last: done.append((first, last)), 10, 2)
    assert sorted(done) == [(0, 5), (5, 10)]
    before = pool(2)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # newer Pythons warn of threads
        child = os.fork()
    if not child:
        signal.alarm(20)
        again: list[int] = []
        in_shares(lambda first, last: again.append(last - first), 10, 2)
        os._exit(0 if again == [5, 5] else 1)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
    assert pool(2) is before
