"""Running, resuming, refusing: the data set never depends on how it came about."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from tests.sweep.conftest import files_of, five_bar_sweep, serial_sweep

import vincula as vc
from vincula.sweep.dataset import SweepData
from vincula.sweep.ledger import Ledger
from vincula.sweep.lock import SweepLock
from vincula.sweep.progress import Progress
from vincula.sweep.running import Places

Undisturbed = Callable[[str], Path]


@pytest.mark.parametrize("options", [{"threads": 3}, {"jobs": 2}])
@pytest.mark.parametrize("name", ["serial", "five-bar"])
def test_threads_and_processes_give_the_same_bytes(
    name: str, options: dict[str, int], tmp_path: Path, undisturbed: Undisturbed
) -> None:
    sweep = serial_sweep() if name == "serial" else five_bar_sweep()
    sweep.run(tmp_path / "a.zarr", **options)  # type: ignore[arg-type]
    assert files_of(tmp_path / "a.zarr") == files_of(undisturbed(name))


def test_nothing_tells_of_a_clock_or_a_host(undisturbed: Undisturbed) -> None:
    import datetime
    import getpass
    import socket

    text = b"".join(files_of(undisturbed("five-bar")).values())
    for word in (
        socket.gethostname(),
        str(datetime.datetime.now(datetime.UTC).year),
        sys.prefix,
        getpass.getuser(),
    ):
        assert len(word) < 4 or word.encode() not in text


def test_every_point_has_a_state_and_unreached_ones_a_reason(undisturbed: Undisturbed) -> None:
    data = vc.open_sweep(undisturbed("five-bar"))
    found = data.to_xarray()
    status = found["status"].values
    assert set(np.unique(status)) == {0, 3}
    where = tuple(int(k) for k in np.argwhere(status == 3)[0])
    assert " close" in data.reason(where)
    assert data.reason(tuple(int(k) for k in np.argwhere(status == 0)[0])) == ""
    assert sum(found["status"].attrs["reasons"].values()) == (status == 3).sum()
    assert np.isnan(found["kinematic.efficiencies"].values[status == 3]).all()


def test_a_second_run_is_refused_and_resuming_a_finished_one_changes_nothing(tmp_path: Path) -> None:
    target, sweep = tmp_path / "a.zarr", serial_sweep()
    sweep.run(target)
    before = files_of(target)
    with pytest.raises(vc.SweepError, match="there is a sweep already") as refusal:
        sweep.run(target)
    assert refusal.value.kind == "usage"
    sweep.run(target, resume=True)
    assert files_of(target) == before
    sweep.run(target, overwrite=True)
    assert files_of(target) == before


def test_something_else_is_never_overwritten(tmp_path: Path) -> None:
    (tmp_path / "a.zarr").mkdir()
    (tmp_path / "a.zarr" / "thesis.tex").write_text("years")
    for options in ({}, {"overwrite": True}, {"resume": True}):
        with pytest.raises(vc.SweepError, match="no sweep of vincula"):
            serial_sweep().run(tmp_path / "a.zarr", **options)
    assert (tmp_path / "a.zarr" / "thesis.tex").read_text() == "years"
    with pytest.raises(vc.SweepError, match="no such folder"):
        serial_sweep().run(tmp_path / "nowhere" / "a.zarr")


def test_a_changed_model_is_refused_with_both_hashes(tmp_path: Path) -> None:
    target = tmp_path / "a.zarr"
    arm = vc.load("example:five-bar").with_active(["o1", "o5"])
    over = {"o1": [-0.1, 0.0], "o5": [-0.1, 0.0]}
    one = vc.Sweep(arm, over, ["counts"])
    one.run(target)
    two = vc.Sweep(arm.with_tolerance(1e-4), over, ["counts"])
    assert one.manifest["model"] != two.manifest["model"]
    with pytest.raises(vc.SweepError, match="the model has changed") as refusal:
        two.run(target, resume=True)
    assert refusal.value.kind == "refused"
    assert one.manifest["model"] in str(refusal.value)
    assert two.manifest["model"] in str(refusal.value)


@pytest.mark.parametrize(
    ("other", "words"),
    [
        (lambda arm, over: vc.Sweep(arm, {**over, "o1": [-0.1, 0.01]}, ["counts"]), "points have changed"),
        (lambda arm, over: vc.Sweep(arm, over, ["summary"]), "other quantities"),
        (lambda arm, over: vc.Sweep(arm, over, ["counts"], chunk=1), "chunks have another size"),
        (
            lambda arm, over: vc.Sweep(arm, over, ["counts"], weights=vc.Weights(rate=[2.0, 1.0])),
            "model has changed",
        ),
    ],
)
def test_another_sweep_is_refused(other: Callable[..., vc.Sweep], words: str, tmp_path: Path) -> None:
    arm = vc.load("example:five-bar").with_active(["o1", "o5"])
    over = {"o1": [-0.1, 0.0], "o5": [-0.1, 0.0]}
    vc.Sweep(arm, over, ["counts"]).run(tmp_path / "a.zarr")
    with pytest.raises(vc.SweepError, match=words):
        other(arm, over).run(tmp_path / "a.zarr", resume=True)


def test_two_processes_on_one_sweep_the_second_is_refused(tmp_path: Path) -> None:
    """The lock is the system's: a leftover file of a killed process locks nothing."""
    places = Places(tmp_path / "a.zarr")
    places.lock.write_text("1\n")
    code = (
        "import sys; from tests.sweep.conftest import serial_sweep; import vincula\n"
        "try: serial_sweep().run(sys.argv[1])\n"
        "except vincula.SweepError as error: print(error.kind, error)"
    )
    command = [sys.executable, "-c", code, str(places.data)]
    with SweepLock(places.lock, places.data):
        told = subprocess.run(command, capture_output=True, text=True, check=True).stdout
        assert told.startswith("refused")
        assert "another process" in told
        assert not places.data.exists()
    assert not places.lock.exists()
    assert subprocess.run(command, capture_output=True, text=True, check=True).stdout == ""
    assert SweepData(places.data).status().complete


def test_damaged_and_missing_chunks_are_computed_again(tmp_path: Path, undisturbed: Undisturbed) -> None:
    target, sweep = tmp_path / "a.zarr", serial_sweep()
    sweep.run(target)
    expected = files_of(undisturbed("serial"))
    chunk = target / "kinematic.smallest" / "c.1.0"
    chunk.write_bytes(chunk.read_bytes()[:-1] + b"\xff")
    (target / "counts" / "c.2.0.0").unlink()
    (target / "zarr.json").unlink()
    told: list[Progress] = []
    sweep.run(target, resume=True, progress=told.append)
    assert files_of(target) == expected
    computed = [p for p in told if p.stage == "computing"]
    assert computed[-1].done - computed[0].before == 2 * 11


def test_resuming_from_a_cut_ledger_is_refused_and_from_none_begins_anew(tmp_path: Path) -> None:
    target, sweep = tmp_path / "a.zarr", serial_sweep()
    sweep.run(target)
    ledger = Places(target).ledger
    ledger.write_bytes(ledger.read_bytes()[:-100])
    with pytest.raises(vc.SweepError, match="damaged") as refusal:
        sweep.run(target, resume=True)
    assert refusal.value.kind == "storage"
    sweep.run(target, overwrite=True)
    assert SweepData(target).status().complete


def test_starts_are_fixed_in_the_ledger_and_used(tmp_path: Path, undisturbed: Undisturbed) -> None:
    target, sweep = tmp_path / "a.zarr", five_bar_sweep()
    sweep.run(target)
    with Ledger(Places(target).ledger) as ledger:
        starts = ledger.starts()
        ledger.forget([1])
    assert len(starts) == sweep.chunking.count
    block = sweep.block(1)
    again = five_bar_sweep().run(target, resume=True).to_xarray()
    place = sweep.chunking.slices(1)
    stored = again["configuration"].values[place].reshape(-1, again.sizes["coordinate"])
    assert np.array_equal(stored, block.arrays["configuration"], equal_nan=True)
    assert files_of(target) == files_of(undisturbed("five-bar"))


def test_progress_tells_points_and_ends_with_done(tmp_path: Path) -> None:
    told: list[Progress] = []
    serial_sweep().run(tmp_path / "a.zarr", progress=told.append)
    assert told[-1].stage == "done"
    assert told[-1].done == told[-1].total == 99
    assert [p.done for p in told if p.stage == "computing"] == sorted(
        p.done for p in told if p.stage == "computing"
    )


def test_executors_are_one_of_three() -> None:
    with pytest.raises(vc.ModelError, match="jobs and threads"):
        serial_sweep().run("never.zarr", jobs=1, threads=1)
    with pytest.raises(vc.ModelError, match="jobs is 0"):
        serial_sweep().run("never.zarr", jobs=0)
    with pytest.raises(vc.ModelError, match="hang_after"):
        serial_sweep().run("never.zarr", hang_after=-1.0)
