"""Damaged MJCF files end in one of our errors, never in another exception, a crash or a standstill."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest
from tests.conftest import ROOT

pytest.importorskip("mujoco")


def test_damaged_files_end_in_our_errors() -> None:
    script, folder = ROOT / "tests" / "files" / "mjcf_fuzz.py", ROOT / "tests" / "files" / "mjcf"
    run = subprocess.run(
        [sys.executable, str(script), str(folder), "400"],
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
        env={**os.environ, "PYTHONPATH": str(ROOT / "src")},
    )
    assert (run.returncode, run.stdout, run.stderr) == (0, "", "")
