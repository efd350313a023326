"""The SQL of the views: one a table over all stages, and one a stage and table."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from vines import schema
from vines.schema import Table
from vines.store import Result, Store, canonical

__all__ = ["View", "list_views", "quote", "select", "stage_results", "text"]

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
    names = f"{text(pipeline)} AS pipeline, {text(stage)} AS stage"
    origin = f"FROM {source}" if source is not None else "WHERE false"
    return f"SELECT {names}, {', '.join(columns)} {origin}"


@dataclass(frozen=True, slots=True)
class View:
    """A view that can be made.

    Attributes
    ----------
    name : str
        What a query calls it.
    statements : tuple of str
        SQL that makes it, and its short name without quotes if it has one.
    sources : tuple of (str, Path, str)
        Table, file and pipeline of each piece.
    words : tuple of str
        All of them, in lower case, stand in a query that uses the view.
    """

    name: str
    statements: tuple[str, ...]
    sources: tuple[tuple[str, Path, str], ...]
    words: tuple[str, ...]


def stage_results(store: Store, pipelines: Collection[str] | None = None) -> Iterator[tuple[str, str, Result]]:
    """Yield pipeline, stage and result of everything that is pinned and stored.

    Parameters
    ----------
    store : Store
        Where the results are.
    pipelines : collection of str, optional
        Only of these.
    """
    for pipeline, pins in store.pinned().items():
        if pipelines is None or pipeline in pipelines:
            for stage, pin in sorted(pins.items()):
                if store.has(pin["result"]):
                    yield pipeline, stage, store.result(pin["result"])


def list_views(
    results: Iterable[tuple[str, str, Result]], place: Callable[[str, str, str], str | None] | None = None
) -> list[View]:
    """Return all views over some results: one a table of ``schemas/`` over all stages, then those of single stages.

    Parameters
    ----------
    results : iterable of (str, str, Result)
        Pipeline, stage, result.
    place : callable, optional
        Path of a file as SQL shall write it, from pipeline, stage and its name in the result; where it lies in the
        store if left out. None for a log that is not there.
    """

    def path_of(pipeline: str, stage: str, result: Result, file: str) -> str | None:
        return str(result.folder / file) if place is None else place(pipeline, stage, file)

    pieces: dict[str, list[str]] = {name: [] for name, spec in schema.tables().items() if spec.stored}
    files: dict[str, list[tuple[str, Path, str]]] = {name: [] for name in pieces}
    logs: list[str] = []
    single: list[View] = []
    for pipeline, stage, result in results:
        logs += _log_rows(pipeline, stage, result, lambda file, of=(pipeline, stage, result): path_of(*of, file))
        for i, (name, about) in enumerate(result.manifest["tables"].items()):
            if name not in pieces:
                continue
            path = result.folder / f"{name}.parquet"
            source = f"read_parquet({text(str(path_of(pipeline, stage, result, path.name)))})"
            query = select(schema.table(name), pipeline, stage, source, about["columns"])
            pieces[name].append(query)
            files[name].append((name, path, pipeline))
            called = f"{pipeline}.{stage}" if i == 0 else f"{pipeline}.{stage}.{name}"
            made = [f"CREATE VIEW {quote(called)} AS {query}"]
            if i == 0:
                made = [f"CREATE SCHEMA IF NOT EXISTS {quote(pipeline)}", *made]
                made.append(f"CREATE VIEW {quote(pipeline)}.{quote(stage)} AS SELECT * FROM {quote(called)}")
            single.append(View(called, tuple(made), ((name, path, pipeline),), (pipeline.lower(), stage.lower())))
    whole = []
    for name, queries in pieces.items():
        query = " UNION ALL ".join(queries) or select(schema.table(name), "", "", None, ())
        whole.append(View(name, (f"CREATE VIEW {quote(name)} AS {query}",), tuple(files[name]), (name,)))
    whole.append(View("logs", (_logs(logs),), (), ("logs",)))
    return [*whole, *single]


def _log_rows(pipeline: str, stage: str, result: Result, path_of: Callable[[str], str | None]) -> list[str]:
    spec = schema.table("logs")
    rows = []
    for log in result.manifest["logs"]:
        about = result.manifest["files"][log["file"]]
        row = {
            "point_id": log["point_id"],
            "log_id": f"{result.key[:12]}/{log['point_id']}",
            "path": path_of(log["file"]),
            **log["params"],
            "name": log["name"],
            "bytes": about["bytes"],
            "sha256": about["sha256"],
            "provenance": canonical(result.manifest["provenance"]),
        }
        values = [pipeline, stage, *(row.get(name) for name in spec.names)]
        rows.append("(" + ", ".join(_literal(value) for value in values) + ")")
    return rows


def _logs(rows: list[str]) -> str:
    """Return the SQL of ``logs``, whose rows come from manifests and not from a Parquet file."""
    spec = schema.table("logs")
    if not rows:
        return f"CREATE VIEW logs AS {select(spec, '', '', None, ())}"
    names = ", ".join(quote(name) for name in ("pipeline", "stage", *spec.names))
    typed = ", ".join(f"CAST({quote(c.name)} AS {_TYPES[c.dtype]}) AS {quote(c.name)}" for c in spec.columns)
    return f"CREATE VIEW logs AS SELECT pipeline, stage, {typed} FROM (VALUES {', '.join(rows)}) AS t({names})"


def _literal(value: Any) -> str:
    if value is None:
        return "NULL"
    if isinstance(value, float):
        return f"{value!r}::DOUBLE"
    return str(value) if isinstance(value, int) else text(str(value))


def text(value: str) -> str:
    """Return a text as SQL quotes it.

    Examples
    --------
    >>> text("it's")
    "'it''s'"
    """
    return "'" + value.replace("'", "''") + "'"
