"""`vincula convert`: any file that can be read, as a native file or as SDF."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

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

if TYPE_CHECKING:
    from vincula.files.native_writer import NativeData
    from vincula.files.sdf_writer import SdfData
    from vincula.mechanism.mechanism import Mechanism

ENDINGS: Final = (".yaml", ".yml", ".json", ".sdf")


@click.command(
    "convert",
    short_help="Write IN as a native or SDF file OUT.",
    epilog="Example: vincula convert robot.xml robot.yaml --reference gripper",
)
@click.argument("file", metavar="IN")
@click.argument("output", metavar="OUT")
@active_option
@reference_options
@lock_option
@set_option
@loops_option
@click.option("--force", is_flag=True, help="Replace OUT if it is there.")
@click.option("--lossy", is_flag=True, help="Write OUT even if it cannot hold everything; the rest is said.")
@output_options
def convert_command(
    file: str, output: str, active: str | None, force: bool, lossy: bool, as_json: bool, **options: Any
) -> None:
    """Write the mechanism of IN as a native file (.yaml, .json) or an SDF file (.sdf) OUT.

    IN is a path or example:NAME. The native file is drawn at the configuration of IN, in metres and
    radians: every joint value is zero there. Motors, locks and the reference member are written too.
    What the format cannot hold is an error, unless --lossy.
    """
    from vincula.cli.subject import read_subject

    target = Path(output)
    if target.suffix.lower() not in ENDINGS:
        raise BadOptionError(f"{output}: the name says the format; it must end in {', '.join(ENDINGS)}")
    if target.exists() and not force:
        raise BadOptionError(f"{output}: there is such a file already; --force replaces it")
    with warnings_on_stderr():
        subject = read_subject(file, at=None, tolerance=None, **options).with_active(active)
        data, text = _converted(subject.mechanism, target)
        if not lossy:
            data.refuse_losses()
        _write(target, text)
    if as_json:
        print_json(
            {
                "schema": "vincula/conversion/1",
                "input": file,
                "output": output,
                "changed": data.changed,
                "lost": data.lost,
                "load": subject.report.to_dict(),
            }
        )
        return
    for text in data.lost:
        click.echo(f"lost: {text}", err=True)
    for text in data.changed:
        click.echo(f"changed: {text}", err=True)
    click.echo(f"wrote {output}", err=True)


def _converted(mechanism: Mechanism, target: Path) -> tuple[NativeData | SdfData, str]:
    """What a file of the target's format holds of a mechanism, and its text."""
    if target.suffix.lower() == ".sdf":
        from vincula.files.sdf_writer import sdf_data

        sdf = sdf_data(mechanism)
        return sdf, sdf.text
    from vincula.files.native_writer import native_data
    from vincula.files.yaml_writer import as_json, as_yaml

    data = native_data(mechanism)
    return data, as_json(data.content) if target.suffix.lower() == ".json" else as_yaml(data.content)


def _write(target: Path, text: str) -> None:
    """Write beside the target and move there, so that a failure leaves no half file."""
    part = target.with_name(f".{target.name}.{os.getpid()}.part")
    try:
        part.write_text(text, encoding="utf-8")
        part.replace(target)
    except OSError as error:
        part.unlink(missing_ok=True)
        raise FileError(f"{target}: cannot be written ({error.strerror})") from error
