"""`vincula design`: the best dimensions of a mechanism, from a design file."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from vincula.cli.options import output_options
from vincula.cli.output import print_json, warnings_on_stderr
from vincula.cli.warming import tell_first_wait

if TYPE_CHECKING:
    from vincula.design.front import Front
    from vincula.design.judged import Judged
    from vincula.design.landscape import Landscape
    from vincula.design.optimum import Optimum
    from vincula.design.problem import DesignProblem
    from vincula.files.design_schema import SearchEntry
    from vincula.kernels.compiled import PathName


@dataclass(frozen=True, slots=True)
class Wanted:
    """What is to be done with a problem.

    Attributes:
        over: Variables of a landscape; empty for a search.
        points: Points along each of them.
        how: Settings of a search.
    """

    over: tuple[str, ...]
    points: tuple[int, ...]
    how: dict[str, Any]


@click.command(
    "design",
    short_help="Find the best dimensions of a mechanism.",
    epilog="Example: vincula design DESIGN.yaml --log designs.db -o best.yaml --figure best.svg",
)
@click.argument("file", metavar="DESIGN.yaml")
@click.option("--scan", "over", metavar="NAME[,NAME]", help="A landscape over one or two variables.")
@click.option("--points", metavar="N[,N]", help="Points along each variable of a landscape (default: 41).")
@click.option("--seed", type=click.IntRange(0), help="Seed of the search.")
@click.option("--population", type=click.IntRange(5), metavar="N", help="Designs of a generation.")
@click.option("--generations", type=click.IntRange(1), metavar="N", help="Most generations.")
@click.option(
    "--log",
    "log_file",
    metavar="FILE",
    help="Keep every evaluated design there; what is there already is used and not computed again.",
)
@click.option("-o", "--output", metavar="FILE", help="Write the best mechanism: native .yaml or .json.")
@click.option(
    "--member",
    type=click.IntRange(1),
    default=1,
    metavar="N",
    help="Compromise that -o writes (default: 1).",
)
@click.option("--figure", metavar="FIGURE", help="Figure to write: .svg, .png or .pdf.")
@click.option("--data", metavar="FILE.csv", help="Every evaluated design as a table.")
@click.option(
    "--path",
    type=click.Choice(["auto", "lanes", "reference"]),
    default="auto",
    help="How batches are computed; reference needs no compilation and is quicker for a few designs.",
)
@click.option("--quiet", is_flag=True, help="No progress on stderr.")
@output_options
def design_command(
    file: str,
    over: str | None,
    points: str | None,
    seed: int | None,
    population: int | None,
    generations: int | None,
    log_file: str | None,
    output: str | None,
    member: int,
    figure: str | None,
    data: str | None,
    path: PathName,
    quiet: bool,
    as_json: bool,
) -> None:
    """Find the best dimensions of a mechanism: what DESIGN.yaml lets change, judged by its objectives.

    One objective gives its optimum, how flat it is and what manufacturing errors do to it; several give the
    best compromises (extra `opt`); --scan gives the landscape. DESIGN.yaml is a path or example:NAME, a
    problem of the catalog (stewart, stewart-unit, five-bar, delta, finger, ankle). A search with --log that
    was interrupted goes on when the same command is given again, and ends where an undisturbed one does.
    """
    from vincula.cli.design_page import ProgressLine, text_of

    _refuse_endings(output, figure, data)
    with warnings_on_stderr():
        problem, wanted = _problem(file, over, points)
        given = {"seed": seed, "population": population, "generations": generations}
        wanted.how.update({name: value for name, value in given.items() if value is not None})
        problem.path = path
        tell_first_wait(quiet=quiet or path == "reference")
        with ProgressLine(quiet=quiet) as progress:
            found = _found(problem, wanted, log_file, progress)
        if as_json:
            print_json(found.to_dict())
        else:
            click.echo(text_of(found))
        _write(found, output, member, figure, data)


def _problem(file: str, over: str | None, points: str | None) -> tuple[DesignProblem, Wanted]:
    """The problem of a file or of the catalog, and what is to be done with it."""
    from vincula.files.load import EXAMPLE

    names = tuple(name.strip() for name in over.split(",")) if over else ()
    counts = _counts(points)
    if file.startswith(EXAMPLE):
        from vincula.design.problems import design_problem

        return design_problem(file[len(EXAMPLE) :].strip()), Wanted(names, counts, {})
    from vincula.files.design_file import read_design

    read = read_design(file)
    scan = read.entry.scan
    if scan is not None and not names:
        names, counts = tuple(scan.over), counts or tuple(scan.points or ())
    return read.problem, Wanted(names, counts, _settings(read.entry.search, len(read.problem.objectives)))


def _settings(entry: SearchEntry, objectives: int) -> dict[str, Any]:
    how: dict[str, Any] = {
        "seed": entry.seed,
        "population": entry.population,
        "generations": entry.generations,
    }
    how |= {"samples": entry.samples, "polish": entry.polish} if objectives == 1 else {"method": entry.method}
    return {name: value for name, value in how.items() if value is not None}


def _counts(points: str | None) -> tuple[int, ...]:
    try:
        return tuple(int(word) for word in points.split(",")) if points else ()
    except ValueError:
        raise click.UsageError(f"--points {points!r} is not of the form N or N,N") from None


def _found(
    problem: DesignProblem, wanted: Wanted, log_file: str | None, progress: Any
) -> Optimum | Landscape | Front:
    log = problem.log(log_file) if log_file is not None else None
    try:
        if wanted.over:
            counts: Sequence[int] | int = wanted.points or 41
            if isinstance(counts, tuple) and len(counts) == 1:
                counts = counts[0]
            return problem.scan(*wanted.over, counts=counts, log=log, progress=progress)
        if len(problem.objectives) == 1:
            return problem.optimize(log=log, progress=progress, **wanted.how)
        return problem.front(log=log, progress=progress, **wanted.how)
    except KeyboardInterrupt:
        if log_file is not None:
            click.echo(f"\nthe same command goes on with what is in {log_file}", err=True)
        raise
    finally:
        if log is not None:
            log.close()


def _refuse_endings(output: str | None, figure: str | None, data: str | None) -> None:
    from vincula.view.plot import FORMATS

    if figure is not None and Path(figure).suffix.lower() not in FORMATS:
        raise click.UsageError(f"--figure {figure}: the name must end in {', '.join(FORMATS)}")
    if data is not None and Path(data).suffix.lower() != ".csv":
        raise click.UsageError(f"--data {data}: the name must end in .csv")
    if output is not None and Path(output).suffix.lower() not in (".yaml", ".yml", ".json"):
        raise click.UsageError(f"-o {output}: the name must end in .yaml, .yml or .json")


def _write(
    found: Optimum | Landscape | Front, output: str | None, member: int, figure: str | None, data: str | None
) -> None:
    from vincula.cli.design_page import everything_of
    from vincula.errors import FileError

    try:
        if output is not None:
            from vincula.files.save import save

            save(_best(found, member), output, "native", force=True)
        if figure is not None:
            from vincula.view.design_figure import plot_design
            from vincula.view.plot import save_figure

            save_figure(plot_design(found), figure)
        if data is not None:
            with Path(data).open("w", newline="", encoding="utf-8") as stream:
                csv.writer(stream).writerows(_rows(found.problem, everything_of(found)))
    except OSError as error:
        raise FileError(
            f"{error.filename or output or figure}: cannot be written ({error.strerror})"
        ) from error
    for path in (output, figure, data):
        if path is not None:
            click.echo(f"wrote {path}", err=True)


def _best(found: Optimum | Landscape | Front, member: int) -> Any:
    """The mechanism to write, with the weights that it was judged by."""
    from vincula.design.front import Front
    from vincula.design.optimum import Optimum

    problem = found.problem
    if isinstance(found, Optimum):
        made = found.mechanism()
    elif isinstance(found, Front):
        if member > len(found.members):
            raise click.UsageError(f"--member {member}: there are {len(found.members)} compromises")
        made = problem.mechanism(found.members.designs[member - 1])
    else:
        made = problem.mechanism(list(found.best()[0].values()))
    weights = problem.objectives[0].weights or problem.weights
    return made if weights is None else made.with_weights(weights)


def _rows(problem: DesignProblem, judged: Judged) -> list[list[Any]]:
    """A header and a row for every design; amounts by which it breaks each constraint."""
    objectives = [objective.name for objective in problem.objectives]
    rows: list[list[Any]] = [
        [*problem.space.names, *objectives, "feasible", "doubtful", *problem.names_of_constraints]
    ]
    able = judged.feasible
    columns = (judged.designs, judged.objectives, able[:, None], judged.doubtful[:, None], judged.broken)
    for parts in zip(*columns, strict=True):
        row: list[Any] = []
        for part in parts:
            row += [int(x) if isinstance(x, bool) else x for x in part.tolist()]
        rows.append(row)
    return rows
