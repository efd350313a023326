"""Tables: their columns as ``schemas/*.toml`` declares them, and the casting of data to them."""

from __future__ import annotations

import functools
import hashlib
import json
import tomllib
from collections.abc import Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vines.doors import brought
from vines.errors import PlugInError, SchemaError, UnknownNameError, nearest
from vines.places import shipped
from vines.schema._columns import DTYPES, Column, Table
from vines.schema._declared import expand
from vines.schema._system_tables import of_system, of_systems

if TYPE_CHECKING:
    import pyarrow as pa

__all__ = ["arrow_schema", "cast", "digest", "table", "tables"]

GROUP = "vines.tables"
"""Entry points of packages that bring tables: the name is that of the table, the value a package with its file."""


def tables() -> dict[str, Table]:
    """Return all tables by name: those of ``schemas/``, and those that installed packages bring.

    Examples
    --------
    >>> [name for name in tables() if "branches" in name and name < "f"]
    ['branches', 'cubic_barriers_branches', 'drag_branches', 'duffing_branches']
    """
    return {name: _table(name) for name in dict.fromkeys([*_names(), *brought(GROUP)])}


def table(name: str) -> Table:
    """Return one table.

    Raises
    ------
    UnknownNameError
        If there is none of that name; the message names the nearest.

    Examples
    --------
    >>> table("impacts").columns[0].name
    'point_id'
    """
    if name not in _names() and name not in brought(GROUP):
        raise UnknownNameError(f"unknown table {name!r}: {nearest(name, tables())}")
    return _table(name)


@functools.cache
def digest(name: str) -> str:
    """Return the SHA-256 of what a table's data depend on: version, names, types and units of the columns.

    Examples
    --------
    >>> len(digest("points"))
    64
    """
    spec = table(name)
    form = [spec.name, spec.version, [[c.name, c.dtype, c.unit] for c in spec.columns]]
    return hashlib.sha256(json.dumps(form, separators=(",", ":")).encode()).hexdigest()


def arrow_schema(name: str) -> pa.Schema:
    """Return the Arrow schema of a table, with unit, description and source as metadata of each field.

    Examples
    --------
    >>> arrow_schema("points").field("A").type
    DataType(double)
    """
    import pyarrow as pa

    types = {
        "bool": pa.bool_(),
        "float64": pa.float64(),
        "int8": pa.int8(),
        "int64": pa.int64(),
        "list<float64>": pa.list_(pa.float64()),
        "list<int8>": pa.list_(pa.int8()),
        "string": pa.string(),
    }
    return pa.schema(
        pa.field(
            column.name,
            types[column.dtype],
            nullable=column.name != "point_id",
            metadata={"unit": column.unit, "description": column.description, "source": column.source},
        )
        for column in table(name).columns
    )


def cast(name: str, data: pa.Table | Sequence[Mapping[str, Any]] | Mapping[str, Any]) -> pa.Table:
    """Return data as a table of the schema: columns in order, cast without loss; those left out are null.

    Parameters
    ----------
    name : str
        Table of ``schemas/``.
    data : pyarrow.Table, sequence of rows, or mapping of columns
        Rows are dicts; columns are arrays of one length.

    Raises
    ------
    SchemaError
        If a column is unknown, cannot be cast, or ``point_id`` is missing or null.

    Examples
    --------
    >>> cast("impacts", [{"point_id": "a", "t": 1}]).column("t").to_pylist()
    [1.0]
    """
    import pyarrow as pa

    schema = arrow_schema(name)
    arrow: Any = data if isinstance(data, pa.Table) else None
    if arrow is not None:
        given: dict[str, Any] = {key: arrow.column(key) for key in arrow.column_names}
        length = arrow.num_rows
    elif isinstance(data, Mapping):
        given = dict(data)
        length = len(next(iter(given.values()), ()))
    else:
        keys = dict.fromkeys(key for row in data for key in row)
        given = {key: [row.get(key) for row in data] for key in keys}
        length = len(data)
    for key in given:
        if key not in schema.names:
            raise SchemaError(f"table {name!r} has no column {key!r}: {nearest(key, schema.names)}")
    arrays = [_array(name, field, given.get(field.name), length) for field in schema]
    return pa.Table.from_arrays(arrays, schema=schema)


def _array(name: str, field: pa.Field, values: Any, length: int) -> Any:
    import pyarrow as pa

    if values is None:
        values = pa.nulls(length, field.type)
    try:
        made = values if isinstance(values, pa.Array | pa.ChunkedArray) else _from_python(values, field.type)
        made = made.cast(field.type)
    except (pa.ArrowException, TypeError, ValueError, OverflowError) as error:
        text = str(error).splitlines()[0]
        raise SchemaError(f"table {name!r}, column {field.name!r}: not {field.type}: {text}") from None
    if len(made) != length:
        raise SchemaError(f"table {name!r}, column {field.name!r}: {len(made)} values where {length} are needed")
    if not field.nullable and made.null_count:
        raise SchemaError(f"table {name!r}, column {field.name!r}: may not be empty; give every row its id")
    return made


def _from_python(values: Any, kind: pa.DataType) -> Any:
    import pyarrow as pa

    if hasattr(values, "dtype"):
        plain = {"float64": pa.float64(), "int64": pa.int64(), "int8": pa.int8()}.get(str(values.dtype))
        if plain is None or values.ndim != 1:
            return pa.array(values)
        # pyarrow would ask pandas whether this is a series, and loading pandas takes a third of a second
        return pa.Array.from_buffers(plain, len(values), [None, pa.py_buffer(values.tobytes())])
    return pa.array(list(values), type=kind)


@functools.cache
def _names() -> tuple[str, ...]:
    return tuple(sorted([*(path.stem for path in shipped("schemas").glob("*.toml")), *of_systems()]))


@functools.cache
def _table(name: str) -> Table:
    """Read a table when it is first asked for: what a plan needs is a few of them."""
    if name in of_systems():
        return of_system(name)
    file = (shipped("schemas") if name in _names() else _folder(name)) / f"{name}.toml"
    spec = _read(file.name, tomllib.loads(file.read_text("utf-8")))
    if spec.name != name:
        raise SchemaError(f"schemas/{file.name}: declares the table {spec.name!r}; call the file as the table")
    return spec


def _folder(name: str) -> Path:
    """Return the folder of the package that brings a table; the package is not loaded for it."""
    entry = brought(GROUP)[name]
    try:
        found = find_spec(entry.value)
    except ImportError as error:
        raise PlugInError(f"table {name!r}: the package {entry.value} cannot be loaded: {error}") from None
    for place in (found.submodule_search_locations or ()) if found is not None else ():
        if (Path(place) / f"{name}.toml").is_file():
            return Path(place)
    raise PlugInError(f"table {name!r}: the package {entry.value} that should bring {name}.toml has no such file")


def _read(file: str, form: dict[str, Any]) -> Table:
    try:
        columns = tuple(Column(**column) for entry in form["columns"] for column in expand(entry))
        spec = Table(form["name"], form["description"], form["version"], columns, form.get("stored", True))
    except (KeyError, TypeError, SchemaError) as error:
        raise SchemaError(f"schemas/{file}: {error}; correct it, or install again what brings it") from None
    wrong = [column.dtype for column in columns if column.dtype not in DTYPES]
    if wrong or not columns or columns[0].name != "point_id":
        raise SchemaError(f"schemas/{file}: dtypes are {', '.join(DTYPES)}, and the first column is point_id")
    for column in columns:
        plain = {"string"} if column.values else {"float64", "int8", "int64"}
        if column.limited and column.dtype not in plain:
            raise SchemaError(
                f"schemas/{file}: {column.name} is {column.dtype}; values are for texts, limits for numbers"
            )
    return spec
