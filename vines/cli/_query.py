"""``vines query``: SQL over the catalogue."""

from __future__ import annotations

from pathlib import Path

import click


@click.command("query")
@click.argument("sql")
@click.option(
    "--format",
    "form",
    type=click.Choice(["table", "csv", "json", "parquet"]),
    help="How to write the answer; the default follows the suffix of --out, else table.",
)
@click.option(
    "--out", type=click.Path(dir_okay=False, path_type=Path), help="Write to this file instead of the screen."
)
def command(sql: str, form: str | None, out: Path | None) -> None:
    """Ask the result tables in SQL (DuckDB's dialect).

    \b
    vines query "select A, name, kinetic_ratio from points where stage = 'up'"
    vines query "select * from bifurcations" --out bifurcations.csv
    """  # noqa: D301
    from vines.stages import write_query

    write_query(sql, form=form, out=out)
