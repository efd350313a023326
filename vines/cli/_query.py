"""``vines query``: SQL over the catalogue."""

from __future__ import annotations

import json
import math
import tempfile
from decimal import Decimal
from pathlib import Path
from typing import Any

import click

from vines.cli._study import the_study
from vines.errors import QueryError

SUFFIXES = {".csv": "csv", ".json": "json", ".parquet": "parquet"}


@click.command("query")
@click.argument("sql")
@click.option(
    "--format",
    "form",
    type=click.Choice(["table", "csv", "json", "parquet"]),
    help="How to write the answer; the default follows the suffix of --out, else table.",
)
@click.option("--out", type=click.Path(dir_okay=False, path_type=Path), help="Write to this file, not the screen.")
def command(sql: str, form: str | None, out: Path | None) -> None:
    """Ask the result tables in SQL (DuckDB's dialect).

    \b
    vines query "select A, name, kinetic_ratio from points where stage = 'up'"
    vines query "select * from bifurcations" --out bifurcations.csv
    """  # noqa: D301
    from vines.stages import rows_of, save_query

    if form is None and out is not None and out.suffix not in {*SUFFIXES, ".txt"}:
        allowed = ".csv, .json, .parquet, .txt"
        raise QueryError(
            f"--out {out}: the suffix {out.suffix!r} names no format; allowed: {allowed}; or give --format"
        )
    study = the_study()
    form = form or (SUFFIXES.get(out.suffix, "table") if out is not None else "table")
    match form:
        case "csv" | "parquet" if out is not None:
            save_query(sql, out, form, study=study)
        case "parquet":
            raise QueryError("--format parquet needs --out FILE: a terminal cannot show it")
        case "csv":
            with tempfile.TemporaryDirectory() as folder:
                save_query(sql, Path(folder) / "answer.csv", "csv", study=study)
                click.echo((Path(folder) / "answer.csv").read_text("utf-8"), nl=False)
        case "json":
            names, rows = rows_of(sql, study=study)
            _put(json.dumps([dict(zip(names, map(_plain, row), strict=True)) for row in rows], indent=1), out)
        case _:
            from vines.cli._layout import lines

            _put("\n".join(lines(*rows_of(sql, study=study), wrap=None)), out)


def _put(text: str, out: Path | None) -> None:
    if out is None:
        click.echo(text)
    elif not out.parent.is_dir():
        raise QueryError(f"{out}: the folder {out.parent} does not exist; make it first")
    else:
        out.write_text(text + "\n", encoding="utf-8")


def _plain(value: Any) -> Any:
    """Return a value as JSON knows it; a NaN is null, and SQL's decimals are numbers."""
    if isinstance(value, Decimal):
        return float(value)
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, list | tuple):
        return [_plain(each) for each in value]
    if isinstance(value, dict):
        return {str(key): _plain(each) for key, each in value.items()}
    return value if value is None or isinstance(value, bool | int | str) else str(value)
