"""The SQL of the views: one a table over all stages, and one a stage and table."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

from vines import schema
from vines.schema import Table
from vines.store import Result, Store, canonical

__all__ = ["define_views", "quote", "select"]

_TYPES = {
    "bool": "BOOLEAN",
    "float64": "DOUBLE",
    "int8": "TINYINT",
    "int64": "BIGINT",
    "list<float64>": "DOUBLE[]",
    "list<int8>": "TINYINT[]",
    "string": "VARCHAR",
}


def quote(name: str) -> str:
    """Return a name as SQL quotes it.

    Examples
    --------
    >>> quote("quickstart.up")
    '"quickstart.up"'
    """
    return '"' + name.replace('"', '""') + '"'


def select(spec: Table, pipeline: str, stage: str, source: str | None, there: Collection[str]) -> str:
    """Return the query for the rows of one stage.

    Parameters
    ----------
    spec : Table
        The table.
    pipeline, stage : str
        Values of the first two columns.
    source : str or None
        What to read from; ``None`` for no rows.
    there : collection of str
        Columns that the source has. A result stored under an earlier schema may lack some; they are null.
    """
    columns = [
        quote(column.name) if column.name in there else f"CAST(NULL AS {_TYPES[column.dtype]}) AS {quote(column.name)}"
        for column in spec.columns
    ]
    names = f"{_text(pipeline)} AS pipeline, {_text(stage)} AS stage"
    origin = f"FROM {source}" if source is not None else "WHERE false"
    return f"SELECT {names}, {', '.join(columns)} {origin}"


def define_views(connection: Any, store: Store) -> list[str]:
    """Define all views over what is pinned in a store and return their names."""
    pieces: dict[str, list[str]] = {name: [] for name, spec in schema.tables().items() if spec.stored}
    logs: list[list[Any]] = []
    names: list[str] = []
    for pipeline, pins in store.pinned().items():
        made = False
        for stage, pin in sorted(pins.items()):
            if not store.has(pin["result"]):
                continue
            result = store.result(pin["result"])
            logs += _log_rows(pipeline, stage, result)
            for i, (name, about) in enumerate(result.manifest["tables"].items()):
                if name not in pieces:
                    continue
                source = f"read_parquet({_text(str(result.folder / f'{name}.parquet'))})"
                query = select(schema.table(name), pipeline, stage, source, about["columns"])
                pieces[name].append(query)
                view = f"{pipeline}.{stage}" if i == 0 else f"{pipeline}.{stage}.{name}"
                connection.execute(f"CREATE VIEW {quote(view)} AS {query}")
                names.append(view)
                if i == 0:
                    if not made:
                        connection.execute(f"CREATE SCHEMA {quote(pipeline)}")
                        made = True
                    connection.execute(f"CREATE VIEW {quote(pipeline)}.{quote(stage)} AS {query}")
    for name, queries in pieces.items():
        query = " UNION ALL ".join(queries) or select(schema.table(name), "", "", None, ())
        connection.execute(f"CREATE VIEW {quote(name)} AS {query}")
    _define_logs(connection, logs)
    return [*pieces, "logs", *names]


def _log_rows(pipeline: str, stage: str, result: Result) -> list[list[Any]]:
    spec = schema.table("logs")
    rows = []
    for log in result.manifest["logs"]:
        about = result.manifest["files"][log["file"]]
        row = {
            "point_id": log["point_id"],
            "log_id": f"{result.key[:12]}/{log['point_id']}",
            "path": str(result.folder / log["file"]),
            **log["params"],
            "name": log["name"],
            "bytes": about["bytes"],
            "sha256": about["sha256"],
            "provenance": canonical(result.manifest["provenance"]),
        }
        rows.append([pipeline, stage, *(row.get(name) for name in spec.names)])
    return rows


def _define_logs(connection: Any, rows: list[list[Any]]) -> None:
    """Make ``logs``: a table, since its rows come from manifests and not from a Parquet file."""
    spec = schema.table("logs")
    columns = ", ".join(f"{quote(column.name)} {_TYPES[column.dtype]}" for column in spec.columns)
    connection.execute(f"CREATE TABLE logs (pipeline VARCHAR, stage VARCHAR, {columns})")
    if rows:
        places = ", ".join("?" for _ in rows[0])
        connection.executemany(f"INSERT INTO logs VALUES ({places})", rows)


def _text(value: str) -> str:
    return "'" + value.replace("'", "''") + "'"
