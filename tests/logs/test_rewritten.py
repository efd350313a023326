"""Another program rewrites a log: its content is read, or refused; never a wrong channel, never a traceback."""

import io
import random
import struct
from collections import Counter
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.reader import make_reader
from mcap.records import Channel
from mcap.writer import CompressionType, Writer

from tests.logs.conftest import made_up
from tests.logs.refused import or_refused
from tests.logs.rewriting import rewritten
from tests.logs.test_recover import TIMES, is_part
from tests.logs.test_round_trip import same
from vines import logs
from vines.errors import LogError

pytestmark = pytest.mark.long(20)

OLDER = Path(__file__).parent / "older"
"""Logs that vines wrote before they held digests of their content."""
TOPICS = ("/state", "/impact", "/stick", "/tf", "/tf_static", "/curves", "/impact_log", "/robot_description")
KEEP = settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
WRITERS = st.fixed_dictionaries(
    {
        "compression": st.sampled_from(list(CompressionType)),
        "chunk_size": st.sampled_from([500, 5000, 1 << 20]),
        "chunking": st.booleans(),
        "crcs": st.booleans(),
        "metadata_last": st.booleans(),
        "first": st.permutations(TOPICS),
        "spared": st.integers(0, 3),
        "library": st.sampled_from(["another program", "vines", ""]),
        "sequences": st.booleans(),
    }
)


@pytest.fixture(scope="module")
def small(run):
    """Return the arrays of a short run, among them states at one time: before and after an impact."""
    states = run["states"][:60].copy()
    states["t"][20:24] = states["t"][20]
    return {**run, "states": states, "impacts": run["impacts"][:9], "bare": True}


@pytest.fixture(scope="module")
def log(small, tmp_path_factory):
    return logs.write_run(tmp_path_factory.mktemp("log") / "run.mcap", **small)


def equal(log, other):
    """Assert that two logs hold the same tables, where numbers may be missing (nan)."""
    for key in (*TIMES, "base"):
        assert repr(getattr(log, key).to_pylist()) == repr(getattr(other, key).to_pylist())
    assert set(log.sensors) == set(other.sensors)
    for name, table in other.sensors.items():
        assert repr(log.sensors[name].to_pylist()) == repr(table.to_pylist())


@KEEP
@given(how=WRITERS)
def test_content_that_was_rewritten_is_as_written(small, log, tmp_path, how):
    file = tmp_path / "other.mcap"
    file.write_bytes(rewritten(log.read_bytes(), **how))
    back = logs.read(file)
    assert back.complete
    for key in TIMES:
        same(getattr(back, key), small[key])
    assert (back.name, back.parameters, back.declaration) == ("made up", small["parameters"], small["declaration"])
    if back.remarks:  # else the bytes before the status are the same
        assert "content as written" in back.remarks[0]
    with pytest.raises(LogError, match=r"is intact.* nothing to recover"):
        logs.recover(file, tmp_path / "out.mcap")


def test_messages_in_any_order_are_put_in_that_of_time(small, log, tmp_path):
    def shuffled(messages):
        random.Random(1).shuffle(messages)
        return messages

    file = tmp_path / "shuffled.mcap"
    file.write_bytes(rewritten(log.read_bytes(), order=shuffled))
    assert logs.read(file).complete
    same(logs.read(file).states, small["states"])


@KEEP
@given(how=WRITERS, kept=st.sets(st.sampled_from(TOPICS[:3]), min_size=1))
def test_filtered_log_is_read_and_what_is_missing_is_named(small, log, tmp_path, how, kept):
    file = tmp_path / "filtered.mcap"
    file.write_bytes(rewritten(log.read_bytes(), keep=lambda topic: topic in kept, **how))
    back = logs.read(file)
    assert (back.status, back.complete) == ("filtered", False)
    for key, topic in zip(TIMES, TOPICS, strict=False):
        same(getattr(back, key), small[key] if topic in kept else small[key][:0])
        assert (topic in kept) != any(line.startswith(f"{topic} is missing") for line in back.remarks)


def test_cut_by_time_is_not_taken_for_the_whole(small, log, tmp_path):
    file = tmp_path / "some.mcap"
    file.write_bytes(rewritten(log.read_bytes(), order=lambda messages: messages[: len(messages) // 2]))
    back = logs.read(file)
    assert back.status == "filtered"
    assert 0 < back.states.num_rows < 60
    same(back.states, small["states"][: back.states.num_rows])
    assert any("of 60 messages" in line for line in back.remarks)


def test_without_metadata_what_can_be_decoded_is_read_and_the_rest_named(small, log, tmp_path):
    file = tmp_path / "bare.mcap"
    file.write_bytes(rewritten(log.read_bytes(), metadata=lambda name: False))
    back = logs.read(file)
    assert (back.kind, back.status) == ("foreign", "unknown")
    same(back.states, small["states"])
    assert back.remarks[-1].endswith("/curves (cdr), /robot_description (cdr)")
    assert set(back.others) == {"/tf", "/tf_static", "/impact_log"}


def test_other_content_is_damage(log, tmp_path):
    def changed(messages):
        schema, channel, message = messages[30]
        message.data = message.data[:-1] + bytes([message.data[-1] ^ 1])
        return [*messages[:30], (schema, channel, message), *messages[31:]]

    file = tmp_path / "changed.mcap"
    file.write_bytes(rewritten(log.read_bytes(), order=changed))
    with pytest.raises(LogError, match="are not those that were written"):
        logs.read(file)
    file.write_bytes(rewritten(log.read_bytes(), order=lambda messages: [*messages, messages[-1]]))
    with pytest.raises(LogError, match="are not those that were written"):
        logs.read(file)


def two_runs(log, small, folder):
    """Return logs of two runs, merged by another program: messages of both on channels of one topic."""
    other = logs.write_run(folder / "b.mcap", **{**small, "name": "another"})
    return rewritten(log.read_bytes()), rewritten(other.read_bytes(), metadata=lambda name: name == "vines.run")


def test_merged_logs_are_not_mixed(log, small, tmp_path):
    stream = io.BytesIO()
    writer = Writer(stream)
    writer.start()
    for data in two_runs(log, small, tmp_path):
        reader = make_reader(io.BytesIO(data))
        for each in reader.iter_metadata():
            writer.add_metadata(each.name, each.metadata)
        for schema, channel, message in reader.iter_messages(topics=["/state"]):
            kind = writer.register_schema(schema.name, schema.encoding, schema.data)
            number = writer.register_channel(channel.topic, channel.message_encoding, kind)
            writer.add_message(number, message.log_time, message.data, message.publish_time)
    writer.finish()
    file = tmp_path / "merged.mcap"
    file.write_bytes(stream.getvalue())
    with pytest.raises(LogError, match=r"two records vines\.run that differ"):
        logs.read(file)


PLACES = st.floats(0, 1, exclude_max=True)


def damaged(data, kind, places, width):
    """Return bytes with one bit, the end, or a stretch of them lost, doubled, or put where others were."""
    a, b = (int(place * len(data)) for place in places)
    taken = data[a : a + width]
    if kind == "flipped":
        return data[:a] + bytes([data[a] ^ 1 << width % 8]) + data[a + 1 :]
    made = {"cut": data[:a], "lost": data[:a] + data[a + width :], "doubled": data[:a] + taken + data[a:]}
    return made.get(kind, data[:b] + taken + data[b + len(taken) :])


@settings(KEEP, max_examples=120)
@given(
    how=WRITERS,
    kind=st.sampled_from(["flipped", "cut", "lost", "doubled", "copied"]),
    places=st.tuples(PLACES, PLACES),
    width=st.sampled_from([0, 1, 5, 31, 300, 5000]),
)
def test_damage_after_rewriting_is_never_a_wrong_row(small, log, tmp_path, how, kind, places, width):
    data = damaged(rewritten(log.read_bytes(), **how), kind, places, width)
    file, out = tmp_path / "hurt.mcap", tmp_path / "hurt.recovered.mcap"
    out.unlink(missing_ok=True)
    file.write_bytes(data)
    for back in filter(None, (or_refused(lambda: logs.read(file)), or_refused(lambda: recovered(file)))):
        for key in TIMES:
            table = getattr(back, key)
            if back.complete:
                same(table, small[key])
            elif not any(f"/{key[:-1]}:" in line and "cannot be checked" in line for line in back.remarks):
                # Where messages were taken out and no checksums are left, nothing vouches for the rest; that is said.
                rows = zip(*(table[name].to_pylist() for name in small[key].dtype.names), strict=True)
                assert Counter(map(repr, rows)) <= Counter(map(repr, small[key].tolist()))


@pytest.mark.parametrize("chunk", [0, 3])
def test_chunk_that_stands_in_the_file_twice_is_taken_once(chunk, small, log, tmp_path):
    """Once its messages were there twice, and minus so many were told to be lost."""
    data = rewritten(log.read_bytes(), chunk_size=1500)
    places = [at for at, opcode, _ in records_of(data) if opcode == Opcode.CHUNK]
    start, stop = places[chunk : chunk + 2]
    file = tmp_path / "twice.mcap"
    file.write_bytes(data[:stop] + data[start:])
    said = logs.recover(file)
    same(logs.read(said.path).states, small["states"])
    (lost,) = said.lost
    assert "it stands in the file before" in lost


def records_of(data):
    """Yield place, opcode and content of the whole records of a file."""
    at = 8
    while at + 9 <= len(data):
        opcode, length = struct.unpack_from("<BQ", data, at)
        if at + 9 + length > len(data):
            break
        yield at, opcode, data[at + 9 : at + 9 + length]
        at += 9 + length


def recovered(file):
    return logs.read(logs.recover(file).path)


def test_rewritten_rig_keeps_each_sensor_to_its_name(tmp_path):
    """The repair that once called a sensor's samples the motion of the base."""
    about = {"quantity": "displacement", "unit": "m", "sign": "positive to the right", "rate": "100"}
    samples = {name: made_up("vines.v1.SensorSample", 40, "t", k) for k, name in enumerate("abcd")}
    base = made_up("vines.v1.BaseMotion", 30, "t", 9)
    path = logs.write_rig(
        tmp_path / "rig.mcap",
        sensors={name: logs.Sensor(rows, about) for name, rows in samples.items()},
        **{"base": base, "provenance": {}, "parameters": {}, "name": "rig"},
    )
    first = ["/sensor/c", "/sensor/b", "/sensor/a", "/base", "/sensor/d"]
    whole = rewritten(path.read_bytes(), first=first, chunk_size=3000)
    for data in (whole, whole[: len(whole) * 2 // 3]):
        file = tmp_path / "other.mcap"
        file.write_bytes(data)
        back = logs.read(file if data is whole else logs.recover(file).path)
        assert back.kind == "rig"
        for name, rows in samples.items():
            assert is_part(back.sensors[name], rows, "t") > (39 if data is whole else 0)
        is_part(back.base, base, "t")


@pytest.mark.parametrize("name", ["run", "rig"])
def test_older_logs_are_read_and_rewritten_ones_too(name, tmp_path):
    older = logs.read(OLDER / f"{name}.mcap")
    assert (older.complete, older.remarks) == (True, ())
    file = tmp_path / "lz4.mcap"
    file.write_bytes(rewritten((OLDER / f"{name}.mcap").read_bytes(), library="mcap copy"))
    back = logs.read(file)
    assert back.complete
    assert back.remarks == (
        "rewritten by 'mcap copy', as many messages as written, for whose content only checksums of that program vouch "
        "(an older log, or one without vines.content)",
    )
    equal(back, older)


@pytest.mark.parametrize("chunking", [True, False])
def test_older_log_that_was_rewritten_without_checksums_is_not_called_complete(chunking, tmp_path):
    file = tmp_path / "none.mcap"
    file.write_bytes(rewritten((OLDER / "run.mcap").read_bytes(), crcs=False, chunking=chunking))
    back = logs.read(file)
    assert (back.status, back.complete) == ("unverified", False)
    assert "nothing vouches" in back.remarks[0]


@pytest.mark.parametrize("cut", [1, 8, 60, 8000])
@pytest.mark.parametrize("name", ["run", "rig"])
def test_cut_end_of_an_older_log_loses_no_channel(name, cut, tmp_path):
    """Older logs hold one digest for all schemas of one name: /tf_static and all sensors but the last were lost."""
    file = tmp_path / "cut.mcap"
    file.write_bytes((OLDER / f"{name}.mcap").read_bytes()[:-cut])
    said = logs.recover(file)
    assert said.lost == ()
    older, back = logs.read(OLDER / f"{name}.mcap"), logs.read(said.path)
    equal(back, older)
    if name == "run":
        assert "/tf_static: 1 of 1 messages, t 0 to 0" in said.saved


@KEEP
@given(cut=st.floats(0.1, 0.99), crcs=st.booleans(), chunking=st.booleans())
def test_log_rewritten_without_checksums_is_salvaged_record_by_record_up_to_a_cut(
    small, log, tmp_path, cut, crcs, chunking
):
    data = rewritten(log.read_bytes(), chunking=chunking, crcs=crcs and not chunking, chunk_size=2000)
    data = data[: int(cut * len(data))]
    # By mcap's own writer: all messages that are whole before the cut, a chunk being whole or not there.
    there = None if chunking else messages_before(data)
    file = tmp_path / "cut.mcap"
    file.write_bytes(data)
    (tmp_path / "cut.recovered.mcap").unlink(missing_ok=True)
    back = or_refused(lambda: recovered(file))
    if back is None:
        assert not there
        return
    assert (back.status, back.complete) == ("recovered", False)
    in_part = any(0 < getattr(back, key).num_rows < len(small[key]) for key in TIMES)
    # Of a channel that is whole the digest vouches; one may be whole and the next not begun.
    assert not in_part or back.remarks[-1].endswith("of the messages have no checksum: they are unverified")
    for key, topic in zip(TIMES, TOPICS, strict=False):
        table = getattr(back, key)
        same(table, small[key][: table.num_rows])
        if there is not None:
            assert table.num_rows == there[topic]


def messages_before(data):
    """Count the whole message records in a file that was cut, by topic."""
    counts, topics = dict.fromkeys(TOPICS, 0), {}
    for _, opcode, body in records_of(data):
        if opcode == Opcode.CHANNEL:
            channel = Channel.read(ReadDataStream(io.BytesIO(body)))
            topics[channel.id] = channel.topic
        elif opcode == Opcode.MESSAGE:
            counts[topics[int.from_bytes(body[:2], "little")]] += 1
    return counts if any(counts.values()) else None


def test_nothing_of_a_damaged_log_is_taken_that_no_checksum_vouches_for(small, log, tmp_path):
    """A cut leaves what is before it; a flipped bit may be anywhere: messages without a checksum are then left out."""
    data = bytearray(rewritten(log.read_bytes(), chunking=False, crcs=True))
    data[data.index(b"\x05", len(data) // 2)] ^= 0xFF
    file = tmp_path / "flipped.mcap"
    file.write_bytes(data)
    back = or_refused(lambda: recovered(file))
    for key in TIMES if back is not None else ():
        table = getattr(back, key)
        assert table.num_rows in (0, len(small[key]))


def test_cut_file_without_metadata_stays_one_of_which_nobody_knows_the_run(small, log, tmp_path):
    """Once it was called a run, with the messages of one of two channels of a kind."""
    stream = io.BytesIO()
    writer = Writer(stream, chunk_size=1000)
    writer.start()
    numbers = {}
    for run in ("a", "b"):
        for schema, channel, message in make_reader(io.BytesIO(log.read_bytes())).iter_messages(topics=["/state"]):
            if run not in numbers:
                kind = writer.register_schema(schema.name, schema.encoding, schema.data)
                numbers[run] = writer.register_channel(channel.topic, channel.message_encoding, kind, {"run": run})
            writer.add_message(numbers[run], message.log_time, message.data, message.publish_time)
    writer.finish()
    file = tmp_path / "two.mcap"
    file.write_bytes(stream.getvalue()[:-1])
    back = recovered(file)
    assert (back.kind, back.status, back.provenance) == ("foreign", "unknown", {})
    assert [len(table) for table in back.others.values()] == [60, 60]
    assert "several channels hold the same kind of message" in back.remarks[0]


@pytest.mark.parametrize("name", [b"vines.content", b"/stick\x01"])
def test_hurt_record_of_a_log_without_checksums_is_damage_and_not_an_older_log(name, log, tmp_path):
    """Neither the digests of the content nor the topics that the status counts may be others than those written."""
    data = bytearray(rewritten(log.read_bytes(), crcs=False, chunking=False))
    place = data.index(b"vines.status") + data[data.index(b"vines.status") :].index(b"/stick") + 1
    at = data.index(name) + len(name) + 60 if name == b"vines.content" else place
    data[at] ^= 1
    file = tmp_path / "hurt.mcap"
    file.write_bytes(data)
    with pytest.raises(LogError, match="damaged: its SHA-256 does not fit, and"):
        logs.read(file)


def test_rewriter_that_keeps_the_name_of_vines_gets_no_description_made_anew(small, log, tmp_path):
    """The number of a channel is that of the file, also where its header says that vines wrote it."""
    data = rewritten(log.read_bytes(), library="vines", chunking=False, first=["/tf", "/curves", "/impact", "/state"])
    file = tmp_path / "kept.mcap"
    file.write_bytes(data[: len(data) // 2])
    back = recovered(file)
    assert back.states.num_rows > 10
    for key in TIMES:
        table = getattr(back, key)
        same(table, small[key][: table.num_rows])


@pytest.mark.parametrize("tail", [bytes([opcode, *bytes(8)]) for opcode in range(1, 16)], ids=lambda each: str(each[0]))
def test_bytes_of_a_cut_message_that_look_like_a_record_cost_nothing_else(small, log, tmp_path, tail):
    """Found by hypothesis: the last bytes before a cut, inside a number, were the head of a record without content."""
    data = rewritten(log.read_bytes(), chunking=False, crcs=False)
    whole = [place for place, opcode, _ in records_of(data) if opcode == Opcode.MESSAGE][60]
    file = tmp_path / "cut.mcap"
    file.write_bytes(data[: whole + 60] + tail)
    back = recovered(file)
    assert sum(getattr(back, key).num_rows for key in TIMES) > 10
    assert back.remarks[-1].endswith("of the messages have no checksum: they are unverified")
