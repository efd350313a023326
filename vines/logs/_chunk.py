"""One chunk of an MCAP file: its messages in the order of time, compressed, with checksum and message indexes."""

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
from vines.logs._digests import entries, entry
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
    contents : dict of int to bytes
        What the messages of each channel say, for the digest of its content.
    """

    record: records.Chunk
    indexes: dict[int, bytes]
    counts: dict[int, int]
    contents: dict[int, bytes]


def packed(parts: Sequence[Rows]) -> Packed:
    """Pack and compress rows as one chunk; free of shared state, so that several can be made at once."""
    blocks = [pack(rows) for rows in parts]
    messages = [message for block in blocks for message in _split(block)]
    order = np.argsort(np.concatenate([rows.times for rows in parts]), kind="stable")
    contents = {rows.channel.number: entries(block).tobytes() for rows, block in zip(parts, blocks, strict=True)}
    return _closed([messages[place] for place in order.tolist()], contents)


def _split(block: np.ndarray) -> list[bytes]:
    data, width = block.tobytes(), block.shape[1]
    return [data[start : start + width] for start in range(0, len(data), width)]


def repacked(messages: Sequence[bytes]) -> Packed:
    """Return message records, whole and with their heads and in the order of time, as one chunk."""
    said: dict[int, list[bytes]] = {}
    for message in messages:
        (number,) = struct.unpack_from("<H", message, 9)
        said.setdefault(number, []).append(entry(message))
    return _closed(messages, {number: b"".join(each) for number, each in said.items()})


def _closed(messages: Sequence[bytes], contents: dict[int, bytes]) -> Packed:
    """Return messages as a chunk."""
    data = b"".join(messages)
    sizes = np.array([len(message) for message in messages], np.int64)
    offsets = np.cumsum(sizes) - sizes
    raw = np.frombuffer(data, np.uint8)
    numbers = raw[offsets[:, None] + np.arange(9, 11)].view("<u2")[:, 0]
    times = raw[offsets[:, None] + np.arange(15, 23)].view("<u8")[:, 0]
    indexes = {
        int(number): _index(int(number), times[numbers == number], offsets[numbers == number])
        for number in np.unique(numbers)
    }
    record = records.Chunk(
        compression="zstd",
        data=zstandard.ZstdCompressor(level=3).compress(data),
        message_start_time=int(times.min()),
        message_end_time=int(times.max()),
        uncompressed_crc=zlib.crc32(data),
        uncompressed_size=len(data),
    )
    counts = {int(number): int(count) for number, count in zip(*np.unique(numbers, return_counts=True), strict=True)}
    return Packed(record, indexes, counts, contents)


def _index(number: int, times: np.ndarray, offsets: np.ndarray) -> bytes:
    """Return a message index record."""
    pairs = np.empty((len(times), 2), "<u8")
    pairs[:, 0] = times
    pairs[:, 1] = offsets
    return struct.pack("<BQHI", Opcode.MESSAGE_INDEX, 6 + pairs.nbytes, number, pairs.nbytes) + pairs.tobytes()
