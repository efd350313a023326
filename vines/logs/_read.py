"""Read a log: all of it, checked, or a :class:`~vines.errors.LogError`.

Every checksum of the file is compared (data section, chunks, summary, and the SHA-256 in the log's own status), so a
log that was cut or altered is never half read. Messages are decoded a run of equal ones at a time; what was packed
otherwise (by another writer of the same schema) goes through protobuf.
"""

from __future__ import annotations

import hashlib
import os
import struct
import zlib
from collections.abc import Mapping
from dataclasses import dataclass, field
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import zstandard
from google.protobuf.message import DecodeError
from mcap import records
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.stream_reader import CRCValidationError, get_chunk_data_stream

from vines.errors import FileMissingError, LogError
from vines.logs._channels import (
    CHANNELS,
    KINDS,
    PARAMETERS,
    PROVENANCE,
    RECOVERED,
    RUN,
    SAMPLE,
    SENSOR,
    STATUS,
    Channel,
    message_header,
)
from vines.logs._decode import decode, differing_fields, table
from vines.logs._foreign import foreign_tables
from vines.logs._frames import data_section, frames

if TYPE_CHECKING:
    import pyarrow as pa

__all__ = ["BROKEN", "Log", "read"]

_AGAIN = "`vines recover` saves what is intact, or make the run again"

BROKEN = (
    *(McapError, CRCValidationError, zstandard.ZstdError, DecodeError),
    *(struct.error, UnicodeDecodeError, ValueError, IndexError, MemoryError, OverflowError),
)
"""What the decoders raise on damaged bytes."""


@dataclass(frozen=True)
class Log:
    """A run as read from its log.

    Attributes
    ----------
    path : Path
        The file.
    name : str
        What the run is called.
    kind : str
        ``"run"`` of the simulator, ``"orbit"`` (one period of one), ``"rig"``, or ``"foreign"`` for an MCAP file that
        vines did not write.
    states, impacts, sticks : pyarrow.Table
        Columns as the fields of ``vines.v1.State``, ``Impact`` and ``Stick``, dimensionless; each column's
        metadata holds its ``unit`` and ``description``.
    orbits, base : pyarrow.Table
        The same of ``vines.v1.Orbit`` and, in SI units, ``BaseMotion``; without rows in most logs.
    sensors : dict of str to pyarrow.Table
        Samples of each sensor of a rig (``vines.v1.SensorSample``), SI; the table's metadata say what was measured.
    others : dict of str to pyarrow.Table
        Channels of a file that vines did not write, by topic, the log time in nanoseconds first.
    provenance : dict of str to str
        Where the numbers come from; what was not text is JSON.
    parameters : dict of str to float
        The parameters of the model.
    word : str
        The word of an orbit, else empty.
    attractor : str
        What the run settles to, if its writer knew.
    declaration : str or None
        The TOML text that declared the run.
    status : str
        ``"complete"`` for a run that its writer finished, ``"recovered"`` for one that ``vines recover`` salvaged,
        ``"unknown"`` where vines did not write the file.
    recovered : dict of str to str
        What was saved and what was lost, for a salvaged log.
    sha256 : str
        Digest of the file.
    """

    path: Path
    name: str
    kind: str
    states: pa.Table
    impacts: pa.Table
    sticks: pa.Table
    orbits: pa.Table
    base: pa.Table
    sensors: dict[str, pa.Table]
    others: dict[str, pa.Table]
    provenance: dict[str, str]
    parameters: dict[str, float]
    word: str
    attractor: str
    declaration: str | None
    status: str
    recovered: dict[str, str]
    sha256: str

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
    rows: dict[int, list[np.ndarray]] = field(default_factory=dict)
    foreign: dict[int, list[tuple[int, bytes]]] = field(default_factory=dict)


def read(path: str | os.PathLike[str]) -> Log:
    """Read a log whole.

    Parameters
    ----------
    path : path-like
        An MCAP file. Of one that vines did not write, the channels in protobuf and JSON become the tables `others`.

    Raises
    ------
    FileMissingError
        If there is no such file.
    LogError
        If it is damaged, cut short or unfinished, or has a channel that cannot be decoded.
    """
    file = Path(path)
    if not file.is_file():
        raise FileMissingError(f'there is no log {file}; `vines query "select path from logs"` lists the known ones')
    data = file.read_bytes()
    try:
        found = _walk(file, data)
    except LogError:
        raise
    except BROKEN as broken:
        raise LogError(f"{file} is damaged ({_line(broken)}); {_AGAIN}") from broken
    return _assemble(file, found, data)


def _line(error: Exception) -> str:
    return " ".join(str(error).split()) or type(error).__name__


def _walk(file: Path, data: bytes) -> _Found:
    """Check the frame of the file and go through the records of its data section."""
    found = _Found()
    start, stop = data_section(file, data, _AGAIN)
    # Before anything is looked at: what damage would look like, such as another version, it must not be called.
    if data[stop - 13 : stop - 4] == struct.pack("<BQ", Opcode.DATA_END, 4):
        (crc,) = struct.unpack_from("<I", data, stop - 4)
        if crc and crc != zlib.crc32(memoryview(data)[: stop - 13]):
            raise LogError(f"{file} is damaged: the checksum of its data does not fit; {_AGAIN}")
    finished = False
    ours = True
    for place, opcode, body in frames(data, start, stop):
        if finished:
            raise LogError(f"{file} is damaged: records follow the end of its data section; {_AGAIN}")
        if opcode == Opcode.METADATA:
            entry = records.Metadata.read(ReadDataStream(BytesIO(body)))
            found.metadata[entry.name] = entry.metadata
            written = entry.metadata.get("sha256")
            if entry.name == STATUS and written and written != hashlib.sha256(memoryview(data)[:place]).hexdigest():
                raise LogError(f"{file} is damaged: its SHA-256 does not fit; {_AGAIN}")
        elif opcode == Opcode.DATA_END:
            finished = True
        else:
            # Provenance comes first in a log of vines: without it the file is somebody else's.
            ours = ours and (opcode == Opcode.HEADER or PROVENANCE in found.metadata)
            _take(file, found, opcode, body, keep=not ours)
    if not finished:
        raise LogError(f"{file} is cut short: its data section has no end; {_AGAIN}")
    return found


def _take(file: Path, found: _Found, opcode: int, body: bytes, keep: bool) -> None:
    """Take one record of the data section, or of a chunk, into what was found; ``keep`` messages of any channel."""
    stream = ReadDataStream(BytesIO(body))
    if opcode == Opcode.ATTACHMENT:
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
        _messages(file, found, chunk.read(size), keep)
    elif opcode == Opcode.MESSAGE:
        _messages(file, found, struct.pack("<BQ", opcode, len(body)) + body, keep)


def _recognise(file: Path, found: _Found, topic: records.Channel) -> None:
    """Note a channel that carries one of our messages; refuse one whose schema differs from ours."""
    schema = found.schemas.get(topic.schema_id)
    if schema is None or topic.message_encoding != "protobuf":
        return
    if schema.name == SAMPLE:
        name = topic.topic.removeprefix(SENSOR)
        channel = Channel(topic.id, topic.topic, SAMPLE, "t", name, topic.metadata)
    elif schema.name in KINDS:
        channel = KINDS[schema.name]
    else:
        return
    differing = differing_fields(schema.data, schema.name)
    if differing:
        raise LogError(
            f"{file} was written with another version of {schema.name} (it lacks or changes {', '.join(differing)}); "
            "read it with the vines that wrote it"
        )
    found.known[topic.id] = channel


def _messages(file: Path, found: _Found, data: bytes, keep: bool) -> None:
    """Decode the records of a chunk, a run of message records of equal channel and length at a time."""
    start = 0
    while start < len(data):
        opcode, length = struct.unpack_from("<BQ", data, start)
        size = 9 + length
        if start + size > len(data):
            raise ValueError("a record in a chunk is longer than the chunk")
        if opcode != Opcode.MESSAGE:
            _take(file, found, opcode, data[start + 9 : start + size], keep)
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
            found.rows.setdefault(number, []).append(decode(raw[:, 31:], channel))
        elif keep:
            found.foreign.setdefault(number, []).extend(
                (int(heads["log_time"][k]), data[start + k * size + 31 : start + (k + 1) * size]) for k in range(count)
            )
        start += count * size


def _check_complete(file: Path, found: _Found, status: Mapping[str, str]) -> None:
    """Refuse a log of vines that was not finished, or lacks messages that its status counts."""
    if status.get("status") not in ("complete", "recovered"):
        raise LogError(f"{file} is incomplete: its writer did not finish it (no {STATUS} = complete); {_AGAIN}")
    for number in found.known:
        topic = found.topics[number].topic
        read_rows, written = sum(map(len, found.rows.get(number, []))), status.get(topic)
        if written is not None and written != str(read_rows):
            raise LogError(f"{file} is damaged: {read_rows} of {written} messages on {topic}; {_AGAIN}")
    if found.metadata.get(RUN, {}).get("kind", "run") != "rig" and status["status"] == "complete":
        for channel in CHANNELS:
            if channel not in found.known.values():
                raise LogError(f"{file} has no channel of {channel.message}; {_AGAIN}")


def _assemble(file: Path, found: _Found, data: bytes) -> Log:
    """Return the log, once everything that it should hold has been found."""
    ours = PROVENANCE in found.metadata
    status = found.metadata.get(STATUS, {} if ours else {"status": "unknown"})
    others: dict[str, pa.Table] = {}
    if ours:
        _check_complete(file, found, status)
    else:
        topics = {number: topic for number, topic in found.topics.items() if number not in found.known}
        others = foreign_tables(file, topics, found.schemas, found.foreign)
    try:
        parameters = {key: float(text) for key, text in found.metadata.get(PARAMETERS, {}).items()}
    except ValueError as unfit:
        raise LogError(f"{file} holds a parameter that is no number ({unfit}); {_AGAIN}") from None
    about = found.metadata.get(RUN, {})
    declaration = found.attachments.get("declaration.toml") if ours else None
    parts = {channel.message: [] for channel in KINDS.values()}
    sensors: dict[str, pa.Table] = {}
    for number, channel in found.known.items():
        if channel.message == SAMPLE:
            sensors[channel.key] = table(found.rows.get(number, []), channel)
        else:
            parts[channel.message] += found.rows.get(number, [])
    return Log(
        path=file,
        name=about.get("name", file.stem),
        kind=about.get("kind", "run") if ours else "foreign",
        provenance=found.metadata.get(PROVENANCE, {}),
        parameters=parameters,
        word=about.get("word", ""),
        attractor=about.get("attractor", ""),
        declaration=None if declaration is None else declaration.decode(),
        status=status["status"],
        recovered=found.metadata.get(RECOVERED, {}),
        sensors=sensors,
        others=others,
        sha256=hashlib.sha256(data).hexdigest(),
        **{channel.key: table(parts[channel.message], channel) for channel in KINDS.values()},
    )
