"""What `mcap doctor` finds wrong with a file, looked for with mcap's own records and nothing of vines.

The conditions are those of doctor.go of the mcap command line; offsets of summary, attachments, metadata and messages,
and the checksums, which it does not check, are added.
"""

import struct
import zlib
from io import BytesIO
from itertools import pairwise
from pathlib import Path

from mcap import records
from mcap.data_stream import ReadDataStream, RecordBuilder
from mcap.opcode import Opcode
from mcap.stream_reader import get_chunk_data_stream

MAGIC = b"\x89MCAP0\r\n"


def walked(data: bytes, at: int = 0):
    """Yield place, opcode, content and end of each record."""
    while at < len(data):
        opcode, length = struct.unpack_from("<BQ", data, at)
        yield at, Opcode(opcode), data[at + 9 : at + 9 + length], at + 9 + length
        at += 9 + length


def parsed(kind, body: bytes):
    return kind.read(ReadDataStream(BytesIO(body)))


def written(record) -> bytes:
    builder = RecordBuilder()
    record.write(builder)
    return builder.end()


def findings(path: Path) -> list[str]:
    """Return what is wrong with a file, a line each: errors, and warnings, which begin so."""
    data = path.read_bytes()
    found: list[str] = []

    def must(holds: bool, what: str) -> None:
        if not holds:
            found.append(what)

    must(data[:8] == MAGIC == data[-8:], "magic")
    every = [(at + 8, opcode, body, end + 8) for at, opcode, body, end in walked(data[8:-8])]
    of = {opcode: [each for each in every if each[1] == opcode] for opcode in Opcode}
    must(len(of[Opcode.DATA_END]) == 1, "one DataEnd")
    ((data_end, _, end_body, summary_start),) = of[Opcode.DATA_END]
    ((footer_at, _, footer_body, _),) = of[Opcode.FOOTER]
    footer = parsed(records.Footer, footer_body)
    must(parsed(records.DataEnd, end_body).data_section_crc == zlib.crc32(data[:data_end]), "CRC of the data")
    must(footer.summary_crc == zlib.crc32(data[summary_start : footer_at + 25]), "CRC of the summary")
    must(footer.summary_start == summary_start, "summary start")
    header = parsed(records.Header, of[Opcode.HEADER][0][2])
    must(bool(header.library), "warning: no library")
    must(header.profile in ("", "ros1", "ros2"), "warning: profile")

    front = [each for each in every if each[0] < data_end]
    back = [each for each in every if each[0] > data_end]
    described: list[dict[int, records.Schema | records.Channel]] = []
    for part, name in ((front, "data"), (back, "summary")):
        for opcode, kind in ((Opcode.SCHEMA, records.Schema), (Opcode.CHANNEL, records.Channel)):
            listed = [parsed(kind, body) for _, code, body, _ in part if code == opcode]
            must(len({each.id for each in listed}) == len(listed), f"warning: {kind.__name__} twice in {name}")
            described.append({each.id: each for each in listed})
    schemas, channels, *repeated = described
    must([schemas, channels] == repeated, "summary repeats schemas and channels")
    must(0 not in schemas and all(each.encoding for each in schemas.values()), "schemas")
    must(all(each.schema_id in schemas for each in channels.values()), "schema of a channel")

    latest, total = 0, dict.fromkeys(channels, 0)
    chunks: dict[int, records.ChunkIndex] = {}
    for place, (at, opcode, body, end) in enumerate(front):
        if opcode != Opcode.CHUNK:
            must(opcode != Opcode.MESSAGE, "warning: message outside of chunks")
            continue
        chunk = parsed(records.Chunk, body)
        stream, size = get_chunk_data_stream(chunk, validate_crc=True)
        must(size == chunk.uncompressed_size, "size of a chunk")
        inside = stream.read(size)
        times, where = [], {}
        for start, kind, content, _ in walked(inside):
            must(kind == Opcode.MESSAGE, "record in a chunk")
            number, _, time, _ = struct.unpack_from("<HIQQ", content)
            must(number in channels, "message before its channel")
            must(time >= latest, "warning: message earlier than the latest one")
            latest = max(latest, time)
            times.append(time)
            where.setdefault(number, []).append((time, start))
            total[number] += 1
        must((chunk.message_start_time, chunk.message_end_time) == (min(times), max(times)), "times of a chunk")
        indexes = {}
        after = end
        for index_at, code, content, index_end in front[place + 1 :]:
            if code != Opcode.MESSAGE_INDEX:
                break
            index = parsed(records.MessageIndex, content)
            indexes[index.channel_id] = index_at
            must(index.records == where.get(index.channel_id), "message index")
            after = index_end
        must(set(indexes) == set(where), "one message index a channel")
        chunks[at] = records.ChunkIndex(
            chunk_length=end - at,
            chunk_start_offset=at,
            compression=chunk.compression,
            compressed_size=len(chunk.data),
            message_start_time=chunk.message_start_time,
            message_end_time=chunk.message_end_time,
            message_index_length=after - end,
            message_index_offsets=indexes,
            uncompressed_size=chunk.uncompressed_size,
        )
    indexed = [parsed(records.ChunkIndex, body) for _, code, body, _ in back if code == Opcode.CHUNK_INDEX]
    must(indexed == list(chunks.values()), "chunk indexes")
    times = [(each.message_start_time, each.message_end_time) for each in indexed]
    must(all(a[1] <= b[0] for a, b in pairwise(times)), "warning: chunks overlap in time")

    for opcode, code, kind in (
        (Opcode.METADATA, Opcode.METADATA_INDEX, records.MetadataIndex),
        (Opcode.ATTACHMENT, Opcode.ATTACHMENT_INDEX, records.AttachmentIndex),
    ):
        lists = [parsed(kind, body) for _, each, body, _ in back if each == code]
        places = [(at, end - at) for at, _, _, end in of[opcode]]
        must([(each.offset, each.length) for each in lists] == places, f"{kind.__name__} offsets")
    ((_, _, body, _),) = of[Opcode.STATISTICS]
    statistics = parsed(records.Statistics, body)
    must(statistics.channel_message_counts == total, "counts of the statistics")
    must(
        statistics
        == records.Statistics(
            attachment_count=len(of[Opcode.ATTACHMENT]),
            channel_count=len(channels),
            channel_message_counts=total,
            chunk_count=len(chunks),
            message_count=sum(total.values()),
            message_end_time=max((each[1] for each in times), default=0),
            message_start_time=min((each[0] for each in times), default=0),
            metadata_count=len(of[Opcode.METADATA]),
            schema_count=len(schemas),
        ),
        "statistics",
    )
    offsets = [parsed(records.SummaryOffset, body) for _, code, body, _ in back if code == Opcode.SUMMARY_OFFSET]
    groups: dict[int, list[int]] = {}
    for at, code, _, end in back:
        if code not in (Opcode.SUMMARY_OFFSET, Opcode.FOOTER):
            groups.setdefault(code, [at, end])[1] = end
    must(
        [(each.group_opcode, each.group_start, each.group_start + each.group_length) for each in offsets]
        == [(code, *span) for code, span in groups.items()],
        "summary offsets",
    )
    first = min((at for at, code, _, _ in back if code == Opcode.SUMMARY_OFFSET), default=0)
    must(footer.summary_offset_start == first, "start of the summary offsets")
    # The bytes of each small record are those that mcap's own writer makes of it.
    for _, code, body, _ in back:
        kind = {Opcode.CHUNK_INDEX: records.ChunkIndex, Opcode.STATISTICS: records.Statistics}.get(code)
        must(kind is None or written(parsed(kind, body))[9:] == body, "bytes of a record")
    return sorted(set(found))
