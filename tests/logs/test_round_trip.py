"""What is written is what is read, by vines and by mcap's own reader."""

import functools
import hashlib
import io

import numpy as np
import pytest
from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from mcap.reader import make_reader
from mcap.records import Attachment, Channel, DataEnd, Footer, Header, Message, Metadata, Schema, Statistics
from mcap.stream_reader import StreamReader
from mcap.writer import CompressionType, Writer

from vines import logs, schema
from vines.errors import FileMissingError, SchemaError


def same(table, rows):
    assert table.column_names == list(rows.dtype.names)
    for name in rows.dtype.names:
        np.testing.assert_array_equal(table[name].to_numpy(), rows[name])


def test_round_trip(run, log_file):
    log = logs.read(log_file)
    same(log.states, run["states"])
    same(log.impacts, run["impacts"])
    same(log.sticks, run["sticks"])
    assert log.parameters == run["parameters"]
    assert log.provenance == {
        "key": "0f",
        "stage": "quickstart.run",
        "versions": '{"numba": "0.6", "numpy": "2"}',
    }
    assert (log.name, log.declaration, log.status, log.complete) == (
        *("made up", run["declaration"], "complete"),
        True,
    )


def test_columns_carry_their_units(log_file):
    column = logs.read(log_file).states.schema.field("w_dot")
    assert column.metadata[b"unit"] == b"b omega0"
    assert column.metadata[b"description"].startswith(b"Rate of the gap")


def test_empty_run_round_trips(run, tmp_path):
    nothing = {key: run[key][:0] for key in ("states", "impacts", "sticks")}
    log = logs.read(logs.write_run(tmp_path / "empty.mcap", **{**run, **nothing, "declaration": None}))
    assert log.states.num_rows == log.impacts.num_rows == log.sticks.num_rows == 0
    assert log.declaration is None


finite = st.floats(allow_nan=True, allow_infinity=True, width=64)


@st.composite
def rows(draw, name, time):
    dtype = schema.numpy_dtype(name)
    count = draw(st.integers(0, 6))
    made = np.zeros(count, dtype)
    for field in dtype.names:
        if field == time:
            made[field] = np.sort(draw(hnp.arrays(float, count, elements=st.floats(0.0, 9e9))))
        elif dtype[field].kind == "f":
            made[field] = draw(hnp.arrays(float, count, elements=finite))
        else:
            made[field] = draw(hnp.arrays(dtype[field], count))
    return made


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    states=rows("vines.v1.State", "t"),
    impacts=rows("vines.v1.Impact", "t"),
    sticks=rows("vines.v1.Stick", "t_start"),
    provenance=st.dictionaries(st.text(max_size=8), st.text(max_size=20), max_size=3),
    parameters=st.dictionaries(st.text(max_size=8), st.floats(allow_nan=False), max_size=3),
    name=st.text(max_size=12),
    declaration=st.none() | st.text(max_size=30),
)
def test_any_run_round_trips(tmp_path, states, impacts, sticks, provenance, parameters, name, declaration):
    log = logs.read(
        logs.write_run(
            tmp_path / "any.mcap",
            states=states,
            impacts=impacts,
            sticks=sticks,
            provenance=provenance,
            parameters=parameters,
            name=name,
            declaration=declaration,
        )
    )
    same(log.states, states)
    same(log.impacts, impacts)
    same(log.sticks, sticks)
    assert (log.provenance, log.parameters, log.name, log.declaration) == (
        *(provenance, parameters, name),
        declaration,
    )


def test_infinite_velocities_round_trip_without_a_warning(run, tmp_path):
    impacts = run["impacts"].copy()
    impacts["v1_after"][0] = impacts["v2_after"][0] = np.inf
    same(logs.read(logs.write_run(tmp_path / "infinite.mcap", **{**run, "impacts": impacts})).impacts, impacts)


def test_bytes_are_the_same_again_and_for_any_order_of_keys(run, log_file, tmp_path):
    turned = {key: dict(reversed(run[key].items())) for key in ("provenance", "parameters")}
    again = logs.write_run(tmp_path / "again.mcap", **{**run, **turned})
    assert again.read_bytes() == log_file.read_bytes()


def test_order_of_records(log_file):
    """Provenance is the first record after the header, the status the last before the end of the data."""
    records = list(StreamReader(io.BytesIO(log_file.read_bytes()), validate_crcs=True).records)
    end = next(place for place, record in enumerate(records) if isinstance(record, DataEnd))
    kinds = [type(record) for record in records[:end]]
    assert kinds[:4] == [Header, Metadata, Metadata, Metadata]
    assert records[1].name == "vines.provenance"
    assert kinds[4:11] == [Attachment, Schema, Channel, Schema, Channel, Schema, Channel]
    assert records[end - 1].name == "vines.status"
    status = dict(records[end - 1].metadata)
    place = log_file.read_bytes().index(b"vines.status") - 13
    assert status.pop("sha256") == hashlib.sha256(log_file.read_bytes()[:place]).hexdigest()
    assert status == {"status": "complete", "/state": "3000", "/impact": "40", "/stick": "3"}
    assert isinstance(records[-1], Footer)
    assert records[end].data_section_crc != 0
    assert records[-1].summary_crc != 0


@functools.cache
def decoder(name, descriptors):
    """Return a protobuf class made from nothing but what the file itself says."""
    pool = descriptor_pool.DescriptorPool()
    for file in descriptor_pb2.FileDescriptorSet.FromString(descriptors).file:
        pool.Add(file)
    return message_factory.GetMessageClass(pool.FindMessageTypeByName(name))


def test_mcap_reads_every_message_through_protobuf(run, log_file):
    seen = {"/state": [], "/impact": [], "/stick": []}
    with log_file.open("rb") as stream:
        for kind, channel, message in make_reader(stream, validate_crcs=True).iter_messages():
            assert (kind.encoding, channel.message_encoding) == ("protobuf", "protobuf")
            seen[channel.topic].append((message, decoder(kind.name, kind.data).FromString(message.data)))
    for topic, key, time in (
        ("/state", "states", "t"),
        ("/impact", "impacts", "t"),
        ("/stick", "sticks", "t_start"),
    ):
        assert len(seen[topic]) == len(run[key])
        for number, ((message, decoded), row) in enumerate(zip(seen[topic], run[key], strict=True)):
            assert message.sequence == number
            assert message.log_time == message.publish_time == round(float(row[time]) * 1e9)
            np.testing.assert_array_equal([getattr(decoded, name) for name in row.dtype.names], list(row.tolist()))


def test_index_and_statistics_fit_what_is_there(log_file):
    data = log_file.read_bytes()
    chunks = list(StreamReader(io.BytesIO(data), emit_chunks=True).records)
    sizes = [record.uncompressed_size for record in chunks if type(record).__name__ == "Chunk"]
    assert len(sizes) == 3
    assert all(64 * 1024 < size <= 256 * 1024 for size in sizes[:-1])
    statistics = next(record for record in chunks if isinstance(record, Statistics))
    assert statistics.channel_message_counts == {1: 3000, 2: 40, 3: 3}
    assert statistics.message_count == sum(
        isinstance(record, Message) for record in StreamReader(io.BytesIO(data)).records
    )
    summary = make_reader(io.BytesIO(data)).get_summary()
    assert summary is not None
    assert [index.message_end_time for index in summary.chunk_indexes][-1] == statistics.message_end_time
    times = [message.log_time for _, _, message in make_reader(io.BytesIO(data)).iter_messages()]
    assert len(times) == statistics.message_count
    assert times == sorted(times)
    assert (times[0], times[-1]) == (statistics.message_start_time, statistics.message_end_time)


@pytest.mark.parametrize("compression", list(CompressionType))
def test_same_messages_from_another_writer_are_read(run, tmp_path, compression):
    """Another writer leaves zeros out and mixes the channels: protobuf decodes what numpy cannot."""
    path = tmp_path / "other.mcap"
    run = {**run, "states": run["states"][:50].copy()}
    run["states"]["stuck"][::2] = 0
    with path.open("wb") as stream:
        writer = Writer(stream, compression=compression, enable_data_crcs=True)
        writer.start()
        writer.add_metadata("vines.provenance", {"by": "another"})
        for number, (name, key) in enumerate((("State", "states"), ("Impact", "impacts"), ("Stick", "sticks"))):
            data = schema.schema_bytes(f"vines.v1.{name}")
            writer.register_channel(f"/{key}", "protobuf", writer.register_schema(f"vines.v1.{name}", "protobuf", data))
            kind = schema.message_class(f"vines.v1.{name}")
            for row in run[key]:
                message = kind(**{field: row[field].item() for field in row.dtype.names})
                writer.add_message(number + 1, 0, message.SerializeToString(), 0)
        writer.add_metadata("vines.status", {"status": "complete"})
        writer.finish()
    log = logs.read(path)
    same(log.states, run["states"])
    same(log.impacts, run["impacts"])
    same(log.sticks, run["sticks"])
    assert log.name == "other"


def test_a_failure_leaves_nothing_and_keeps_what_was(run, log_file, monkeypatch):
    before = log_file.read_bytes()
    monkeypatch.setattr("vines.logs._file.LogFile.finish", lambda self: (_ for _ in ()).throw(OSError("disk full")))
    with pytest.raises(OSError, match="disk full"):
        logs.write_run(log_file, **run)
    assert log_file.read_bytes() == before
    assert [path.name for path in log_file.parent.iterdir()] == [log_file.name]


def test_further_fields_are_left_out(run, tmp_path):
    from numpy.lib import recfunctions

    more = recfunctions.append_fields(run["impacts"], "extra", np.arange(40), usemask=False)
    same(logs.read(logs.write_run(tmp_path / "more.mcap", **{**run, "impacts": more})).impacts, run["impacts"])


def change(rows, field, value, place=0):
    rows = rows.copy()
    rows[field][place] = value
    return rows


@pytest.mark.parametrize(
    ("key", "spoil", "message"),
    [
        ("states", lambda rows: rows[["t", "x1"]], r"states lack v1, x2.*vines\.v1\.State needs"),
        ("states", lambda rows: rows["t"], "states lack t, x1"),
        ("states", lambda rows: rows.reshape(2, -1), r"shape \(2, 1500\)"),
        ("states", lambda rows: change(rows, "t", -1.0), "from -1.0 to"),
        ("states", lambda rows: change(rows, "t", np.nan, -1), "to nan"),
        ("impacts", lambda rows: change(rows, "t", 50.0, 3), "impacts are not sorted by time: row 4"),
        (
            "impacts",
            lambda rows: rows.astype([(n, "f8" if n == "side" else rows.dtype[n]) for n in rows.dtype.names]),
            "'side' of impacts has type float64; int32 is needed",
        ),
        (
            "impacts",
            lambda rows: change(
                rows.astype([(n, "i8" if n == "side" else rows.dtype[n]) for n in rows.dtype.names]),
                "side",
                2**40,
            ),
            "'side' of impacts holds numbers that do not fit int32",
        ),
    ],
)
def test_arrays_that_do_not_fit_are_refused(run, tmp_path, key, spoil, message):
    with pytest.raises(SchemaError, match=message):
        logs.write_run(tmp_path / "bad.mcap", **{**run, key: spoil(run[key])})
    assert list(tmp_path.iterdir()) == []


def test_provenance_that_is_no_text_is_refused(run, tmp_path):
    with pytest.raises(SchemaError, match="provenance 'x' cannot be stored"):
        logs.write_run(tmp_path / "bad.mcap", **{**run, "provenance": {"x": object()}})


def test_missing_folder_and_missing_file(run, tmp_path):
    with pytest.raises(FileMissingError, match="does not exist; create it first"):
        logs.write_run(tmp_path / "no" / "run.mcap", **run)
    with pytest.raises(FileMissingError, match="there is no log"):
        logs.read(tmp_path / "no.mcap")
