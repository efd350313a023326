"""Questions to the catalogue: tables, SQL, checks."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vines import catalogue
from vines.errors import QueryError, UnknownNameError, nearest
from vines.pipeline import available
from vines.places import find_root
from vines.stages._running import open_store

if TYPE_CHECKING:
    import pyarrow as pa

__all__ = ["checks", "list_tables", "query", "table", "write_query"]


def query(sql: str) -> pa.Table:
    """Ask the catalogue in SQL (DuckDB's dialect) and return an Arrow table.

    The views are described in docs/tables.md: one a table over all pinned results, and one a stage, named
    ``"<pipeline>.<stage>"``.

    Raises
    ------
    QueryError
        If DuckDB cannot answer; one line.
    """
    return catalogue.query(open_store(), sql)


def table(name: str) -> pa.Table:
    """Return a view of the catalogue, such as ``orbits``, as an Arrow table.

    Raises
    ------
    UnknownNameError
        If there is no such view.
    """
    return catalogue.table(open_store(), name)


def list_tables() -> list[dict[str, Any]]:
    """Return name, rows and description of the views: the tables, then the single stages."""
    return catalogue.list_views(open_store())


def write_query(sql: str, *, form: str | None, out: Path | None) -> None:
    """Ask and write the answer: to the screen or a file; as table, csv, json or parquet.

    Raises
    ------
    QueryError
        If DuckDB cannot answer, or Parquet is asked for on the screen.
    """
    suffixes = {".csv": "csv", ".json": "json", ".parquet": "parquet"}
    form = form or (suffixes.get(out.suffix, "table") if out is not None else "table")
    if form == "parquet" and out is None:
        raise QueryError("--format parquet needs --out FILE: a terminal cannot show it")
    if out is not None and not out.parent.is_dir():
        raise QueryError(f"--out {out}: the folder {out.parent} does not exist; make it first")
    catalogue.write(open_store(), sql, form=form, out=out)


def checks(name: str | None = None) -> list[dict[str, Any]]:
    """Return the rows of the check table, of one pipeline or of all that were run.

    Raises
    ------
    UnknownNameError
        If there is no such pipeline, or if nothing was checked yet.
    """
    if name is not None and name not in (known := available(find_root())):
        raise UnknownNameError(f"unknown pipeline {name!r}: {nearest(name, known)}")
    where = "" if name is None else f"where pipeline = '{name}'"
    rows = query(f"select * from checks {where} order by pipeline, stage, point_id").to_pylist()
    if not rows:
        what = name or "any pipeline"
        raise UnknownNameError(f"nothing has been checked for {what}; run 'vines run {name or 'quickstart'}' first")
    return json.loads(json.dumps(rows))
