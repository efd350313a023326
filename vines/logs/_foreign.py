"""Tables from MCAP files that vines did not write: channels in protobuf, with any schema, and in JSON."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
from google.protobuf.message import DecodeError, Message
from mcap import records

from vines.errors import LogError
from vines.logs._contents import Messages
from vines.logs._walk import Found

if TYPE_CHECKING:
    import pyarrow as pa

__all__ = ["foreign_tables", "is_readable", "why_unfit"]

_READABLE = ("protobuf", "json")
_UNFIT = (DecodeError, KeyError, NotImplementedError, OverflowError, RecursionError, TypeError, ValueError)
"""What decoding raises of messages that are not what they should be."""


def foreign_tables(
    file: Path, topics: Mapping[int, records.Channel], found: Found
) -> tuple[dict[str, pa.Table], list[str]]:
    """Return the messages of each channel as a table, the log time in nanoseconds as its first column.

    Parameters
    ----------
    file : Path
        Where they come from, for messages.
    topics : mapping of int to mcap.records.Channel
        The channels to decode, by their numbers.
    found : Found
        What is in the file.

    Returns
    -------
    tuple of (dict of str to pyarrow.Table, list of str)
        The tables by topic, and what a reader should know: channels in an encoding that is neither protobuf nor JSON,
        and columns of values of several types.

    Raises
    ------
    LogError
        If a message does not fit its schema, or holds what no table can.
    """
    tables: dict[str, pa.Table] = {}
    unread = [f"{topic.topic} ({topic.message_encoding})" for topic in topics.values() if not is_readable(topic)]
    remarks: list[str] = []
    if unread:
        remarks.append(f"channels that vines cannot decode (it reads protobuf and JSON): {', '.join(sorted(unread))}")
    for number, topic in topics.items():
        if not is_readable(topic):
            continue
        try:
            made, mixed = _table(_rows(topic, found.schema(number), found.messages[number]))
        except _UNFIT as unfit:
            raise LogError(f"{file}: the messages on {topic.topic} {_said(unfit)}") from None
        # Two channels may share a topic; their numbers keep them apart.
        tables[topic.topic if topic.topic not in tables else f"{topic.topic}#{number}"] = made
        remarks += [f"{name} on {topic.topic} has values of several types: each stands as JSON text" for name in mixed]
    return tables, remarks


def is_readable(topic: records.Channel) -> bool:
    """Whether a channel is in an encoding that can be decoded."""
    return topic.message_encoding in _READABLE


def why_unfit(topic: records.Channel, schema: records.Schema | None, message: Messages) -> str:
    """Return why a message of such a channel cannot be read alone; empty if it can."""
    try:
        _table(_rows(topic, schema, message))
    except _UNFIT as unfit:
        return _said(unfit)
    return ""


def _said(unfit: BaseException) -> str:
    """Return in words what messages do that cannot be read."""
    if isinstance(unfit, OverflowError):
        return "hold an integer beyond 64 bits"
    if isinstance(unfit, RecursionError):
        return "are nested too deeply"
    return f"do not fit their schema ({' '.join(str(unfit).split())})"


def _rows(topic: records.Channel, schema: records.Schema | None, messages: Messages) -> list[dict[str, Any]]:
    payloads = [message[31:] for message in messages.in_order()]
    if topic.message_encoding == "json":
        decoded = [json.loads(data) for data in payloads]
        contents = [each if isinstance(each, dict) else {"value": each} for each in decoded]
    else:
        if schema is None:
            raise KeyError("a protobuf channel needs a schema")
        kind = _class(schema.name, schema.data)
        contents = [_plain(kind.FromString(data)) for data in payloads]
    times = messages.times[messages.order()].tolist() if payloads else []
    return [{"log_time": time, **content} for time, content in zip(times, contents, strict=True)]


def _class(name: str, descriptors: bytes) -> type[Message]:
    """Return a protobuf class from what the file says about it."""
    pool = descriptor_pool.DescriptorPool()
    waiting = {file.name: file for file in descriptor_pb2.FileDescriptorSet.FromString(descriptors).file}

    def add(name: str) -> None:
        file = waiting.pop(name, None)
        if file is not None:
            for needed in file.dependency:
                add(needed)
            pool.Add(file)

    for each in list(waiting):
        add(each)
    return message_factory.GetMessageClass(pool.FindMessageTypeByName(name))


def _plain(message: Message) -> dict[str, Any]:
    """Return a message as Python values: enums by name, maps as lists of pairs, what is absent as None."""
    found: dict[str, Any] = {}
    for each in message.DESCRIPTOR.fields:
        value = getattr(message, each.name)
        if each.message_type is not None and each.message_type.GetOptions().map_entry:
            of_messages = each.message_type.fields_by_name["value"].message_type is not None
            found[each.name] = [{"key": k, "value": _plain(v) if of_messages else v} for k, v in value.items()]
        elif each.is_repeated:
            found[each.name] = [_value(each, item) for item in value]
        elif each.has_presence and not message.HasField(each.name):
            found[each.name] = None
        else:
            found[each.name] = _value(each, value)
    return found


def _value(each: Any, value: Any) -> Any:
    if each.message_type is not None:
        return _plain(value)
    if each.enum_type is not None:
        known = each.enum_type.values_by_number.get(value)
        return str(value) if known is None else known.name
    return value


def _table(rows: list[dict[str, Any]]) -> tuple[pa.Table, list[str]]:
    """Return rows as a table, and its columns of values of several types."""
    import pyarrow as pa

    names = list(dict.fromkeys(["log_time", *(name for row in rows for name in row)]))
    columns = [pa.array([row["log_time"] for row in rows], pa.uint64())]
    mixed: list[str] = []
    for name in names[1:]:
        values = [row.get(name) for row in rows]
        try:
            columns.append(_column(values))
        except (pa.ArrowInvalid, pa.ArrowTypeError, pa.ArrowNotImplementedError):
            mixed.append(name)
            texts = [None if each is None else json.dumps(each, ensure_ascii=False) for each in values]
            columns.append(pa.array(texts, pa.string()))
    return pa.table(columns, names=names), mixed


def _column(values: list[Any]) -> pa.Array:
    import pyarrow as pa

    try:
        return pa.array(values)
    except OverflowError as larger:
        # Numbers from 2^63 on, as in fields of type uint64, fit 64 bits too.
        try:
            return pa.array(values, pa.uint64())
        except (pa.ArrowInvalid, pa.ArrowTypeError, OverflowError):
            if len(values) == 1:
                raise larger from None
        for each in values:
            _column([each])  # each fits alone: it is the type that they do not share
        raise pa.ArrowTypeError("integers with and without a sign") from None
