"""From the messages of a channel to arrays and tables."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from google.protobuf.descriptor_pb2 import FileDescriptorSet

from vines.logs._channels import Channel
from vines.logs._contents import Messages
from vines.schema import field_notes, message_class, numpy_dtype, schema_bytes, wire_format

if TYPE_CHECKING:
    import pyarrow as pa

__all__ = ["decode", "differing_fields", "table"]


def decode(messages: np.ndarray, channel: Channel) -> np.ndarray:
    """Return message records of equal length, one a row of bytes, as a structured array."""
    layout = wire_format(channel.message)
    count, size = messages.shape
    if size == 31 + len(layout.blank):
        tags = 31 + layout.tags
        if (messages[:, tags] == np.frombuffer(layout.blank, np.uint8)[layout.tags]).all():
            return np.ndarray(count, layout.dtype, messages, offset=31, strides=(size,))
    kind = message_class(channel.message)
    rows = np.empty(count, numpy_dtype(channel.message))
    for place in range(count):
        message = kind.FromString(messages[place, 31:].tobytes())
        rows[place] = tuple(getattr(message, name) for name in rows.dtype.names or ())
    return rows


def table(messages: Messages, channel: Channel) -> pa.Table:
    """Return the messages of a channel as a table, in the order of time."""
    import pyarrow as pa

    parts = [decode(block, channel) for block in messages.blocks]
    order = messages.order()
    dtype, notes = numpy_dtype(channel.message), field_notes(channel.message)
    columns = [
        np.concatenate([np.empty(0, dtype[name]), *(part[name] for part in parts)])[order] for name in dtype.names or ()
    ]
    schema = pa.schema(
        [
            pa.field(
                name,
                pa.from_numpy_dtype(dtype[name]),
                metadata={"unit": notes[name][0], "description": notes[name][1]},
            )
            for name in dtype.names or ()
        ],
        metadata=dict(channel.metadata) or None,
    )
    return pa.table([pa.array(column) for column in columns], schema=schema)


def differing_fields(descriptors: bytes, message: str) -> list[str]:
    """Return the fields of our message that a serialised FileDescriptorSet lacks or describes otherwise."""
    ours, theirs = _fields(schema_bytes(message), message), _fields(descriptors, message)
    return sorted(name for name, *_ in ours - theirs)


def _fields(descriptors: bytes, message: str) -> set[tuple[str, int, int]]:
    """Return name, number and type of the fields of a message."""
    return {
        (each.name, each.number, each.type)
        for file in FileDescriptorSet.FromString(descriptors).file
        for kind in file.message_type
        if f"{file.package}.{kind.name}" == message
        for each in kind.field
    }
