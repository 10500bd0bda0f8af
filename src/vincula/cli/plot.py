"""`vincula plot`: the mechanism and its ellipsoids as a figure."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, cast

import click

from vincula.cli.options import close_option, mechanism_options, output_options, together, weights_option
from vincula.cli.output import mixed_units_advice, print_json, warnings_on_stderr

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vincula.analysis.ellipsoid import Kind
    from vincula.cli.subject import Subject

DRAWABLE: Final = ("kinematic", "active-force", "passive-force", "dual-force")


@click.command(
    "plot",
    short_help="Draw FILE and its ellipsoids.",
    epilog="Example: vincula plot example:five-bar -o five-bar.svg",
)
@click.option(
    "--active",
    "designs",
    multiple=True,
    metavar="A,B|all",
    help="Motors; given several times, one row of pictures a choice.",
)
@together(mechanism_options, close_option, weights_option)
@click.option(
    "-o",
    "--output",
    required=True,
    metavar="FIGURE",
    help="File to write; its end says how: .svg, .png or .pdf. An old one is replaced.",
)
@click.option(
    "--ellipsoid",
    "ellipsoids",
    multiple=True,
    type=click.Choice([*DRAWABLE, "none"]),
    help="Which ellipsoid to draw; repeatable, all four without it. none: the mechanism alone.",
)
@click.option(
    "--names/--no-names", default=None, help="Name the joints or not (default: where there is room)."
)
@click.option("--width", type=click.FloatRange(1.0, 100.0), metavar="INCH", help="Width of the figure.")
@output_options
def plot_command(
    file: str,
    designs: Sequence[str],
    weights: str | None,
    output: str,
    ellipsoids: Sequence[str],
    names: bool | None,
    width: float | None,
    as_json: bool,
    **options: Any,
) -> None:
    """Draw FILE with its motors, passive joints and ellipsoids at the reference point.

    FILE is a path or example:NAME. Needs the extra `plot` (matplotlib).
    """
    from vincula.cli.subject import read_subject
    from vincula.view.plot import FORMATS

    if Path(output).suffix.lower() not in FORMATS:
        raise click.UsageError(f"-o {output}: the figure's name must end in {', '.join(FORMATS)}")
    if "none" in ellipsoids and len(ellipsoids) > 1:
        raise click.UsageError("--ellipsoid none cannot be combined with others")
    kinds = [name.replace("-", " ") for name in ellipsoids if name != "none"] if ellipsoids else None
    with warnings_on_stderr() as advice:
        subject = read_subject(file, **options)
        if subject.mechanism.reference is not None and kinds != []:
            advice.append(mixed_units_advice(subject.linearize()))
        figure = _figure(subject, designs, weights, cast("list[Kind] | None", kinds), names, width)
        _save(figure, output)
    if as_json:
        mechanism = subject.mechanism
        print_json(
            {
                "schema": "vincula/figure/1",
                "mechanism": mechanism.name,
                "reference": None if mechanism.reference is None else mechanism.reference.body,
                "ellipsoids": [name for name in ellipsoids or DRAWABLE if name != "none"],
                "figure": output,
            }
        )
    else:
        click.echo(f"wrote {output}", err=True)


def _figure(
    subject: Subject,
    designs: Sequence[str],
    weights: str | None,
    kinds: list[Kind] | None,
    names: bool | None,
    width: float | None,
) -> Figure:
    from vincula.view.plot import plot_comparison, plot_mechanism

    choices: Sequence[str | None] = designs or [None]
    variants = [subject.with_active(choice).with_weights(weights) for choice in choices]
    first, q = variants[0].mechanism, subject.configuration
    size: dict[str, Any] = {} if width is None else {"width": width}
    if len(variants) == 1:
        return plot_mechanism(first, q, ellipsoids=kinds, names=names, **size)
    motors = [variant.mechanism.active for variant in variants]
    return plot_comparison(first, motors, q, ellipsoids=kinds, names=names, **size)


def _save(figure: Figure, output: str) -> None:
    from vincula.errors import FileError
    from vincula.view.plot import save_figure

    try:
        save_figure(figure, output)
    except OSError as error:
        raise FileError(f"{output}: the figure cannot be written ({error.strerror})") from error
