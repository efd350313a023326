"""The catalogue: views over what is pinned, answers and messages."""

import pytest

from vines import schema
from vines.catalogue import connect, connect_tables
from vines.errors import QueryError, UnknownNameError
from vines.store import Store, write_parquet


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
    made.pin("second", "lost", {"result": "c" * 64})
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
    import json

    path = store.results / ("a" * 64) / "manifest.json"
    manifest = json.loads(path.read_text())
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
