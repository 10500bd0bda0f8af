"""`vincula close`: a closed configuration, how it was found, and on which branch it is."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from vincula.cli.exits import BadOptionError
from vincula.cli.options import active_option, mechanism_options, once, output_options, together
from vincula.cli.output import print_json, warnings_on_stderr
from vincula.errors import FileError, ModelError

if TYPE_CHECKING:
    from vincula.cli.subject import Subject
    from vincula.mechanism.holding import MotorValues, PoseOrPoint

motors_option = click.option(
    "--motors",
    multiple=True,
    metavar="CONFIG",
    callback=once,
    help="Values to hold: name=value,... by joint, axis or motor name, in the units of the file.",
)
hold_option = click.option(
    "--hold",
    multiple=True,
    metavar="A,B|motors",
    callback=once,
    help="Joints or axes held at the values they start from; motors: all active ones.",
)
point_option = click.option(
    "--point",
    multiple=True,
    metavar="X,Y[,Z]",
    callback=once,
    help="Where to hold the reference point, ground axes.",
)
pose_option = click.option(
    "--pose",
    multiple=True,
    metavar="X,Y,ANGLE | X,Y,Z,QW,QX,QY,QZ",
    callback=once,
    help="Where to hold the reference member: reference point and axes of the body, ground axes.",
)
limits_option = click.option("--limits/--no-limits", default=False, help="Respect joint limits or not.")


@click.command(
    "close",
    short_help="Close the loops of FILE.",
    epilog="Example: vincula close example:five-bar --motors o1=0.2,o5=-0.1",
)
@together(active_option, mechanism_options)
@together(motors_option, hold_option, point_option, pose_option, limits_option)
@click.option("--starts", type=click.IntRange(1, 10_000), default=25, show_default=True, metavar="N",
              help="Starts to try: the given one, then random displacements of it.")  # fmt: skip
@click.option("--modes", is_flag=True, help="All assembly modes found from N random starts, motors held.")
@click.option("-o", "--output", metavar="FILE.json", help="Write the configuration, for --at FILE.json.")
@output_options
def close_command(
    file: str,
    active: str | None,
    motors: str | None,
    hold: str | None,
    point: str | None,
    pose: str | None,
    limits: bool,
    starts: int,
    modes: bool,
    output: str | None,
    as_json: bool,
    **options: Any,
) -> None:
    """Close the loops of FILE, starting at --at, and say how far everything moved.

    FILE is a path or example:NAME. What is neither held nor locked stays as near to the start as
    closing permits. If it cannot be closed (exit code 1): which loop, its gap, lengths that cannot meet.
    """
    from vincula.cli import close_page
    from vincula.cli.subject import read_subject

    with warnings_on_stderr():
        subject = read_subject(file, **options).with_active(active)
        held, where = asked_to_hold(subject, motors, hold, point, pose)
        if modes:
            if where is not None or output is not None:
                raise click.UsageError("--modes goes with --motors and --hold only")
            _show_modes(subject, held, starts, limits, as_json)
            return
        q = subject.mechanism.close(
            subject.configuration, motors=held, pose=where, limits=limits, attempts=starts
        )
        if output is not None:
            _write(output, close_page.configuration_of(subject, q))
    if as_json:
        print_json(close_page.closure_facts(subject, q))
    else:
        close_page.closure_page(subject, q).show()


def asked_to_hold(
    subject: Subject, motors: str | None, hold: str | None, point: str | None, pose: str | None
) -> tuple[MotorValues, PoseOrPoint | None]:
    """What the options ask to hold: values by name, and a pose or point of the member."""
    from vincula.cli.asked import motor_values, point_or_pose

    if point is not None and pose is not None:
        raise click.UsageError("give --point or --pose, not both")
    held = dict(motor_values(subject, "--motors", motors)) if motors is not None else {}
    if hold is not None:
        for name, value in _start_values(subject, hold).items():
            held.setdefault(name, value)
    if pose is not None:
        return held, point_or_pose(subject, "--pose", pose, pose=True)
    return held, None if point is None else point_or_pose(subject, "--point", point, pose=False)


def _start_values(subject: Subject, hold: str) -> MotorValues:
    """Values of the named joints and axes where the search starts."""
    from vincula.mechanism.modes import motors_at

    mechanism, q = subject.mechanism, subject.configuration
    if hold.strip().lower() == "motors":
        return motors_at(mechanism, q)
    try:
        axes = mechanism.resolve_motors(hold)
    except ModelError as error:
        raise BadOptionError(f"--hold: {error}") from error
    return motors_at(mechanism, q, axes)


def _show_modes(subject: Subject, held: MotorValues, starts: int, limits: bool, as_json: bool) -> None:
    from vincula.cli import close_page
    from vincula.mechanism.modes import motors_at

    fixed = held or motors_at(subject.mechanism, subject.configuration)
    found = subject.mechanism.assembly_modes(fixed, starts=starts, limits=limits)
    if not found:  # the refusal says why
        subject.mechanism.close(subject.configuration, motors=fixed, limits=limits)
    if as_json:
        print_json(close_page.modes_facts(subject, found, starts))
    else:
        close_page.modes_page(subject, found, starts).show()


def _write(output: str, values: dict[str, float | list[float]]) -> None:
    import json

    try:
        Path(output).write_text(json.dumps(values, indent=2) + "\n", encoding="utf-8")
    except OSError as error:
        raise FileError(f"{output}: the configuration cannot be written ({error.strerror})") from error
