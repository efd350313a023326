"""One chunk of an MCAP file: its messages compressed, with checksum and message indexes."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import zstandard
from mcap import records
from mcap.opcode import Opcode

from vines.logs._channels import Rows
from vines.logs._pack import pack

__all__ = ["Packed", "packed", "repacked"]


@dataclass(frozen=True)
class Packed:
    """A chunk that is ready to be written.

    Attributes
    ----------
    record : mcap.records.Chunk
        The record.
    indexes : dict of int to bytes
        The message index record of each channel.
    counts : dict of int to int
        Messages of each channel.
    """

    record: records.Chunk
    indexes: dict[int, bytes]
    counts: dict[int, int]


def packed(parts: Sequence[Rows]) -> Packed:
    """Pack and compress rows as one chunk; free of shared state, so that several can be made at once."""
    body: list[bytes] = []
    indexes: dict[int, bytes] = {}
    size = 0
    for rows in parts:
        data = pack(rows)
        indexes[rows.channel.number] = _index(
            rows.channel.number, rows.times, size + rows.width * np.arange(len(rows), dtype=np.uint64)
        )
        body.append(data)
        size += len(data)
    data = b"".join(body)
    record = records.Chunk(
        compression="zstd",
        data=zstandard.ZstdCompressor(level=3).compress(data),
        message_start_time=min(int(rows.times[0]) for rows in parts),
        message_end_time=max(int(rows.times[-1]) for rows in parts),
        uncompressed_crc=zlib.crc32(data),
        uncompressed_size=size,
    )
    return Packed(record, indexes, {rows.channel.number: len(rows) for rows in parts})


def repacked(messages: Sequence[bytes]) -> Packed:
    """Return message records, whole and with their heads, as one chunk."""
    places: dict[int, list[tuple[int, int]]] = {}
    size = 0
    for message in messages:
        number, time = struct.unpack_from("<H4xQ", message, 9)
        places.setdefault(number, []).append((time, size))
        size += len(message)
    data = b"".join(messages)
    times = [time for entries in places.values() for time, _ in entries]
    indexes = {}
    for number, entries in places.items():
        by_time = np.array(sorted(entries), np.uint64)
        indexes[number] = _index(number, by_time[:, 0], by_time[:, 1])
    record = records.Chunk(
        compression="zstd",
        data=zstandard.ZstdCompressor(level=3).compress(data),
        message_start_time=min(times),
        message_end_time=max(times),
        uncompressed_crc=zlib.crc32(data),
        uncompressed_size=size,
    )
    return Packed(record, indexes, {number: len(entries) for number, entries in places.items()})


def _index(number: int, times: np.ndarray, offsets: np.ndarray) -> bytes:
    """Return a message index record."""
    entries = np.empty((len(times), 2), "<u8")
    entries[:, 0] = times
    entries[:, 1] = offsets
    return struct.pack("<BQHI", Opcode.MESSAGE_INDEX, 6 + entries.nbytes, number, entries.nbytes) + entries.tobytes()
