"""Tables: their columns as ``schemas/*.toml`` declares them, and the casting of data to them."""

from __future__ import annotations

import functools
import hashlib
import json
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vines.doors import brought
from vines.errors import PlugInError, SchemaError, UnknownNameError, nearest
from vines.model import VI_NES, most_balls, read_system, system_names
from vines.places import shipped
from vines.schema._declared import expand

if TYPE_CHECKING:
    import pyarrow as pa

__all__ = ["OF_EACH_SYSTEM", "Column", "Table", "arrow_schema", "cast", "digest", "system_table", "table", "tables"]

GROUP = "vines.tables"
"""Entry points of packages that bring tables: the name is that of the table, the value a package with its file."""
OF_EACH_SYSTEM = ("bifurcations", "branches", "impacts", "orbits", "points")
"""Tables that every system has: the VI-NES under these names, another one with its name before them."""
DTYPES = ("bool", "float64", "int8", "int64", "list<float64>", "list<int8>", "string")


@dataclass(frozen=True, slots=True)
class Column:
    """One column of a table.

    Attributes
    ----------
    name : str
        Name, as SQL sees it.
    dtype : str
        One of bool, float64, int8, int64, string, list<float64>, list<int8>.
    unit : str
        ``"1"`` for a dimensionless number, ``"rad"``, ``"T"`` (forcing periods), ``"1/T"``, ``"B"``; empty
        for what is not a number of something.
    description : str
        What it holds, in one line.
    source : str
        Equation or section of the paper, or the page of docs/ that defines it.
    values : tuple of str
        The only texts that are allowed; empty if any is.
    minimum, maximum : float or None
        Least and largest number allowed. Empty values and nan always are.
    """

    name: str
    dtype: str
    unit: str
    description: str
    source: str
    values: tuple[str, ...] = ()
    minimum: float | None = None
    maximum: float | None = None

    @property
    def limited(self) -> bool:
        """Whether not every value of the type is allowed."""
        return bool(self.values) or self.minimum is not None or self.maximum is not None

    @property
    def allowed(self) -> str:
        """What is allowed, in words; empty if everything is.

        Examples
        --------
        >>> table("points").columns[1].allowed
        '>= 0'
        """
        if self.values:
            return ", ".join(self.values)
        least = "" if self.minimum is None else f">= {self.minimum:g}"
        most = "" if self.maximum is None else f"<= {self.maximum:g}"
        return " and ".join(filter(None, (least, most)))


@dataclass(frozen=True, slots=True)
class Table:
    """A table of ``schemas/``.

    Attributes
    ----------
    name, description : str
        Its name and what a row is.
    version : int
        Raised when the meaning of a column changes.
    columns : tuple of Column
        ``point_id`` first.
    stored : bool
        False for what is made from manifests when asked, such as ``logs``.
    system : str
        The system that its rows are of.
    """

    name: str
    description: str
    version: int
    columns: tuple[Column, ...]
    stored: bool
    system: str = VI_NES.name

    @property
    def like(self) -> str:
        """What the table is called for the VI-NES.

        Examples
        --------
        >>> table("impact_pair_points").like, table("points").like
        ('points', 'points')
        """
        return self.name if self.system == VI_NES.name else self.name.removeprefix(f"{self.system}_")

    @property
    def walls(self) -> dict[str, str]:
        """What the letters of words and the signs of sides mean; empty where there are none.

        Examples
        --------
        >>> table("impact_pair_impacts").walls["L"]
        'lower end of the capsule, side +1'
        """
        if not {"word", "side"} & set(self.names):
            return {}
        contacts = read_system(self.system, most_balls(self.system)).contacts
        return {each.letter: f"{each.text}, side {each.sign:+d}" for each in contacts}

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the columns, in order."""
        return tuple(column.name for column in self.columns)


def tables() -> dict[str, Table]:
    """Return all tables by name: those of ``schemas/``, and those that installed packages bring.

    Examples
    --------
    >>> [name for name in tables() if "bif" in name]
    ['bifurcations', 'impact_pair_bifurcations', 'parallel_bifurcations']
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
    return tuple(sorted([*(path.stem for path in shipped("schemas").glob("*.toml")), *_of_systems()]))


@functools.cache
def _of_systems() -> dict[str, tuple[str, str]]:
    """Return the tables that each system beside the VI-NES has of its own, with the table each is like."""
    others = [name for name in system_names() if name != VI_NES.name]
    return {f"{system}_{base}": (system, base) for system in others for base in OF_EACH_SYSTEM}


def system_table(system: str, base: str) -> str:
    """Return what a table of :data:`OF_EACH_SYSTEM` is called for a system.

    Examples
    --------
    >>> system_table("vi_nes", "points"), system_table("impact_pair", "points")
    ('points', 'impact_pair_points')
    """
    return base if system == VI_NES.name else f"{system}_{base}"


def _of_system(name: str) -> Table:
    """Return a table like one of the VI-NES: with the names of the system, and what every other system has beside."""
    called, base = _of_systems()[name]
    system = read_system(called, most_balls(called))
    folder = shipped("schemas")
    form = tomllib.loads((folder / f"{base}.toml").read_text("utf-8"))
    more = folder / "systems" / "columns" / f"{base}.toml"
    entries = [*form["columns"], *(tomllib.loads(more.read_text("utf-8"))["columns"] if more.exists() else ())]
    # a coordinate may be called as a column that the common table has anyhow
    expanded = [each for entry in entries for own in _of_balls(entry, system.balls) for each in expand(own, system)]
    columns = {each["name"]: each for each in reversed(expanded)}
    kept = [each for each in reversed(columns.values()) if each["name"] not in system.without]
    about = f"Of the system {called}: {form['description'][:1].lower()}{form['description'][1:]}"
    return Table(name, about, form["version"], tuple(Column(**each) for each in kept), True, called)


def _of_balls(entry: dict[str, Any], balls: int) -> list[dict[str, Any]]:
    """Return an entry, or one a ball where it is said to be there for each."""
    if "each" not in entry:
        return [entry]
    rest = {key: value for key, value in entry.items() if key != "each"}
    return [
        rest | {"name": f"{rest['name']}_{ball}", "description": f"{rest['description']}, ball {ball}"}
        for ball in range(1, balls + 1)
    ]


@functools.cache
def _table(name: str) -> Table:
    """Read a table when it is first asked for: what a plan needs is a few of them."""
    if name in _of_systems():
        return _of_system(name)
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
    except ImportError:
        found = None
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
