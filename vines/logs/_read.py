"""Read the MCAP log of a run: all of it, checked, or a :class:`~vines.errors.LogError`.

Every checksum of the file is compared (data section, chunks, summary), so a log that was cut or altered is
never half read. Messages are decoded a run of equal ones at a time; what was packed otherwise (by another
writer of the same schema) goes through protobuf.
"""

from __future__ import annotations

import os
import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass, field
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import zstandard
from google.protobuf.descriptor_pb2 import FileDescriptorSet
from google.protobuf.message import DecodeError
from mcap import records
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.stream_reader import CRCValidationError, get_chunk_data_stream
from mcap.writer import MCAP0_MAGIC

from vines.errors import FileMissingError, LogError
from vines.logs._channels import CHANNELS, PARAMETERS, PROVENANCE, RUN, STATUS, Channel, message_header
from vines.logs._decode import decode, table
from vines.schema import schema_bytes

if TYPE_CHECKING:
    import pyarrow as pa

__all__ = ["Log", "read"]

_FOOTER = struct.Struct("<BQQQI")
_AGAIN = "make the run again"


@dataclass(frozen=True)
class Log:
    """A run as read from its log.

    Attributes
    ----------
    path : Path
        The file.
    name : str
        What the run is called.
    states, impacts, sticks : pyarrow.Table
        Columns as the fields of ``vines.v1.State``, ``Impact`` and ``Stick``, dimensionless; each column's
        metadata holds its ``unit`` and ``description``.
    provenance : dict of str to str
        Where the numbers come from; what was not text is JSON.
    parameters : dict of str to float
        The parameters of the model.
    declaration : str or None
        The TOML text that declared the run.
    status : str
        ``"complete"`` for a run that its writer finished.
    """

    path: Path
    name: str
    states: pa.Table
    impacts: pa.Table
    sticks: pa.Table
    provenance: dict[str, str]
    parameters: dict[str, float]
    declaration: str | None
    status: str

    @property
    def complete(self) -> bool:
        """Whether the writer finished the run."""
        return self.status == "complete"


@dataclass
class _Found:
    """What has been met in a file so far."""

    metadata: dict[str, dict[str, str]] = field(default_factory=dict)
    attachments: dict[str, bytes] = field(default_factory=dict)
    schemas: dict[int, records.Schema] = field(default_factory=dict)
    topics: dict[int, records.Channel] = field(default_factory=dict)
    known: dict[int, Channel] = field(default_factory=dict)
    rows: dict[str, list[np.ndarray]] = field(default_factory=lambda: {channel.key: [] for channel in CHANNELS})


def read(path: str | os.PathLike[str]) -> Log:
    """Read a log whole.

    Parameters
    ----------
    path : path-like
        An MCAP file that :func:`vines.logs.write_run` wrote, or that holds the same messages and metadata.

    Raises
    ------
    FileMissingError
        If there is no such file.
    LogError
        If it is damaged, cut short or unfinished, or is not a log of vines.
    """
    file = Path(path)
    if not file.is_file():
        raise FileMissingError(f'there is no log {file}; `vines query "select path from logs"` lists the known ones')
    data = file.read_bytes()
    try:
        found = _walk(file, data)
    except LogError:
        raise
    except (
        *(McapError, CRCValidationError, zstandard.ZstdError, DecodeError),
        *(struct.error, UnicodeDecodeError, ValueError, IndexError, MemoryError, OverflowError),
    ) as broken:
        raise LogError(f"{file} is damaged ({_line(broken)}); {_AGAIN}") from broken
    return _assemble(file, found)


def _line(error: Exception) -> str:
    return " ".join(str(error).split()) or type(error).__name__


def _walk(file: Path, data: bytes) -> _Found:
    """Check the frame of the file and go through the records of its data section."""
    if not data.startswith(MCAP0_MAGIC):
        raise LogError(f"{file} is not an MCAP file (it begins with {data[:8]!r}); a log of vines ends in .mcap")
    tail = len(data) - len(MCAP0_MAGIC)
    footer = tail - _FOOTER.size
    if footer < len(MCAP0_MAGIC) or data[tail:] != MCAP0_MAGIC:
        raise LogError(f"{file} is cut short: {len(data)} bytes and no end mark; {_AGAIN}")
    opcode, length, summary, _, crc = _FOOTER.unpack_from(data, footer)
    if (opcode, length) != (Opcode.FOOTER, 20):
        raise LogError(f"{file} is damaged: no footer before the end mark; {_AGAIN}")
    if summary and crc and crc != zlib.crc32(data[summary : tail - 4]):
        raise LogError(f"{file} is damaged: the checksum of its summary does not fit; {_AGAIN}")

    found = _Found()
    finished = 0
    for start, opcode, body in _frames(data, len(MCAP0_MAGIC), summary or footer):
        if finished:
            raise LogError(f"{file} is damaged: records follow the end of its data section; {_AGAIN}")
        if opcode == Opcode.DATA_END:
            finished = start
            (crc,) = struct.unpack("<I", body)
            if crc and crc != zlib.crc32(data[:start]):
                raise LogError(f"{file} is damaged: the checksum of its data does not fit; {_AGAIN}")
        else:
            _take(file, found, opcode, body)
    if not finished:
        raise LogError(f"{file} is cut short: its data section has no end; {_AGAIN}")
    return found


def _frames(data: bytes, start: int, stop: int) -> Iterator[tuple[int, int, bytes]]:
    """Yield the place, opcode and content of each record between two places."""
    while start < stop:
        opcode, length = struct.unpack_from("<BQ", data, start)
        if start + 9 + length > stop:
            raise ValueError(f"a record at byte {start} is longer than the file")
        yield start, opcode, data[start + 9 : start + 9 + length]
        start += 9 + length


def _take(file: Path, found: _Found, opcode: int, body: bytes) -> None:
    """Take one record of the data section, or of a chunk, into what was found."""
    stream = ReadDataStream(BytesIO(body))
    if opcode == Opcode.METADATA:
        entry = records.Metadata.read(stream)
        found.metadata[entry.name] = entry.metadata
    elif opcode == Opcode.ATTACHMENT:
        attachment = records.Attachment.read(stream)
        found.attachments[attachment.name] = attachment.data
    elif opcode == Opcode.SCHEMA:
        schema = records.Schema.read(stream)
        found.schemas[schema.id] = schema
    elif opcode == Opcode.CHANNEL:
        topic = records.Channel.read(stream)
        found.topics[topic.id] = topic
        _recognise(file, found, topic)
    elif opcode == Opcode.CHUNK:
        chunk, size = get_chunk_data_stream(records.Chunk.read(stream), validate_crc=True)
        _messages(file, found, chunk.read(size))
    elif opcode == Opcode.MESSAGE:
        _messages(file, found, struct.pack("<BQ", opcode, len(body)) + body)


def _recognise(file: Path, found: _Found, topic: records.Channel) -> None:
    """Note a channel that carries one of our messages; refuse one whose schema differs from ours."""
    schema = found.schemas.get(topic.schema_id)
    channel = next((each for each in CHANNELS if schema and schema.name == each.message), None)
    if schema is None or channel is None or topic.message_encoding != "protobuf":
        return
    ours, theirs = _fields(schema_bytes(channel.message), schema.name), _fields(schema.data, schema.name)
    if ours - theirs:
        differing = ", ".join(sorted(name for name, *_ in ours - theirs))
        raise LogError(
            f"{file} was written with another version of {schema.name} (it lacks or changes {differing}); "
            "read it with the vines that wrote it"
        )
    found.known[topic.id] = channel


def _fields(descriptors: bytes, message: str) -> set[tuple[str, int, int]]:
    """Return name, number and type of the fields of a message in a serialised FileDescriptorSet."""
    return {
        (each.name, each.number, each.type)
        for file in FileDescriptorSet.FromString(descriptors).file
        for kind in file.message_type
        if f"{file.package}.{kind.name}" == message
        for each in kind.field
    }


def _messages(file: Path, found: _Found, data: bytes) -> None:
    """Decode the records of a chunk, a run of message records of equal channel and length at a time."""
    start = 0
    while start < len(data):
        opcode, length = struct.unpack_from("<BQ", data, start)
        size = 9 + length
        if start + size > len(data):
            raise ValueError("a record in a chunk is longer than the chunk")
        if opcode != Opcode.MESSAGE:
            _take(file, found, opcode, data[start + 9 : start + size])
            start += size
            continue
        if length < 22:
            raise ValueError("a message record is shorter than its header")
        heads = np.frombuffer(data, message_header(length - 22), (len(data) - start) // size, start)
        number = int(heads["channel"][0])
        if number not in found.topics:
            raise ValueError(f"a message belongs to channel {number}, which is not described")
        equal = (heads["opcode"] == opcode) & (heads["length"] == length) & (heads["channel"] == number)
        count = len(equal) if equal.all() else int(np.argmin(equal))
        channel = found.known.get(number)
        if channel is not None:
            raw = np.frombuffer(data, np.uint8, count * size, start).reshape(count, size)
            found.rows[channel.key].append(decode(raw[:, 31:], channel))
        start += count * size


def _assemble(file: Path, found: _Found) -> Log:
    """Return the log, once everything that makes a log of vines has been found."""
    if PROVENANCE not in found.metadata:
        topics = ", ".join(sorted(f"{topic.topic} ({topic.message_encoding})" for topic in found.topics.values()))
        raise LogError(
            f"{file} is an MCAP file but no log of vines: it has no metadata record {PROVENANCE!r}; "
            f"its channels: {topics or 'none'}"
        )
    status = found.metadata.get(STATUS)
    if status is None or status.get("status") != "complete":
        raise LogError(f"{file} is incomplete: its writer did not finish it (no {STATUS} = complete); {_AGAIN}")
    for channel in CHANNELS:
        if channel not in found.known.values():
            raise LogError(f"{file} has no channel of {channel.message}; {_AGAIN}")
        read_rows, written = sum(map(len, found.rows[channel.key])), status.get(channel.topic)
        if written is not None and written != str(read_rows):
            raise LogError(f"{file} is damaged: {read_rows} of {written} messages on {channel.topic}; {_AGAIN}")
    try:
        parameters = {key: float(text) for key, text in found.metadata.get(PARAMETERS, {}).items()}
    except ValueError as unfit:
        raise LogError(f"{file} holds a parameter that is no number ({unfit}); {_AGAIN}") from None
    declaration = found.attachments.get("declaration.toml")
    return Log(
        path=file,
        name=found.metadata.get(RUN, {}).get("name", file.stem),
        provenance=found.metadata[PROVENANCE],
        parameters=parameters,
        declaration=None if declaration is None else declaration.decode(),
        status=status["status"],
        **{channel.key: table(found.rows[channel.key], channel) for channel in CHANNELS},
    )
