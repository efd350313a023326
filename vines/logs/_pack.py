"""From arrays to the messages of a chunk: which rows go together, and their bytes."""

from __future__ import annotations

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
    number = np.repeat(np.arange(len(every)), [len(rows) for rows in every])
    widths = np.array([rows.width for rows in every])
    by_time = np.argsort(times, kind="stable")
    chunk = (np.cumsum(widths[number[by_time]]) - 1) // CHUNK_BYTES
    chunks = int(chunk[-1]) + 1 if len(chunk) else 0
    edges = [
        np.concatenate([[0], np.cumsum(np.bincount(chunk[number[by_time] == place], minlength=chunks))])
        for place in range(len(every))
    ]
    for k in range(chunks):
        parts = [rows.part(slice(int(edge[k]), int(edge[k + 1]))) for rows, edge in zip(every, edges, strict=True)]
        yield [part for part in parts if len(part)]


def pack(rows: Rows) -> np.ndarray:
    """Return rows as MCAP message records, one a row of bytes."""
    layout = rows.layout
    header = message_header(len(layout.blank))
    buffer = np.empty((len(rows), header.itemsize), np.uint8)
    buffer[:, 31:] = np.frombuffer(layout.blank, np.uint8)
    heads = buffer.view(header)[:, 0]
    heads["opcode"] = Opcode.MESSAGE
    heads["length"] = 22 + len(layout.blank)
    heads["channel"] = rows.channel.number
    heads["sequence"] = np.arange(rows.first, rows.first + len(rows))
    heads["log_time"] = rows.times
    heads["publish_time"] = rows.times
    payload = np.ndarray(len(rows), layout.dtype, buffer, offset=31, strides=(header.itemsize,))
    for name in layout.dtype.names or ():
        payload[name] = rows.values[name]
    return buffer
