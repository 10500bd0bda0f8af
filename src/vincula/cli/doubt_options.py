"""Options that settle doubt: numbers as typed and proved, numbers as they may be meant, or an assumption."""

from __future__ import annotations

import click

from vincula.cli.options import together

snap_option = click.option(
    "--snap",
    is_flag=True,
    help="Read numbers as what they probably mean: angles near multiples of pi/12, components near simple "
    "roots, lengths that are roundings of another. Every number read so is told.",
)

settling_options = together(
    click.option(
        "--exact",
        is_flag=True,
        help="Prove the ranks: exactly where the numbers of FILE say what they are, else from below. Needs "
        "the extra 'exact'.",
    ),
    click.option(
        "--assume-singular",
        is_flag=True,
        help="Take doubtful singular values as zero; the result says so.",
    ),
)

doubt_options = together(snap_option, settling_options)
