"""The SQL of the views: one a table over all stages, and one a stage and table."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple

from vines import schema
from vines.errors import StoreError
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


_SHARED = ("all_orbits", "all_points")
"""Views of what the tables of all systems have."""
_MADE = {
    "impact_power": "(impact_loss_left + impact_loss_right)/duration",
    "ties": "0",
}
"""What the tables of the VI-NES do not have because it follows from what they have."""


def quote(name: str) -> str:
    """Return a name as SQL quotes it.

    Examples
    --------
    >>> quote("quickstart.up")
    '"quickstart.up"'
    """
    return '"' + name.replace('"', '""') + '"'


def select(
    spec: Table,
    pipeline: str,
    stage: str,
    source: str | None,
    there: Collection[str],
    made: Mapping[str, str] = MappingProxyType({}),
) -> str:
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
    made : mapping of str to str
        SQL for columns that it lacks.
    """
    columns = [
        quote(column.name)
        if column.name in there
        else f"CAST({made.get(column.name, 'NULL')} AS {_TYPES[column.dtype]}) AS {quote(column.name)}"
        for column in spec.columns
    ]
    names = f"{text(pipeline)} AS pipeline, {text(stage)} AS stage"
    origin = f"FROM {source}" if source is not None else "WHERE false"
    return f"SELECT {names}, {', '.join(columns)} {origin}"


class Source(NamedTuple):
    """A stored table that is one piece of a view: its table of ``schemas/``, file, pipeline, result, and query."""

    table: str
    path: Path
    pipeline: str
    key: str
    query: str


@dataclass(frozen=True, slots=True)
class View:
    """A view that can be made.

    Attributes
    ----------
    name : str
        What a query calls it.
    words : tuple of str
        All of them, in lower case, stand in a query that uses the view.
    sources : tuple of Source
        Its pieces.
    empty : str
        The query where there is no piece.
    short : tuple of str
        Pipeline and stage, where the view also answers to them without quotes.
    """

    name: str
    words: tuple[str, ...]
    sources: tuple[Source, ...] = ()
    empty: str = ""
    short: tuple[str, ...] = ()

    @property
    def is_single(self) -> bool:
        """Whether it shows one stage alone."""
        return len(self.words) > 1

    def statements(self, left_out: Collection[Path] = ()) -> list[str]:
        """Return the SQL that makes it, without the pieces in some files."""
        pieces = [each.query for each in self.sources if each.path not in left_out]
        made = [f"CREATE VIEW {quote(self.name)} AS {' UNION ALL '.join(pieces) or self.empty}"]
        if self.short:
            schema_name, view = map(quote, self.short)
            made = [f"CREATE SCHEMA IF NOT EXISTS {schema_name}", *made]
            made.append(f"CREATE VIEW {schema_name}.{view} AS SELECT * FROM {quote(self.name)}")
        return made


def stage_results(
    store: Store, pipelines: Collection[str] | None = None
) -> tuple[list[tuple[str, str, Result]], dict[str, str]]:
    """Return what is pinned and stored, and what is pinned and cannot be read.

    Parameters
    ----------
    store : Store
        Where the results are.
    pipelines : collection of str, optional
        Only of these.

    Returns
    -------
    results : list of (str, str, Result)
        Pipeline, stage and result.
    absent : dict of str to str
        Why a pipeline, or ``<pipeline>.<stage>``, is not among them.
    """
    pinned, damaged = store.readable_pins()
    found: list[tuple[str, str, Result]] = []
    absent = {name: why for name, why in damaged.items() if pipelines is None or name in pipelines}
    for pipeline, pins in pinned.items():
        if pipelines is None or pipeline in pipelines:
            for stage, pin in sorted(pins.items()):
                try:
                    found.append((pipeline, stage, store.result(pin["result"])))
                except StoreError as error:
                    absent[f"{pipeline}.{stage}"] = str(error)
    return found, absent


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

    pieces: dict[str, list[Source]] = {name: [] for name, spec in schema.tables().items() if spec.stored}
    shared: dict[str, list[Source]] = {name: [] for name in _SHARED}
    logs: list[str] = []
    single: list[View] = []
    for pipeline, stage, result in results:
        logs += _log_rows(pipeline, stage, result, lambda file, of=(pipeline, stage, result): path_of(*of, file))
        for i, (name, about) in enumerate(result.manifest["tables"].items()):
            if name not in pieces:
                continue
            path = result.folder / f"{name}.parquet"
            place_of = f"read_parquet({text(str(path_of(pipeline, stage, result, path.name)))})"
            query = select(schema.table(name), pipeline, stage, place_of, about["columns"])
            piece = Source(name, path, pipeline, result.key, query)
            pieces[name].append(piece)
            called = f"{pipeline}.{stage}" if i == 0 else f"{pipeline}.{stage}.{name}"
            short = (pipeline, stage) if i == 0 else ()
            single.append(View(called, (pipeline.lower(), stage.lower()), (piece,), short=short))
            common = f"all_{schema.table(name).like}"
            if common in shared:
                made = _MADE | {"system": text(schema.table(name).system)}
                query = select(schema.table(common), pipeline, stage, place_of, about["columns"], made)
                shared[common].append(Source(name, path, pipeline, result.key, query))
    whole = [
        View(name, (name,), tuple(found), empty=select(schema.table(name), "", "", None, ()))
        for name, found in (pieces | shared).items()
    ]
    return [*whole, View("logs", ("logs",), empty=_logs(logs)), *single]


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
    """Return the query of ``logs``, whose rows come from manifests and not from a Parquet file."""
    spec = schema.table("logs")
    if not rows:
        return select(spec, "", "", None, ())
    names = ", ".join(quote(name) for name in ("pipeline", "stage", *spec.names))
    typed = ", ".join(f"CAST({quote(c.name)} AS {_TYPES[c.dtype]}) AS {quote(c.name)}" for c in spec.columns)
    return f"SELECT pipeline, stage, {typed} FROM (VALUES {', '.join(rows)}) AS t({names})"


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
