"""`vincula warm-up`: compile the kernels now, so that nothing has to wait for them later."""

from __future__ import annotations

import click

from vincula.cli.options import output_options
from vincula.cli.output import print_json


@click.command("warm-up", short_help="Compile the kernels of batches and sweeps.")
@output_options
def warm_up_command(as_json: bool) -> None:
    """Compile the kernels that evaluate many configurations, and keep them on disk.

    They do not depend on the mechanism and are compiled once a machine, which takes up to some minutes;
    later runs load them in less than a second. Needs the extra `fast` (numba).
    """
    from vincula.cli.page import Column, Page, Table
    from vincula.kernels.warming import cache_folder, warm_up

    seconds = warm_up()
    if as_json:
        print_json({"schema": "vincula/warm-up/1", "seconds": seconds, "folder": str(cache_folder())})
        return
    page = Page()
    page.heading("Kernels", "ready")
    rows = [[words, f"{value:.2f}"] for words, value in seconds.items()]
    page.table(Table([Column("kernel"), Column("seconds")], rows))
    page.sentence(f"Kept in {cache_folder()}")
    page.show()


def tell_first_wait(*, quiet: bool) -> None:
    """Say on stderr that the kernels are not compiled yet, before a command waits for that."""
    from vincula.kernels.warming import first_wait

    words = "" if quiet else first_wait()
    if words:
        click.echo(words, err=True)
