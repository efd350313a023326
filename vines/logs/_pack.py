"""From arrays to the messages of a chunk: which rows go together, and their bytes."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from mcap.opcode import Opcode

from vines.logs._channels import Channel, message_header
from vines.schema import wire_format

__all__ = ["cut", "pack"]

_CHUNK_BYTES = 224 * 1024
"""Uncompressed size at which a chunk is closed: what a damaged byte, or a killed writer, can cost."""


def cut(times: Mapping[Channel, np.ndarray]) -> list[dict[Channel, slice]]:
    """Return which rows of each channel share a chunk, so that chunks follow each other in time."""
    order = list(times)
    every = np.concatenate([times[channel] for channel in order])
    number = np.repeat(np.arange(len(order)), [len(times[channel]) for channel in order])
    widths = np.array([31 + len(wire_format(channel.message).blank) for channel in order])
    by_time = np.argsort(every, kind="stable")
    chunk = (np.cumsum(widths[number[by_time]]) - 1) // _CHUNK_BYTES
    chunks = int(chunk[-1]) + 1 if len(chunk) else 0
    edges = [
        np.concatenate([[0], np.cumsum(np.bincount(chunk[number[by_time] == place], minlength=chunks))])
        for place in range(len(order))
    ]
    return [
        {channel: slice(int(edge[k]), int(edge[k + 1])) for channel, edge in zip(order, edges, strict=True)}
        for k in range(chunks)
    ]


def pack(rows: np.ndarray, times: np.ndarray, channel: Channel, first: int) -> bytes:
    """Return rows as MCAP message records, one after the other, numbered from ``first``."""
    layout = wire_format(channel.message)
    header = message_header(len(layout.blank))
    buffer = np.empty((len(rows), header.itemsize), np.uint8)
    buffer[:, 31:] = np.frombuffer(layout.blank, np.uint8)
    heads = buffer.view(header)[:, 0]
    heads["opcode"] = Opcode.MESSAGE
    heads["length"] = 22 + len(layout.blank)
    heads["channel"] = channel.number
    heads["sequence"] = np.arange(first, first + len(rows))
    heads["log_time"] = times
    heads["publish_time"] = times
    payload = np.ndarray(len(rows), layout.dtype, buffer, offset=31, strides=(header.itemsize,))
    for name in layout.dtype.names or ():
        payload[name] = rows[name]
    return buffer.tobytes()
