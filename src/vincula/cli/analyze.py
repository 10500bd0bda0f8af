"""`vincula analyze`: everything about one mechanism at one configuration."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from vincula.cli.doubt_options import doubt_options
from vincula.cli.exits import DONE, DOUBTFUL
from vincula.cli.options import (
    active_option,
    close_option,
    convention_option,
    mechanism_options,
    output_options,
    strict_option,
    together,
    viewpoint_option,
    weights_option,
)
from vincula.cli.output import print_json, said_warnings, tell, warnings_on_stderr

if TYPE_CHECKING:
    from vincula.analysis.ellipsoid import Convention, Viewpoint
    from vincula.cli.subject import Subject


@click.command(
    "analyze",
    short_help="Mobility, statics and ellipsoids of FILE.",
    epilog="Example: vincula analyze robot.xml --reference gripper@tip --active j1,j2 --at key:home",
)
@together(active_option, mechanism_options, close_option, weights_option, viewpoint_option, convention_option)
@together(doubt_options, strict_option, output_options)
@click.pass_context
def analyze_command(
    ctx: click.Context,
    /,
    file: str,
    active: str | None,
    weights: str | None,
    viewpoint: Viewpoint,
    convention: Convention,
    snap: bool,
    exact: bool,
    assume_singular: bool,
    strict: bool,
    as_json: bool,
    **options: Any,
) -> None:
    """Mobility, statics and the five ellipsoids of FILE at one configuration.

    FILE is a path or example:NAME. An open loop is refused (exit code 1): nothing is moved unless --close.
    A doubtful rank is told with what would decide it (exit code 3 with --strict): --exact, --snap or
    --assume-singular.
    """
    from vincula.analysis.result import analyze
    from vincula.cli.readings import closed_subject, model_with_readings
    from vincula.cli.subject import read_subject

    def read(snap: bool) -> Subject:
        return read_subject(file, snap=snap, **options).with_active(active).with_weights(weights)

    with warnings_on_stderr(quiet=True):
        subject = closed_subject(read, snap=snap)
        analysis = analyze(
            model_with_readings(subject, lambda: read(True)),
            viewpoint=viewpoint,
            convention=convention,
            exact=exact,
            assume_singular=assume_singular,
        )
        if as_json:
            tell(said_warnings([analysis]))
            print_json(analysis.to_dict())
        else:
            from vincula.cli.analysis_page import analysis_page

            analysis_page(analysis, subject).show()
    ctx.exit(DOUBTFUL if strict and analysis.ledger.status == "doubtful" else DONE)
