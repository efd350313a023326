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
    times = np.concatenate([rows.times for rows in parts])
    numbers = np.repeat([rows.channel.number for rows in parts], [len(rows) for rows in parts])
    sizes = np.repeat([rows.width for rows in parts], [len(rows) for rows in parts])
    contents = {rows.channel.number: entries(block).tobytes() for rows, block in zip(parts, blocks, strict=True)}
    if len(parts) == 1:
        return _closed(blocks[0].tobytes(), numbers, times, sizes, contents)
    messages = [message for block in blocks for message in _split(block)]
    order = np.argsort(times, kind="stable")
    data = b"".join([messages[place] for place in order.tolist()])
    return _closed(data, numbers[order], times[order], sizes[order], contents)


def _split(block: np.ndarray) -> list[bytes]:
    data, width = block.tobytes(), block.shape[1]
    return [data[start : start + width] for start in range(0, len(data), width)]


def repacked(messages: Sequence[bytes]) -> Packed:
    """Return message records, whole and with their heads and in the order of time, as one chunk."""
    said: dict[int, list[bytes]] = {}
    heads = [struct.unpack_from("<H4xQ", message, 9) for message in messages]
    for (number, _), message in zip(heads, messages, strict=True):
        said.setdefault(number, []).append(entry(message))
    numbers, times = (np.array(each) for each in zip(*heads, strict=True))
    sizes = np.array([len(message) for message in messages])
    contents = {number: b"".join(each) for number, each in said.items()}
    return _closed(b"".join(messages), numbers, times, sizes, contents)


def _closed(
    data: bytes, numbers: np.ndarray, times: np.ndarray, sizes: np.ndarray, contents: dict[int, bytes]
) -> Packed:
    """Return messages as a chunk, given the channel, log time and length of each in their order."""
    offsets = np.cumsum(sizes) - sizes
    indexes: dict[int, bytes] = {}
    counts: dict[int, int] = {}
    for number in sorted(contents):
        own = numbers == number
        indexes[number] = _index(number, times[own], offsets[own])
        counts[number] = int(own.sum())
    record = records.Chunk(
        compression="zstd",
        data=zstandard.ZstdCompressor(level=3).compress(data),
        message_start_time=int(times.min()),
        message_end_time=int(times.max()),
        uncompressed_crc=zlib.crc32(data),
        uncompressed_size=len(data),
    )
    return Packed(record, indexes, counts, contents)


def _index(number: int, times: np.ndarray, offsets: np.ndarray) -> bytes:
    """Return a message index record."""
    pairs = np.empty((len(times), 2), "<u8")
    pairs[:, 0] = times
    pairs[:, 1] = offsets
    return struct.pack("<BQHI", Opcode.MESSAGE_INDEX, 6 + pairs.nbytes, number, pairs.nbytes) + pairs.tobytes()
