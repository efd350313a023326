"""An MCAP file in the making: its records, checksums, indexes and summary.

Chunks come as numpy arrays of whole message records, past the writer of the mcap package, which makes one
Python call a message; the small records (schemas, indexes, statistics) are that package's own. The tests read
every byte back through its reader with CRC validation.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Mapping
from typing import BinaryIO

import numpy as np
import zstandard
from mcap import records
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.writer import MCAP0_MAGIC

from vines.logs._channels import CHANNELS, Channel, log_times
from vines.logs._pack import pack
from vines.schema import schema_bytes

__all__ = ["LogFile"]


class LogFile:
    """An MCAP file that is being written, with what its summary will say."""

    def __init__(self, stream: BinaryIO):
        self._stream = stream
        self._offset = 0
        self._crc = 0
        self._repeated: dict[Opcode, list[records.McapRecord]] = {
            opcode: []
            for opcode in (
                *(Opcode.SCHEMA, Opcode.CHANNEL, Opcode.STATISTICS),
                *(Opcode.CHUNK_INDEX, Opcode.ATTACHMENT_INDEX, Opcode.METADATA_INDEX),
            )
        }
        self._counts = {channel.number: 0 for channel in CHANNELS}
        self._span: tuple[int, int] | None = None
        self._zstd = zstandard.ZstdCompressor(level=3)
        self._put(MCAP0_MAGIC)
        self._record(records.Header(profile="", library="vines"))

    def _put(self, data: bytes) -> int:
        """Write bytes of the data section; return where they begin."""
        start = self._offset
        self._stream.write(data)
        self._crc = zlib.crc32(data, self._crc)
        self._offset += len(data)
        return start

    def _record(self, record: records.McapRecord) -> tuple[int, int]:
        """Write a small record; return where it begins and how long it is."""
        data = _bytes(record)
        return self._put(data), len(data)

    def metadata(self, name: str, values: dict[str, str]) -> None:
        offset, length = self._record(records.Metadata(name=name, metadata=values))
        self._repeated[Opcode.METADATA_INDEX].append(records.MetadataIndex(offset=offset, length=length, name=name))

    def attachment(self, name: str, media_type: str, data: bytes) -> None:
        record = records.Attachment(create_time=0, log_time=0, name=name, media_type=media_type, data=data)
        offset, length = self._record(record)
        index = records.AttachmentIndex(
            offset=offset,
            length=length,
            log_time=0,
            create_time=0,
            data_size=len(data),
            name=name,
            media_type=media_type,
        )
        self._repeated[Opcode.ATTACHMENT_INDEX].append(index)

    def channel(self, channel: Channel) -> None:
        schema = records.Schema(
            id=channel.number, data=schema_bytes(channel.message), encoding="protobuf", name=channel.message
        )
        described = records.Channel(
            id=channel.number,
            topic=channel.topic,
            message_encoding="protobuf",
            metadata={},
            schema_id=channel.number,
        )
        for opcode, record in ((Opcode.SCHEMA, schema), (Opcode.CHANNEL, described)):
            self._record(record)
            self._repeated[opcode].append(record)

    def chunk(self, rows: Mapping[Channel, np.ndarray], places: Mapping[Channel, slice]) -> None:
        """Write one chunk and its message indexes; ``places`` are the rows' numbers in their channels."""
        body: list[bytes] = []
        indexes: dict[int, bytes] = {}
        size = 0
        spans: list[tuple[int, int]] = []
        for channel, part in rows.items():
            if not len(part):
                continue
            times = log_times(part[channel.time])
            packed = pack(part, times, channel, places[channel].start)
            entries = np.empty((len(part), 2), "<u8")
            entries[:, 0] = times
            entries[:, 1] = size + len(packed) // len(part) * np.arange(len(part))
            head = struct.pack("<BQHI", Opcode.MESSAGE_INDEX, 6 + entries.nbytes, channel.number, entries.nbytes)
            indexes[channel.number] = head + entries.tobytes()
            body.append(packed)
            size += len(packed)
            spans.append((int(times[0]), int(times[-1])))
            self._counts[channel.number] += len(part)
        data = b"".join(body)
        first, last = min(span[0] for span in spans), max(span[1] for span in spans)
        self._span = (first, last) if self._span is None else (min(first, self._span[0]), max(last, self._span[1]))
        compressed = self._zstd.compress(data)
        offset, length = self._record(
            records.Chunk(
                compression="zstd",
                data=compressed,
                message_start_time=first,
                message_end_time=last,
                uncompressed_crc=zlib.crc32(data),
                uncompressed_size=size,
            )
        )
        index_offsets = {number: self._put(index) for number, index in indexes.items()}
        self._repeated[Opcode.CHUNK_INDEX].append(
            records.ChunkIndex(
                chunk_length=length,
                chunk_start_offset=offset,
                compression="zstd",
                compressed_size=len(compressed),
                message_start_time=first,
                message_end_time=last,
                message_index_length=sum(map(len, indexes.values())),
                message_index_offsets=index_offsets,
                uncompressed_size=size,
            )
        )

    def finish(self) -> None:
        """Write the end of the data section, the summary and the footer, each with its checksum."""
        self._record(records.DataEnd(self._crc))
        first, last = self._span or (0, 0)
        self._repeated[Opcode.STATISTICS].append(
            records.Statistics(
                attachment_count=len(self._repeated[Opcode.ATTACHMENT_INDEX]),
                channel_count=len(self._repeated[Opcode.CHANNEL]),
                channel_message_counts=self._counts,
                chunk_count=len(self._repeated[Opcode.CHUNK_INDEX]),
                message_count=sum(self._counts.values()),
                metadata_count=len(self._repeated[Opcode.METADATA_INDEX]),
                message_start_time=first,
                message_end_time=last,
                schema_count=len(self._repeated[Opcode.SCHEMA]),
            )
        )
        start = self._offset
        summary = bytearray()
        offsets = bytearray()
        for opcode, group in self._repeated.items():
            data = b"".join(map(_bytes, group))
            if data:
                offsets += _bytes(
                    records.SummaryOffset(group_opcode=opcode, group_start=start + len(summary), group_length=len(data))
                )
            summary += data
        offset_start = start + len(summary)
        summary += offsets
        # The checksum of the summary covers the footer too, up to the checksum itself.
        summary += struct.pack("<BQQQ", Opcode.FOOTER, 20, start, offset_start)
        self._stream.write(summary + struct.pack("<I", zlib.crc32(summary)) + MCAP0_MAGIC)


def _bytes(record: records.McapRecord) -> bytes:
    builder = RecordBuilder()
    record.write(builder)
    return builder.end()
