"""`vincula place`: which joints should get the motors; every admissible choice in one ranked table."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from vincula.cli.compare import CRITERION_NAMES
from vincula.cli.exits import DONE, DOUBTFUL, BadOptionError
from vincula.cli.options import (
    close_option,
    mechanism_options,
    once,
    output_options,
    strict_option,
    together,
    weights_option,
)
from vincula.cli.output import mixed_units_advice, print_json, tell, warnings_on_stderr

if TYPE_CHECKING:
    from vincula.analysis.indices import Part
    from vincula.cli.subject import Subject
    from vincula.design.placement import Placement
    from vincula.sweep.sweep import Sweep

choosing_options = together(
    click.option(
        "--motors",
        required=True,
        metavar="N|A..B",
        help="How many motors: 2, 1..5 or 2,4.",
    ),
    click.option(
        "--forbid",
        multiple=True,
        metavar="A,B",
        callback=once,
        help="Joints, axes or motors that get no motor.",
    ),
    click.option(
        "--require",
        multiple=True,
        metavar="A,B",
        callback=once,
        help="Joints, axes or motors of every choice.",
    ),
    click.option(
        "--cost",
        "costs",
        multiple=True,
        metavar="JOINT=2,...",
        help="Cost of a motor by joint; 1 for the others.",
    ),
    click.option(
        "--over",
        metavar="SWEEP.yaml",
        help="Judge at every closed point of this sweep: worst and mean. Its own motors drive it.",
    ),
)

ranking_options = together(
    click.option(
        "--rank-by",
        type=click.Choice(CRITERION_NAMES),
        default="kinematic",
        show_default=True,
        metavar="INDEX",
        help="What to rank by, as in `vincula compare`; over several configurations its worst value.",
    ),
    click.option(
        "--on",
        type=click.Choice(["translation", "rotation", "all"]),
        default="all",
        show_default=True,
        help="Components that an index looks at.",
    ),
    click.option(
        "--front",
        metavar="A,B",
        help="Criteria of the Pareto front: those of --rank-by, and cost and motors (less is better). "
        "By default the one of --rank-by, active-force and cost.",
    ),
    click.option("--seed", type=int, default=0, show_default=True, help="Seed of a search."),
    click.option(
        "--budget",
        type=click.IntRange(1),
        metavar="N",
        help="Choices that a search looks at (default 8192). There is a search only beyond 65536 choices.",
    ),
)


@click.command(
    "place",
    short_help="Rank all choices of joints for the motors of FILE.",
    epilog="Example: vincula place example:five-bar --motors 1..4 --forbid o3 --cost o2=2,o4=2",
)
@together(mechanism_options, close_option, choosing_options, ranking_options, weights_option)
@click.option(
    "--show",
    type=click.IntRange(0),
    metavar="N",
    help="Choices in the table and reasons in words (default 40 and 12); 0 shows all. --json holds all.",
)
@click.option("-o", "--output", metavar="FIGURE", help="Figure to write: .svg, .png or .pdf.")
@click.option("--width", type=click.FloatRange(1.0, 100.0), metavar="INCH", help="Width of the figure.")
@together(strict_option, output_options)
@click.pass_context
def place_command(
    ctx: click.Context,
    /,
    file: str,
    motors: str,
    forbid: str | None,
    require: str | None,
    costs: Sequence[str],
    over: str | None,
    rank_by: str,
    on: Part,
    front: str | None,
    seed: int,
    budget: int | None,
    weights: str | None,
    show: int | None,
    output: str | None,
    width: float | None,
    strict: bool,
    as_json: bool,
    **options: Any,
) -> None:
    """Rank every admissible choice of joints for the motors of FILE.

    Candidates are all unlocked joint axes that are not part of a free joint, and motors of FILE that drive
    several axes. A choice that leaves the reference member loose with all motors locked comes last, with the
    reason: which motion is left, and which joints take part. FILE is a path or example:NAME.
    """
    from vincula.cli.subject import read_subject
    from vincula.design.placement import BUDGET

    _refuse_ending(output)
    if over is not None and options["at"] is not None:
        raise click.UsageError("--at and --over exclude each other: the sweep says where")
    sizes, cost = read_sizes(motors), read_costs(costs)
    with warnings_on_stderr(quiet=True):
        subject = read_subject(file, **options)
        subject = _ready(subject, sizes, forbid, require, cost, weights)
        found = _placed(
            subject, sizes, over,
            forbid=forbid or (), require=require or (), cost=cost, rank_by=rank_by, on=on,
            front=None if front is None else [name.strip() for name in front.split(",")],
            seed=seed, budget=budget or BUDGET, progress=_progress(),
        )  # fmt: skip
    tell([mixed_units_advice(found.looked.models[0])] if found.warnings else [])
    if as_json:
        print_json(found.to_dict())
    else:
        from vincula.cli.place_page import page_of

        page_of(found, show).show()
    if output is not None:
        from vincula.view.placement_figure import plot_placement
        from vincula.view.plot import save_figure

        save_figure(plot_placement(found, width=width), output)
        click.echo(f"wrote {output}", err=True)
    ctx.exit(DOUBTFUL if strict and any(choice.doubtful_at for choice in found.choices) else DONE)


def read_sizes(text: str) -> tuple[int, ...]:
    """Numbers of motors of `2`, `1..5` or `2,4`.

    Raises:
        BadOptionError: Another form, or a range that ends before it begins.
    """
    found: list[int] = []
    for part in text.split(","):
        low, dots, high = (word.strip() for word in part.partition(".."))
        try:
            first = int(low)
            last = int(high) if dots else first
        except ValueError:
            raise BadOptionError(f"--motors {text!r} is not of the form 2, 1..5 or 2,4") from None
        if last < first:
            raise BadOptionError(
                f"--motors {text!r}: {first}..{last} is empty; the smaller number comes first"
            )
        if last - first > 100_000:
            raise BadOptionError(f"--motors {text!r}: no mechanism has so many joints")
        found += range(first, last + 1)
    return tuple(dict.fromkeys(found))


def read_costs(texts: Sequence[str]) -> dict[str, float]:
    """Costs by name of `joint=2,other=3`, given once or several times.

    Raises:
        BadOptionError: No number, or a name given twice.
    """
    from vincula.mechanism.names import split_names

    found: dict[str, float] = {}
    for text in texts:
        for part in split_names(text):
            name, equals, value = (word.strip() for word in part.rpartition("="))
            try:
                number = float(value)
            except ValueError:
                equals = ""
            if not (name and equals):
                raise BadOptionError(f"--cost {part!r} is not of the form joint=2")
            if name in found:
                raise BadOptionError(f"--cost: {name!r} is given twice")
            found[name] = number
    return found


def _ready(
    subject: Subject,
    sizes: Sequence[int],
    forbid: str | None,
    require: str | None,
    cost: dict[str, float],
    weights: str | None,
) -> Subject:
    """The subject with weights that know every candidate; refuses what was asked for in vain."""
    from dataclasses import replace

    from vincula.design.admissible import Admissible
    from vincula.errors import ModelError

    try:
        admissible = Admissible.of_mechanism(subject.mechanism, sizes, forbid or (), require or (), cost)
    except ModelError as error:
        raise BadOptionError(str(error)) from error
    candidates = subject.mechanism.with_active(admissible.candidates)
    return replace(subject, mechanism=candidates).with_weights(weights)


def _placed(subject: Subject, sizes: Sequence[int], over: str | None, **asked: Any) -> Placement:
    from vincula.design.placement import place
    from vincula.errors import UnknownNameError

    if subject.mechanism.reference is None:
        subject.linearize()  # refuses, and says which option is missing
    try:
        if over is not None:
            return place(subject.mechanism, sizes, over=_sweep(over), **asked)
        subject.linearize()  # an open loop is refused with the closest closed configuration
        return place(subject.mechanism, sizes, at=subject.configuration, **asked)
    except UnknownNameError as error:
        raise BadOptionError(str(error)) from error


def _sweep(path: str) -> Sweep:
    from vincula.cli.sweep_subject import sweep_of
    from vincula.files.sweep_file import read_sweep

    return sweep_of(read_sweep(path))


def _refuse_ending(output: str | None) -> None:
    from vincula.view.plot import FORMATS

    if output is not None and Path(output).suffix.lower() not in FORMATS:
        raise click.UsageError(f"-o {output}: the figure's name must end in {', '.join(FORMATS)}")


def _progress() -> Callable[[int, int], None] | None:
    """A line on a terminal's stderr that is written over; nothing elsewhere."""
    import sys
    import time

    if not sys.stderr.isatty():
        return None
    last = [time.monotonic()]

    def show(done: int, total: int) -> None:
        now = time.monotonic()
        if now - last[0] > 0.2:
            last[0] = now
            click.echo(f"\r{done} of at most {total} choices looked at   ", err=True, nl=False)

    return show
