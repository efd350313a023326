"""``vines schema TABLE``: columns, units and meaning."""

from __future__ import annotations

import json

import click

from vines.errors import UnknownNameError, nearest


@click.command("schema")
@click.argument("table", required=False)
@click.option("--declaration", is_flag=True, help="Print the JSON Schema of pipeline files, for editors.")
@click.option("--json", "as_json", is_flag=True, help="For machines.")
def command(table: str | None, declaration: bool, as_json: bool) -> None:
    """Describe the columns of TABLE: name, type, unit, what it is, and where it comes from."""
    from vines import schema

    if declaration:
        from vines.stages import declaration_schema

        click.echo(declaration_schema())
        return
    if table is None:
        raise UnknownNameError(
            f"which table? {nearest('', schema.tables())}; or --declaration for the form of pipelines"
        )
    found = schema.table(table)
    if as_json:
        rows = [
            {
                "name": c.name,
                "dtype": c.dtype,
                "unit": c.unit,
                "description": c.description,
                "source": c.source,
            }
            for c in found.columns
        ]
        click.echo(
            json.dumps(
                {"table": table, "version": found.version, "description": found.description, "columns": rows},
                indent=2,
            )
        )
        return
    from vines.cli._layout import print_rows

    click.echo(f"{table} (version {found.version}): {found.description}\n")
    print_rows(
        ["column", "type", "unit", "description", "source"],
        [[c.name, c.dtype, c.unit, c.description, c.source] for c in found.columns],
    )
