"""Whether data are what a table of ``schemas/`` says: values on writing, the form of a file on reading."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from vines.errors import SchemaError
from vines.schema._columns import Column
from vines.schema._tables import arrow_schema, table

if TYPE_CHECKING:
    import pyarrow as pa

__all__ = ["check_values", "disagreements", "metadata_disagreements", "units"]


def units(name: str) -> dict[str, str]:
    """Return the unit of each column of a table that has one.

    Examples
    --------
    >>> units("impacts")["phase"]
    'rad'
    """
    return {column.name: column.unit for column in table(name).columns if column.unit}


def check_values(name: str, data: pa.Table) -> None:
    """Check that the values of a table are among those that its schema allows.

    Empty values and nan are allowed everywhere: they say that there is no value.

    Parameters
    ----------
    name : str
        Table of ``schemas/``.
    data : pyarrow.Table
        Rows of it; columns may be missing.

    Raises
    ------
    SchemaError
        If a value is not allowed; the message has the first one.

    Examples
    --------
    >>> check_values("points", arrow_schema("points").empty_table())
    """
    there = set(data.column_names)
    for column in table(name).columns:
        if (
            column.name in there
            and column.limited
            and (bad := _first_bad(column, data.column(column.name))) is not None
        ):
            row, value = bad
            raise SchemaError(
                f"table {name!r}, column {column.name!r}: {value!r} in row {row} is not allowed: {column.allowed}"
            )


def _first_bad(column: Column, values: Any) -> tuple[int, Any] | None:
    import pyarrow as pa
    import pyarrow.compute

    pc: Any = pyarrow.compute
    if column.values:
        good = pc.is_in(values, value_set=pa.array(column.values, type=values.type), skip_nulls=False)
    else:
        span = pc.min_max(values).as_py()  # nan and empty values do not count
        low, high = (span[end] if span[end] is not None else math.nan for end in ("min", "max"))
        if not (low < (column.minimum if column.minimum is not None else -math.inf)) and not (
            high > (column.maximum if column.maximum is not None else math.inf)
        ):
            return None
        good = pa.scalar(True)
        if column.minimum is not None:
            good = pc.and_(good, pc.greater_equal(values, column.minimum))
        if column.maximum is not None:
            good = pc.and_(good, pc.less_equal(values, column.maximum))
        if pa.types.is_floating(values.type):
            good = pc.or_(good, pc.is_nan(values))
    good = pc.or_kleene(good, pc.is_null(values))
    place = pc.index(good, False).as_py()
    return None if place < 0 else (place, values[place].as_py())


def disagreements(name: str, found: pa.Schema) -> list[str]:
    """Return how the schema of a file disagrees with that of its table, one line each; empty if it does not.

    Columns that are missing are no disagreement: a result stored before a column was added keeps those it has.

    Parameters
    ----------
    name : str
        Table of ``schemas/``.
    found : pyarrow.Schema
        That of the file, with metadata.
    """
    wanted = arrow_schema(name)
    lines = []
    for field in found:
        if field.name not in wanted.names:
            lines.append(f"column {field.name!r} is not one of {name!r}")
            continue
        ours: Any = wanted.field(field.name)
        if field.type != ours.type:
            lines.append(f"column {field.name!r} is {field.type}, the schema says {ours.type}")
        unit = (field.metadata or {}).get(b"unit", b"").decode()
        if unit != ours.metadata[b"unit"].decode():
            lines.append(f"column {field.name!r} is in {unit!r}, the schema says {ours.metadata[b'unit'].decode()!r}")
    return lines + metadata_disagreements(name, (found.metadata or {}).get(b"vines"), found.names)


def metadata_disagreements(name: str, text: bytes | None, columns: list[str] | None = None) -> list[str]:
    """Return how the JSON text under the metadata key ``vines`` disagrees with the schema, one line each.

    Parameters
    ----------
    name : str
        Table of ``schemas/``.
    text : bytes or None
        What the file has under the key.
    columns : list of str, optional
        Columns of the file, whose units have to be told; those that the text names if left out.
    """
    if text is None:
        return ["the key 'vines' with units and provenance is missing"]
    try:
        about = json.loads(text)
    except ValueError:
        about = None
    if not isinstance(about, Mapping) or not isinstance(about.get("units"), Mapping):
        return ["the key 'vines' holds no units and provenance"]
    spec = table(name)
    if about.get("table") != name:
        return [f"it is a table {about.get('table')!r}, not {name!r}"]
    if about.get("version") != spec.version:
        return [f"it is version {about.get('version')} of {name!r}, this vines has version {spec.version}"]
    wanted, told = units(name), about["units"]
    named = set(told) if columns is None else set(columns)
    return [
        f"the unit of {column!r} is told as {told.get(column)!r}, the schema says {wanted.get(column)!r}"
        for column in sorted(named & {*told, *wanted})
        if told.get(column) != wanted.get(column)
    ]
