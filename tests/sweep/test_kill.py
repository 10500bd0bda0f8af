"""kill -9 at any moment: what was recorded stays, and the data set is the undisturbed one, bit for bit.

The number of kills is small here; VINCULA_KILLS=200 is the whole promise.
"""

from __future__ import annotations

import os
import signal
import sys
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from tests.sweep.conftest import beside, files_of, five_bar_sweep, serial_sweep
from tests.sweep.killing import children_of, ended, kill_until_done, process_group, run_in_child

from vincula.sweep.dataset import SweepData

KILLS = int(os.environ.get("VINCULA_KILLS", "12"))

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="forks, and looks into /proc")


@pytest.mark.parametrize(("name", "longest"), [("serial", 0.4), ("five-bar", 1.5)])
def test_parent_killed_at_random_moments(
    name: str, longest: float, tmp_path: Path, rng: np.random.Generator, undisturbed: Callable[[str], Path]
) -> None:
    expected = files_of(undisturbed(name))
    sweep = serial_sweep() if name == "serial" else five_bar_sweep()
    rounds = killed = 0
    while killed < KILLS:
        target = tmp_path / f"{rounds}.zarr"
        more, _ = kill_until_done(
            partial(sweep.run, target, threads=1, resume=True),
            rng,
            min(6, KILLS - killed),
            longest,
        )
        killed += more
        rounds += 1
        assert files_of(target) == expected
        assert SweepData(target).status().complete
        assert [name for name in beside(target) if name.startswith(target.name)] == []


def test_what_was_recorded_is_not_computed_again(tmp_path: Path, rng: np.random.Generator) -> None:
    """Chunks done before the kill are still done after it, and their files are not written again."""
    target, sweep = tmp_path / "a.zarr", five_bar_sweep()
    child = run_in_child(lambda: sweep.run(target, threads=1, resume=True))
    deadline = time.monotonic() + 60.0
    while time.monotonic() < deadline and not list(target.glob("status/c.*")):
        time.sleep(0.005)
    time.sleep(0.05)
    with process_group(child):
        pass
    ended(child, 10.0)
    before = {path: path.stat().st_mtime_ns for path in target.glob("status/c.*")}
    done = SweepData(target).status().done
    sweep.run(target, threads=1, resume=True)
    kept = [path for path, when in before.items() if path.stat().st_mtime_ns == when]
    assert len(kept) >= done
    assert done < sweep.chunking.count


def test_workers_killed_at_random_moments(
    tmp_path: Path, rng: np.random.Generator, undisturbed: Callable[[str], Path]
) -> None:
    """A chunk whose worker dies twice fails and says so; resumed, the data set is the undisturbed one."""
    expected, sweep = files_of(undisturbed("serial")), serial_sweep()
    killed = rounds = 0
    while killed < KILLS:
        target = tmp_path / f"{rounds}.zarr"
        rounds += 1
        complete = False
        while not complete:
            child = run_in_child(partial(sweep.run, target, jobs=2, resume=True))
            with process_group(child):
                while ended(child, float(rng.uniform(0.0, 1.2))) is None:
                    workers = children_of(child)
                    if workers and killed < KILLS:
                        os.kill(int(rng.choice(workers)), signal.SIGKILL)
                        killed += 1
            complete = SweepData(target).status().complete
        assert files_of(target) == expected


def test_a_chunk_whose_workers_die_twice_fails_with_its_inputs_and_the_sweep_goes_on(tmp_path: Path) -> None:
    """Every worker is killed as soon as it is there, three times: one retry, then the chunk fails."""
    target, sweep = tmp_path / "a.zarr", serial_sweep(chunk=50)
    child = run_in_child(lambda: sweep.run(target, jobs=1, resume=True))
    with process_group(child):
        killed: set[int] = set()
        while len(killed) < 2:
            for worker in children_of(child):
                if worker not in killed:
                    os.kill(worker, signal.SIGKILL)
                    killed.add(worker)
            time.sleep(0.001)
        assert ended(child, 120.0) == 0
    status = SweepData(target).status()
    assert len(status.failed) == 1
    assert "ended by signal 9, 2 times" in status.failed[0].error
    assert '"chunk": 0' in status.failed[0].inputs
    assert status.done == sweep.chunking.count - 1
    assert status.counts["failed"] == int(np.prod(sweep.chunking.extent(0)))
    assert "signal 9" in SweepData(target).reason((0, 0))


def test_a_worker_that_hangs_costs_one_retry(tmp_path: Path, undisturbed: Callable[[str], Path]) -> None:
    target, sweep = tmp_path / "a.zarr", serial_sweep()
    child = run_in_child(lambda: sweep.run(target, jobs=1, resume=True, hang_after=20.0))
    with process_group(child):
        deadline = time.monotonic() + 60.0
        while time.monotonic() < deadline and not (workers := children_of(child)):
            time.sleep(0.01)
        os.kill(workers[0], signal.SIGSTOP)
        assert ended(child, 200.0) == 0
    assert files_of(target) == files_of(undisturbed("serial"))


def test_workers_end_with_their_parent(tmp_path: Path) -> None:
    child = run_in_child(lambda: serial_sweep().run(tmp_path / "a.zarr", jobs=2, resume=True))
    deadline = time.monotonic() + 60.0
    while time.monotonic() < deadline and len(workers := children_of(child)) < 2:
        time.sleep(0.01)
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    deadline = time.monotonic() + 60.0
    while time.monotonic() < deadline and any(Path(f"/proc/{pid}").exists() for pid in workers):
        time.sleep(0.05)
    assert not any(Path(f"/proc/{pid}").exists() for pid in workers)
