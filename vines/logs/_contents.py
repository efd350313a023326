"""The messages of a channel as they stand in a file, and in the order of time."""

from __future__ import annotations

import hashlib
import struct
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np
from mcap import records
from mcap.opcode import Opcode

from vines.logs._channels import message_header
from vines.logs._digests import description, entries, entry

__all__ = ["Messages", "Places", "gather", "split"]

_HEAD = struct.Struct("<BQH")
_MESSAGE = int(Opcode.MESSAGE)
_NO_MESSAGE = range(Opcode.HEADER, Opcode.DATA_END + 1)

Places = dict[tuple[int, int], list[int]]
"""Where messages begin, by channel and length."""


@dataclass
class Messages:
    """Messages of one channel, in groups of one length, as they stand in the file.

    Attributes
    ----------
    blocks : list of numpy.ndarray of uint8, shape (n, 31 + length)
        Message records, a record a row, head included.
    places : list of numpy.ndarray of int64, shape (n,)
        Numbers that grow with the place in the file.
    """

    blocks: list[np.ndarray] = field(default_factory=list)
    places: list[np.ndarray] = field(default_factory=list)

    def __len__(self) -> int:
        return sum(map(len, self.blocks))

    def _heads(self, name: str) -> np.ndarray:
        return np.concatenate([block.view(message_header(block.shape[1] - 31))[name][:, 0] for block in self.blocks])

    @property
    def times(self) -> np.ndarray:
        """Log times [ns], in the order of the blocks."""
        return self._heads("log_time")

    def order(self) -> np.ndarray:
        """Return the order of time; messages of one time follow their sequence, or else their place in the file."""
        if not self.blocks:
            return np.zeros(0, np.int64)
        return np.lexsort((np.concatenate(self.places), self._heads("sequence"), self.times))

    def in_order(self) -> Iterator[bytes]:
        """Yield the message records in the order of time."""
        ends = np.cumsum([0, *map(len, self.blocks)])
        for place in self.order().tolist():
            block = int(np.searchsorted(ends, place, side="right")) - 1
            yield self.blocks[block][place - ends[block]].tobytes()

    def digest(self, topic: records.Channel, schema: records.Schema | None) -> str:
        """Return the SHA-256 of what the channel says, see :mod:`vines.logs._digests`."""
        sha = hashlib.sha256(description(topic, schema).encode())
        if len({block.shape[1] for block in self.blocks}) == 1:
            sha.update(np.concatenate([entries(block) for block in self.blocks])[self.order()].tobytes())
        else:
            for message in self.in_order():
                sha.update(entry(message))
        return sha.hexdigest()


def split(data: bytes) -> tuple[Places, list[tuple[int, bytes]]]:
    """Return where the messages of a chunk begin, and its schemas and channels as opcode and content.

    Raises
    ------
    ValueError
        If a record is longer than the chunk, or of a kind that a chunk cannot hold, such as a chunk.
    """
    if len(data) >= 31:
        opcode, length, number = _HEAD.unpack_from(data)
        size = 9 + length
        # Most chunks of a rig hold messages of one channel and length in a row.
        if opcode == Opcode.MESSAGE and length >= 22 and len(data) % size == 0:
            heads = np.frombuffer(data, message_header(length - 22))
            if ((heads["opcode"] == opcode) & (heads["length"] == length) & (heads["channel"] == number)).all():
                return {(number, length): list(range(0, len(data), size))}, []
    places: Places = {}
    described: list[tuple[int, bytes]] = []
    start = 0
    size = len(data)
    while start < size:
        # A head and the number of a channel; records that are shorter than that hold nothing.
        opcode, length, number = _HEAD.unpack_from(data, start) if start + 11 <= size else (0, size, 0)
        end = start + 9 + length
        if end > size:
            raise ValueError("a record in a chunk is longer than the chunk")
        if opcode == _MESSAGE:
            if length < 22:
                raise ValueError("a message record is shorter than its header")
            key = (number, length)
            if key in places:
                places[key].append(start)
            else:
                places[key] = [start]
        elif opcode in (Opcode.SCHEMA, Opcode.CHANNEL):
            described.append((opcode, data[start + 9 : end]))
        elif opcode in _NO_MESSAGE:
            raise ValueError(f"a chunk holds a record of kind {opcode}; messages, schemas and channels are allowed")
        start = end
    return places, described


def gather(into: Mapping[int, Messages], data: bytes, places: Places, before: int) -> None:
    """Add messages of a piece of a file to those of their channels."""
    raw = np.frombuffer(data, np.uint8)
    for (number, length), starts in places.items():
        at = np.array(starts, np.int64)
        size = 9 + length
        if len(at) * size == len(data):
            block = raw.reshape(-1, size)
        else:
            block = np.lib.stride_tricks.sliding_window_view(raw, size)[at]
        into[number].blocks.append(block)
        into[number].places.append(before + at)
