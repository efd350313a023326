"""The catalogue: views over what is pinned, answers and messages."""

import csv
import io
import json
import math

import pyarrow.parquet as pq
import pytest

from vines import schema
from vines.catalogue import connect, connect_tables
from vines.errors import DamageWarning, QueryError, SchemaError, UnknownNameError
from vines.store import Store, describe_file, write_parquet

VERSION = schema.table("points").version


@pytest.fixture
def store(tmp_path):
    """Give a store with two pipelines pinned, in a folder whose name needs quoting."""
    made = Store(tmp_path / "it's data")
    for key, pipeline, stage, shift in (("a" * 64, "first", "up", 0.0), ("b" * 64, "second", "symmetric", 1.0)):
        with made.staging() as place:
            folder = place / "result"
            (folder / "logs").mkdir(parents=True)
            (folder / "logs" / "p0.mcap").write_bytes(b"log")
            points = [{"point_id": f"p{i}", "A": i + shift, "status": "ok", "name": "1:1"} for i in range(3)]
            impacts = [{"point_id": "p0", "t": 0.5, "index": 0}]
            tables = {}
            for name, rows in (("points", points), ("impacts", impacts)):
                write_parquet(folder / f"{name}.parquet", name, rows, provenance={"key": key})
                tables[name] = {"rows": len(rows), "columns": list(schema.table(name).names)}
            log = {"point_id": "p0", "file": "logs/p0.mcap", "params": {"A": shift}, "name": "1:1"}
            manifest = {"kind": "toy", "ingredients": {}, "provenance": {"key": key}, "tables": tables, "logs": [log]}
            made.commit(key, folder, manifest)
        made.pin(pipeline, stage, {"result": key})
    return made


def test_views_span_all_pipelines_and_name_each_stage(store):
    with connect(store) as catalogue:
        columns, rows = catalogue.fetch("select * from points order by pipeline, A")
        assert columns[:4] == ["pipeline", "stage", "point_id", "mu"]
        assert [row[:3] for row in rows[2:4]] == [("first", "up", "p2"), ("second", "symmetric", "p0")]
        assert catalogue.fetch('select count(*) from "first.up"')[1] == [(3,)]
        assert catalogue.fetch("select max(A) from second.symmetric")[1] == [(3.0,)]
        assert catalogue.fetch('select "index" from "first.up.impacts"')[1] == [(0,)]


def test_every_table_has_a_view_with_its_columns_even_if_empty(tmp_path):
    with connect(Store(tmp_path / "none")) as catalogue:
        for name, spec in schema.tables().items():
            table = catalogue.table(name)
            assert table.column_names == ["pipeline", "stage", *spec.names]
            assert table.num_rows == 0
    assert not (tmp_path / "none").exists()


def test_logs_come_from_the_manifests(store):
    with connect(store) as catalogue:
        rows = catalogue.query("select log_id, path, A, name, bytes from logs order by A").to_pylist()
    assert rows[0]["log_id"] == "aaaaaaaaaaaa/p0"
    assert rows[1]["path"] == str(store.results / ("b" * 64) / "logs" / "p0.mcap")
    assert (rows[1]["A"], rows[1]["name"], rows[1]["bytes"]) == (1.0, "1:1", 3)


def test_columns_that_an_older_result_lacks_are_null(store, monkeypatch):
    path = store.results / ("a" * 64) / "manifest.json"
    manifest = json.loads(path.read_text())
    del manifest["check"]  # as versions before it wrote
    manifest["tables"]["points"]["columns"].remove("name")
    path.write_text(json.dumps(manifest))
    with connect(store) as catalogue:
        assert catalogue.fetch("select distinct name from first.up")[1] == [(None,)]


@pytest.mark.parametrize(
    ("sql", "words"),
    [
        ("select * from pionts", "did you mean 'points'"),
        ("select kinetic_rati from points", "kinetic_ratio"),
        ("selec * from points", "syntax error"),
        ("select 1/'x'", "Could not convert"),
        ("", "is not one query"),
    ],
)
def test_a_bad_query_is_one_line(store, sql, words):
    with connect(store) as catalogue, pytest.raises(QueryError) as caught:
        catalogue.query(sql)
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


def test_an_unknown_table_names_the_nearest(store):
    with connect(store) as catalogue, pytest.raises(UnknownNameError, match=r"did you mean 'first\.up'"):
        catalogue.table("first.upp")


def test_tables_in_memory_answer_like_the_catalogue():
    up = schema.cast("points", [{"point_id": "a", "A": 0.1, "name": "1:1"}])
    down = schema.cast("points", [{"point_id": "a", "A": 0.2, "name": "2:1"}])
    with connect_tables({"points": {"up": up, "down": down}}) as query:
        assert query("select name from points where stage = 'down' and A = 0.2") == [("2:1",)]
        assert query("select * from orbits") == []
        with pytest.raises(QueryError, match="did you mean 'points'"):
            query("select * from point")


def seal(path):
    """Put what a file is now into the manifest of its result, as an earlier version would have written it."""
    manifest = json.loads((path.parent / "manifest.json").read_text())
    manifest.pop("check", None)
    manifest["files"][path.name] = describe_file(path)
    (path.parent / "manifest.json").write_text(json.dumps(manifest))


@pytest.mark.parametrize(
    "sql", ["select count(*) from points", "select count(*) from POINTS where pipeline = 'second'"]
)
def test_what_is_damaged_is_named_and_the_rest_answers(store, sql):
    path = store.results / ("a" * 64) / "points.parquet"
    whole = path.read_bytes()
    flipped = bytes([*whole[:200], whole[200] ^ 4, *whole[201:]])
    for damaged in (whole[:-100], b"", flipped):
        path.write_bytes(damaged)
        with (
            connect(store) as catalogue,
            pytest.warns(DamageWarning, match=r"points\.parquet is damaged: .* 'vines run first' me"),
        ):
            assert catalogue.fetch(sql)[1] == [(3,)]
        with connect(store) as catalogue:
            assert catalogue.fetch("select count(*) from second.symmetric")[1] == [(3,)]
            assert catalogue.fetch('select count(*) from "first.up.impacts"')[1] == [(1,)]
            with pytest.raises(
                QueryError, match=r"points\.parquet is damaged: .* 'vines run first' mends it"
            ) as caught:
                catalogue.fetch("select * from first.up")
            assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", ["pipelines/first.pins.json", f"results/{'a' * 64}/manifest.json"])
def test_damaged_pins_or_a_manifest_stop_no_other_query(store, name):
    path = store.data / name
    path.write_bytes(path.read_bytes()[:-20])
    with connect(store) as catalogue, pytest.warns(DamageWarning, match=path.name):
        assert catalogue.fetch("select distinct pipeline from points")[1] == [("second",)]
    with connect(store) as catalogue, pytest.raises(QueryError, match=path.name):
        catalogue.fetch('select * from "first.up"')


def test_a_file_of_another_version_or_unit_is_one_clear_line(store):
    path = store.results / ("a" * 64) / "points.parquet"
    table = pq.read_table(path)
    about = json.loads(table.schema.metadata[b"vines"])
    for change, words in (
        ({"version": 7}, f"it is version 7 of 'points', this vines has version {VERSION}"),
        ({"units": {**about["units"], "A": "m"}}, "the unit of 'A' is told as 'm', the schema says '1'"),
    ):
        pq.write_table(table.replace_schema_metadata({"vines": json.dumps(about | change)}), path)
        seal(path)
        for sql in (
            "select * from points",
            "select * from first.up",
            "select * from second.symmetric join points p on 1",
        ):
            with connect(store) as catalogue, pytest.raises(SchemaError) as caught:
                catalogue.query(sql)
            assert words in str(caught.value)
            assert "until 'vines run first' made it again" in str(caught.value)
            assert "\n" not in str(caught.value)
        with connect(store) as catalogue:  # what does not read the file still answers
            assert catalogue.fetch("select count(*) from second.symmetric")[1] == [(3,)]


def test_the_views_are_listed_where_a_query_asks_for_them(store):
    with connect(store) as catalogue:
        names = {row[0] for row in catalogue.fetch("select table_name from information_schema.tables")[1]}
        assert set(catalogue.names) <= names
        assert catalogue.fetch("select count(*) from POINTS")[1] == [(6,)]


AWKWARD = """select * from (values (1, 'a,"b"' || chr(10) || 'é', [1.5, null], true, 1e300, null),
    (2, '', []::double[], false, 'nan'::double, '-inf'::double)) t(i, words, list, yes, x, y)"""


def test_awkward_values_survive_every_form(store, tmp_path):
    with connect(store) as catalogue:
        catalogue.save(AWKWARD, tmp_path / "a.csv", "csv")
        catalogue.save(AWKWARD, tmp_path / "a.parquet", "parquet")
        catalogue.save("select A from points where false", tmp_path / "empty.csv", "csv")
        catalogue.save("select A from points where false", tmp_path / "empty.parquet", "parquet")
    rows = list(csv.DictReader(io.StringIO((tmp_path / "a.csv").read_text("utf-8"), newline="")))
    assert [row["words"] for row in rows] == ['a,"b"\né', ""]
    assert [row["list"] for row in rows] == ["[1.5, NULL]", "[]"]
    kept = pq.read_table(tmp_path / "a.parquet").to_pylist()
    assert kept[0]["list"] == [1.5, None]
    assert math.isnan(kept[1]["x"])
    assert kept[1]["y"] == -math.inf
    assert (tmp_path / "empty.csv").read_text().strip() == "A"
    assert pq.read_table(tmp_path / "empty.parquet").schema.field("A").metadata == {b"unit": b"1"}


def test_polars_and_pandas_read_the_files_as_they_are(store):
    import pandas as pd
    import polars as pl

    path = store.results / ("a" * 64) / "points.parquet"
    assert pl.scan_parquet(path).filter(pl.col("A") > 0.5).collect()["point_id"].to_list() == ["p1", "p2"]
    assert pd.read_parquet(path)["A"].tolist() == [0.0, 1.0, 2.0]
    with connect(store) as catalogue:
        assert catalogue.table("points").to_pandas()["A"].max() == 3.0
        assert pl.from_arrow(catalogue.table("points")).height == 6


@pytest.mark.parametrize(
    ("sql", "words"),
    [
        ("explain analyze copy (select 1) to 'FILE'", "the catalogue is read only"),
        ("EXPLAIN\n ANALYZE copy points to 'FILE'", "the catalogue is read only"),
        ("explain create table t as select 1", "the catalogue is read only"),
        ("copy (select 1) to 'FILE'", "the catalogue is read only"),
        ("attach 'FILE'", "the catalogue is read only"),
        ("set enable_external_access = true", "the catalogue is read only"),
        ("select * from read_csv('/etc/passwd')", "a query reads the results of the study and nothing else"),
        ("select * from '/etc/passwd'", "'/etc/passwd'"),
        ("select * from read_text('/etc/hostname')", "a query reads the results of the study and nothing else"),
        ("select * from glob('/etc/*')", "a query reads the results of the study and nothing else"),
        ("select * from read_text('RESULTS/../pipelines/first.pins.json')", "reads the results of the study and noth"),
    ],
)
def test_a_query_writes_no_file_and_reads_none_but_the_results(store, tmp_path, sql, words):
    file = tmp_path / "written"
    asked = sql.replace("FILE", str(file).replace("'", "''")).replace("RESULTS", str(store.results).replace("'", "''"))
    for answer in ("query", "fetch"):
        with connect(store) as catalogue, pytest.raises(QueryError) as caught:
            getattr(catalogue, answer)(asked)
        assert words in str(caught.value)
        assert "\n" not in str(caught.value)
    assert not file.exists()


def test_a_query_is_explained_and_a_comment_is_no_statement(store):
    with connect(store) as catalogue:
        assert catalogue.fetch("explain analyze select A from points")[1]
        assert catalogue.fetch("-- how many\nselect count(*) from points")[1] == [(6,)]
        assert catalogue.fetch("/* how many */ select count(*) from points")[1] == [(6,)]
