"""Shares merged, and workers of a cluster: the same data set as from one process."""

from __future__ import annotations

import os
import signal
import threading
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from tests.sweep.conftest import beside, files_of, five_bar_sweep, serial_sweep

import vincula as vc
from vincula.sweep.dataset import SweepData
from vincula.sweep.progress import Progress

Undisturbed = Callable[[str], Path]


def test_three_shares_merged(tmp_path: Path, undisturbed: Undisturbed) -> None:
    target = tmp_path / "a.zarr"
    for i in (1, 2, 3):
        share = five_bar_sweep().run(target, shard=(i, 3))
        assert share.status().complete
    merged = vc.merge_shards(target)
    assert merged.status().complete
    assert files_of(target) == files_of(undisturbed("five-bar"))
    assert [name for name in beside(target) if "shard" not in name] == []
    again = vc.merge_shards(target)  # merging once more changes nothing
    assert files_of(again.path) == files_of(undisturbed("five-bar"))


def test_a_missing_share_may_be_merged_later_or_computed_by_resuming(
    tmp_path: Path, undisturbed: Undisturbed
) -> None:
    target, sweep = tmp_path / "a.zarr", serial_sweep()
    for i in (1, 3):
        sweep.run(target, shard=(i, 3))
    status = vc.merge_shards(target).status()
    assert not status.complete
    assert status.done == len(range(0, status.chunks, 3)) + len(range(2, status.chunks, 3))
    found = SweepData(target).to_xarray()
    assert (found["status"].values == 255).sum() == status.points - status.points_done
    assert sweep.run(target, resume=True).status().complete
    assert files_of(target) == files_of(undisturbed("serial"))


def test_shares_of_another_sweep_are_refused(tmp_path: Path) -> None:
    target = tmp_path / "a.zarr"
    serial_sweep().run(target, shard=(1, 2))
    serial_sweep(chunk=33).run(target, shard=(2, 2))
    with pytest.raises(vc.SweepError, match=r"has changed|another size"):
        vc.merge_shards(target)
    with pytest.raises(vc.SweepError, match="no shares"):
        vc.merge_shards(tmp_path / "other.zarr")


def test_damaged_shares_are_refused(tmp_path: Path) -> None:
    target = tmp_path / "a.zarr"
    share = serial_sweep().run(target, shard=(1, 1))
    chunk = next(iter(sorted(share.path.glob("counts/c.*"))))
    chunk.write_bytes(chunk.read_bytes()[:-1] + b"\x07")
    with pytest.raises(vc.SweepError, match="not what its ledger says") as refusal:
        vc.merge_shards(target)
    assert refusal.value.kind == "storage"


def test_bad_shares_are_refused(tmp_path: Path) -> None:
    for share in ((0, 3), (4, 3), (1, 100)):
        with pytest.raises(vc.SweepError, match="share"):
            serial_sweep().run(tmp_path / "a.zarr", shard=share)


@pytest.mark.slow
@pytest.mark.parametrize("killed", [0, 2])
def test_a_dask_cluster(killed: int, tmp_path: Path, undisturbed: Undisturbed) -> None:
    """Four workers, two of them killed on the way."""
    distributed = pytest.importorskip("distributed")
    with warnings.catch_warnings(), distributed.LocalCluster(
        n_workers=4, threads_per_worker=1, dashboard_address=None, host="127.0.0.1", silence_logs=50
    ) as cluster:  # fmt: skip
        warnings.simplefilter("ignore")  # the cluster's own, when its workers die
        began = threading.Event()
        victims = [worker.pid for worker in cluster.workers.values()][:killed]
        killer = threading.Thread(target=_kill, args=(began, victims), daemon=True)
        killer.start()

        def tell(progress: Progress) -> None:
            if progress.running:
                began.set()

        sweep = five_bar_sweep(chunk=3)
        sweep.run(tmp_path / "a.zarr", scheduler=cluster.scheduler_address, progress=tell)
        killer.join(timeout=30.0)
    sweep.run(tmp_path / "b.zarr", threads=1)
    assert SweepData(tmp_path / "a.zarr").status().complete
    assert files_of(tmp_path / "a.zarr") == files_of(tmp_path / "b.zarr")


def _kill(began: threading.Event, victims: list[int]) -> None:
    began.wait(60.0)
    for pid in victims:
        time.sleep(0.1)
        os.kill(pid, signal.SIGKILL)


def test_no_scheduler(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    cluster: Any = pytest.importorskip("vincula.sweep.cluster")
    pytest.importorskip("distributed")
    monkeypatch.setattr(cluster, "PATIENCE", 0.5)
    with pytest.raises(vc.SweepError, match="no dask scheduler"):
        serial_sweep().run(tmp_path / "a.zarr", scheduler="tcp://127.0.0.1:9")
