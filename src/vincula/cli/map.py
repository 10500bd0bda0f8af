"""`vincula map`: workspace and singular curves over two variables, as data and as a figure."""

from __future__ import annotations

import csv
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from vincula.cli.options import (
    active_option,
    close_option,
    debug_option,
    json_option,
    mechanism_options,
    together,
    weights_option,
)
from vincula.cli.output import print_json, warnings_on_stderr

if TYPE_CHECKING:
    from vincula.cli.subject import Subject
    from vincula.maps.curves import Curve
    from vincula.maps.map_data import SingularityMap
    from vincula.maps.variables import Variable

POINTS = 61
"""Values along a variable when nothing is said."""


@click.command(
    "map",
    short_help="Map the workspace of FILE and its singular curves.",
    epilog="Example: vincula map example:five-bar --over x=-1.6:2.2 --over y=-4.6:1.2 "
    "--index kinematic.inverse_condition_number:translation -o map.svg",
)
@click.option(
    "--over",
    "variables",
    multiple=True,
    required=True,
    metavar="NAME=FROM:TO[:COUNT]",
    help="A variable, given twice: a motor or joint axis, or x, y, z, angle (in space rx, ry, rz) of the "
    "reference member; in m and rad, or with a unit (a1=-60deg:60deg:61).",
)
@together(active_option, mechanism_options, close_option, weights_option)
@click.option(
    "--index",
    "indices",
    multiple=True,
    metavar="QUANTITY",
    help="An index to evaluate, such as kinematic.inverse_condition_number:translation, or distance (to the "
    "nearest singular curve); repeatable, the first is shown in colour.",
)
@click.option(
    "--modes",
    type=click.Choice(["start", "all"]),
    default="start",
    help="start: the branch of the configuration looked at; all: every branch found there.",
)
@click.option("--limits/--no-limits", default=True, help="Whether joint limits bound the region.")
@click.option("-o", "--output", metavar="FIGURE", help="Figure to write: .svg, .png or .pdf.")
@click.option(
    "--data",
    metavar="FILE",
    help="Data to write: .json or .zarr (everything), or .csv (a row a point reached).",
)
@click.option("--linkage/--no-linkage", default=True, help="Draw the mechanism in the map where it fits.")
@click.option("--width", type=click.FloatRange(1.0, 100.0), metavar="INCH", help="Width of the figure.")
@together(json_option, debug_option)
def map_command(
    file: str,
    variables: Sequence[str],
    active: str | None,
    closing: bool,
    weights: str | None,
    indices: Sequence[str],
    modes: str,
    limits: bool,
    output: str | None,
    data: str | None,
    linkage: bool,
    width: float | None,
    as_json: bool,
    **options: Any,
) -> None:
    """Where FILE reaches over two variables, its indices there, and where it is singular, by type.

    Over two motors the mechanism is driven by them, over x and y its reference member is led. Singular
    curves are located by root finding: where the member becomes free with the motors locked, where
    motors lose authority over it, where loops degenerate; and what bounds the region. FILE is a path or
    example:NAME.
    """
    from vincula.cli.subject import read_subject
    from vincula.maps.singularity_map import map_over

    _refuse_endings(output, data)
    chosen = [read_variable(text) for text in variables]
    with warnings_on_stderr():
        subject = read_subject(file, closing=closing, **options).with_active(active).with_weights(weights)
        found = map_over(
            subject.mechanism,
            chosen,
            start=subject.configuration,
            quantities=[name for name in indices if name != "distance"],
            modes="all" if modes == "all" else "start",
            limits=limits,
            progress=_progress(),
        )
        _write(found, output, data, indices[0] if indices else None, linkage=linkage, width=width)
    if as_json:
        print_json(found.to_dict())
    else:
        _print(found, subject)


def read_variable(text: str) -> Variable:
    """A variable from `NAME=FROM:TO[:COUNT]`.

    Raises:
        click.UsageError: Another form, or a number that is none.
    """
    from vincula.errors import ModelError
    from vincula.maps.variables import Variable
    from vincula.spatial.units import quantity

    name, equals, ranges = (part.strip() for part in text.partition("="))
    parts = ranges.split(":")
    if not (name and equals and len(parts) in (2, 3)):
        raise click.UsageError(f"--over {text!r} is not of the form NAME=FROM:TO[:COUNT], such as x=-1:1:61")
    try:
        dimension: Any = "angle" if parts[0].strip().endswith(("deg", "rad")) else _dimension(parts[0])
        low, high = (quantity(part, dimension, f"--over {name}") for part in parts[:2])
        count = int(parts[2]) if len(parts) == 3 else POINTS
        return Variable(name, low, high, count)
    except (ValueError, ModelError) as error:
        raise click.UsageError(f"--over {text!r}: {error}") from None


def _dimension(text: str) -> str:
    """Plain numbers are metres or radians, whichever the variable is in: both leave them as they are."""
    return "length" if text.strip()[-1:].isalpha() else "angle"


def _refuse_endings(output: str | None, data: str | None) -> None:
    from vincula.view.plot import FORMATS

    if output is not None and Path(output).suffix.lower() not in FORMATS:
        raise click.UsageError(f"-o {output}: the figure's name must end in {', '.join(FORMATS)}")
    if data is not None and Path(data).suffix.lower() not in (".json", ".csv", ".zarr"):
        raise click.UsageError(f"--data {data}: the name must end in .json, .csv or .zarr")


def _progress() -> Callable[[str, int, int], None] | None:
    """A line on a terminal's stderr that is written over; nothing elsewhere."""
    import sys
    import time

    if not sys.stderr.isatty():
        return None
    last = [0.0]

    def show(words: str, done: int, total: int) -> None:
        now = time.monotonic()
        if now - last[0] > 0.2:
            last[0] = now
            click.echo(f"\r{words}: {done} of at most {total} points reached   ", err=True, nl=False)

    return show


def _write(
    found: SingularityMap,
    output: str | None,
    data: str | None,
    shown: str | None,
    *,
    linkage: bool,
    width: float | None,
) -> None:
    from vincula.errors import FileError

    try:
        if data is not None and Path(data).suffix.lower() == ".csv":
            with Path(data).open("w", newline="", encoding="utf-8") as stream:
                csv.writer(stream).writerows(_rows(found))
        elif data is not None and Path(data).suffix.lower() == ".zarr":
            from vincula.maps.dataset import write_zarr

            write_zarr(found, data)
        elif data is not None:
            import json

            Path(data).write_text(json.dumps(found.to_dict(), allow_nan=False) + "\n", encoding="utf-8")
        if output is not None:
            from vincula.view.map_figure import plot_map
            from vincula.view.plot import save_figure

            save_figure(plot_map(found, shown, linkage=linkage, width=width), output)
    except OSError as error:
        raise FileError(
            f"{error.filename or output or data}: cannot be written ({error.strerror})"
        ) from error
    for path in (data, output):
        if path is not None:
            click.echo(f"wrote {path}", err=True)


def _rows(found: SingularityMap) -> list[list[Any]]:
    """A header and a row for every point reached."""
    names = [f"{v.name} [{unit}]" for v, unit in zip(found.variables, found.units, strict=True)]
    indices = list(found.sheets[0].quantities)
    rows: list[list[Any]] = [
        ["branch", *names, "status", *indices, f"distance [{found.distance_unit}]", "nearest"]
    ]
    for k, sheet in enumerate(found.sheets):
        for i, j in zip(*sheet.reached.nonzero(), strict=True):
            rows.append(
                [k + 1, found.grid[0][i], found.grid[1][j], found.status_names[sheet.status[i, j]],
                 *(sheet.quantities[name][i, j] for name in indices), sheet.distance[i, j],
                 sheet.nearest[i, j]]
            )  # fmt: skip
    return rows


def _print(found: SingularityMap, subject: Subject) -> None:
    from vincula.view.plot import motors_text

    reference = found.mechanism.reference
    member = reference.body if reference else "no reference member"
    click.echo(f"{found.mechanism.name}: map of {member!r}, {motors_text(subject.mechanism)}")
    for k, sheet in enumerate(found.sheets):
        total = sheet.reached.size
        head = f"branch {k + 1}: " if len(found.sheets) > 1 else ""
        click.echo(f"{head}{int(sheet.reached.sum())} of {total} points of the grid are reached")
        seen: dict[tuple[str, bool], list[Curve]] = {}
        for curve in sheet.curves:
            seen.setdefault((curve.kind, curve.edge), []).append(curve)
        for (kind, edge), group in seen.items():
            where = "bounds the region" if edge else "crosses it"
            points = sum(len(curve.points) for curve in group)
            pieces = f"{len(group)} curve{'s' if len(group) > 1 else ''}, {points} points"
            click.echo(f"  {kind} {where} ({pieces}): {group[0].crossings[0].words}")
        for kind, words in sheet.everywhere.items():
            click.echo(f"  {kind} at every point: {words}")
        if not seen and not sheet.everywhere:
            click.echo("  no singular curve, and the region fills the grid")
