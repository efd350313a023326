"""A table as one Parquet file, with units and provenance inside; the same bytes each time, checked on reading."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any

from vines import schema
from vines.errors import SchemaError
from vines.store._keys import canonical

if TYPE_CHECKING:
    import pyarrow as pa

__all__ = ["ROW_GROUP", "TableFile", "read_parquet", "write_parquet"]

ROW_GROUP = 122_880
"""Rows in a row group: DuckDB's vector block, measured best for narrow queries (docs/tables.md)."""


class TableFile:
    """A Parquet file that grows piece by piece; its bytes do not depend on how the rows were cut into pieces.

    Parameters
    ----------
    path : Path
        File to write.
    name : str
        Table of ``schemas/``; what is added is cast to it.
    provenance : mapping
        Plain data for the schema metadata key ``vines``; nothing that differs from run to run.
    sorted_by : sequence of str
        Columns that the rows are sorted by, ascending, for readers that skip row groups.
    columns : sequence of str, optional
        Only these columns of the table.

    Raises
    ------
    SchemaError
        If rows do not fit the schema, or have a value that it does not allow.
    OSError
        If the file cannot be written.
    """

    def __init__(
        self,
        path: Path,
        name: str,
        *,
        provenance: Mapping[str, Any],
        sorted_by: Sequence[str] = (),
        columns: Sequence[str] | None = None,
    ) -> None:
        import pyarrow as pa
        import pyarrow.parquet as pq

        spec = schema.table(name)
        about = {
            "table": name,
            "version": spec.version,
            "units": schema.units(name),
            "provenance": dict(provenance),
        }
        kept = [column for column in spec.columns if columns is None or column.name in columns]
        floats: Any = [column.name for column in kept if column.dtype == "float64"]
        floats += [f"{column.name}.list.element" for column in kept if column.dtype == "list<float64>"]
        strings: Any = [column.name for column in kept if column.dtype == "string"]
        form = schema.arrow_schema(name)
        form = pa.schema([form.field(column.name) for column in kept], metadata={"vines": canonical(about)})
        self.rows = 0
        self._path = path
        self._name = name
        self._schema = form
        self._waiting: list[pa.Table] = []
        self._count = 0
        self._writer = pq.ParquetWriter(
            path,
            form,
            compression="zstd",
            use_dictionary=strings,
            use_byte_stream_split=floats,
            sorting_columns=[pq.SortingColumn(form.get_field_index(column)) for column in sorted_by] or None,
        )

    def __enter__(self) -> TableFile:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if kind is None:
            self._write(self._count)
        self._writer.close()

    def add(self, data: pa.Table | Sequence[Mapping[str, Any]]) -> None:
        """Add rows at the end; full row groups are written at once. Columns that a table lacks are empty."""
        import pyarrow as pa

        table: Any = data if isinstance(data, pa.Table) else schema.cast(self._name, data)
        self._waiting.append(table)
        self._count += table.num_rows
        self.rows += table.num_rows
        self._write(self._count - self._count % ROW_GROUP)

    def _write(self, rows: int) -> None:
        import pyarrow as pa

        if not rows:
            return
        whole: Any = pa.concat_tables(self._waiting, promote_options="default")
        self._waiting = [whole.slice(rows)]
        self._count -= rows
        try:
            for start in range(0, rows, ROW_GROUP):
                # one array a column: pages are cut the same whatever the pieces were
                group: Any = whole.slice(start, min(ROW_GROUP, rows - start)).combine_chunks()
                group = schema.cast(self._name, group).select(self._schema.names).combine_chunks()
                schema.check_values(self._name, group)
                group = group.replace_schema_metadata(self._schema.metadata)
                self._writer.write_table(group, row_group_size=ROW_GROUP)
        except pa.ArrowException as error:
            raise OSError(f"{self._path}: {error}") from error


def write_parquet(
    path: Path,
    name: str,
    data: pa.Table | Sequence[Mapping[str, Any]],
    *,
    provenance: Mapping[str, Any],
    sorted_by: Sequence[str] = (),
    sparse: bool = False,
) -> int:
    """Write rows of a table and return how many there are.

    Parameters
    ----------
    path : Path
        File to write.
    name : str
        Table of ``schemas/``; the data are cast to it.
    data : pyarrow.Table or sequence of rows
        In their final order.
    provenance : mapping
        Plain data for the schema metadata key ``vines``; nothing that differs from run to run.
    sorted_by : sequence of str
        Columns that the rows are sorted by, ascending, for readers that skip row groups.
    sparse : bool
        Leave out the columns that are empty throughout.

    Raises
    ------
    SchemaError
        If the data do not fit the schema.
    OSError
        If the file cannot be written.
    """
    table = schema.cast(name, data)
    columns = None
    if sparse:
        full = [column for column in table.column_names if table.column(column).null_count < table.num_rows]
        columns = list(dict.fromkeys(["point_id", *full]))
    with TableFile(path, name, provenance=provenance, sorted_by=sorted_by, columns=columns) as file:
        file.add(table)
    return file.rows


def check_form(path: Path, name: str) -> None:
    """See that columns, units and version of a stored table are those of the schema; reads no rows.

    Raises
    ------
    SchemaError
        If they are not; one line with the first disagreement and how many more there are.
    OSError
        If the file cannot be read.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    try:
        wrong = schema.disagreements(name, pq.read_schema(path))
    except pa.ArrowException as error:
        raise OSError(f"{path}: {str(error).splitlines()[0]}") from None
    if wrong:
        more = f" (and {len(wrong) - 1} more)" if len(wrong) > 1 else ""
        raise SchemaError(f"{path}: {wrong[0]}{more}; run its pipeline again, with --force if the file was changed")


def read_parquet(path: Path, name: str) -> pa.Table:
    """Return a stored table, once its columns, units and version are those of the schema.

    Parameters
    ----------
    path : Path
        The file.
    name : str
        Table of ``schemas/`` that it should be.

    Raises
    ------
    SchemaError, OSError
        As :func:`check_form`.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    check_form(path, name)
    try:
        return pq.read_table(path)
    except pa.ArrowException as error:
        raise OSError(f"{path}: {str(error).splitlines()[0]}") from None
