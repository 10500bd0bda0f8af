"""`vincula convert`: any file that can be read, as a native file."""

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

ENDINGS: Final = (".yaml", ".yml", ".json")


@click.command(
    "convert",
    short_help="Write IN as a native file OUT.",
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
@output_options
def convert_command(
    file: str, output: str, active: str | None, force: bool, as_json: bool, **options: Any
) -> None:
    """Write the mechanism of IN as a native file OUT (.yaml or .json).

    IN is a path or example:NAME. The native file is drawn at the configuration of IN, in metres and
    radians: every joint value is zero there. Motors, locks and the reference member are written too.
    What a native file cannot hold is an error.
    """
    from vincula.cli.subject import read_subject
    from vincula.files.native_writer import native_data

    target = Path(output)
    if target.suffix.lower() not in ENDINGS:
        raise BadOptionError(f"{output}: a native file is written; its name must end in {', '.join(ENDINGS)}")
    if target.exists() and not force:
        raise BadOptionError(f"{output}: there is such a file already; --force replaces it")
    with warnings_on_stderr():
        subject = read_subject(file, at=None, tolerance=None, **options).with_active(active)
        data = native_data(subject.mechanism)
        data.refuse_losses()
        _write(target, _text(data, target))
    if as_json:
        print_json(
            {
                "schema": "vincula/conversion/1",
                "input": file,
                "output": output,
                "changed": data.changed,
                "load": subject.report.to_dict(),
            }
        )
        return
    for text in data.changed:
        click.echo(f"changed: {text}", err=True)
    click.echo(f"wrote {output}", err=True)


def _text(data: NativeData, target: Path) -> str:
    from vincula.files.yaml_writer import as_json, as_yaml

    return as_json(data.content) if target.suffix.lower() == ".json" else as_yaml(data.content)


def _write(target: Path, text: str) -> None:
    """Write beside the target and move there, so that a failure leaves no half file."""
    part = target.with_name(f".{target.name}.{os.getpid()}.part")
    try:
        part.write_text(text, encoding="utf-8")
        part.replace(target)
    except OSError as error:
        part.unlink(missing_ok=True)
        raise FileError(f"{target}: cannot be written ({error.strerror})") from error
