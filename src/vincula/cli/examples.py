"""`vincula examples` and `vincula schema`: what there is to try, and what a file may say."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from vincula.cli.options import output_options
from vincula.cli.output import print_json

if TYPE_CHECKING:
    from vincula.cli.page import Page
    from vincula.files.json_schema import SchemaKind
    from vincula.mechanism.catalog.entry import Entry


@click.command("examples", short_help="List the examples, or describe one.")
@click.argument("name", required=False)
@output_options
def examples_command(name: str | None, as_json: bool) -> None:
    """List the mechanisms of the catalog, or describe the one called NAME.

    Every command takes example:NAME where it takes a file, and --set for its parameters.
    """
    from vincula.mechanism.catalog.registry import entry, examples

    wanted = examples() if name is None else (entry(name.removeprefix("example:")),)
    if as_json:
        print_json({"schema": "vincula/examples/1", "examples": [_as_dictionary(one) for one in wanted]})
        return
    (_list_page(wanted) if name is None else _entry_page(wanted[0])).show()


def _as_dictionary(entry: Entry) -> dict[str, Any]:
    return {
        "name": entry.name,
        "title": entry.title,
        "description": entry.description,
        "reference": entry.reference,
        "parameters": [
            {
                "name": parameter.name,
                "default": parameter.default,
                "value": parameter.value,
                "unit": parameter.unit,
                "meaning": parameter.meaning,
            }
            for parameter in entry.parameters
        ],
    }


def _list_page(entries: tuple[Entry, ...]) -> Page:
    from vincula.cli.page import Column, Page, Table

    page = Page()
    page.heading("Examples", "use example:NAME wherever a FILE is asked for")
    page.table(Table([Column("name"), Column("what it is", fold=True)], [[e.name, e.title] for e in entries]))
    page.sentence("More about one: vincula examples NAME")
    return page


def _entry_page(entry: Entry) -> Page:
    from vincula.cli.page import Column, Page, Table

    page = Page()
    page.heading(f"example:{entry.name}", entry.title)
    page.sentence(entry.description)
    page.sentence(f"Source: {entry.reference}.")
    if entry.parameters:
        page.heading("Parameters", f"change one with --set {entry.parameters[0].name}=VALUE")
        columns = [Column("name"), Column("default", justify="right"), Column("what it is", fold=True)]
        page.table(Table(columns, [[p.name, p.default, p.meaning] for p in entry.parameters]))
    page.heading("Try")
    for command in ("inspect", "analyze"):
        page.sentence(f"vincula {command} example:{entry.name}")
    return page


@click.command("schema", short_help="Print the JSON schema of native, sweep or design files.")
@click.argument("kind", type=click.Choice(["native", "sweep", "design"]), default="native")
@output_options
def schema_command(kind: SchemaKind, as_json: bool) -> None:
    """Print the JSON schema of native files (or of sweep or design files), with or without --json.

    Editors that know JSON schema complete and check such files with it.
    """
    from vincula.files.json_schema import json_schema

    print_json(json_schema(kind))
