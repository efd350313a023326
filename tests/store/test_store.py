"""The store: atomic, deterministic, with provenance and units in the files."""

import json
import multiprocessing
import os
import signal
import subprocess
import sys
from importlib import metadata
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from vines import schema
from vines.errors import SchemaError, StoreError, UnknownNameError
from vines.store import (
    Ids,
    Store,
    TableFile,
    canonical,
    commit_part,
    describe_table,
    key_of,
    read_parquet,
    revision,
    versions,
    write_parquet,
)

P = [f"{i:020x}" for i in range(10)]
ROWS = [{"point_id": P[i], "A": 0.1 * i, "status": "ok"} for i in range(5)]


def commit(store, key, text="hello", **options):
    with store.staging() as place:
        folder = place / "result"
        folder.mkdir()
        (folder / "note.txt").write_text(text)
        about = {"kind": "toy", "tables": {}, "logs": []}
        return store.commit(key, folder, about, **options)


def test_keys_do_not_depend_on_the_order_of_names():
    assert key_of({"a": 1.0, "b": 2}) == key_of({"b": 2, "a": 1.0})
    assert key_of({"a": 0.1 + 0.2}) != key_of({"a": 0.3})
    assert canonical({"ä": True}) == '{"\\u00e4":true}'
    with pytest.raises(ValueError, match="JSON"):
        canonical({"a": float("nan")})


def test_nothing_is_made_by_reading(tmp_path):
    store = Store(tmp_path / "data")
    assert store.pins("any") == {}
    assert store.pinned() == {}
    assert not store.has("x")
    assert store.pool("x").parts() == []
    assert not store.data.exists()


def test_a_result_is_there_with_its_manifest_and_stays_as_it_is(tmp_path):
    store = Store(tmp_path)
    result = commit(store, "k" * 64)
    assert result.files["note.txt"].read_text() == "hello"
    assert result.manifest["files"]["note.txt"]["bytes"] == 5
    assert result.manifest["host"]
    assert result.damage() == []
    assert commit(store, "k" * 64, "other").files["note.txt"].read_text() == "hello"
    assert commit(store, "k" * 64, "other", replace=True).files["note.txt"].read_text() == "other"
    assert list(store.staging_folder.iterdir()) == []


def test_what_is_stored_is_on_the_disk_before_it_has_its_name(tmp_path, monkeypatch):
    store, synced = Store(tmp_path / "data"), []

    def fsync(descriptor):
        path = Path(f"/proc/self/fd/{descriptor}").readlink()
        synced.append(path.name)
        assert path.is_dir() or path.stat().st_size, "synced before it was written"

    monkeypatch.setattr(os, "fsync", fsync)
    commit(store, "ab")
    # its files, then its folder; the folder of results last, once its name stands there
    assert set(synced[:-2]) >= {"note.txt", "manifest.json"}
    assert synced[-2:] == ["result", "results"]
    synced.clear()
    store.pin("toys", "up", {"result": "ab"})
    assert synced[0].startswith(".toys.pins.json.")
    assert synced[-1] == "pipelines"


def test_damage_is_found(tmp_path):
    result = commit(Store(tmp_path), "k" * 64)
    (result.folder / "note.txt").write_text("hellO")
    assert result.damage() == ["note.txt is damaged: its checksum differs from that of what was written"]
    (result.folder / "note.txt").unlink()
    assert result.damage() == ["note.txt is missing"]


def test_what_is_not_there_is_said_in_one_line(tmp_path):
    store = Store(tmp_path)
    with pytest.raises(StoreError, match="no result kkkkkkkkkkkk"):
        store.result("k" * 64)
    result = commit(store, "k" * 64)
    with pytest.raises(UnknownNameError, match="no table 'points'"):
        result.table("points")
    (result.folder / "manifest.json").write_text("{")
    with pytest.raises(StoreError, match="the next run of its pipeline makes it again"):
        store.result("k" * 64)
    store.pin("one", "up", {"result": "k"})
    (store.pipelines / "one.pins.json").write_text("nonsense")
    with pytest.raises(StoreError, match=r"one\.pins\.json is damaged"):
        store.pins("one")


def test_pins_are_kept_by_pipeline_and_stage(tmp_path):
    store = Store(tmp_path)
    store.pin("one", "up", {"result": "a"})
    store.pin("one", "down", {"result": "b"})
    store.pin("two", "up", {"result": "c"})
    store.unpin("one", ["up"])
    assert store.pinned() == {"one": {"down": {"result": "b"}}, "two": {"up": {"result": "c"}}}


def test_parquet_has_units_and_provenance_and_the_same_bytes_each_time(tmp_path):
    about = {"key": "k", "kind": "toy"}
    for name in ("one", "two"):
        write_parquet(tmp_path / name, "points", ROWS, provenance=about, sorted_by=["A"])
    assert (tmp_path / "one").read_bytes() == (tmp_path / "two").read_bytes()
    read = pq.ParquetFile(tmp_path / "one")
    said = json.loads(read.schema_arrow.metadata[b"vines"])
    assert said["provenance"] == about
    assert said["units"]["phase"] == "rad"
    assert read.schema_arrow.field("phase").metadata[b"unit"] == b"rad"
    group = read.metadata.row_group(0)
    assert group.sorting_columns[0].column_index == schema.table("points").names.index("A")
    column = group.column(schema.table("points").names.index("A"))
    assert "BYTE_STREAM_SPLIT" in column.encodings
    assert column.compression == "ZSTD"


def test_lists_of_floats_are_stored_and_come_back(tmp_path):
    write_parquet(tmp_path / "o", "orbits", [{"point_id": "a", "t": [0.0, 1.5], "side": [1, -1]}], provenance={})
    assert pq.read_table(tmp_path / "o").to_pylist()[0]["t"] == [0.0, 1.5]


def test_rows_that_do_not_fit_are_refused(tmp_path):
    with pytest.raises(SchemaError, match="no column 'B'"):
        write_parquet(tmp_path / "x", "points", [{"point_id": "a", "B": 1}], provenance={})
    assert not (tmp_path / "x").exists()


def part(store, number, rows, failed=(), logs=None):
    with store.staging() as place:
        folder = place / "part"
        folder.mkdir()
        for name in (logs or {}).values():
            (folder / name).write_text(name)
        ids = [row["point_id"] for row in rows]
        tables = {"points": schema.cast("points", rows)}
        commit_part(store.pool("k").folder, folder, number, tables, ids=Ids.of(ids), failed=failed, logs=logs or {})


def located(store, *points):
    found = store.pool("k").locate(Ids.of(points))
    return list(zip(found.part.tolist(), found.row.tolist(), found.failed.tolist(), strict=True))


def test_a_pool_finds_points_in_all_parts(tmp_path):
    store = Store(tmp_path)
    assert located(store, P[0]) == [(-1, -1, False)]
    part(store, 1, ROWS[:2], logs={P[1]: "p1.txt"})
    part(store, 2, ROWS[2:])
    pool = store.pool("k")
    assert pool.next_number() == 3
    assert located(store, P[4], P[0], P[9]) == [(1, 2, False), (0, 0, False), (-1, -1, False)]
    assert pool.row("points", P[3])["A"] == ROWS[3]["A"]
    assert pool.parts()[0].logs == {P[1]: "p1.txt"}
    assert pool.parts()[0].versions == versions()
    with pytest.raises(StoreError, match="not in the pool"):
        pool.row("points", P[9])


def test_a_part_that_comes_meanwhile_does_not_shift_what_was_located(tmp_path):
    """A worker of a run that was killed may commit a part of a lower number between two looks."""
    store = Store(tmp_path)
    part(store, 2, ROWS[:2])
    pool = store.pool("k")
    found = pool.locate(Ids.of([P[1]]))
    part(store, 1, ROWS[2:])
    assert len(pool.parts()) == 2
    assert found.parts[found.part[0]].ids.hex()[found.row[0]] == P[1]


def test_a_part_stores_no_empty_columns_and_gives_them_back(tmp_path):
    store = Store(tmp_path)
    part(store, 1, ROWS)
    (found,) = store.pool("k").parts()
    assert pq.read_schema(found.folder / "points.parquet").names == ["point_id", "A", "status"]
    assert found.table("points").equals(schema.cast("points", ROWS))


def test_a_point_that_failed_counts_until_it_was_computed(tmp_path):
    store = Store(tmp_path)
    part(store, 1, [{"point_id": P[0], "status": "failed"}, ROWS[1]], failed=[P[0]])
    assert located(store, P[0], P[1]) == [(0, 0, True), (0, 1, False)]
    part(store, 2, ROWS[:1])
    assert located(store, P[0], P[1]) == [(1, 0, False), (0, 1, False)]
    part(store, 3, [{"point_id": P[0], "status": "failed"}], failed=[P[0]])
    assert located(store, P[0]) == [(1, 0, False)]


def test_ids_that_agree_in_eight_bytes_are_told_apart():
    ids = Ids.of(["00" * 8 + tail for tail in ("0001", "0002", "0003")])
    assert ids.locate(Ids.of(["00" * 8 + tail for tail in ("0002", "0004", "0001")])).tolist() == [1, -1, 0]
    assert Ids.of([]).locate(ids).tolist() == [-1, -1, -1]
    assert ids.arrow().to_pylist() == ids.hex()


def test_bytes_do_not_depend_on_how_rows_were_cut(tmp_path, monkeypatch):
    monkeypatch.setattr("vines.store._parquet.ROW_GROUP", 7)
    rows = [{"point_id": f"{i:020x}", "A": 0.1 * i, "name": "1:1" if i % 3 else None} for i in range(40)]
    for name, size in (("one", 40), ("two", 3), ("three", 11)):
        with TableFile(tmp_path / name, "points", provenance={}) as file:
            for i in range(0, 40, size):
                file.add(rows[i : i + size])
    assert (tmp_path / "one").read_bytes() == (tmp_path / "two").read_bytes() == (tmp_path / "three").read_bytes()
    assert pq.ParquetFile(tmp_path / "one").metadata.num_row_groups == 6


def test_a_part_that_comes_twice_is_kept_once(tmp_path):
    store = Store(tmp_path)
    part(store, 1, ROWS[:2])
    part(store, 1, ROWS[:2])
    assert len(store.pool("k").parts()) == 1


def test_a_writer_waits_for_another_and_clears_what_a_killed_one_left(tmp_path):
    code = "import sys, time; from pathlib import Path; from vines.store import Store; s = Store(Path(sys.argv[1]))\n"
    code += (
        "with s.writing(), s.staging() as f:\n    (f / 'half').write_text('x'); print('in', flush=True); time.sleep(60)"
    )
    other = subprocess.Popen([sys.executable, "-c", code, str(tmp_path)], stdout=subprocess.PIPE)
    assert other.stdout is not None
    other.stdout.readline()
    store = Store(tmp_path)
    waited = []

    def kill():
        waited.append(True)
        os.kill(other.pid, signal.SIGKILL)

    with store.writing(kill):
        assert not any(store.staging_folder.iterdir())
    other.communicate()
    assert waited == [True]
    assert not multiprocessing.active_children()


def test_provenance_names_versions_and_revision():
    assert set(versions()) == {"numba", "numpy", "python", "vines"}
    assert {name: versions()[name] for name in ("numba", "numpy")} == {
        n: metadata.version(n) for n in ("numba", "numpy")
    }
    assert revision() == "" or len(revision().rstrip("+")) == 40


def test_pins_and_manifests_need_no_heavy_package(tmp_path):
    commit(Store(tmp_path), "k" * 64)
    code = "import sys; from pathlib import Path; from vines.store import Store; s = Store(Path(sys.argv[1]))\n"
    code += "s.pinned(); s.result('k' * 64); print({'pyarrow', 'numpy', 'filelock'} & set(sys.modules))"
    out = subprocess.run([sys.executable, "-c", code, str(tmp_path)], capture_output=True, text=True, check=True)
    assert out.stdout.strip() == "set()"


def test_a_table_is_checked_on_writing_and_on_reading(tmp_path):
    path = tmp_path / "points.parquet"
    for column, value, words in (("regime", "lively", "periodic, quasi"), ("r", 1.5, ">= 0 and <= 1")):
        with pytest.raises(SchemaError, match=f"{value!r} in row 1 is not allowed: {words}"):
            write_parquet(path, "points", [{"point_id": "a"}, {"point_id": "b", column: value}], provenance={})
    rows = [{"point_id": "a", "regime": "chaotic", "r": 0.65, "lyapunov": float("nan"), "phase": 1.0}]
    write_parquet(path, "points", rows, provenance={})
    table = read_parquet(path, "points")
    about = json.loads(table.schema.metadata[b"vines"])
    degrees = table.schema.field("phase").with_metadata({"unit": "deg"})
    place = table.schema.names.index("phase")
    for changed, words in (
        (table.set_column(place, degrees, table.column("phase")), "column 'phase' is in 'deg', the schema says 'rad'"),
        (table.replace_schema_metadata(None), "the key 'vines' with units and provenance is missing"),
        (told(table, about | {"version": 0}), "it is version 0 of 'points', this vines has version"),
        (told(table, about | {"table": "orbits"}), "it is a table 'orbits', not 'points'"),
        (told(table, about | {"units": about["units"] | {"A": "m"}}), "the unit of 'A' is told as 'm'"),
        (table.append_column("mine", [[1]]), "column 'mine' is not one of 'points'"),
        (table.set_column(place, "phase", [["1"]]), "column 'phase' is string, the schema says double"),
    ):
        pq.write_table(changed, path)
        with pytest.raises(SchemaError) as caught:
            read_parquet(path, "points")
        assert words in str(caught.value)
        assert "\n" not in str(caught.value)
    path.write_bytes(b"no table")
    with pytest.raises(OSError, match=r"points\.parquet"):
        read_parquet(path, "points")


def told(table, about):
    return table.replace_schema_metadata({"vines": json.dumps(about)})


def test_form_of_the_files(tmp_path):
    path = tmp_path / "points.parquet"
    rows = {"point_id": [f"{i:06d}" for i in range(130_000)], "A": np.linspace(0, 1, 130_000)}
    write_parquet(path, "points", pa.table(rows), provenance={"key": "k"}, sorted_by=["A"])
    meta = pq.read_metadata(path)
    assert [meta.row_group(i).num_rows for i in range(meta.num_row_groups)] == [122_880, 7_120]
    column = meta.row_group(0).column(meta.schema.to_arrow_schema().names.index("A"))
    assert (column.compression, "BYTE_STREAM_SPLIT" in column.encodings) == ("ZSTD", True)
    assert meta.row_group(0).sorting_columns[0].column_index == meta.schema.to_arrow_schema().names.index("A")
    assert pq.read_schema(path).field("A").metadata[b"unit"] == b"1"
    about = json.loads(pq.read_schema(path).metadata[b"vines"])
    assert (about["units"]["A"], about["provenance"]) == ("1", {"key": "k"})
    assert describe_table("points", 3)["units"]["phase"] == "rad"
