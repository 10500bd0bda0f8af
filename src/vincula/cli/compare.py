"""`vincula compare`: several choices of motors for one mechanism, ranked in one table."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING, Any, Final

import click

from vincula.cli.doubt_options import doubt_options
from vincula.cli.exits import DONE, DOUBTFUL
from vincula.cli.options import (
    close_option,
    mechanism_options,
    output_options,
    strict_option,
    together,
    weights_option,
)
from vincula.cli.output import print_json, said_warnings, tell, warnings_on_stderr

if TYPE_CHECKING:
    from vincula.analysis.ellipsoid import Ellipsoid
    from vincula.analysis.indices import Part
    from vincula.analysis.ranking import RankedDesign
    from vincula.cli.page import Page
    from vincula.cli.subject import Subject

CRITERION_NAMES: Final = (
    "kinematic", "active-force", "passive-force", "internal-force", "dual-force",
    "yoshikawa", "inverse-condition", "isotropy", "smallest-singular-value",
)  # fmt: skip
"""Names of `vincula.analysis.ranking.CRITERIA`, here so that help needs no import of it."""


@click.command(
    "compare",
    short_help="Rank choices of motors for FILE.",
    epilog="Example: vincula compare example:five-bar --active o1,o5 --active o2,o4 --active all",
)
@click.option(
    "--active",
    "designs",
    multiple=True,
    required=True,
    metavar="A,B|all",
    help="Motors of one design; give the option once a design.",
)
@mechanism_options
@click.option(
    "--rank-by",
    "criterion",
    type=click.Choice(CRITERION_NAMES),
    default="kinematic",
    show_default=True,
    metavar="INDEX",
    help="What to rank by, more being better: the smallest finite efficiency of an ellipsoid (kinematic, "
    "active-force, passive-force, internal-force, dual-force) or an index of the kinematic one (yoshikawa, "
    "inverse-condition, isotropy, smallest-singular-value).",
)
@click.option(
    "--on",
    type=click.Choice(["translation", "rotation", "all"]),
    default="all",
    show_default=True,
    help="Components that an index looks at.",
)
@together(close_option, weights_option, doubt_options, strict_option, output_options)
@click.pass_context
def compare_command(
    ctx: click.Context,
    /,
    file: str,
    designs: Sequence[str],
    criterion: str,
    on: Part,
    weights: str | None,
    snap: bool,
    exact: bool,
    assume_singular: bool,
    strict: bool,
    as_json: bool,
    **options: Any,
) -> None:
    """Rank choices of motors for FILE in one table, best first.

    Designs that leave the reference member indeterminate (it moves with all motors locked) come last,
    with the reason.
    """
    from vincula.analysis.ranking import ranked_designs
    from vincula.analysis.result import analyze
    from vincula.cli.readings import model_with_readings
    from vincula.cli.subject import read_subject

    def read(design: str, *, snap: bool) -> Subject:
        return read_subject(file, snap=snap, **options).with_active(design).with_weights(weights)

    with warnings_on_stderr(quiet=True):
        subject = read_subject(file, snap=snap, **options)
        analyses = []
        for design in designs:
            variant = subject.with_active(design).with_weights(weights)
            model = model_with_readings(variant, partial(read, design, snap=True))
            analyses.append(analyze(model, exact=exact, assume_singular=assume_singular))
        ranked = ranked_designs(analyses, criterion, on)
    tell([*(f"read as meant: {number}" for number in subject.report.snapped), *said_warnings(analyses)])
    if as_json:
        print_json(_as_dictionary(ranked, criterion, on))
    else:
        _page(ranked, criterion, on).show()
    doubtful = any(design.analysis.ledger.status == "doubtful" for design in ranked)
    ctx.exit(DOUBTFUL if strict and doubtful else DONE)


def _as_dictionary(ranked: Sequence[RankedDesign], criterion: str, on: Part) -> dict[str, Any]:
    first = ranked[0].analysis.model
    return {
        "schema": "vincula/comparison/1",
        "mechanism": first.mechanism,
        "reference": first.reference,
        "frame": first.frame,
        "rank_by": criterion,
        "on": on,
        "designs": [
            {
                "rank": place,
                "active": [column.name for column in design.analysis.model.motors],
                "index": _number(design.index),
                "reason": design.reason or None,
                "summary": design.analysis.ledger.summary.as_dict(),
                "efficiencies": {
                    one.kind.replace(" ", "_"): [_number(float(value)) for value in one.efficiencies]
                    for one in design.analysis.ellipsoids
                },
                "status": design.analysis.ledger.status,
            }
            for place, design in enumerate(ranked, start=1)
        ],
        "warnings": list(dict.fromkeys(text for design in ranked for text in design.analysis.warnings)),
    }


def _number(value: float | None) -> float | str | None:
    if value is None or value != value:
        return None
    return "inf" if value == float("inf") else value


def _page(ranked: Sequence[RankedDesign], criterion: str, on: Part) -> Page:
    from vincula.analysis.ranking import CRITERIA
    from vincula.cli.page import Column, Page, Table, number

    model = ranked[0].analysis.model
    page = Page()
    page.heading(model.mechanism, f"{len(ranked)} choices of motors for {model.reference}, {model.frame}")
    where = "" if criterion == "kinematic" or criterion.endswith("-force") else f", on {on} components"
    page.sentence(f"Best first by {CRITERIA[criterion]}{where}.")
    columns = [
        Column("", "right"),
        Column("motors", fold=True),
        Column("index", "right"),
        Column("kine-\nmatic", fold=True),
        Column("active\nforce", fold=True),
        Column("redun-\ndancy", "right"),
        Column("internal\ntorques", "right"),
        Column("structural\nwrenches", "right"),
    ]
    rows = []
    for place, design in enumerate(ranked, start=1):
        analysis = design.analysis
        counts = analysis.ledger.summary
        rows.append(
            [
                str(place),
                ", ".join(column.name for column in analysis.model.motors) or "none",
                "-" if design.index is None else number(design.index),
                _values(analysis.kinematic),
                _values(analysis.active_force),
                str(counts.redundancy),
                str(counts.internal_torques),
                str(counts.structural_wrenches),
            ]
        )
    page.table(Table(columns, rows))
    for place, design in enumerate(ranked, start=1):
        if design.reason:
            page.sentence(f"{place} stands behind: {design.reason}.")
        if design.analysis.ledger.status == "doubtful":
            page.sentence(f"{place} is doubtful: a rank is not decided (see vincula analyze).")
    return page


def _values(ellipsoid: Ellipsoid) -> str:
    from vincula.cli.page import number

    return ", ".join(number(value, 4) for value in ellipsoid.efficiencies) or "none"
