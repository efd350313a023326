"""Digests: of records as they stand in a file, and of what a channel says, whatever the bytes.

Any program that rewrites an MCAP file (compresses, sorts, merges, filters it) gives channels new numbers and the file
other bytes. What a channel is and says stays: its topic, schema, encoding and metadata, and its messages in the order
of time. Numbers, sequence numbers, chunks and compression are not content.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping

import numpy as np
from mcap import records
from mcap.data_stream import RecordBuilder

__all__ = ["bytes_of", "description", "digest_of", "entries", "entry", "sealed", "trusted"]


def bytes_of(record: records.McapRecord) -> bytes:
    """Return the bytes of a record."""
    builder = RecordBuilder()
    record.write(builder)
    return builder.end()


def digest_of(record: records.McapRecord) -> str:
    """Return the SHA-256 of the bytes of a record."""
    return hashlib.sha256(bytes_of(record)).hexdigest()


def sealed(name: str, digests: Mapping[str, str]) -> dict[str, str]:
    """Return digests with one of their own under the name of their record."""
    return {**digests, name: _of_digests(digests)}


def trusted(name: str, digests: Mapping[str, str]) -> dict[str, str]:
    """Return the digests of a record if they are intact themselves, else nothing."""
    rest = {key: digest for key, digest in digests.items() if key != name}
    return rest if digests.get(name) == _of_digests(rest) else {}


def _of_digests(digests: Mapping[str, str]) -> str:
    return hashlib.sha256(repr(sorted(digests.items())).encode()).hexdigest()


def description(topic: records.Channel, schema: records.Schema | None) -> str:
    """Return the SHA-256 of what a channel is: all that the file says about it but its numbers."""
    parts = [topic.topic, topic.message_encoding]
    if schema is not None:
        parts += [schema.name, schema.encoding, hashlib.sha256(schema.data).hexdigest()]
    return hashlib.sha256(repr((parts, sorted(topic.metadata.items()))).encode()).hexdigest()


def entries(messages: np.ndarray) -> np.ndarray:
    """Return what is content of message records of one length: log time, length, payload.

    Parameters
    ----------
    messages : numpy.ndarray of uint8, shape (n, 31 + length)
        A record a row, head included.

    Returns
    -------
    numpy.ndarray of uint8, shape (n, 12 + length)
    """
    count, size = messages.shape
    payload = f"V{size - 31}"  # as a whole: many short rows of bytes take twice as long
    record = np.dtype(
        {"names": ["time", "payload"], "formats": ["<u8", payload], "offsets": [15, 31], "itemsize": size}
    )
    told = np.ndarray(count, record, messages, strides=(messages.strides[0],))
    made = np.empty(count, np.dtype([("time", "<u8"), ("length", "<u4"), ("payload", payload)]))
    made["time"], made["length"], made["payload"] = told["time"], size - 31, told["payload"]
    return made.view(np.uint8).reshape(count, size - 19)


def entry(message: bytes) -> bytes:
    """Return what is content of one message record, as :func:`entries` does of many."""
    return message[15:23] + (len(message) - 31).to_bytes(4, "little") + message[31:]
