"""Every evaluated design, kept in one file: what a search goes on from after an interruption.

A search is determined by its seed and by what its designs are worth.  The log keeps both, batch by batch,
in the order in which they were asked for; a search that is begun again is given the answers of the log as
long as it asks the same questions, and so arrives where an undisturbed one does.
"""

from __future__ import annotations

import json
import os
import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from vincula.arrays import Matrix
from vincula.design.judged import Judged, joined
from vincula.errors import DesignError

if TYPE_CHECKING:
    from vincula.design.problem import DesignProblem

VERSION: Final = 1


class Log:
    """A file of batches of judged designs; use it as a context manager, or close it.

    Args:
        path: The file; it is made when it is not there.
        problem: The problem that it belongs to.

    Raises:
        DesignError: The file is no log, of another problem, or cannot be written.
    """

    def __init__(self, path: str | os.PathLike[str], problem: DesignProblem) -> None:
        self.path = Path(path)
        self._signs = problem.signs
        meta = {
            "version": VERSION,
            "problem": problem.name,
            "fingerprint": problem.fingerprint(),
            "variables": list(problem.space.names),
            "objectives": [objective.name for objective in problem.objectives],
            "constraints": list(problem.names_of_constraints),
        }
        with self._storing():
            self._base = sqlite3.connect(self.path, isolation_level=None)
            self._base.execute("PRAGMA synchronous=FULL")
            self._base.execute("CREATE TABLE IF NOT EXISTS meta (content TEXT NOT NULL)")
            self._base.execute(
                "CREATE TABLE IF NOT EXISTS batches (run TEXT, step INTEGER, designs BLOB, objectives BLOB, "
                "broken BLOB, doubtful BLOB, PRIMARY KEY (run, step))"
            )
            kept = self._base.execute("SELECT content FROM meta").fetchone()
            if kept is None:
                self._base.execute("INSERT INTO meta VALUES (?)", (json.dumps(meta),))
        if kept is not None and json.loads(kept[0]) != meta:
            self._base.close()
            raise DesignError(
                f"{self.path}: this log is of another problem, or of another state of its mechanism"
            )

    def __enter__(self) -> Log:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Close the file."""
        self._base.close()

    def get(self, run: str, step: int, designs: Matrix) -> Judged | None:
        """The answer to a question that was asked before; None for a new one.

        Raises:
            DesignError: At this step of this run other designs were asked for: other software, say.
        """
        with self._storing():
            row = self._base.execute(
                "SELECT designs, objectives, broken, doubtful FROM batches WHERE run = ? AND step = ?",
                (run, step),
            ).fetchone()
        if row is None:
            return None
        if row[0] != np.ascontiguousarray(designs).tobytes():
            raise DesignError(
                f"{self.path}: step {step} of {run} asked for other designs before: the log was written with "
                "other software or settings; begin a new one"
            )
        return self._judged(row, designs.shape[1])

    def put(self, run: str, step: int, judged: Judged) -> None:
        """Keep a batch; it is on disk when this returns."""
        with self._storing():
            self._base.execute(
                "INSERT INTO batches VALUES (?, ?, ?, ?, ?, ?)",
                (run, step, *(np.ascontiguousarray(a).tobytes() for a in (
                    judged.designs, judged.objectives, judged.broken, judged.doubtful))),
            )  # fmt: skip

    def everything(self) -> Judged | None:
        """All designs of all runs, in the order in which they were kept; None for an empty log."""
        with self._storing():
            rows = self._base.execute(
                "SELECT designs, objectives, broken, doubtful FROM batches ORDER BY rowid"
            ).fetchall()
            content = json.loads(self._base.execute("SELECT content FROM meta").fetchone()[0])
        return joined([self._judged(row, len(content["variables"])) for row in rows]) if rows else None

    def _judged(self, row: tuple[bytes, ...], columns: int) -> Judged:
        designs = np.frombuffer(row[0]).reshape(-1, columns)
        count = max(len(designs), 1)
        tables: list[Any] = [np.frombuffer(part).reshape(len(designs), -1 if len(designs) else 1)
                             for part in row[1:3]]  # fmt: skip
        return Judged(designs, tables[0], tables[1], self._signs, np.frombuffer(row[3], dtype=bool)[:count])

    @contextmanager
    def _storing(self) -> Iterator[None]:
        """What the data base refuses, as an error of ours."""
        try:
            yield
        except sqlite3.Error as error:
            raise DesignError(f"{self.path}: the log cannot be used ({error})", kind="storage") from error
