"""A damaged ledger is recognised and never believed."""

from __future__ import annotations

import os
import sqlite3
from pathlib import Path

import numpy as np
import pytest

from vincula.errors import SweepError
from vincula.sweep.ledger import Ledger, Reason, Record

EVERY = int(os.environ.get("VINCULA_CUTS_EVERY", "61"))
"""Every how many bytes a ledger is cut; 1 is the whole promise."""

MANIFEST = {"format": 1, "chunks": 8, "model": "abc"}


def record(chunk: int) -> Record:
    return Record(
        chunk,
        "done",
        {"status/c.0": f"{chunk:08x}-7"},
        {"ok": 7},
        reasons=(Reason(0, 3, "because " * chunk),),
    )


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """A ledger with starts and five of eight chunks."""
    path = tmp_path / "a.ledger"
    with Ledger.create(path, MANIFEST) as ledger:
        ledger.put_starts({k: np.arange(3.0) + k for k in range(8)})
        for chunk in range(5):
            ledger.put([record(chunk)])
    return path


def content(path: Path) -> tuple[dict[str, object], list[Record], dict[int, list[float]]]:
    with Ledger(path) as ledger:
        starts = {k: list(v) for k, v in ledger.starts().items() if v is not None}
        return ledger.manifest, list(ledger.records()), starts


def test_what_is_put_is_there(path: Path) -> None:
    manifest, records, starts = content(path)
    assert manifest == MANIFEST
    assert records == [record(k) for k in range(5)]
    assert starts == {k: [k, k + 1.0, k + 2.0] for k in range(8)}


def test_every_cut_is_recognised(path: Path, tmp_path: Path) -> None:
    data, cut = path.read_bytes(), tmp_path / "cut.ledger"
    whole = content(path)
    believed, kinds = [], set()
    for size in [*range(0, len(data), EVERY), *range(4096, len(data), 4096), len(data) - 1]:
        cut.write_bytes(data[:size])
        try:
            assert content(cut) == whole, size
            believed.append(size)
        except SweepError as error:
            kinds.add((error.kind, "damaged" in str(error)))
    assert believed == []
    assert kinds == {("storage", True)}


def test_changed_bytes_are_never_believed(path: Path, tmp_path: Path, rng: np.random.Generator) -> None:
    """A changed byte is noticed or changes nothing; chunks may be missing then, never wrong."""
    data, changed = path.read_bytes(), tmp_path / "changed.ledger"
    manifest, records, starts = content(path)
    for _ in range(400):
        place = int(rng.integers(len(data)))
        changed.write_bytes(
            data[:place] + bytes([data[place] ^ int(rng.integers(1, 256))]) + data[place + 1 :]
        )
        try:
            found = content(changed)
        except SweepError:
            continue
        assert found[0] == manifest
        assert all(one in records for one in found[1])
        assert all(starts[k] == value for k, value in found[2].items())


def test_a_copy_without_its_journal_is_not_wrong(path: Path, tmp_path: Path) -> None:
    """Copies taken while a transaction is being written: noticed, or as it was before."""
    base = sqlite3.connect(path)
    base.execute("PRAGMA cache_size = 1")
    base.execute("BEGIN IMMEDIATE")
    copies = []
    for k in range(300):
        base.execute(
            "INSERT OR REPLACE INTO chunk VALUES (?,?,?,?,?,?,?,?)", (k, *["x" * 400] * 6, "no digest")
        )
        if k % 50 == 0:
            copies.append(path.read_bytes())
    base.rollback()
    base.close()
    copy = tmp_path / "copy.ledger"
    for data in copies:
        copy.write_bytes(data)
        try:
            found = content(copy)
        except SweepError:
            continue
        assert all(one in [record(k) for k in range(5)] for one in found[1])


def test_no_ledger(tmp_path: Path) -> None:
    with pytest.raises(SweepError, match="no such ledger"):
        Ledger(tmp_path / "none.ledger")


def test_another_format_is_refused(tmp_path: Path) -> None:
    with pytest.raises(SweepError, match="format 2"):
        Ledger.create(tmp_path / "a.ledger", {**MANIFEST, "format": 2})
