"""From arrays to the messages of a chunk: which rows go together, and their bytes."""

from __future__ import annotations

import struct
from collections.abc import Iterator, Sequence

import numpy as np
from mcap.opcode import Opcode

from vines.logs._channels import Rows, message_header

__all__ = ["CHUNK_BYTES", "cut", "pack"]

CHUNK_BYTES = 224 * 1024
"""Uncompressed size at which a chunk is closed: what a damaged byte, or a killed writer, can cost."""


def cut(every: Sequence[Rows]) -> Iterator[list[Rows]]:
    """Yield the rows of each chunk, so that chunks follow each other in time."""
    times = np.concatenate([rows.times for rows in every])
    number = np.repeat(np.arange(len(every), dtype=np.uint16), [len(rows) for rows in every])
    widths = np.array([rows.width for rows in every])
    in_time = number[np.argsort(times, kind="stable")]
    chunk = (np.cumsum(widths[in_time]) - 1) // CHUNK_BYTES
    chunks = int(chunk[-1]) + 1 if len(chunk) else 0
    ends = np.searchsorted(chunk, np.arange(chunks + 1))
    edges = [np.searchsorted(np.flatnonzero(in_time == place), ends) for place in range(len(every))]
    for k in range(chunks):
        parts = [rows.part(slice(int(edge[k]), int(edge[k + 1]))) for rows, edge in zip(every, edges, strict=True)]
        yield [part for part in parts if len(part)]


def pack(rows: Rows) -> np.ndarray:
    """Return rows as MCAP message records, one a row of bytes."""
    layout = rows.layout
    record = message_header(len(layout.blank))
    head = struct.pack("<BQH", Opcode.MESSAGE, 22 + len(layout.blank), rows.channel.number)
    buffer = np.empty((len(rows), record.itemsize), np.uint8)
    buffer[:] = np.frombuffer(head + bytes(31 - len(head)) + layout.blank, np.uint8)
    heads = buffer.view(record)[:, 0]
    heads["sequence"] = np.arange(rows.first, rows.first + len(rows))
    heads["log_time"] = rows.times
    heads["publish_time"] = rows.times
    payload = np.ndarray(len(rows), layout.dtype, buffer, offset=31, strides=(record.itemsize,))
    for name in layout.dtype.names or ():
        payload[name] = rows.values[name]
    return buffer
