"""Files of any records, right and wrong: read or refused in a line, and what is recovered was in them."""

import io
import zlib
from collections import Counter

import lz4.frame
import pytest
import zstandard
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from mcap import records
from mcap.data_stream import RecordBuilder
from mcap.reader import make_reader
from mcap.writer import MCAP0_MAGIC

from tests.logs.refused import or_refused
from vines import logs, schema

pytestmark = pytest.mark.long(20)

KEEP = settings(max_examples=300, deadline=None, suppress_health_check=list(HealthCheck))
NUMBERS = st.sampled_from([0, 1, 1, 2, 2, 3, 3, 4])
TEXT = st.sampled_from(["/state", "/base", "/sensor/a", "a\x1b[31m\nb", ""])
KINDS = ("vines.v1.State", "vines.v1.BaseMotion", "vines.v1.SensorSample")
BLANKS = [schema.wire_format(kind).blank for kind in KINDS]


def written(record: records.McapRecord | bytes) -> bytes:
    if isinstance(record, bytes):
        return record
    builder = RecordBuilder()
    record.write(builder)
    return builder.end()


SCHEMAS = st.one_of(
    st.builds(
        lambda number, name: records.Schema(number, schema.schema_bytes(name), "protobuf", name),
        NUMBERS,
        st.sampled_from(KINDS),
    ),
    st.builds(records.Schema, NUMBERS, st.binary(max_size=9), st.sampled_from(["protobuf", "jsonschema"]), TEXT),
)
CHANNELS = st.builds(
    records.Channel,
    id=NUMBERS,
    topic=TEXT,
    message_encoding=st.sampled_from(["protobuf", "protobuf", "json", "cbor"]),
    metadata=st.dictionaries(TEXT, TEXT, max_size=2),
    schema_id=NUMBERS,
)
MESSAGES = st.builds(
    lambda number, time, sequence, odd: records.Message(
        number, time, BLANKS[(number - 1) % 3] if odd is None else odd, 0, sequence
    ),
    NUMBERS,
    st.integers(0, 2**64 - 1),
    st.integers(0, 9),
    # Mostly what its channel holds.
    st.sampled_from([*[None] * 20, b"", b"{}", b'{"x": 36893488147419103232}', b"[[[[", BLANKS[0]]),
)
SMALL = st.one_of(SCHEMAS, CHANNELS, *[MESSAGES] * 5)
# Too short for a message, a schema, a channel or a chunk: of any kind, and never right.
RAW = st.builds(
    lambda opcode, body: bytes([opcode]) + len(body).to_bytes(8, "little") + body,
    st.integers(0, 255),
    st.binary(max_size=12),
)
METADATA = st.builds(
    records.Metadata,
    name=st.sampled_from(["vines.status", "vines.provenance", "vines.run", "vines.digests", "other"]),
    metadata=st.dictionaries(st.sampled_from(["status", "/state", "sha256", "name"]), st.text(max_size=8), max_size=3),
)
ATTACHMENTS = st.builds(
    lambda name, data: records.Attachment(create_time=0, log_time=0, name=name, media_type="", data=data),
    TEXT,
    st.binary(max_size=9),
)


DESCRIBED = [
    record
    for number, (name, topic) in enumerate(zip(KINDS, ("/state", "/base", "/sensor/a"), strict=True), 1)
    for record in (
        records.Schema(number, schema.schema_bytes(name), "protobuf", name),
        records.Channel(number, topic, "protobuf", {}, number),
    )
]


@st.composite
def chunks(draw):
    """Return a chunk, whose sizes and checksum may be wrong, and the records in it."""
    inside = draw(st.lists(st.one_of(MESSAGES, MESSAGES, MESSAGES, SMALL, RAW), max_size=8))
    data = b"".join(map(written, inside))
    compression = draw(st.sampled_from(["", *["zstd", "lz4"] * 4, "br"]))
    packed = {"zstd": zstandard.ZstdCompressor().compress, "lz4": lz4.frame.compress}.get(compression, bytes)(data)
    size = max(0, len(data) + draw(st.sampled_from([*[0] * 9, 1, -1, 2**40])))
    crc = draw(st.sampled_from([*[zlib.crc32(data)] * 6, 0, 1]))
    return records.Chunk(compression, packed, 0, 0, crc, size), inside


@st.composite
def files(draw):
    """Return the bytes of a file, perhaps cut, and all records that it was made of."""
    parts = draw(st.lists(st.one_of(SMALL, *[chunks()] * 4, METADATA, ATTACHMENTS, RAW), max_size=8))
    # Descriptions that are right come first more often than not; others may gainsay them.
    parts = [*DESCRIBED[: draw(st.sampled_from([0, 2, 4, 6, 6]))], *parts]
    data, every = MCAP0_MAGIC + written(records.Header("", draw(st.sampled_from(["vines", "another"])))), []
    for part in parts:
        record, inside = part if isinstance(part, tuple) else (part, [part])
        data += written(record)
        every += inside
    data += b"".join(map(written, (records.DataEnd(0), records.Footer(0, 0, 0)))) + MCAP0_MAGIC
    return data[: draw(st.sampled_from([len(data), len(data), draw(st.integers(0, len(data)))]))], every


@KEEP
@given(made=files())
def test_any_file_is_read_or_refused_and_nothing_is_made_up(tmp_path, made):
    data, every = made
    file, out = tmp_path / "any.mcap", tmp_path / "out.mcap"
    file.write_bytes(data)
    out.unlink(missing_ok=True)
    log = or_refused(lambda: logs.read(file))
    if log is not None:
        assert all(remark.isprintable() for remark in log.remarks)
    said = or_refused(lambda: logs.recover(file, out))
    assert out.exists() == (said is not None)
    if said is None:
        return
    assert log is None
    assert all(line.isprintable() for line in (*said.saved, *said.lost))
    assert not logs.read(out).complete
    # Read by mcap's own reader: each message, on the channel that it was on, and no message twice.
    there = Counter(
        (each.channel_id, each.log_time, each.sequence, each.data)
        for each in every
        if isinstance(each, records.Message)
    )
    saved: Counter[tuple[int, int, int, bytes]] = Counter()
    for kind, channel, message in make_reader(io.BytesIO(out.read_bytes()), validate_crcs=True).iter_messages():
        saved[message.channel_id, message.log_time, message.sequence, message.data] += 1
        assert channel in every
        assert kind is None or kind in every
    assert saved <= there
    assert saved.total() > 0
