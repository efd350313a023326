"""Views over stored tables, and SQL on them. Nothing is downloaded and nothing written."""

from __future__ import annotations

import contextlib
import difflib
import re
import warnings
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, Literal

from vines import schema
from vines.catalogue._views import View, list_views, quote, select, stage_results, text
from vines.errors import DamageWarning, QueryError, SchemaError, UnknownNameError, nearest
from vines.packages import need
from vines.store import Store

if TYPE_CHECKING:
    import pyarrow as pa

__all__ = ["Catalogue", "connect", "connect_tables"]

_NO_TABLE = re.compile(r"Table with name (\S+) does not exist")
_NEAR = re.compile(r"syntax error at or near \"(\w+)\"")
_NO_COLUMN = re.compile(
    r"Referenced column \"(?P<a>[^\"]+)\" not found|Table \"[^\"]+\" does not have a column named \"(?P<b>[^\"]+)\""
    r"|Cannot extract field '(?P<c>[^']+)' from expression \"[^\"]+\" because it is not a struct"
)
_QUOTED = re.compile(r"\"([^\"]+)\"")
_ABOUT = ("information_schema", "duckdb_", "pragma", "show ", "describe ", "sqlite_master", "pg_catalog")
_KIND = re.compile(r"^(Catalog|Parser|Binder|Conversion|Invalid Input|Out of Range|Permission) Error: ")
_EXPLAIN = re.compile(r"\s*explain(\s+analyze)?\b", re.IGNORECASE)


class Catalogue:
    """An open connection; close it, or use it in a ``with`` statement.

    Parameters
    ----------
    connection : duckdb.DuckDBPyConnection
        In memory.
    views : sequence of View
        The views there are. One is made when a query may use it: to make all takes longer than most queries.
    store : Store, optional
        Where their files are; without one they are made already.
    absent : mapping of str to str, optional
        Why a pipeline, or ``<pipeline>.<stage>``, is in none of the views though it is pinned.
    """

    def __init__(
        self,
        connection: Any,
        views: Iterable[View],
        store: Store | None = None,
        absent: Mapping[str, str] | None = None,
    ) -> None:
        self._connection = connection
        self._views = {view.name: view for view in views}
        self._store = store
        self._absent = dict(absent or {})
        self._refused: dict[str, str] = {}
        self._told: set[str] = set()
        self._made: set[str] = set(self._views) if store is None else set()
        self.names = tuple(self._views)

    def __enter__(self) -> Catalogue:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Close the connection."""
        self._connection.close()

    def query(self, sql: str) -> pa.Table:
        """Answer a query with an Arrow table; columns that keep the name of a stored one keep its unit.

        Over all pipelines it is answered without the results that are damaged; a `DamageWarning` names each.

        Raises
        ------
        QueryError
            If the query cannot be answered; one line, with the nearest table if one was misspelt, or what is wrong
            with the stage that it asks for.
        SchemaError
            If a file that it reads is not what the schema of its table says.
        """
        return _with_units(self._run(sql, lambda relation: relation.to_arrow_table()))

    def fetch(self, sql: str) -> tuple[list[str], list[tuple[Any, ...]]]:
        """Answer a query with the names of the columns and the rows; quicker than Arrow for what is only shown.

        Raises
        ------
        QueryError
            As :meth:`query`.
        SchemaError
            As :meth:`query`.
        """
        return self._run(sql, lambda relation: (list(relation.columns), relation.fetchall()))

    def save(self, sql: str, path: Path, form: Literal["csv", "parquet"]) -> None:
        """Answer a query into a file; lists stand in one CSV field as DuckDB writes them.

        Raises
        ------
        QueryError
            As :meth:`query`.
        """
        answer = self.query(sql)
        if form == "csv":
            import duckdb

            with duckdb.connect(":memory:") as writer:  # the connection of the catalogue writes nothing
                writer.from_arrow(answer).write_csv(str(path))
            return
        import pyarrow.parquet as pq

        pq.write_table(answer, path, compression="zstd")

    def count(self, name: str) -> int:
        """Return the number of rows of a view."""
        return self.fetch(f"select count(*) from {quote(name)}")[1][0][0]

    def table(self, name: str) -> pa.Table:
        """Return all rows of a view.

        Parameters
        ----------
        name : str
            A table of ``schemas/``, ``<pipeline>.<stage>`` for the primary table of one stage, or
            ``<pipeline>.<stage>.<table>``.

        Raises
        ------
        UnknownNameError
            If there is no such view.
        """
        if name not in self.names:
            raise UnknownNameError(f"unknown table {name!r}: {nearest(name, self.names)}")
        return self.query(f"select * from {quote(name)}")

    def _run(self, sql: str, take: Callable[[Any], Any]) -> Any:
        need("duckdb")
        import duckdb

        try:
            statements = duckdb.extract_statements(sql)
            if [each.type for each in statements] == [duckdb.StatementType.EXPLAIN]:
                # what is analysed is carried out
                statements = duckdb.extract_statements(_EXPLAIN.sub("", sql, count=1))
            if [each.type for each in statements] != [duckdb.StatementType.SELECT]:
                shown = " ".join(sql.split())[:60]
                raise QueryError(f"{shown!r} is not one query; the catalogue is read only, ask with a single select")
            self._make(sql)
            return self._interruptible(lambda: take(self._connection.sql(sql)))
        except duckdb.Error as error:
            raise QueryError(self._say(str(error))) from None

    def _interruptible(self, call: Callable[[], Any]) -> Any:
        """Call what DuckDB may take long for; Ctrl-C ends it, which DuckDB does not hear by itself."""
        with ThreadPoolExecutor(max_workers=1) as other:
            answer = other.submit(call)
            try:
                return answer.result()
            except BaseException:
                self._connection.interrupt()
                raise

    def _make(self, sql: str) -> None:
        """Make the views that a query may use: those whose names stand in it, or all if it asks what there is."""
        words = sql.lower()
        everything = any(word in words for word in _ABOUT)
        for view in self._views.values():
            if view.name in self._made or not (everything or all(word in words for word in view.words)):
                continue
            problems = self._problems(view, thorough=not everything)
            if problems and view.is_single:
                # it may be that the query is about another view: what it lacks is told when DuckDB does not find it
                self._refused[view.name] = next(iter(problems.values()))
                continue
            self._made.add(view.name)
            if not view.is_single:
                self._tell([*self._absent.values(), *problems.values()])
            if not everything:
                self._check(view, problems)
            for statement in view.statements(problems):
                self._connection.execute(statement)

    def _problems(self, view: View, *, thorough: bool) -> dict[Path, str]:
        """Return the files of a view that are damaged, and why."""
        found: dict[Path, str] = {}
        if self._store is None:
            return found
        for source in view.sources:
            problem = self._store.problem(source.key, (source.path.name,), thorough=thorough)
            if problem:
                found[source.path] = f"{source.path.parent}: {problem}; 'vines run {source.pipeline}' mends it"
        return found

    def _tell(self, lines: Iterable[str]) -> None:
        """Warn of what an answer lacks, once."""
        for line in lines:
            if line not in self._told:
                self._told.add(line)
                warnings.warn(f"{line}; the answer is without it", DamageWarning, stacklevel=2)

    def _check(self, view: View, left_out: Collection[Path]) -> None:
        """See that the files of a view tell the units and version of their schemas."""
        sources = [each for each in view.sources if each.path not in left_out]
        if not sources:
            return
        files = ", ".join(text(str(each.path)) for each in sources)
        found = self._connection.execute(
            f"SELECT file_name, value FROM parquet_kv_metadata([{files}]) WHERE key = 'vines'"
        ).fetchall()
        told = {Path(name): value for name, value in found}
        wrong = {
            each.path: (lines[0], each.pipeline)
            for each in sources
            if (lines := schema.metadata_disagreements(each.table, told.get(each.path)))
        }
        if wrong:
            path, (line, _) = next(iter(wrong.items()))
            again = " and ".join(f"'vines run {each}'" for each in dict.fromkeys(each for _, each in wrong.values()))
            raise SchemaError(
                f"{path}: {line}, and no query on {view.name} is answered until {again} made it again "
                "(--force if the file was changed; 'vines rig ingest FOLDER' where that made it)"
            )

    def _say(self, text: str) -> str:
        unknown = _NO_TABLE.search(text)
        if unknown:
            name = unknown.group(1).strip('"!')
            for where, why in {**self._absent, **self._refused}.items():
                if name == where or name.startswith(f"{where}.") or where.endswith(f".{name}"):
                    return why
            return f"no table {name!r}: {nearest(name, self.names)}"
        absent = _NO_COLUMN.search(text)
        if absent:
            return _no_column(next(filter(None, absent.groups())), text)
        near = _NEAR.search(text)
        if near and near.group(1).lower() in _column_names():
            word = near.group(1)
            return f'{word} is a word of SQL itself; as a column write it with its table or in quotes: "{word}"'
        if text.startswith("Permission Error"):
            return f"{_KIND.sub('', text.splitlines()[0])}; a query reads the results of the study and nothing else"
        lines = [line.strip() for line in text.splitlines() if line.strip() and not line.startswith("LINE ")]
        told = [line for line in lines[1:] if line.startswith(("Candidate", "Did you mean"))]
        if text.startswith("Parser Error"):
            told.append("ask as in: select A, name from points where stage = 'up'")
        return "; ".join([_KIND.sub("", lines[0]) if lines else "the query failed", *told])


def _no_column(name: str, text: str) -> str:
    """Return the line on a column that there is not, with the few that are nearest of those that DuckDB names."""
    offered = [each for line in text.splitlines() if line.startswith("Candidate") for each in _QUOTED.findall(line)]
    near = difflib.get_close_matches(name, offered or _column_names(), n=5, cutoff=0.5)
    said = f"nearest: {', '.join(near)}; " if near else ""
    return f"no column {name!r}: {said}'vines schema TABLE' lists the columns of a table"


def _column_names() -> set[str]:
    return {name for spec in schema.tables().values() for name in spec.names}


def _with_units(table: pa.Table) -> pa.Table:
    """Return the table with the unit of each column whose name means the same in all stored tables."""
    units: dict[str, set[str]] = {}
    for spec in schema.tables().values():
        for column in spec.columns:
            units.setdefault(column.name, set()).add(column.unit)
    for i, field in enumerate(table.schema):
        told = units.get(field.name, set())
        if len(told) == 1 and (unit := next(iter(told))):
            table = table.set_column(i, field.with_metadata({"unit": unit}), table.column(i))
    return table


def connect(store: Store) -> Catalogue:
    """Open the catalogue of what is pinned in a store.

    There is one view a table of ``schemas/`` over all stages, with the columns ``pipeline`` and ``stage`` first, empty
    where nothing was computed yet; and for each stage ``"<pipeline>.<stage>"`` with its primary table and
    ``"<pipeline>.<stage>.<table>"`` with the others. The first also answers without quotes.

    Parameters
    ----------
    store : Store
        Where the results are.

    Examples
    --------
    >>> from pathlib import Path
    >>> with connect(Store(Path("nowhere"))) as catalogue:
    ...     catalogue.fetch("select count(*) from points")
    (['count_star()'], [(0,)])
    """
    results, absent = stage_results(store)
    return Catalogue(_open(store.results), list_views(results), store, absent)


@contextlib.contextmanager
def connect_tables(
    tables: Mapping[str, Mapping[str, Any]],
) -> Iterator[Callable[[str], list[tuple[Any, ...]]]]:
    """Ask tables in memory as if they were in the catalogue.

    Parameters
    ----------
    tables : mapping
        Arrow tables of stages by table of ``schemas/`` and stage: ``{"points": {"up": table}}``.

    Yields
    ------
    callable
        Takes SQL and returns the rows as tuples. Raises `QueryError`.
    """
    connection = _open()
    try:
        for name, spec in schema.tables().items():
            pieces = []
            for i, (stage, table) in enumerate(tables.get(name, {}).items()):
                connection.register(f"vines_{name}_{i}", table)
                pieces.append(select(spec, "", stage, f"vines_{name}_{i}", table.column_names))
            view = " UNION ALL ".join(pieces) or select(spec, "", "", None, ())
            connection.execute(f"CREATE VIEW {quote(name)} AS {view}")
        catalogue = Catalogue(connection, [View(name, (name,)) for name in schema.tables()])
        yield lambda sql: catalogue.fetch(sql)[1]
    finally:
        connection.close()


def _open(*folders: Path) -> Any:
    """Return a connection that reads from some folders only, and whose configuration nobody changes."""
    need("duckdb")
    import duckdb

    connection = duckdb.connect(
        ":memory:", config={"autoinstall_known_extensions": "false", "autoload_known_extensions": "false"}
    )
    # A result never changes, and its footer tells where to look: to read it again takes longer than a narrow query.
    connection.execute("SET parquet_metadata_cache = true")
    connection.execute(f"SET allowed_directories = [{', '.join(text(str(each.absolute())) for each in folders)}]")
    for setting in (
        "enable_external_access = false",
        "python_enable_replacements = false",
        "lock_configuration = true",
    ):
        connection.execute(f"SET {setting}")
    return connection
