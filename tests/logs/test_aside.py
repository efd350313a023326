"""Messages that are intact and cannot be read: set aside, counted and named, and the others are saved and shown."""

import io

import pytest
from mcap.writer import Writer

from vines import logs
from vines.errors import LogError
from vines.logs import read_damaged
from vines.schema import message_class, schema_bytes


def file_of(path, topics):
    """Write an MCAP file of others; each topic with encoding, schema name, and its payloads."""
    stream = io.BytesIO()
    writer = Writer(stream, chunk_size=300)
    writer.start()
    for topic, (encoding, schema, payloads) in topics.items():
        number = 0
        if schema:
            data = schema_bytes(schema) if encoding == "protobuf" else b"{}"
            number = writer.register_schema(schema, "protobuf" if encoding == "protobuf" else "jsonschema", data)
        channel = writer.register_channel(topic, encoding, number)
        for place, payload in enumerate(payloads):
            writer.add_message(channel, place * 10**9, payload, place * 10**9, sequence=place)
    writer.finish()
    path.write_bytes(stream.getvalue())
    return path


JSON = ("json", "", [b'{"x": %d}' % place for place in range(40)])
STRANGE = {
    b"{not json": "do not fit their schema",
    b'{"x": %d}' % 2**70: "hold an integer beyond 64 bits",
    b"[" * 100_000: "are nested too deeply",
    b"\xff\xfe": "do not fit their schema",
}


@pytest.mark.parametrize("payload", STRANGE, ids=lambda each: repr(each[:9]))
def test_one_message_of_others_costs_that_message(payload, tmp_path):
    strange = ("json", "", [b'{"y": 1}', payload, b'{"y": 3}', payload])
    path = file_of(tmp_path / "theirs.mcap", {"/fine": JSON, "/odd": strange})
    with pytest.raises(LogError, match=STRANGE[payload]):
        logs.read(path)
    made = logs.recover(path)
    (lost,) = made.lost
    assert lost.startswith(f"/odd: 2 messages that {STRANGE[payload]}")
    assert lost.endswith("the first at t 1")
    back = logs.read(made.path)
    assert back.others["/fine"]["x"].to_pylist() == list(range(40))
    assert back.others["/odd"].to_pylist() == [{"log_time": 0, "y": 1}, {"log_time": 2 * 10**9, "y": 3}]
    shown = read_damaged(path)
    assert shown.others["/odd"].num_rows == 2
    assert "/odd: 2 messages that" in shown.remarks[0]


def test_a_protobuf_message_that_does_not_fit(tmp_path):
    state = message_class("vines.v1.State")(t=1.0, x1=0.5).SerializeToString()
    path = file_of(tmp_path / "theirs.mcap", {"/state": ("protobuf", "vines.v1.State", [state, b"\x09\x01", state])})
    made = logs.recover(path)
    assert len(made.lost) == 1
    assert "/state: 1 messages that do not fit their schema" in made.lost[0]
    assert logs.read(made.path).states.num_rows == 2


def test_beside_other_damage_it_is_set_aside_too(tmp_path):
    path = file_of(tmp_path / "theirs.mcap", {"/odd": ("json", "", [b"{not json", b'{"y": 3}']), "/fine": JSON})
    data = bytearray(path.read_bytes())
    place = data.index(b'{"x": 20}')
    data[place : place + 9] = b'{"x": 21}'
    path.write_bytes(data)
    made = logs.recover(path)
    assert any(line.startswith("/odd: 1 messages that") for line in made.lost)
    assert any("a chunk of messages" in line for line in made.lost)
    kept = logs.read(made.path).others["/fine"]["x"].to_pylist()
    assert 20 < len(kept) < 40
    assert 20 not in kept


def test_nothing_that_can_be_read_is_no_log(tmp_path):
    path = file_of(tmp_path / "theirs.mcap", {"/odd": ("json", "", [b"{not json"])})
    with pytest.raises(LogError, match="cannot be read either, so nothing is written"):
        logs.recover(path)
    assert [each.name for each in tmp_path.iterdir()] == ["theirs.mcap"]


def test_values_of_several_types_stand_as_text(tmp_path):
    mixed = ("json", "", [b'{"v": 1, "n": %d}' % 2**63, b'{"v": "on", "n": -1}', b'{"v": null}'])
    log = logs.read(file_of(tmp_path / "theirs.mcap", {"/mixed": mixed}))
    assert log.others["/mixed"]["v"].to_pylist() == ["1", '"on"', None]
    assert log.others["/mixed"]["n"].to_pylist() == [str(2**63), "-1", None]
    assert [line.partition(" has")[0] for line in log.remarks] == ["v on /mixed", "n on /mixed"]
