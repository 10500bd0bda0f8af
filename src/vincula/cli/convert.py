"""`vincula convert`: any file that can be read, in any format that can be written."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from vincula.cli.exits import BadOptionError
from vincula.cli.options import (
    active_option,
    lock_option,
    loops_option,
    output_options,
    reference_options,
    set_option,
)
from vincula.cli.output import print_json, warnings_on_stderr
from vincula.errors import FileError

FORMATS = ("native", "mjcf", "sdf", "urdf-plus", "urdf-gepetto")


@click.command(
    "convert",
    short_help="Write IN in another format: native, MJCF, SDF, URDF.",
    epilog="Example: vincula convert robot.xml robot.yaml --reference gripper",
)
@click.argument("file", metavar="IN")
@click.argument("output", metavar="OUT")
@click.option(
    "--to",
    "kind",
    type=click.Choice(FORMATS),
    help="Format of OUT; by default what its name ends in: .yaml .json native, .xml mjcf, .sdf, "
    ".urdf urdf-plus. urdf-gepetto writes a side file OUT.yaml beside OUT.urdf.",
)
@active_option
@reference_options
@lock_option
@set_option
@loops_option
@click.option("--force", is_flag=True, help="Replace OUT if it is there.")
@click.option("--lossy", is_flag=True, help="Write OUT even if it cannot hold everything; the rest is said.")
@output_options
def convert_command(
    file: str,
    output: str,
    kind: str | None,
    active: str | None,
    force: bool,
    lossy: bool,
    as_json: bool,
    **options: Any,
) -> None:
    """Write the mechanism of IN as OUT: native, MJCF, SDF, or URDF with its loops in URDF+ or a side file.

    IN is a path or example:NAME. Files are drawn at the configuration of IN, in metres and radians.
    Motors are written too. What the format cannot hold is an error, unless --lossy.
    """
    from vincula.cli.subject import read_subject
    from vincula.files.save import format_of, save

    target = Path(output)
    try:
        format_of(target, kind)
    except FileError as error:
        raise BadOptionError(str(error)) from None
    if target.exists() and not force:
        raise BadOptionError(f"{output}: there is such a file already; --force replaces it")
    with warnings_on_stderr():
        subject = read_subject(file, at=None, tolerance=None, **options).with_active(active)
        saved = save(subject.mechanism, target, kind, lossy=lossy, force=force)
    if as_json:
        print_json(
            {
                "schema": "vincula/conversion/1",
                "input": file,
                "output": output,
                "format": saved.format,
                "files": list(saved.files),
                "changed": list(saved.changed),
                "lost": list(saved.lost),
                "load": subject.report.to_dict(),
            }
        )
        return
    for text in saved.lost:
        click.echo(f"lost: {text}", err=True)
    for text in saved.changed:
        click.echo(f"changed: {text}", err=True)
    for name in saved.files:
        click.echo(f"wrote {name}", err=True)
