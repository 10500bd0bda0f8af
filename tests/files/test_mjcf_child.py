"""MuJoCo's parser in a process of its own: what hangs, starves or kills it costs that process only."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from tests.conftest import ROOT

import vincula as vc
from vincula.files import mjcf_child
from vincula.files.limits import DEFAULT_LIMITS, Limits
from vincula.files.mjcf import load_mjcf

pytest.importorskip("mujoco")

FOLDER = ROOT / "tests" / "files" / "mjcf"
HINGES = FOLDER / "hinges.xml"
IMPORTS = "import os, sys, time; from vincula.files.mjcf_child import _limit_memory, _limit_time, serve; "


@pytest.fixture
def broken(monkeypatch: pytest.MonkeyPatch) -> Iterator[pytest.MonkeyPatch]:
    """The next process of the parser does as it is told; the one after it works again."""
    mjcf_child.CHILD.stop()
    yield monkeypatch
    monkeypatch.undo()
    mjcf_child.CHILD.stop()


@pytest.mark.parametrize(
    ("serve", "seconds", "expected"),
    [
        ("time.sleep(60)", 0.2, "took more than 0.2 s"),
        ("_limit_time(0.0)\nwhile True: pass", 60.0, "took more than 60 s"),
        ("os.abort()", 5.0, "died over it \\(signal 6\\)"),
        ("sys.exit(3)", 5.0, "died over it \\(exit code 3\\)"),
        ("_limit_memory(); x = bytearray(600 << 20)", 5.0, "needs more than 512 MiB"),
        ("sys.stdin.buffer.read(8); os.write(1, b'x' * 8); time.sleep(60)", 0.2, "took more than|died"),
    ],
)
@pytest.mark.skipif(sys.platform != "linux", reason="computing time and memory are limited on Linux")
def test_a_parser_that_does_not_answer(
    serve: str, seconds: float, expected: str, broken: pytest.MonkeyPatch
) -> None:
    broken.setattr(mjcf_child, "_SERVE", IMPORTS + serve)
    start = time.monotonic()
    with pytest.raises(vc.FileError, match=rf"hinges\.xml:\d+:\d+: mujoco.*: .*{expected}"):
        load_mjcf(HINGES, replace(DEFAULT_LIMITS, seconds=seconds))
    assert time.monotonic() - start < 20.0
    broken.undo()
    assert load_mjcf(HINGES)[0].joints


def test_the_process_is_kept_and_replaced_when_it_dies() -> None:
    load_mjcf(HINGES)
    first = mjcf_child.CHILD._process
    load_mjcf(HINGES)
    assert mjcf_child.CHILD._process is first
    assert first is not None
    first.kill()
    first.wait()
    assert load_mjcf(HINGES)[0].joints
    assert mjcf_child.CHILD._process is not first


@pytest.mark.parametrize("path", sorted(FOLDER.glob("*.xml")), ids=lambda path: path.stem)
def test_it_makes_no_difference(path: Path) -> None:
    """A file read in the process of its own and one read here give the same mechanism and report."""
    apart, here = (load_mjcf(path, Limits(isolated=isolated)) for isolated in (True, False))
    assert str(apart[1]) == str(here[1])
    assert apart[0].body.keys() == here[0].body.keys()
    poses = [
        [
            *(j.frame_on_first for j in m.joints),
            *(j.frame_on_second for j in m.joints),
            *(b.pose for b in m.bodies),
        ]
        for m in (apart[0], here[0])
    ]
    for ours, theirs in zip(*poses, strict=True):
        assert (ours.position == theirs.position).all()
        assert (ours.rotation == theirs.rotation).all()


def test_a_parser_that_cannot_be_started(broken: pytest.MonkeyPatch) -> None:
    broken.setattr(sys, "executable", "/nowhere/python")
    with pytest.raises(vc.FileError, match=r"cannot be started .*isolated=False"):
        load_mjcf(HINGES)
    assert load_mjcf(HINGES, Limits(isolated=False))[0].joints


def test_the_folder_of_the_user_is_not_searched_for_modules(tmp_path: Path) -> None:
    """A mujoco.py beside a stranger's file is not what reads it."""
    (tmp_path / "mujoco.py").write_text("raise SystemExit('this is not MuJoCo')", encoding="utf-8")
    (tmp_path / "json.py").write_text("raise SystemExit('this is not json')", encoding="utf-8")
    code = f"import vincula; print(len(vincula.load({str(HINGES)!r}).joints))"
    run = subprocess.run(
        [sys.executable, "-P", "-c", code],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "PYTHONPATH": str(ROOT / "src")},
    )
    assert run.stderr == ""
    assert int(run.stdout) == len(load_mjcf(HINGES)[0].joints)


def test_a_forked_process_starts_its_own() -> None:
    if not hasattr(os, "fork"):
        pytest.skip("needs fork")
    load_mjcf(HINGES)
    parent = mjcf_child.CHILD._process
    code = os.fork()
    if code == 0:
        load_mjcf(HINGES)
        os._exit(0 if mjcf_child.CHILD._process is not parent else 1)
    assert os.waitpid(code, 0)[1] == 0
    assert parent is not None
    assert parent.poll() is None
    assert load_mjcf(HINGES)[0].joints
