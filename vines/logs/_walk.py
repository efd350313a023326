"""Go through an MCAP file: check its frame and its checksums, and take what is in it, not yet decoded."""

from __future__ import annotations

import hashlib
import struct
import zlib
from collections import defaultdict
from dataclasses import dataclass, field
from io import BytesIO
from pathlib import Path

import zstandard
from google.protobuf.message import DecodeError
from mcap import records
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode

from vines.errors import ChunkError, LogError
from vines.logs._channels import OURS, STATUS
from vines.logs._contents import Messages, gather, split
from vines.logs._frames import data_section, frames, indexed
from vines.logs._unpack import Unpacker

__all__ = ["AGAIN", "BROKEN", "Found", "line_of", "walk"]

AGAIN = "`vines recover` saves what is intact, or make the run again"

BROKEN = (
    *(McapError, zstandard.ZstdError, DecodeError, struct.error, UnicodeDecodeError, ValueError, IndexError),
    *(MemoryError, OverflowError, RecursionError, RuntimeError),
)
"""What the decoders raise on damaged bytes; that of lz4 raises RuntimeError."""


@dataclass
class Found:
    """What is in a file.

    Attributes
    ----------
    library : str
        The program that wrote it, as its header says.
    metadata : dict of str to dict of str to str
        By name.
    attachments : dict of str to mcap.records.Attachment
        By name.
    schemas, topics : dict of int
        By their numbers in the file.
    messages : dict of int to Messages
        By the number of their channel.
    sha256 : str
        Digest of the file.
    sha_fits : bool or None
        Whether the SHA-256 in the status is that of the bytes before it; None if there is none.
    covered : bool
        Whether a checksum covers every message: that of its chunk, or that of the whole data.
    """

    library: str = ""
    metadata: dict[str, dict[str, str]] = field(default_factory=dict)
    attachments: dict[str, records.Attachment] = field(default_factory=dict)
    schemas: dict[int, records.Schema] = field(default_factory=dict)
    topics: dict[int, records.Channel] = field(default_factory=dict)
    messages: defaultdict[int, Messages] = field(default_factory=lambda: defaultdict(Messages))
    sha256: str = ""
    sha_fits: bool | None = None
    covered: bool = True

    def count(self, number: int) -> int:
        """Return how many messages a channel has."""
        return len(self.messages[number]) if number in self.messages else 0

    def schema(self, number: int) -> records.Schema | None:
        """Return the schema of a channel, if it has one."""
        return self.schemas.get(self.topics[number].schema_id)

    def digest(self, number: int) -> str:
        """Return the SHA-256 of what a channel says."""
        return self.messages[number].digest(self.topics[number], self.schema(number))


def line_of(error: BaseException) -> str:
    """Return what an error says as one line."""
    return " ".join(str(error).split()) or type(error).__name__


def walk(file: Path, data: bytes, unpacker: Unpacker) -> Found:
    """Check the frame of a file and go through the records of its data section.

    Raises
    ------
    LogError
        If it is no MCAP file, or its frame, a checksum or a record is damaged.
    ChunkError
        If a chunk is compressed in an unknown way, or takes more memory than is allowed.
    """
    try:
        return _walk(file, data, unpacker)
    except ChunkError as refused:
        raise ChunkError(f"{file}: {refused}") from refused
    except LogError:
        raise
    except BROKEN as broken:
        raise LogError(f"{file} is damaged ({line_of(broken)}); {AGAIN}") from broken


def _walk(file: Path, data: bytes, unpacker: Unpacker) -> Found:
    found = Found()
    start, stop = data_section(file, data, AGAIN)
    crc = 0
    # Before anything is looked at: what damage would look like, such as another version, it must not be called.
    if data[stop - 13 : stop - 4] == struct.pack("<BQ", Opcode.DATA_END, 4):
        (crc,) = struct.unpack_from("<I", data, stop - 4)
        if crc and crc != zlib.crc32(memoryview(data)[: stop - 13]):
            raise LogError(f"{file} is damaged: the checksum of its data does not fit; {AGAIN}")
    sha, hashed = hashlib.sha256(), 0
    finished = False
    alone: dict[tuple[int, int], list[int]] = {}
    # Grows with every piece, so that places in chunks and outside of them follow each other.
    before = 0
    for place, opcode, body in frames(data, start, stop):
        if finished:
            raise LogError(f"{file} is damaged: records follow the end of its data section; {AGAIN}")
        if opcode == Opcode.MESSAGE:
            if len(body) < 22:
                raise ValueError("a message record is shorter than its header")
            found.covered = found.covered and crc != 0
            (number,) = struct.unpack_from("<H", body)
            alone.setdefault((number, len(body)), []).append(place)
            continue
        if opcode == Opcode.CHUNK:
            gather(found.messages, data, alone, before)
            alone, before = {}, before + len(data)
            chunk = records.Chunk.read(ReadDataStream(BytesIO(body)))
            inside = unpacker.unpack(chunk)
            found.covered = found.covered and (crc != 0 or chunk.uncompressed_crc != 0)
            places, described = split(inside, indexed(data, place + 9 + len(body), stop))
            for kind, content in described:
                _take(found, kind, content)
            gather(found.messages, inside, places, before)
            before += len(inside)
        elif opcode == Opcode.METADATA:
            sha.update(memoryview(data)[hashed:place])
            hashed = place
            _metadata(file, found, body, sha.hexdigest())
        elif opcode == Opcode.DATA_END:
            finished = True
        else:
            _take(found, opcode, body)
    if not finished:
        raise LogError(f"{file} is cut short: its data section has no end; {AGAIN}")
    gather(found.messages, data, alone, before)
    sha.update(memoryview(data)[hashed:])
    found.sha256 = sha.hexdigest()
    undescribed = sorted(set(found.messages) - set(found.topics))
    if undescribed:
        raise ValueError(f"a message belongs to channel {undescribed[0]}, which is not described")
    return found


def _metadata(file: Path, found: Found, body: bytes, sha256: str) -> None:
    """Take a metadata record, given the SHA-256 of what stands before it."""
    entry = records.Metadata.read(ReadDataStream(BytesIO(body)))
    if entry.name.startswith(OURS) and found.metadata.get(entry.name, entry.metadata) != entry.metadata:
        raise LogError(
            f"{file} holds two records {entry.name} that differ, as if logs of several runs had been merged; "
            "vines does not guess which messages belong to which, read the logs one by one"
        )
    found.metadata[entry.name] = entry.metadata
    written = entry.metadata.get("sha256")
    if entry.name == STATUS and written:
        found.sha_fits = written == sha256


def _take(found: Found, opcode: int, body: bytes) -> None:
    """Take one record that is neither metadata nor messages."""
    stream = ReadDataStream(BytesIO(body))
    if opcode == Opcode.HEADER:
        found.library = records.Header.read(stream).library
    elif opcode == Opcode.ATTACHMENT:
        attachment = records.Attachment.read(stream)
        found.attachments[attachment.name] = attachment
    elif opcode == Opcode.SCHEMA:
        schema = records.Schema.read(stream)
        if found.schemas.setdefault(schema.id, schema) != schema:
            raise ValueError(f"schema {schema.id} is described twice, and not alike")
    elif opcode == Opcode.CHANNEL:
        topic = records.Channel.read(stream)
        if found.topics.setdefault(topic.id, topic) != topic:
            raise ValueError(f"channel {topic.id} is described twice, and not alike")
