"""Damaged files by the thousand: every reader reads them or refuses them in our words, in time.

Five thousand a reader in continuous integration, fewer at a desk (VINCULA_FUZZ sets how many); more, by
hand: `python -m benchmarks.fuzz`.
"""

from __future__ import annotations

import os
import subprocess
import sys

import pytest
from tests.conftest import ROOT
from tests.files.fuzzing.hunting import hunt
from tests.files.fuzzing.readers import READERS

COUNT = int(os.environ.get("VINCULA_FUZZ", "500"))


@pytest.mark.slow
@pytest.mark.parametrize("name", READERS)
def test_damaged_files_are_read_or_refused(name: str) -> None:
    if name == "mjcf":
        pytest.importorskip("mujoco")
    for tally in hunt(name, COUNT):
        for finding in tally.findings.values():
            raise AssertionError(f"{finding.what}\n{finding.data[:2000]!r}\n{finding.trace}")
    assert tally.inputs == COUNT
    assert tally.accepted > COUNT // 100  # the damage is not so heavy that only refusals are tried


def test_the_hunter_finds_what_is_there(monkeypatch: pytest.MonkeyPatch) -> None:
    """A reader with a mistake: the finding names it, and the input is cut down to what shows it."""
    from tests.files.fuzzing import hunting
    from tests.files.fuzzing.readers import Reader, Seed, reader

    def broken(data: bytes, _path: object) -> None:
        if b"9" in data:
            raise KeyError("nine")

    faulty = Reader(
        "expressions", "text", broken, [Seed(s.data, s.path) for s in reader("expressions").seeds]
    )
    monkeypatch.setattr(hunting, "reader", lambda _name: faulty)
    findings = {
        what: found for tally in hunting.hunt("expressions", 300) for what, found in tally.findings.items()
    }
    assert {found.data for found in findings.values()} == {b"9"}
    assert all(what.startswith("KeyError") for what in findings)


def test_the_program_runs(tmp_path: object) -> None:
    run = subprocess.run(
        [sys.executable, "-m", "benchmarks.fuzz", "expressions", "--count", "200", "--out", str(tmp_path)],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "PYTHONPATH": str(ROOT / "src")},
    )
    assert (run.returncode, run.stderr) == (0, "")
    assert "expressions: 200 inputs" in run.stdout
