"""No room: a message with the bytes needed, and going on later gives the undisturbed data set."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from tests.sweep.conftest import beside, files_of, five_bar_sweep, serial_sweep

import vincula as vc
from vincula.sweep.dataset import SweepData
from vincula.sweep.running import Places

resource = pytest.importorskip("resource", reason="limits of files")
RUN = """
import json, resource, signal, sys
from tests.sweep import conftest
import vincula
name, target, limit = sys.argv[1:]
kind, _, chunk = name.partition(":")
sweep = getattr(conftest, kind)(*([int(chunk)] if chunk else []))
if int(limit):
    resource.setrlimit(resource.RLIMIT_FSIZE, (int(limit), int(limit)))
try:
    sweep.run(target, threads=1, resume=True)
except vincula.SweepError as error:
    print(json.dumps({"kind": error.kind, "text": str(error), "needed": error.details.get("needed")}))
"""


def run(name: str, target: Path, limit: int, *before: str) -> dict[str, object] | None:
    """What a run in another process, whose files may not grow beyond a limit, refused; None when done."""
    command = [*before, sys.executable, "-c", RUN, name, str(target), str(limit)]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=300)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout) if done.stdout else None


@pytest.mark.parametrize("limit", [200, 1100, 4500, 12500])
def test_files_that_may_not_grow(limit: int, tmp_path: Path, undisturbed: Callable[[str], Path]) -> None:
    """Low limits stop the data, higher ones the ledger, which needs pages of 4096 bytes for every table."""
    target = tmp_path / "a.zarr"
    refused = run("serial_sweep", target, limit)
    assert refused is not None
    assert refused["kind"] == "storage"
    assert "resume" in str(refused["text"])
    assert [name for name in beside(target) if not name.endswith(("-journal", ".new"))] == []
    if Places(target).ledger.exists():
        status = SweepData(target).status()
        assert not status.complete
    assert run("serial_sweep", target, 0) is None
    assert files_of(target) == files_of(undisturbed("serial"))
    assert beside(target) == []


def test_the_data_and_the_ledger_are_both_reached_by_limits(tmp_path: Path) -> None:
    """Of the limits above some stop at a chunk, with bytes counted, and some at the ledger itself."""
    at_data = run("serial_sweep", tmp_path / "a.zarr", 12500)
    assert at_data is not None
    assert "no room" in str(at_data["text"])
    at_ledger = run("serial_sweep", tmp_path / "b.zarr", 4500)
    assert at_ledger is not None
    assert not Places(tmp_path / "b.zarr").data.exists()


def test_the_ledger_may_not_grow(tmp_path: Path) -> None:
    """It could be made, and chunks have room, but their rows and reasons need another page."""
    target = tmp_path / "a.zarr"
    refused = run("five_bar_sweep:3", target, 16384)
    assert refused is not None
    assert refused["kind"] == "storage"
    assert "bytes are still needed" in str(refused["text"])
    assert list(target.glob("status/c.*"))
    five_bar_sweep(3).run(target, resume=True)
    five_bar_sweep(3).run(tmp_path / "b.zarr")
    assert files_of(target) == files_of(tmp_path / "b.zarr")


def _can_mount() -> bool:
    if sys.platform != "linux" or shutil.which("unshare") is None:
        return False
    probe = ["unshare", "-Urm", "sh", "-c", "mount -t tmpfs -o size=64k none /mnt"]
    return subprocess.run(probe, capture_output=True, check=False).returncode == 0


IN_A_SMALL_ROOM = """
set -e
mount -t tmpfs -o size={size}k none {room}
{python} -c "$RUN" {name} {room}/a.zarr 0
cp -a {room}/. {copy}
"""


@pytest.mark.skipif(not _can_mount(), reason="no small file system can be mounted here")
@pytest.mark.parametrize(("name", "size"), [("serial_sweep", 100), ("five_bar_sweep", 80)])
def test_a_small_file_system(
    name: str, size: int, tmp_path: Path, undisturbed: Callable[[str], Path]
) -> None:
    """A full tmpfs: what was stored on it is copied to a larger disk, and the sweep goes on."""
    room, copy = tmp_path / "room", tmp_path / "copy"
    room.mkdir()
    copy.mkdir()
    script = IN_A_SMALL_ROOM.format(size=size, room=room, copy=copy, name=name, python=sys.executable)
    done = subprocess.run(
        ["unshare", "-Urm", "sh", "-c", script],
        capture_output=True, text=True, check=False, timeout=300, env={**os.environ, "RUN": RUN},
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    refused = json.loads(done.stdout)
    assert refused["kind"] == "storage"
    assert "bytes are still needed" in refused["text"]
    sweep = serial_sweep() if name == "serial_sweep" else five_bar_sweep()
    finished = sweep.run(copy / "a.zarr", resume=True)
    assert finished.status().complete
    expected = files_of(undisturbed("serial" if name == "serial_sweep" else "five-bar"))
    assert files_of(copy / "a.zarr") == expected


def test_a_read_only_folder(tmp_path: Path) -> None:
    if os.geteuid() == 0:
        pytest.skip("root may write anywhere")
    (tmp_path / "r").mkdir(mode=0o500)
    with pytest.raises(vc.SweepError, match="cannot be stored") as refusal:
        serial_sweep().run(tmp_path / "r" / "a.zarr")
    assert refusal.value.kind == "storage"
