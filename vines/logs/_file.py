"""An MCAP file in the making: its records, checksums, indexes and summary.

Chunks come as numpy arrays of whole message records, past the writer of the mcap package, which makes one
Python call a message; the small records (schemas, indexes, statistics) are that package's own. The tests read
every byte back through its reader with CRC validation.
"""

from __future__ import annotations

import hashlib
import struct
import zlib
from collections import Counter, deque
from collections.abc import Iterable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from itertools import accumulate
from typing import BinaryIO

from mcap import records
from mcap.opcode import Opcode
from mcap.writer import MCAP0_MAGIC

from vines.logs._channels import CONTENT, DIGESTS, STATUS, Channel
from vines.logs._chunk import Packed, packed
from vines.logs._digests import bytes_of, description, sealed
from vines.logs._pack import Placed

__all__ = ["LogFile"]

_AT_ONCE = 2
"""Chunks that are packed and compressed at the same time; the bytes of the file do not depend on it."""


class LogFile:
    """An MCAP file that is being written, with what its summary will say."""

    def __init__(self, stream: BinaryIO, profile: str = ""):
        self._stream = stream
        self._offset = 0
        self._crc = 0
        self._repeated: dict[Opcode, list[bytes]] = {
            opcode: []
            for opcode in (
                *(Opcode.SCHEMA, Opcode.CHANNEL, Opcode.STATISTICS),
                *(Opcode.CHUNK_INDEX, Opcode.ATTACHMENT_INDEX, Opcode.METADATA_INDEX),
            )
        }
        self._counts: Counter[int] = Counter()
        self._span: tuple[int, int] | None = None
        self._sha = hashlib.sha256()
        self._digests: dict[str, str] = {}
        self._schemas: dict[int, records.Schema] = {}
        self._descriptions: dict[str, str] = {}
        self._contents: dict[int, hashlib._Hash] = {}
        self._topics: dict[int, str] = {}
        self._put(MCAP0_MAGIC)
        self._record(records.Header(profile=profile, library="vines"))

    def _put(self, data: bytes) -> int:
        """Write bytes of the data section; return where they begin."""
        start = self._offset
        self._stream.write(data)
        self._crc = zlib.crc32(data, self._crc)
        self._sha.update(data)
        self._offset += len(data)
        return start

    def _record(self, record: records.McapRecord) -> tuple[int, bytes]:
        """Write a small record; return where it begins and its bytes."""
        data = bytes_of(record)
        return self._put(data), data

    def _repeat(self, opcode: Opcode, record: records.McapRecord) -> None:
        self._repeated[opcode].append(bytes_of(record))

    def metadata(self, name: str, values: dict[str, str]) -> None:
        # Sorted, as other programs write them: the digest of the record then stays when one rewrites the log.
        record = records.Metadata(name=name, metadata=dict(sorted(values.items())))
        offset, written = self._record(record)
        self._digests[name] = _digest(written)
        self._repeat(Opcode.METADATA_INDEX, records.MetadataIndex(offset=offset, length=len(written), name=name))

    def attachment(self, name: str, media_type: str, data: bytes) -> None:
        record = records.Attachment(create_time=0, log_time=0, name=name, media_type=media_type, data=data)
        offset, written = self._record(record)
        self._digests[name] = _digest(written)
        index = records.AttachmentIndex(
            offset=offset,
            length=len(written),
            log_time=0,
            create_time=0,
            data_size=len(data),
            name=name,
            media_type=media_type,
        )
        self._repeat(Opcode.ATTACHMENT_INDEX, index)

    def channel(self, channel: Channel) -> None:
        """Describe a channel of vines."""
        encoding, data = channel.described()
        self.schema(records.Schema(id=channel.number, data=data, encoding=encoding, name=channel.message))
        self.topic(
            records.Channel(
                id=channel.number,
                topic=channel.topic,
                message_encoding=channel.encoding,
                metadata=dict(channel.metadata),
                schema_id=channel.number,
            )
        )

    def schema(self, record: records.Schema) -> None:
        self._schemas[record.id] = record
        self._describe(Opcode.SCHEMA, record, f"schema {record.id} {record.name}")

    def topic(self, record: records.Channel) -> None:
        self._counts[record.id] += 0
        described = description(record, self._schemas.get(record.schema_id))
        self._topics[record.id] = record.topic
        self._descriptions[f"description of {record.topic}"] = described
        self._contents[record.id] = hashlib.sha256(described.encode())
        self._describe(Opcode.CHANNEL, record, f"channel {record.id} {record.topic}")

    def _describe(self, opcode: Opcode, record: records.McapRecord, name: str) -> None:
        _, written = self._record(record)
        self._digests[name] = _digest(written)
        self._repeated[opcode].append(written)

    def digests(self) -> None:
        """Write the SHA-256 of each record so far, and one of these."""
        self.metadata(DIGESTS, sealed(DIGESTS, self._digests))

    def status(self, status: str, counts: dict[str, str]) -> None:
        """Write what the channels say, as digests, and the status: the last, with the SHA-256 of all before it."""
        contents = {self._topics[number]: sha.hexdigest() for number, sha in self._contents.items()}
        self.metadata(CONTENT, sealed(CONTENT, {**contents, **self._descriptions}))
        self.metadata(STATUS, {"status": status, **counts, "sha256": self._sha.hexdigest()})

    def chunks(self, every: Iterable[Sequence[Placed]]) -> None:
        """Write chunks in their order; packing and compressing runs ahead in threads."""
        waiting: deque[Future[Packed]] = deque()
        with ThreadPoolExecutor(_AT_ONCE) as pool:
            for parts in every:
                waiting.append(pool.submit(packed, parts))
                if len(waiting) > 2 * _AT_ONCE:
                    self.chunk(waiting.popleft().result())
            while waiting:
                self.chunk(waiting.popleft().result())

    def chunk(self, made: Packed) -> None:
        """Write one chunk and its message indexes."""
        record = made.record
        first, last = record.message_start_time, record.message_end_time
        self._span = (first, last) if self._span is None else (min(first, self._span[0]), max(last, self._span[1]))
        self._counts.update(made.counts)
        for number, content in made.contents.items():
            self._contents[number].update(content)
        # Packed here and written at once: there are many, and records of mcap are put together field by field.
        name = record.compression.encode()
        sizes = (record.uncompressed_size, record.uncompressed_crc, len(name), name, len(record.data))
        body = struct.pack(f"<QQQII{len(name)}sQ", first, last, *sizes)
        head = struct.pack("<BQ", Opcode.CHUNK, len(body) + len(record.data)) + body
        length = len(head) + len(record.data)
        offset = self._put(b"".join((head, record.data, *made.indexes.values())))
        ends = [offset + length + end for end in accumulate(map(len, made.indexes.values()), initial=0)]
        places = b"".join(struct.pack("<HQ", *each) for each in zip(made.indexes, ends, strict=False))
        sizes = (ends[-1] - ends[0], len(name), name, len(record.data), record.uncompressed_size)
        index = struct.pack("<QQQQI", first, last, offset, length, len(places)) + places
        index += struct.pack(f"<QI{len(name)}sQQ", *sizes)
        self._repeated[Opcode.CHUNK_INDEX].append(struct.pack("<BQ", Opcode.CHUNK_INDEX, len(index)) + index)

    def finish(self) -> None:
        """Write the end of the data section, the summary and the footer, each with its checksum."""
        self._record(records.DataEnd(self._crc))
        first, last = self._span or (0, 0)
        self._repeat(
            Opcode.STATISTICS,
            records.Statistics(
                attachment_count=len(self._repeated[Opcode.ATTACHMENT_INDEX]),
                channel_count=len(self._repeated[Opcode.CHANNEL]),
                channel_message_counts=dict(self._counts),
                chunk_count=len(self._repeated[Opcode.CHUNK_INDEX]),
                message_count=self._counts.total(),
                metadata_count=len(self._repeated[Opcode.METADATA_INDEX]),
                message_start_time=first,
                message_end_time=last,
                schema_count=len(self._repeated[Opcode.SCHEMA]),
            ),
        )
        start = self._offset
        summary = bytearray()
        offsets = bytearray()
        for opcode, group in self._repeated.items():
            data = b"".join(group)
            if data:
                offsets += bytes_of(
                    records.SummaryOffset(group_opcode=opcode, group_start=start + len(summary), group_length=len(data))
                )
            summary += data
        offset_start = start + len(summary)
        summary += offsets
        # The checksum of the summary covers the footer too, up to the checksum itself.
        summary += struct.pack("<BQQQ", Opcode.FOOTER, 20, start, offset_start)
        self._stream.write(summary + struct.pack("<I", zlib.crc32(summary)) + MCAP0_MAGIC)


def _digest(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()
