"""Shares of a sweep, computed apart, made into one data set: copied, synced, then recorded as done."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vincula.errors import SweepError, listing
from vincula.sweep.finishing import finish
from vincula.sweep.ledger import Ledger
from vincula.sweep.lock import SweepLock
from vincula.sweep.recorded import differences, refuse_differences, trusted
from vincula.sweep.running import Places
from vincula.sweep.storage import DurableFolder, StorageRoom

if TYPE_CHECKING:
    from vincula.sweep.dataset import SweepData


def merge_shards(output: str | Path, shards: Sequence[str | Path] | None = None) -> SweepData:
    """Make one data set of the shares of a sweep.

    May be interrupted and called again; may be called before all shares are there, and again later.

    Args:
        output: Folder of the data set.
        shards: Folders of the shares; by default all that are beside it, `OUTPUT.shard-I-of-N`.

    Returns:
        The data set; its status says whether it is complete.

    Raises:
        SweepError: No shares, shares of different sweeps, damaged files, no room, another process at it.
    """
    from vincula.sweep.dataset import SweepData

    places = Places(Path(output).absolute())
    parts = [Places(Path(part).absolute()) for part in shards] if shards else _beside(places)
    with SweepLock(places.lock, places.data):
        room = StorageRoom(places.data)
        with room.guarded():
            manifest = _common_manifest(parts)
            with _target(places, manifest) as ledger:
                folder = DurableFolder(places.data, places.aside)
                folder.tidy()
                for part in parts:
                    _copy(part, places, ledger, folder, room)
                finish(places, ledger, folder)
    return SweepData(places.data)


def shares_beside(places: Places) -> list[Places]:
    """The shares of a sweep that lie beside its data set."""
    pattern = re.compile(re.escape(places.data.name) + r"\.shard-\d+-of-\d+")
    folder = places.data.parent
    found = (
        sorted(path for path in folder.iterdir() if pattern.fullmatch(path.name)) if folder.is_dir() else []
    )
    return [Places(path) for path in found]


def _beside(places: Places) -> list[Places]:
    found = shares_beside(places)
    if not found:
        raise SweepError(f"{places.data}: no shares are beside it; run them with --shard i/n", kind="usage")
    return found


def _common_manifest(parts: Sequence[Places]) -> dict[str, Any]:
    first: dict[str, Any] = {}
    for part in parts:
        with Ledger(part.ledger) as ledger:
            manifest = {**ledger.manifest, "shard": None}
        if first:
            refuse_differences(part.data, differences(first, manifest))
        first = first or manifest
    return first


def _target(places: Places, manifest: dict[str, Any]) -> Ledger:
    if places.ledger.exists():
        ledger = Ledger(places.ledger)
        try:
            refuse_differences(places.data, differences(ledger.manifest, manifest))
        except SweepError:
            ledger.close()
            raise
        return ledger
    if places.data.exists():
        raise SweepError(
            f"{places.data}: there is something already that is no sweep of vincula; choose another output",
            kind="usage",
        )
    return Ledger.create(places.ledger, manifest)


def _copy(part: Places, places: Places, ledger: Ledger, folder: DurableFolder, room: StorageRoom) -> None:
    """Every chunk of a share that is not there yet; one that failed gives way to one that did not."""
    with Ledger(part.ledger) as own:
        records, starts = list(own.records()), own.starts()
    done = {record.chunk: record for record in ledger.records()}
    todo = []
    for record in records:
        there = done.get(record.chunk)
        if (
            there is None
            or (there.state == "failed" and record.state == "done")
            or not trusted(places.data, there)
        ):
            todo.append(record)
    room.needed = len(todo) * int(ledger.manifest["bytes"])
    known = ledger.starts()
    if (
        known
        and starts
        and {k: None if v is None else v.tobytes() for k, v in known.items()}
        != {k: None if v is None else v.tobytes() for k, v in starts.items()}
    ):
        raise SweepError(
            f"{part.data}: its chunks start elsewhere than those of the other shares", kind="refused"
        )
    if starts and not known:
        ledger.put_starts(starts)
    _copy_description(part, places, folder)
    damaged = [record.chunk for record in todo if not trusted(part.data, record)]
    if damaged:
        raise SweepError(
            f"{part.data}: the files of chunks {listing(map(str, damaged))} are not what its ledger says: "
            "run that share again with resume",
            kind="storage",
        )
    for record in todo:
        for name in record.checksums:
            folder.write(name, (part.data / name).read_bytes())
        folder.sync(tuple(dict.fromkeys(name.rpartition("/")[0] for name in record.checksums)))
        ledger.put([record])
        room.needed -= int(ledger.manifest["bytes"])


def _copy_description(part: Places, places: Places, folder: DurableFolder) -> None:
    """What describes the arrays, and the values along the dimensions of a grid: the same in every share."""
    for path in [*sorted(part.data.glob("*/zarr.json")), part.data / "zarr.json"]:
        name = path.relative_to(part.data).as_posix()
        content = path.read_bytes()
        axis = f"{path.parent.name}/c.0"
        if json.loads(content).get("dimension_names") == [path.parent.name]:
            folder.write(axis, (part.data / axis).read_bytes())
        if not (places.data / name).is_file():
            folder.write(name, content)
