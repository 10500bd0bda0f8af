"""Ctrl-C: exit code 130, the running chunks finished or dropped, resumable; workers do not see it."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from tests.sweep.conftest import files_of
from tests.sweep.killing import children_of

from vincula.sweep.dataset import SweepData

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="looks into /proc")

# Tests may run where interrupts are ignored, and that is inherited.
CODE = (
    "import signal; signal.signal(signal.SIGINT, signal.default_int_handler); "
    "from vincula.cli.main import main; main()"
)
FILE = """
sweep: 1
model: example:five-bar
active: [o1, o5]
grid:
  o1: {from: -8deg, to: 4deg, points: 6}
  o5: {from: -8deg, to: 4deg, points: 40}
quantities: [kinematic.efficiencies, closure.residual, configuration]
chunk: 6
"""


@pytest.mark.parametrize("options", [[], ["--jobs", "2"]])
def test_an_interrupt_ends_in_order_and_the_sweep_goes_on(options: list[str], tmp_path: Path) -> None:
    (tmp_path / "s.yaml").write_text(FILE)
    command = [sys.executable, "-c", CODE, "sweep"]
    target = tmp_path / "a.zarr"
    process = subprocess.Popen(
        [*command, "run", str(tmp_path / "s.yaml"), "-o", str(target), *options],
        stderr=subprocess.PIPE, text=True, start_new_session=True,
    )  # fmt: skip
    try:
        _wait(lambda: bool(list(target.glob("status/c.*"))))
        workers = children_of(process.pid)
        os.killpg(process.pid, signal.SIGINT)  # as a terminal does: to the workers as well
        _, told = process.communicate(timeout=120)
    finally:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
    assert process.returncode == 130
    assert "vincula sweep resume" in told
    assert "Traceback" not in told
    assert not any(Path(f"/proc/{pid}").exists() for pid in workers)
    status = SweepData(target).status()
    assert 0 < status.done < status.chunks
    assert status.failed == ()
    resumed = subprocess.run([*command, "resume", str(target), "--quiet"], capture_output=True, check=False)
    assert resumed.returncode == 0, resumed.stderr
    whole = [*command, "run", str(tmp_path / "s.yaml"), "-o", str(tmp_path / "b.zarr"), "--quiet"]
    assert subprocess.run(whole, capture_output=True, check=False).returncode == 0
    assert files_of(target) == files_of(tmp_path / "b.zarr")


def _wait(condition: Callable[[], bool], seconds: float = 120.0) -> None:
    deadline = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.01)
