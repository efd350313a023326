"""The messages of a channel as they stand in a file, and in the order of time."""

from __future__ import annotations

import hashlib
import struct
from collections.abc import Iterator, Mapping, Sequence
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

Places = Mapping[tuple[int, int], Sequence[int] | np.ndarray]
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


def split(data: bytes, indexed: Sequence[np.ndarray] = ()) -> tuple[Places, list[tuple[int, bytes]]]:
    """Return where the messages of a chunk begin, and its schemas and channels as opcode and content.

    Parameters
    ----------
    data : bytes
        The records of a chunk.
    indexed : sequence of numpy.ndarray of uint64
        Where each of its indexes says that messages begin. They are not believed: only if the messages there are of one
        channel and length for each, and fill the chunk without a gap, need it not be gone through record by record.

    Raises
    ------
    ValueError
        If a record is longer than the chunk, or of a kind that a chunk cannot hold, such as a chunk.
    """
    filling = _filling(data, indexed)
    if filling is not None:
        return filling, []
    places: dict[tuple[int, int], list[int]] = {}
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
            places.setdefault((number, length), []).append(start)
        elif opcode in (Opcode.SCHEMA, Opcode.CHANNEL):
            described.append((opcode, data[start + 9 : end]))
        elif opcode in _NO_MESSAGE:
            raise ValueError(f"a chunk holds a record of kind {opcode}; messages, schemas and channels are allowed")
        start = end
    return places, described


def _filling(data: bytes, indexed: Sequence[np.ndarray]) -> Places | None:
    """Return where messages begin if those that are indexed are alike in each index, and all that is in a chunk."""
    places: dict[tuple[int, int], np.ndarray] = {}
    begins = np.zeros(len(data) + 1, bool)
    begins[-1] = True
    for starts in indexed:
        last = int(starts.max()) if len(starts) else len(data)
        if last + 31 > len(data):
            return None
        at = starts.astype(np.int64)
        first = int(at[0])
        opcode, length, number = _HEAD.unpack_from(data, first)
        if opcode != _MESSAGE or not 22 <= length <= len(data) - 9 - last or (number, length) in places:
            return None
        # Opcode, length and channel of all of them.
        heads = np.ndarray(len(data) - 10, "V11", data, strides=(1,))[at]
        if heads.tobytes() != data[first : first + 11] * len(at):
            return None
        places[number, length] = at
        begins[at] = True
    # Each ends where another begins, and together they are as long as the chunk: so one follows the other from 0 on.
    filled = sum(len(at) * (9 + length) for (_, length), at in places.items()) == len(data)
    chained = begins[0] and all(begins[at + (9 + length)].all() for (_, length), at in places.items())
    return places if places and filled and chained else None


def gather(into: Mapping[int, Messages], data: bytes, places: Places, before: int) -> None:
    """Add messages of a piece of a file to those of their channels."""
    raw = np.frombuffer(data, np.uint8)
    for (number, length), starts in places.items():
        at = np.asarray(starts, np.int64)
        size = 9 + length
        if len(at) * size == len(data):
            block = raw.reshape(-1, size)
        elif len(at) == 1:
            block = raw[at[0] : at[0] + size].copy().reshape(1, size)
        else:
            # Whole records as the items of an array that begins one at each byte: taken many at a time.
            taken = np.ndarray(len(data) - size + 1, f"V{size}", data, strides=(1,))[at]
            block = taken.view(np.uint8).reshape(-1, size)
        into[number].blocks.append(block)
        into[number].places.append(before + at)
