"""From arrays to the messages of a chunk: which rows go together, and their bytes."""

from __future__ import annotations

import struct
from collections.abc import Iterator, Sequence

import numpy as np
from mcap.opcode import Opcode

from vines.logs._channels import Rows, message_header

__all__ = ["CHUNK_BYTES", "Placed", "cut", "pack"]

CHUNK_BYTES = 224 * 1024
"""Uncompressed size at which a chunk is closed: what a damaged byte, or a killed writer, can cost."""


Placed = tuple[Rows, np.ndarray]
"""Rows of a channel, and where in its chunk each of their messages begins."""


def cut(every: Sequence[Rows]) -> Iterator[list[Placed]]:
    """Yield the rows of each chunk, so that all messages of a log follow each other in time."""
    widths = np.repeat([rows.width for rows in every], [len(rows) for rows in every])
    by_time = np.argsort(np.concatenate([rows.times for rows in every]), kind="stable")
    ends = np.empty(len(widths), np.int64)
    ends[by_time] = np.cumsum(widths[by_time])
    of_each = np.split(ends, np.cumsum([len(rows) for rows in every])[:-1])
    limits = np.arange(0, (int(ends.max()) if len(ends) else 0) + CHUNK_BYTES, CHUNK_BYTES)
    edges = [np.searchsorted(each, limits, side="right").tolist() for each in of_each]
    for k in range(len(limits) - 1):
        taken = [
            (rows.part(slice(edge[k], edge[k + 1])), each[edge[k] : edge[k + 1]] - rows.width)
            for rows, each, edge in zip(every, of_each, edges, strict=True)
            if edge[k] < edge[k + 1]
        ]
        first = min((int(begin[0]) for _, begin in taken), default=0)
        if taken:
            yield [(rows, begin - first) for rows, begin in taken]


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
