"""``vines schema TABLE``: columns, units and meaning."""

from __future__ import annotations

import json

import click


@click.command("schema")
@click.argument("table", required=False)
@click.option("--declaration", is_flag=True, help="Print the JSON Schema of pipeline files, for editors.")
@click.option("--markdown", is_flag=True, help="Print the reference of all tables, as docs/reference_tables.md has it.")
@click.option("--json", "as_json", is_flag=True, help="For machines.")
def command(table: str | None, declaration: bool, markdown: bool, as_json: bool) -> None:
    """Describe the columns of TABLE: name, type, unit, what it is, where it comes from, and which values it may have.

    Without TABLE it lists the tables.
    """
    from vines import schema

    if declaration:
        from vines.stages import declaration_schema

        click.echo(declaration_schema())
        return
    if markdown:
        click.echo(schema.reference(), nl=False)
        return
    if table is None:
        _list(as_json)
        return
    found = schema.table(table)
    if as_json:
        rows = [
            {
                "name": c.name,
                "dtype": c.dtype,
                "unit": c.unit,
                "description": c.description,
                "source": c.source,
                "allowed": c.allowed,
            }
            for c in found.columns
        ]
        click.echo(
            json.dumps(
                {
                    "table": table,
                    "version": found.version,
                    "description": found.description,
                    "walls": found.walls,
                    "columns": rows,
                },
                indent=2,
            )
        )
        return
    from vines.cli._layout import print_rows

    click.echo(f"{table} (version {found.version}): {found.description}\n")
    print_rows(
        ["column", "type", "unit", "description", "allowed", "source"],
        [[c.name, c.dtype, c.unit, c.description, c.allowed, c.source] for c in found.columns],
        wrap=3,
    )
    for letter, wall in found.walls.items():
        click.echo(f"\n{letter}: {wall}", nl=False)
    click.echo("\n" if found.walls else "", nl=False)


def _list(as_json: bool) -> None:
    """Print the tables and what a row of each is."""
    from vines import schema
    from vines.cli._layout import print_rows

    if as_json:
        tables = {name: {"version": s.version, "description": s.description} for name, s in schema.tables().items()}
        click.echo(json.dumps(tables, indent=2))
        return
    print_rows(["table", "columns", "rows"], [[n, len(s.columns), s.description] for n, s in schema.tables().items()])
    click.echo("\nvines schema TABLE describes one; --declaration prints the form of pipelines")
