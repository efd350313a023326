"""``vines list``: the pipelines there are."""

from __future__ import annotations

import json
from typing import Any

import click

from vines.cli._study import the_study


@click.command("list")
@click.option("--json", "as_json", is_flag=True, help="For machines.")
def command(as_json: bool) -> None:
    """List the pipelines and collections and what they are for."""
    from vines.cli._layout import print_rows
    from vines.stages import list_pipelines

    rows = list_pipelines(study=the_study())
    if as_json:
        click.echo(json.dumps(rows, indent=2))
        return
    print_rows(
        ["pipeline", "stages", "title", "source"],
        [[row["name"], _size(row), row["title"], row["source"]] for row in rows],
        wrap=(2, 3),
    )


def _size(row: dict[str, Any]) -> str:
    return f"{len(row['pipelines'])} pipelines" if row["pipelines"] else str(row["stages"])
