"""One chunk of an MCAP file: its messages in the order of time, compressed, with checksum and message indexes."""

from __future__ import annotations

import struct
import threading
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import zstandard
from mcap import records
from mcap.opcode import Opcode

from vines.logs._digests import entries, entry
from vines.logs._pack import Placed, pack

__all__ = ["Packed", "packed", "repacked"]

_own = threading.local()


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
    contents : mapping of int to bytes or memoryview
        What the messages of each channel say, for the digest of its content.
    """

    record: records.Chunk
    indexes: dict[int, bytes]
    counts: dict[int, int]
    contents: Mapping[int, bytes | memoryview]


def packed(parts: Sequence[Placed]) -> Packed:
    """Pack and compress rows as one chunk; free of shared state, so that several can be made at once."""
    data = np.empty(sum(len(rows) * rows.width for rows, _ in parts), np.uint8)
    contents: dict[int, bytes | memoryview] = {}
    places: dict[int, tuple[np.ndarray, np.ndarray]] = {}
    for rows, begin in parts:
        block, number = pack(rows), rows.channel.number
        # Whole records as the items of an array that begins one at each byte: put down many at a time.
        record = np.dtype(f"V{rows.width}")
        np.ndarray(len(data) - rows.width + 1, record, data, strides=(1,))[begin] = block.view(record)[:, 0]
        contents[number], places[number] = entries(block).data, (rows.times, begin)
    return _closed(data.data, places, contents)


def repacked(messages: Sequence[bytes]) -> Packed:
    """Return message records, whole and with their heads and in the order of time, as one chunk."""
    said: dict[int, list[bytes]] = {}
    places: dict[int, list[tuple[int, int]]] = {}
    offset = 0
    for message in messages:
        number, time = struct.unpack_from("<H4xQ", message, 9)
        said.setdefault(number, []).append(entry(message))
        places.setdefault(number, []).append((time, offset))
        offset += len(message)
    contents = {number: b"".join(each) for number, each in said.items()}
    indexed = {number: np.array(each, np.uint64) for number, each in places.items()}
    return _closed(b"".join(messages), {number: (each[:, 0], each[:, 1]) for number, each in indexed.items()}, contents)


def _closed(
    data: bytes | memoryview,
    places: Mapping[int, tuple[np.ndarray, np.ndarray]],
    contents: Mapping[int, bytes | memoryview],
) -> Packed:
    """Return messages as a chunk, given log times and offsets of those of each channel in their order."""
    record = records.Chunk(
        compression="zstd",
        data=_compressed(data),
        message_start_time=min(int(times[0]) for times, _ in places.values()),
        message_end_time=max(int(times[-1]) for times, _ in places.values()),
        uncompressed_crc=zlib.crc32(data),
        uncompressed_size=len(data),
    )
    indexes = {number: _index(number, *places[number]) for number in sorted(places)}
    counts = {number: len(times) for number, (times, _) in places.items()}
    return Packed(record, indexes, counts, contents)


def _compressed(data: bytes | memoryview) -> bytes:
    """Compress with the compressor of this thread: making one takes about as long as compressing a chunk."""
    if not hasattr(_own, "compressor"):
        _own.compressor = zstandard.ZstdCompressor(level=3)
    return _own.compressor.compress(data)


def _index(number: int, times: np.ndarray, offsets: np.ndarray) -> bytes:
    """Return a message index record."""
    pairs = np.empty((len(times), 2), "<u8")
    pairs[:, 0] = times
    pairs[:, 1] = offsets
    return struct.pack("<BQHI", Opcode.MESSAGE_INDEX, 6 + pairs.nbytes, number, pairs.nbytes) + pairs.tobytes()
