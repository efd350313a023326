"""Two results of a stage side by side."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import Any

from vines import schema
from vines.catalogue._views import quote
from vines.packages import need
from vines.store import Result

__all__ = ["ColumnDifference", "TableDifference", "compare_tables"]


@dataclass(frozen=True, slots=True)
class ColumnDifference:
    """How the values of a column differ.

    Attributes
    ----------
    name : str
        The column.
    differ : int
        Rows whose values differ by more than the tolerance; a missing value differs from one that is there.
    largest : float or None
        Largest absolute difference of numbers; None for texts, lists, and where one is always missing.
    first : str
        Where the first of them is.
    """

    name: str
    differ: int
    largest: float | None
    first: str


@dataclass(frozen=True, slots=True)
class TableDifference:
    """How a table differs: rows in both results, in one only, and columns with differences."""

    name: str
    matched: int
    only_a: int
    only_b: int
    columns: tuple[ColumnDifference, ...]

    @property
    def same(self) -> bool:
        """Whether nothing differs."""
        return not (self.only_a or self.only_b or self.columns)


def compare_tables(
    a: Result, b: Result, axes: Collection[str], *, rtol: float, atol: float
) -> tuple[TableDifference, ...]:
    """Compare the tables that two results have in common.

    Parameters
    ----------
    a, b : Result
        Results of the same kind.
    axes : collection of str
        The varied parameters: rows are matched by their values, several with the same values in their order. Without
        any, rows are matched by number.
    rtol, atol : float
        Numbers are the same if ``|a - b| <= atol + rtol max(|a|, |b|)``.

    Returns
    -------
    tuple of TableDifference
        One for each table of `a`.
    """
    need("duckdb")
    import duckdb

    with duckdb.connect(":memory:") as connection:
        return tuple(_table(connection, name, a, b, axes, rtol, atol) for name in a.tables if name in b.tables)


def _table(
    connection: Any, name: str, a: Result, b: Result, axes: Collection[str], rtol: float, atol: float
) -> TableDifference:
    there = set(a.manifest["tables"][name]["columns"]) & set(b.manifest["tables"][name]["columns"])
    columns = [column for column in schema.table(name).columns if column.name in there and column.name != "point_id"]
    keys = [axis for axis in axes if axis in there]
    for side, result in (("a", a), ("b", b)):
        path = str(result.folder / f"{name}.parquet").replace("'", "''")
        over = f"partition by {', '.join(map(quote, keys))} " if keys else ""
        connection.execute(
            f"create or replace temp view {side} as select *, row_number() over ({over}order by file_row_number) as "
            f"\"n th\" from read_parquet('{path}', file_row_number = true)"
        )
    on = " and ".join(f"a.{key} is not distinct from b.{key}" for key in [*map(quote, keys), '"n th"'])
    where = " || ', ' || ".join([*(f"'{key} = ' || a.{quote(key)}" for key in keys), "'row ' || a.\"n th\""])
    both = [f"{side}.{quote(c.name)} as {quote(f'{side} {c.name}')}" for c in columns for side in ("a", "b")]
    picked = ", ".join([f"{where} as place", "a.file_row_number as nth", *both])
    connection.execute(f"create or replace temp table pairs as select {picked} from a join b on {on}")
    counts = [connection.execute(f"select count(*) from {each}").fetchone()[0] for each in ("pairs", "a", "b")]
    found = []
    for column in columns:
        one, other = quote(f"a {column.name}"), quote(f"b {column.name}")
        differ = f"{one} is distinct from {other}"
        largest = "null"
        if column.dtype == "float64":
            near = f"abs({one} - {other}) <= {atol!r} + {rtol!r} * greatest(abs({one}), abs({other}))"
            differ += f" and not coalesce({near}, false)"
        if column.dtype in ("float64", "int8", "int64"):
            largest = f"max(abs({one} - {other}))"
        count, most, first = connection.execute(
            f"select count(*), {largest}, arg_min(place, nth) from pairs where {differ}"
        ).fetchone()
        if count:
            found.append(ColumnDifference(column.name, count, None if most is None else float(most), first))
    matched, rows_a, rows_b = counts
    return TableDifference(name, matched, rows_a - matched, rows_b - matched, tuple(found))
