"""The ledger: what a sweep is, and which of its chunks are done; one SQLite file beside the data set.

Every row carries a digest of itself, and the manifest says how many chunks there are, so that a damaged
or cut ledger is recognised and never believed.  A rollback journal is used, not a write-ahead log:
that one does not work on the network file systems of clusters.
"""

from __future__ import annotations

import hashlib
import json
import sqlite3
from collections.abc import Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any, Final, Literal

import numpy as np

from vincula.arrays import Vector, frozen
from vincula.errors import SweepError

FORMAT: Final = 1
"""Version of the ledger's tables."""
MOST_REASONS: Final = 200
"""Stretches of points of a chunk whose reasons are kept; the rest is told by their status alone.

Words about whole configurations are found one by one, which takes milliseconds."""

State = Literal["done", "failed"]

_TABLES: Final = """
CREATE TABLE manifest (key TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;
CREATE TABLE start (chunk INTEGER PRIMARY KEY, value BLOB, digest TEXT NOT NULL);
CREATE TABLE chunk (
  chunk INTEGER PRIMARY KEY, state TEXT NOT NULL, checksums TEXT NOT NULL, counts TEXT NOT NULL,
  error TEXT NOT NULL, inputs TEXT NOT NULL, reasons TEXT NOT NULL, digest TEXT NOT NULL
);
"""

_COLUMNS: Final = "chunk, state, checksums, counts, error, inputs, reasons, digest"


@dataclass(frozen=True, slots=True)
class Reason:
    """Why some points of a chunk are not ok.

    Attributes:
        first: First point, counted through the whole sweep in the chunk's own order.
        last: Last point of the stretch.
        text: Why.
    """

    first: int
    last: int
    text: str


@dataclass(frozen=True, slots=True)
class Record:
    """What the ledger knows of a chunk.

    Attributes:
        chunk: Its number.
        state: `done`, or `failed` where its worker died or hung twice.
        checksums: Checksum of its file by array.
        counts: Points by status.
        error: Why it failed.
        inputs: What it was given: its points, for repeating it by hand.
        reasons: Why points are not ok.
    """

    chunk: int
    state: State
    checksums: Mapping[str, str]
    counts: Mapping[str, int]
    error: str = ""
    inputs: str = ""
    reasons: tuple[Reason, ...] = ()


class Ledger:
    """The ledger of a sweep; use it as a context manager.

    Args:
        path: The file, which must exist (`Ledger.create` makes one).

    Raises:
        SweepError: There is none, or it is damaged.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        try:
            if not path.is_file():
                raise SweepError(f"{path}: there is no such ledger, so no sweep to go on with", kind="usage")
            with ExitStack() as unless_opened:
                self._base = _connected(path)
                unless_opened.callback(self._base.close)
                self.manifest = self._checked_manifest()
                unless_opened.pop_all()
        except (sqlite3.Error, OSError, UnicodeError) as error:
            raise self._damaged(str(error)) from None

    @staticmethod
    def create(path: Path, manifest: Mapping[str, Any]) -> Ledger:
        """A new ledger, complete or not there at all.

        Raises:
            sqlite3.Error: It cannot be stored.
            OSError: It cannot be stored.
        """
        text = json.dumps(manifest, sort_keys=True)
        draft = path.with_name(path.name + ".new")
        for left in (draft, draft.with_name(draft.name + "-journal")):
            left.unlink(missing_ok=True)
        base = _connected(draft)
        try:
            base.executescript(f"BEGIN;{_TABLES}")
            base.execute("INSERT INTO manifest VALUES ('manifest', ?), ('digest', ?)", (text, _digest(text)))
            base.commit()
        except sqlite3.Error:
            base.close()
            draft.unlink(missing_ok=True)
            raise
        base.close()
        draft.replace(path)
        return Ledger(path)

    def __enter__(self) -> Ledger:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Let go of the file."""
        self._base.close()

    # Chunks -----------------------------------------------------------------------------------

    def records(self) -> Iterator[Record]:
        """Every chunk that is done or failed, in order.

        Raises:
            SweepError: The ledger is damaged.
        """
        with self._believed():
            for row in self._base.execute(
                f"SELECT {_COLUMNS} FROM chunk ORDER BY chunk"  # noqa: S608  a constant
            ):
                yield self._record(row)

    def count(self) -> int:
        """Number of chunks that are done or failed.

        Raises:
            SweepError: The ledger is damaged.
        """
        with self._believed():
            return int(self._base.execute("SELECT COUNT(*) FROM chunk").fetchone()[0])

    def record(self, chunk: int) -> Record | None:
        """What is known of one chunk; None when it is not done.

        Raises:
            SweepError: The ledger is damaged.
        """
        with self._believed():
            row = self._base.execute(
                f"SELECT {_COLUMNS} FROM chunk WHERE chunk = ?",  # noqa: S608  a constant
                (chunk,),
            ).fetchone()
        return None if row is None else self._record(row)

    def put(self, records: Iterable[Record]) -> None:
        """Record chunks as done or failed, all or none; synced when this returns.

        Raises:
            sqlite3.Error: They cannot be stored.
        """
        rows = [_row(record) for record in records]
        with self._base:
            self._base.executemany("INSERT OR REPLACE INTO chunk VALUES (?, ?, ?, ?, ?, ?, ?, ?)", rows)

    def forget(self, chunks: Iterable[int]) -> None:
        """Take chunks for not done.

        Raises:
            sqlite3.Error: That cannot be stored.
        """
        with self._base:
            self._base.executemany("DELETE FROM chunk WHERE chunk = ?", [(chunk,) for chunk in chunks])

    # Starts -----------------------------------------------------------------------------------

    def starts(self) -> dict[int, Vector | None]:
        """Start configurations by chunk, those that are fixed; None where there is none.

        Raises:
            SweepError: The ledger is damaged.
        """
        found: dict[int, Vector | None] = {}
        with self._believed():
            for chunk, value, digest in self._base.execute("SELECT chunk, value, digest FROM start"):
                if digest != _digest(chunk, value):
                    raise self._damaged(f"the start of chunk {chunk} does not fit its digest")
                found[chunk] = (
                    None if value is None else frozen(np.frombuffer(value, dtype="<f8").astype(float))
                )
        return found

    def put_starts(self, starts: Mapping[int, Vector | None]) -> None:
        """Fix the starts of chunks for good.

        Raises:
            sqlite3.Error: They cannot be stored.
        """
        values = {c: None if v is None else np.asarray(v, dtype="<f8").tobytes() for c, v in starts.items()}
        with self._base:
            self._base.executemany(
                "INSERT INTO start VALUES (?, ?, ?)", [(c, v, _digest(c, v)) for c, v in values.items()]
            )

    # Belief -----------------------------------------------------------------------------------

    def _checked_manifest(self) -> dict[str, Any]:
        if self._base.execute("PRAGMA quick_check").fetchone() != ("ok",):
            raise self._damaged("its pages do not fit together")
        found = dict(self._base.execute("SELECT key, value FROM manifest"))
        text = found.get("manifest", "")
        if found.get("digest") != _digest(text):
            raise self._damaged("its manifest does not fit its digest")
        manifest: dict[str, Any] = json.loads(text)
        if manifest.get("format") != FORMAT:
            raise SweepError(
                f"{self.path}: the ledger has format {manifest.get('format')!r}, this version of vincula "
                f"reads {FORMAT}",
                kind="refused",
            )
        return manifest

    def _record(self, row: tuple[Any, ...]) -> Record:
        *content, digest = row
        if digest != _digest(*content) or not 0 <= content[0] < self.manifest["chunks"]:
            raise self._damaged(f"the row of chunk {content[0]} does not fit its digest")
        chunk, state, checksums, counts, error, inputs, reasons = content
        told = tuple(Reason(*entry) for entry in json.loads(reasons))
        return Record(chunk, state, json.loads(checksums), json.loads(counts), error, inputs, told)

    @contextmanager
    def _believed(self) -> Iterator[None]:
        try:
            yield
        except (sqlite3.DatabaseError, UnicodeError) as error:
            raise self._damaged(str(error)) from None

    def _damaged(self, reason: str) -> SweepError:
        if "locked" in reason:
            return SweepError(f"{self.path}: the ledger is being written; try again", kind="refused")
        return SweepError(
            f"{self.path}: the ledger is damaged ({reason}); nothing in it is believed. Put a copy of it "
            "back, or run the sweep anew with --overwrite",
            kind="storage",
        )


def _connected(path: Path) -> sqlite3.Connection:
    base = sqlite3.connect(path, timeout=30.0, check_same_thread=False)
    with ExitStack() as unless_connected:
        unless_connected.callback(base.close)
        base.execute("PRAGMA journal_mode = DELETE").fetchone()
        base.execute("PRAGMA synchronous = EXTRA")
        unless_connected.pop_all()
    return base


def _row(record: Record) -> tuple[Any, ...]:
    reasons = [[r.first, r.last, r.text] for r in record.reasons[:MOST_REASONS]]
    content = (
        record.chunk,
        record.state,
        json.dumps(record.checksums, sort_keys=True),
        json.dumps(record.counts, sort_keys=True),
        record.error,
        record.inputs,
        json.dumps(reasons),
    )
    return (*content, _digest(*content))


def _digest(*content: object) -> str:
    return hashlib.sha256(repr(content).encode()).hexdigest()
