"""`vincula analyze`: everything about one mechanism at one configuration."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

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


@click.command(
    "analyze",
    short_help="Mobility, statics and ellipsoids of FILE.",
    epilog="Example: vincula analyze robot.xml --reference gripper@tip --active j1,j2 --at key:home",
)
@together(active_option, mechanism_options, close_option, weights_option, viewpoint_option, convention_option)
@together(strict_option, output_options)
@click.pass_context
def analyze_command(
    ctx: click.Context,
    /,
    file: str,
    active: str | None,
    weights: str | None,
    viewpoint: Viewpoint,
    convention: Convention,
    strict: bool,
    as_json: bool,
    **options: Any,
) -> None:
    """Mobility, statics and the five ellipsoids of FILE at one configuration.

    FILE is a path or example:NAME. An open loop is refused (exit code 1): nothing is moved unless --close.
    """
    from vincula.analysis.result import analyze
    from vincula.cli.subject import read_subject

    with warnings_on_stderr(quiet=True):
        subject = read_subject(file, **options).with_active(active).with_weights(weights)
        analysis = analyze(subject.linearize(), viewpoint=viewpoint, convention=convention)
        if as_json:
            tell(said_warnings([analysis]))
            print_json(analysis.to_dict())
        else:
            from vincula.cli.analysis_page import analysis_page

            analysis_page(analysis, subject).show()
    ctx.exit(DOUBTFUL if strict and analysis.ledger.status == "doubtful" else DONE)
