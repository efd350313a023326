"""What a file declares may be wrong on purpose: one line, and no more memory than is allowed."""

import io
import os
import struct
import tracemalloc

import pytest
import zstandard
from mcap import records
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.reader import make_reader
from mcap.writer import MCAP0_MAGIC, Writer

from tests.logs.test_damage import foreign
from vines import logs
from vines.errors import ChunkError, LogError

MIB = 2**20


def file_of(*every: records.McapRecord) -> bytes:
    """Return an MCAP file with these records and no summary."""
    builder = RecordBuilder()
    for record in (records.Header("", "test"), *every, records.DataEnd(0), records.Footer(0, 0, 0)):
        record.write(builder)
    return MCAP0_MAGIC + builder.end() + MCAP0_MAGIC


def chunk(data: bytes, *, size: int, compression: str) -> records.Chunk:
    return records.Chunk(
        compression=compression,
        data=data,
        message_start_time=0,
        message_end_time=0,
        uncompressed_crc=0,
        uncompressed_size=size,
    )


def refused(path, data: bytes) -> str:
    path.write_bytes(data)
    tracemalloc.start()
    try:
        for attempt in (logs.read, logs.recover):
            with pytest.raises(LogError) as caught:
                attempt(path)
            assert str(caught.value).isprintable()
    finally:
        _, peak = tracemalloc.get_traced_memory()
        tracemalloc.stop()
    assert peak < 40 * MIB
    with pytest.raises(LogError) as caught:
        logs.read(path)
    return str(caught.value)


ZEROS = zstandard.ZstdCompressor(level=1).compress(bytes(600 * MIB))


@pytest.mark.parametrize("declared", [0, 1000, 600 * MIB, 2**62])
def test_chunk_that_unpacks_to_hundreds_of_megabytes(declared, tmp_path):
    message = refused(tmp_path / "bomb.mcap", file_of(chunk(ZEROS, size=declared, compression="zstd")))
    assert ("more than the 256 MiB" if declared > 1000 else "that it declares") in message


def test_many_chunks_that_are_each_allowed(tmp_path):
    """A bomb in pieces: no chunk is over the limit, all of them are; unknown records are passed over."""
    unknown = struct.pack("<BQ", 0x80, 20 * MIB - 9) + bytes(20 * MIB - 9)
    one = chunk(zstandard.ZstdCompressor(level=1).compress(unknown), size=20 * MIB, compression="zstd")
    path = tmp_path / "many.mcap"
    path.write_bytes(file_of(*[one] * 4))
    assert logs.read(path).kind == "foreign"
    with pytest.raises(ChunkError, match=r"all chunks unpack to more than the 10 MiB that are allowed.*--max-chunk"):
        logs.read(path, max_chunk=30 * MIB)


def test_the_limit_can_be_raised(log_file):
    with pytest.raises(ChunkError, match="if you trust the file, allow more with --max-chunk MIB"):
        logs.read(log_file, max_chunk=1000)
    assert logs.read(log_file, max_chunk=MIB).complete


def test_unknown_compression_is_called_that(tmp_path):
    message = refused(tmp_path / "br.mcap", file_of(chunk(b"abc", size=3, compression="br\x1b[31m")))
    assert "compressed as 'br\\x1b[31m', which vines does not know (it reads zstd, lz4 and none)" in message


def test_chunks_in_chunks(tmp_path):
    inner = chunk(b"", size=0, compression="")
    for _ in range(3000):
        builder = RecordBuilder()
        inner.write(builder)
        data = builder.end()
        inner = chunk(data, size=len(data), compression="")
        if len(data) > 4 * MIB:
            break
    assert "a chunk holds a record of kind 6" in refused(tmp_path / "nested.mcap", file_of(inner))


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (b"[" * 100_000 + b"]" * 100_000, "nested too deeply"),
        (b'{"a":' * 5000 + b"1" + b"}" * 5000, "nested too deeply"),
        (b'{"x": %d}' % 2**70, "an integer beyond 64 bits"),
        (b'{"x": -%d}' % 2**63 + b"", ""),
        (b'{"x": {"y": [%d]}}' % 2**64, "an integer beyond 64 bits"),
        (b'{"x": ' + b"9" * 5000 + b"}", "do not fit their schema"),
        (b'{"x": "\\ud800"}', "do not fit their schema"),
    ],
)
def test_json_that_no_table_holds(text, said, tmp_path):
    path = tmp_path / "json.mcap"
    if said:
        assert said in refused(path, foreign(message=text))
        return
    path.write_bytes(foreign(message=text))
    assert logs.read(path).others["/pose"]["x"].to_pylist() == [-(2**63)]


def test_numbers_of_64_bits_without_sign_are_read(tmp_path):
    path = tmp_path / "large.mcap"
    path.write_bytes(foreign(message=b'{"x": %d}' % (2**64 - 1)))
    assert logs.read(path).others["/pose"]["x"].to_pylist() == [2**64 - 1]


@pytest.mark.parametrize("length", [2**63, 2**40, 10**6])
@pytest.mark.parametrize("opcode", [Opcode.CHUNK, Opcode.METADATA, Opcode.ATTACHMENT, Opcode.MESSAGE, Opcode.SCHEMA])
def test_declared_lengths_that_do_not_fit(opcode, length, tmp_path):
    whole = file_of()
    place = whole.index(struct.pack("<BQ", Opcode.DATA_END, 4))
    record = struct.pack("<BQ", opcode, length) + b"\xff" * 40
    assert "damaged" in refused(tmp_path / "long.mcap", whole[:place] + record + whole[place:])
    inside = struct.pack("<BQ", opcode, 40) + b"\xff" * 40
    path = tmp_path / "inside.mcap"
    path.write_bytes(whole[:place] + inside + whole[place:])
    with pytest.raises(LogError):
        logs.read(path)


def test_names_from_a_file_are_escaped(tmp_path):
    stream = io.BytesIO()
    writer = Writer(stream)
    writer.start()
    for topic, encoding in (("/a", "json"), ("/a\nERROR: \x1b[31mred", "cdr\n"), ("/\u202eb", "cbor")):
        writer.add_message(writer.register_channel(topic, encoding, 0), 0, b"{}", 0)
    writer.finish()
    path = tmp_path / "names.mcap"
    path.write_bytes(stream.getvalue())
    (remark,) = logs.read(path).remarks
    assert "/a\\nERROR: \\x1b[31mred (cdr\\n)" in remark
    assert "/\\u202eb (cbor)" in remark
    assert remark.isprintable()
    assert "\\x1b[31m" in refused(tmp_path / "bad.mcap", foreign(topic="/\x1b[31m", message=b"{"))


def test_what_is_no_file_is_told_as_what_it_is(tmp_path):
    folder, pipe, loop = tmp_path / "folder.mcap", tmp_path / "pipe.mcap", tmp_path / "loop.mcap"
    folder.mkdir()
    os.mkfifo(pipe)
    loop.symlink_to(loop)
    for path, said in ((folder, "is a folder"), (pipe, r"is a pipe \(FIFO\)"), (loop, "symbolic links")):
        for attempt in (logs.read, logs.recover):
            with pytest.raises(LogError, match=said):
                attempt(path)


def test_messages_in_a_chunk_are_in_the_order_of_time(run, tmp_path):
    """`mcap doctor` warns of each message that is earlier than the one before it in its chunk."""
    path = logs.write_run(tmp_path / "run.mcap", **{**run, "bare": True})
    with path.open("rb") as stream:
        times = [m.log_time for _, _, m in make_reader(stream, validate_crcs=True).iter_messages(log_time_order=False)]
    assert times == sorted(times)
    assert len(times) > 5000
