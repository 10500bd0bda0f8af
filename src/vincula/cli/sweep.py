"""`vincula sweep`: run, resume, status, merge, export."""

from __future__ import annotations

import os
import sys
import threading
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from vincula.cli.exits import DONE, INTERRUPTED, REFUSED
from vincula.cli.options import output_options, together
from vincula.cli.output import print_json, warnings_on_stderr
from vincula.cli.warming import tell_first_wait

if TYPE_CHECKING:
    from vincula.sweep.dataset import SweepData


def share(ctx: click.Context, parameter: click.Parameter, value: str | None) -> tuple[int, int] | None:
    """The numbers of `i/n`."""
    if value is None:
        return None
    first, slash, second = value.partition("/")
    if not (slash and first.isascii() and second.isascii() and first.isdigit() and second.isdigit()):
        raise click.BadParameter(f"{value!r}: say i/n, for example 1/3", ctx=ctx, param=parameter)
    i, n = int(first), int(second)
    if not 1 <= i <= n:
        raise click.BadParameter(f"{value!r}: i goes from 1 to n", ctx=ctx, param=parameter)
    return i, n


run_options = together(
    click.option("-o", "--output", metavar="FOLDER", help="The data set (zarr); default: as the file says."),
    click.option("--jobs", type=click.IntRange(1, 1024), metavar="N", help="Worker processes."),
    click.option(
        "--threads", type=click.IntRange(1, 1024), metavar="N", help="Threads (default: one a core)."
    ),
    click.option(
        "--scheduler", metavar="ADDRESS", help="Workers of this dask scheduler do the work (extra `dask`)."
    ),
    click.option(
        "--shard",
        metavar="I/N",
        callback=share,
        help="Compute the I-th of N shares, in files of its own; `vincula sweep merge` joins them.",
    ),
    click.option(
        "--hang-after",
        type=click.FloatRange(0.0, min_open=True),
        metavar="SECONDS",
        help="A worker counts as hung after so long (default: 5 min and 20 times the slowest chunk).",
    ),
    click.option("--quiet", is_flag=True, help="No progress on stderr."),
)


@click.group("sweep", short_help="Compute quantities over many points, safely.")
def sweep_command() -> None:
    """Compute chosen quantities over grids, paths, random sets or tables, into one labelled data set.

    What is stored survives whatever happens: a sweep that was killed or interrupted, or ran out of disk,
    goes on with `vincula sweep resume`.
    """


@sweep_command.command("run", short_help="Run the sweep of a file.")
@click.argument("file", metavar="SWEEP.yaml")
@run_options
@click.option("--resume", is_flag=True, help="Go on with what is there, if anything is.")
@click.option("--overwrite", is_flag=True, help="Remove an earlier sweep of that name first.")
@output_options
@click.pass_context
def run_command(
    ctx: click.Context,
    /,
    file: str,
    output: str | None,
    resume: bool,
    overwrite: bool,
    as_json: bool,
    **options: Any,
) -> None:
    """Run the sweep that SWEEP.yaml describes."""
    if resume and overwrite:
        raise click.UsageError("--resume goes on with what is there, --overwrite removes it: choose one")
    ctx.exit(_run(file, output, resume=resume, overwrite=overwrite, as_json=as_json, **options))


@sweep_command.command("resume", short_help="Go on with a sweep.")
@click.argument("target", metavar="SWEEP.yaml|FOLDER")
@run_options
@output_options
@click.pass_context
def resume_command(
    ctx: click.Context, /, target: str, output: str | None, as_json: bool, **options: Any
) -> None:
    """Go on with a sweep, named by its file or by its data set. Chunks that failed are tried again."""
    from vincula.cli.sweep_subject import sweep_file_of

    file, data = sweep_file_of(target)
    ctx.exit(
        _run(file, output or data, resume=True, must_exist=True, overwrite=False, as_json=as_json, **options)
    )


@sweep_command.command("status", short_help="How complete a sweep is.")
@click.argument("target", metavar="SWEEP.yaml|FOLDER")
@output_options
def status_command(target: str, as_json: bool) -> None:
    """How complete a sweep is, which chunks failed and why, and why points are not ok."""
    from vincula.cli import sweep_page
    from vincula.sweep.dataset import SweepData

    parts = [SweepData(path) for path in _data_sets(target)]
    if as_json:
        print_json(sweep_page.status_facts(parts))
    else:
        sweep_page.status_page(parts).show()


@sweep_command.command("merge", short_help="Join the shares of a sweep.")
@click.argument("target", metavar="SWEEP.yaml|FOLDER")
@click.argument("shards", nargs=-1, metavar="[SHARE]...")
@output_options
@click.pass_context
def merge_command(ctx: click.Context, /, target: str, shards: Sequence[str], as_json: bool) -> None:
    """Join shares (`--shard I/N`) into the data set FOLDER; by default all that lie beside it."""
    from vincula.cli import sweep_page
    from vincula.sweep.merging import merge_shards

    data = merge_shards(_output(target), list(shards) or None)
    ctx.exit(_told(data, "vincula/sweep-merge/1", as_json, sweep_page))


@sweep_command.command("export", short_help="Write a sweep as netCDF, CSV or Parquet.")
@click.argument("target", metavar="SWEEP.yaml|FOLDER")
@click.argument("file", metavar="FILE.nc|FILE.csv|FILE.parquet")
@click.option("--overwrite", is_flag=True, help="Replace FILE.")
@output_options
def export_command(target: str, file: str, overwrite: bool, as_json: bool) -> None:
    """Write a sweep as netCDF, CSV or Parquet (needs pyarrow), by the ending of FILE."""
    from vincula.sweep.dataset import SweepData
    from vincula.sweep.export import export

    data = SweepData(_output(target))
    written = export(data, file, overwrite=overwrite)
    if as_json:
        print_json({"schema": "vincula/sweep-export/1", "data": str(data.path), "file": str(written)})
    else:
        click.echo(f"{written}: written")


def _run(
    file: str,
    output: str | None,
    *,
    as_json: bool,
    quiet: bool,
    resume: bool,
    overwrite: bool,
    must_exist: bool = False,
    shard: tuple[int, int] | None = None,
    **options: Any,
) -> int:
    from vincula.cli import sweep_page
    from vincula.cli.sweep_progress import ProgressOnStderr
    from vincula.cli.sweep_subject import output_of, sweep_of
    from vincula.errors import SweepError
    from vincula.files.sweep_file import read_sweep
    from vincula.sweep.running import Places

    read = read_sweep(file)
    target = output_of(read, output)
    place = Places(target) if shard is None else Places(target).shard(shard)
    if must_exist and not place.ledger.exists():
        raise SweepError(f"{place.data}: nothing has been begun there; use `vincula sweep run`", kind="usage")
    with warnings_on_stderr():
        sweep = sweep_of(read)
        tell_first_wait(quiet=quiet)
        try:
            with ProgressOnStderr(quiet=quiet) as progress:
                data = sweep.run(
                    target, resume=resume, overwrite=overwrite, shard=shard, progress=progress, **options
                )
        except KeyboardInterrupt:
            return _interrupted(place.data)
    return _told(data, "vincula/sweep-run/1", as_json, sweep_page)


def _interrupted(data: Path) -> int:
    """Say how to go on; threads that are still at a chunk must not hold up the end."""
    click.echo(f"interrupted; go on with: vincula sweep resume {data}", err=True)
    if any(thread.name.startswith("sweep_") and not thread.daemon for thread in threading.enumerate()):
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(INTERRUPTED)
    return INTERRUPTED


def _told(data: SweepData, schema: str, as_json: bool, pages: Any) -> int:
    status = data.status()
    if as_json:
        print_json({**pages.status_facts([data]), "schema": schema})
    else:
        pages.status_page([data]).show()
    return DONE if status.complete else REFUSED


def _output(target: str) -> Path:
    """The data set of TARGET, which may be a sweep file."""
    from vincula.cli.sweep_subject import output_of
    from vincula.files.sweep_file import read_sweep

    path = Path(target)
    if path.is_file() and path.suffix.lower() in (".yaml", ".yml", ".json"):
        return output_of(read_sweep(target), None)
    return path


def _data_sets(target: str) -> list[Path]:
    """The data set of TARGET, or its shares where they have not been joined."""
    from vincula.sweep.merging import shares_beside
    from vincula.sweep.running import Places

    places = Places(_output(target).absolute())
    if places.ledger.exists():
        return [places.data]
    return [part.data for part in shares_beside(places)] or [places.data]
