"""`vincula inspect`: what is in a file, before anything is computed with it."""

from __future__ import annotations

from typing import Any

import click

from vincula.cli.doubt_options import snap_option
from vincula.cli.options import active_option, mechanism_options, output_options, together
from vincula.cli.output import print_json, warnings_on_stderr


@click.command("inspect", short_help="What is in FILE: bodies, joints, loops, motors.")
@together(active_option, mechanism_options)
@snap_option
@click.option("--all", "everything", is_flag=True, help="Every joint and loop, however many there are.")
@output_options
def inspect_command(file: str, active: str | None, everything: bool, as_json: bool, **options: Any) -> None:
    """What is in FILE: bodies, joints, loops, motors, mobility, and what the reader made of it.

    FILE is a path or example:NAME. An open loop or a missing reference member is shown, not refused.
    """
    from vincula.cli.inspection_facts import inspection
    from vincula.cli.subject import read_subject

    with warnings_on_stderr():
        facts = inspection(read_subject(file, **options).with_active(active))
    if as_json:
        print_json(facts)
        return
    from vincula.cli.inspection_page import inspection_page

    inspection_page(facts, everything=everything).show()
