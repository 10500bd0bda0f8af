"""What `vincula sweep` says about a sweep, on a page and as JSON."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Final

from vincula.cli.page import Column, Page, Table

if TYPE_CHECKING:
    from vincula.sweep.dataset import SweepData, SweepStatus

MOST_FAILURES: Final = 10
"""Failed chunks that the page lists; JSON has all."""


def status_facts(parts: Sequence[SweepData]) -> dict[str, Any]:
    """How complete a sweep is, for `--json`: one data set, or its shares."""
    if len(parts) == 1:
        return {"schema": "vincula/sweep-status/1", **_facts(parts[0])}
    facts = [_facts(part) for part in parts]
    return {
        "schema": "vincula/sweep-status/1",
        "complete": False,
        "points": sum(part["points"] for part in facts),
        "points_done": sum(part["points_done"] for part in facts),
        "shares": facts,
    }


def _facts(data: SweepData) -> dict[str, Any]:
    status = data.status()
    manifest = status.manifest
    return {
        "data": str(data.path),
        "complete": status.complete,
        "mechanism": manifest["mechanism"],
        "model_hash": manifest["model"],
        "code": manifest["code"],
        "shard": manifest.get("shard"),
        "variables": [name for name, _, _ in manifest["variables"]],
        "quantities": manifest["quantities"],
        "given": manifest["given"],
        "shape": manifest["shape"],
        "chunks": {"all": status.chunks, "done": status.done, "failed": len(status.failed)},
        "points": status.points,
        "points_done": status.points_done,
        "counts": dict(status.counts),
        "failed": [
            {"chunk": record.chunk, "error": record.error, "inputs": json.loads(record.inputs or "null")}
            for record in status.failed
        ],
    }


def status_page(parts: Sequence[SweepData]) -> Page:
    """How complete a sweep is."""
    page = Page()
    for data in parts:
        _describe(page, data, data.status())
    return page


def _describe(page: Page, data: SweepData, status: SweepStatus) -> None:
    manifest = status.manifest
    state = "complete" if status.complete else "not complete"
    page.heading(str(data.path.name), state)
    shape = " x ".join(str(n) for n in manifest["shape"])
    share = manifest.get("shard")
    rows = [
        ("mechanism", manifest["mechanism"]),
        ("model hash", manifest["model"][:16]),
        ("points", f"{shape} over {', '.join(name for name, _, _ in manifest['variables'])}"),
        ("quantities", ", ".join(manifest["quantities"])),
        (
            "stored",
            f"{status.points_done} of {status.points} points, {status.done} of {status.chunks} chunks",
        ),
    ]
    if share:
        rows.append(("share", f"{share[0]} of {share[1]}"))
    told = [f"{count} {name}" for name, count in status.counts.items() if count]
    if told:
        rows.append(("points by status", ", ".join(told)))
    page.facts(rows)
    if status.failed:
        page.sentence(f"{len(status.failed)} chunks failed; `vincula sweep resume` tries them again.", "!")
        shown = [[str(record.chunk), record.error] for record in status.failed[:MOST_FAILURES]]
        page.table(Table([Column("chunk", "right"), Column("why", fold=True)], shown))
    elif not status.complete:
        page.sentence(f"go on with: vincula sweep resume {data.path}")
