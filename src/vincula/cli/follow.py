"""`vincula follow`: along motor values or poses, to the end, a singularity or a limit."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Any, Final, cast

import click

from vincula.cli.exits import DONE, REFUSED
from vincula.cli.options import active_option, mechanism_options, output_options, together
from vincula.cli.output import print_json, warnings_on_stderr
from vincula.errors import FileError

if TYPE_CHECKING:
    from vincula.cli.follow_efficiencies import Axis
    from vincula.cli.subject import Subject
    from vincula.mechanism.following import Waypoint
    from vincula.mechanism.paths import Path
    from vincula.mechanism.watching import SingularityKind

THROUGH: Final = ("platform", "authority", "internal", "all")
"""Words of `--through`; what they mean is in `follow_page.THROUGH`."""


@click.command(
    "follow",
    short_help="Follow motor values or poses of FILE.",
    epilog="Example: vincula follow example:delta --to a1=0.3,a2=0.1,a3=0 --steps 50 --csv path.csv",
)
@together(active_option, mechanism_options)
@click.option(
    "--to",
    "targets",
    multiple=True,
    metavar="CONFIG",
    help="Motor values to go to: name=value,... in the units of the file. Repeatable: one after the other.",
)
@click.option(
    "--path", "file_of_values", metavar="FILE.csv", help="A row of names, then rows of motor values."
)
@click.option(
    "--point", "points", multiple=True, metavar="X,Y[,Z]",
    help="Position of the reference point to go to, ground axes. Repeatable.",
)  # fmt: skip
@click.option(
    "--pose", "poses", multiple=True, metavar="X,Y,ANGLE | X,Y,Z,QW,QX,QY,QZ",
    help="Pose of the reference member to go to, ground axes. Repeatable.",
)  # fmt: skip
@click.option("--steps", type=click.IntRange(1, 1_000_000), metavar="N",
              help="Configurations to record, evenly spaced (default: one a waypoint).")  # fmt: skip
@click.option("--limits/--no-limits", default=True, help="Whether joint limits stop the path (they do).")
@click.option(
    "--through", multiple=True, type=click.Choice(THROUGH),
    help="Kinds of singularity to pass: the platform becomes free, motors lose authority, inner degeneracy.",
)  # fmt: skip
@click.option("--csv", "table", metavar="FILE.csv", help="Write every configuration as a row.")
@click.option("--directions", is_flag=True,
              help="Motor and task direction of every efficiency as columns of the table.")  # fmt: skip
@click.option("--frames", metavar="FOLDER", help="Write a picture of every configuration (extra `plot`).")
@click.option("--frame-format", type=click.Choice(["png", "svg"]), default="png", show_default=True,
              help="Format of the pictures.")  # fmt: skip
@output_options
@click.pass_context
def follow_command(
    ctx: click.Context,
    /,
    file: str,
    active: str | None,
    targets: Sequence[str],
    file_of_values: str | None,
    points: Sequence[str],
    poses: Sequence[str],
    steps: int | None,
    limits: bool,
    through: Sequence[str],
    table: str | None,
    directions: bool,
    frames: str | None,
    frame_format: str,
    as_json: bool,
    **options: Any,
) -> None:
    """Follow FILE from --at along motor values or poses, on one assembly branch.

    FILE is a path or example:NAME. Motors that are not named stand still. It stops at a singularity or
    a joint limit (exit code 1) and says which, where, and which joints take part.
    """
    from vincula.cli import follow_page
    from vincula.cli.subject import read_subject

    if sum(map(bool, (targets, file_of_values, points, poses))) != 1:
        raise click.UsageError("say where to go with one of --to, --path, --point and --pose")
    kinds = follow_page.THROUGH
    chosen = kinds.values() if "all" in through else [kinds[word] for word in through]
    with warnings_on_stderr():
        subject = read_subject(file, **options).with_active(active)
        waypoints = _waypoints(subject, targets, file_of_values, points, poses)
        path = subject.mechanism.follow(
            waypoints,
            start=subject.configuration,
            samples=steps,
            limits=limits,
            through=cast("list[SingularityKind]", list(chosen)),
        )
        if table is not None:
            _write_table(subject, path, table, directions=directions)
        if frames is not None:
            _write_frames(path, frames, frame_format)
    if as_json:
        print_json(follow_page.path_facts(subject, path))
    else:
        follow_page.path_page(subject, path).show()
    ctx.exit(DONE if path.complete else REFUSED)


def _waypoints(
    subject: Subject,
    targets: Sequence[str],
    file_of_values: str | None,
    points: Sequence[str],
    poses: Sequence[str],
) -> list[Waypoint]:
    from vincula.cli.asked import motor_values, path_file, point_or_pose

    if file_of_values is not None:
        return path_file(subject, file_of_values)
    if targets:
        return [motor_values(subject, "--to", text) for text in targets]
    if points:
        return [point_or_pose(subject, "--point", text, pose=False) for text in points]
    return [point_or_pose(subject, "--pose", text, pose=True) for text in poses]


def _write_table(subject: Subject, path: Path, file: str, *, directions: bool) -> None:
    """Joint values in the units of the file, a row a configuration."""
    from vincula.cli.close_page import configuration_of
    from vincula.cli.follow_efficiencies import axes_along

    axes = axes_along(subject, path)
    names = _direction_columns(subject, len(axes[0])) if directions else []
    try:
        with FilePath(file).open("w", newline="", encoding="utf-8") as stream:
            writer = csv.writer(stream)
            for k, point in enumerate(path.points):
                values = configuration_of(subject, point.configuration)
                if k == 0:
                    own = [f"efficiency{i}" for i in range(1, len(axes[0]) + 1)]
                    writer.writerow(["parameter", *_columns(values), "residual", "margin", *own, *names])
                numbers = [x for v in values.values() for x in (v if isinstance(v, list) else [v])]
                numbers += [point.residual, point.margin]
                more = _direction_row(subject, axes[k]) if directions else []
                writer.writerow([point.parameter, *numbers, *(axis.efficiency for axis in axes[k]), *more])
    except OSError as error:
        raise FileError(f"{file}: the table cannot be written ({error.strerror})") from error


def _direction_columns(subject: Subject, count: int) -> list[str]:
    """`motors1[o1]`, `task1[vx]` and so on."""
    task = subject.mechanism.space.twist_components
    return [
        f"{side}{k}[{name}]"
        for k in range(1, count + 1)
        for side, names in (("motors", subject.mechanism.active), ("task", task))
        for name in names
    ]


def _direction_row(subject: Subject, axes: Sequence[Axis]) -> list[float | None]:
    """Empty cells where an efficiency is not finite."""
    nothing: list[float | None] = [None] * (len(subject.mechanism.active) + subject.mechanism.space.dimension)
    return [
        number
        for axis in axes
        for number in (nothing if axis.motors is None or axis.task is None else [*axis.motors, *axis.task])
    ]


def _columns(values: dict[str, float | list[float]]) -> list[str]:
    columns = []
    for name, value in values.items():
        columns += [f"{name}[{k}]" for k in range(len(value))] if isinstance(value, list) else [name]
    return columns


def _write_frames(path: Path, folder: str, ending: str) -> None:
    from vincula.view.animation import path_figures
    from vincula.view.plot import save_figure

    target = FilePath(folder)
    digits = len(str(len(path)))
    try:
        target.mkdir(parents=True, exist_ok=True)
        for k, figure in enumerate(path_figures(path), start=1):
            save_figure(figure, target / f"frame-{k:0{digits}d}.{ending}")
    except OSError as error:
        raise FileError(f"{folder}: the pictures cannot be written ({error.strerror})") from error
