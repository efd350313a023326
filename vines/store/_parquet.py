"""Writing a table as one Parquet file, with units and provenance inside; the same bytes each time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vines import schema
from vines.store._keys import canonical

if TYPE_CHECKING:
    import pyarrow as pa

__all__ = ["ROW_GROUP", "write_parquet"]

ROW_GROUP = 122_880
"""Rows in a row group: DuckDB's vector block, measured best for narrow queries (docs/tables.md)."""


def write_parquet(
    path: Path,
    name: str,
    data: pa.Table | Sequence[Mapping[str, Any]],
    *,
    provenance: Mapping[str, Any],
    sorted_by: Sequence[str] = (),
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

    Raises
    ------
    SchemaError
        If the data do not fit the schema.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    table = schema.cast(name, data)
    spec = schema.table(name)
    about = {
        "table": name,
        "version": spec.version,
        "units": {column.name: column.unit for column in spec.columns if column.unit},
        "provenance": dict(provenance),
    }
    table = table.replace_schema_metadata({"vines": canonical(about)})
    floats: Any = [column.name for column in spec.columns if column.dtype == "float64"]
    floats += [f"{column.name}.list.element" for column in spec.columns if column.dtype == "list<float64>"]
    strings: Any = [column.name for column in spec.columns if column.dtype == "string"]
    sorting = [pq.SortingColumn(table.column_names.index(column)) for column in sorted_by]
    try:
        pq.write_table(
            table,
            path,
            compression="zstd",
            row_group_size=ROW_GROUP,
            use_dictionary=strings,
            use_byte_stream_split=floats,
            sorting_columns=sorting or None,
        )
    except pa.ArrowException as error:
        raise OSError(f"{path}: {error}") from error
    return table.num_rows
