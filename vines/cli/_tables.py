"""``vines tables``: what can be queried."""

from __future__ import annotations

import json

import click

from vines.cli._study import the_study


@click.command("tables")
@click.option("--json", "as_json", is_flag=True, help="For machines.")
def command(as_json: bool) -> None:
    """List the result tables with the number of rows, and the views of single stages."""
    from vines.cli._layout import print_rows
    from vines.stages import list_tables

    rows = list_tables(study=the_study())
    if as_json:
        click.echo(json.dumps(rows, indent=2))
        return
    print_rows(["view", "rows", "a row is"], [[row["view"], row["rows"], row["description"]] for row in rows], wrap=2)
