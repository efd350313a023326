"""Tables of ``schemas/``: what they declare, and the casting of data to them."""

import subprocess
import sys
import tomllib

import numpy as np
import pyarrow as pa
import pytest

from vines import schema
from vines.errors import SchemaError, UnknownNameError
from vines.model import VI_NES
from vines.schema._declared import expand


@pytest.mark.parametrize("name", list(schema.tables()))
def test_every_table_begins_with_point_id_and_describes_each_column_once(name):
    spec = schema.table(name)
    assert spec.columns[0].name == "point_id"
    assert len({column.lower() for column in spec.names}) == len(spec.names)  # SQL does not tell M from m
    assert all(column.description and column.source for column in spec.columns)
    assert all(column.unit for column in spec.columns if "float" in column.dtype)
    assert schema.arrow_schema(name).names == list(spec.names)


def test_units_are_field_metadata():
    metadata = schema.arrow_schema("points").field("phase").metadata
    assert metadata[b"unit"] == b"rad"
    assert metadata[b"source"].startswith(b"paper")


def test_cast_orders_fills_and_converts():
    made = schema.cast("impacts", [{"side": 1, "point_id": "a", "t": 2}, {"point_id": "b", "t": np.float64(3.5)}])
    assert made.schema.equals(schema.arrow_schema("impacts"), check_metadata=True)
    assert made.column("t").to_pylist() == [2.0, 3.5]
    assert made.column("side").to_pylist() == [1, None]


def test_cast_takes_columns_and_arrow_tables_alike():
    columns = {"point_id": ["a", "b"], "x1": np.array([0.1, 0.2]), "side": np.array([1, -1], dtype=np.int64)}
    assert schema.cast("impacts", columns).equals(schema.cast("impacts", pa.table(columns)))


def test_cast_keeps_lists_of_floats():
    made = schema.cast("orbits", [{"point_id": "a", "t": np.array([0.0, 1.5]), "side": [1, -1], "stable": True}])
    assert made.column("t").to_pylist() == [[0.0, 1.5]]
    assert made.column("stable").to_pylist() == [True]


@pytest.mark.parametrize(
    ("data", "words"),
    [
        ([{"point_id": "a", "sied": 1}], "did you mean 'side'"),
        ([{"point_id": "a", "t": "soon"}], "column 't'"),
        ([{"point_id": "a", "side": 300}], "column 'side'"),
        ([{"t": 1.0}], "point_id"),
        ({"point_id": ["a", "b"], "t": [1.0]}, "1 values where 2"),
    ],
)
def test_what_does_not_fit_is_said_in_one_line(data, words):
    with pytest.raises(SchemaError) as caught:
        schema.cast("impacts", data)
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


def test_an_unknown_table_names_the_nearest():
    with pytest.raises(UnknownNameError, match="did you mean 'orbits'"):
        schema.table("orbit")


def test_the_digest_tells_tables_apart():
    digests = {schema.digest(name) for name in schema.tables()}
    assert len(digests) == len(schema.tables())


def test_tables_load_no_arrow():
    code = "import sys; from vines import schema; schema.digest('points'); print('pyarrow' in sys.modules)"
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert out.stdout.strip() == "False"


def test_parameters_and_states_are_those_of_the_system():
    spec = {column.name: column for column in schema.table("points").columns}
    for parameter in VI_NES.parameters:
        column = spec[parameter.name]
        assert (column.description, column.source, column.minimum) == (
            parameter.text,
            parameter.source,
            parameter.allowed.least,
        )
    assert [name for name in spec if name.startswith("end_")] == [f"end_{each.name}" for each in VI_NES.start]
    assert schema.table("orbits").columns[list(schema.table("orbits").names).index("x1")].dtype == "list<float64>"


@pytest.mark.parametrize(
    ("entry", "words"),
    [({"of": "parameter"}, "did you mean 'parameters'"), ({"of": "state", "unit": "m"}, "unknown key 'unit'")],
)
def test_an_unknown_group_is_refused_in_one_line(entry, words):
    with pytest.raises(SchemaError, match=words):
        expand(entry)


@pytest.mark.parametrize("name", list(schema.tables()))
def test_a_written_out_file_declares_the_same_table(name):
    spec = schema.table(name)
    form = tomllib.loads(schema.toml(name))
    columns = [schema.Column(**column | {"values": tuple(column.get("values", ()))}) for column in form["columns"]]
    assert schema.Table(**form | {"columns": tuple(columns)}) == spec
