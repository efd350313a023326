"""Samples of a recorder as it gave them, at their full rate: a tenth of a second of a channel is one message.

A message a sample, as the other channels have, would take thirty times the bytes at 51.2 kS/s.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache, lru_cache

import numpy as np
from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
from google.protobuf.message import Message

from vines.errors import SchemaError
from vines.logs._channels import Channel, Rows, log_times
from vines.logs._contents import Messages
from vines.logs._form import Form
from vines.schema import WireFormat, raw_schema

__all__ = ["RAW", "RAW_SAMPLES", "Raw", "block_of", "raw_channels", "raw_of", "raw_rows"]

RAW = "/raw/"
"""Topics of recorded channels begin so."""
RAW_SAMPLES = "vines.v1.RawSamples"
_FIRST = 300
"""Number of the first channel of raw samples."""
_LISTS = {"<f4": (3, "singles"), "<f8": (4, "doubles"), "<i4": (5, "counts")}
"""By the type of the samples: number and name of the field that holds them."""
_NEEDED = ("unit", "rate", "dtype")
_BLOCK = 0.1
"""Seconds of a message."""
_MOST = 16384
"""Samples of a message at most, so that a chunk holds some."""
_HEAD = 31 + 9 + 9 + 1 + 4


@dataclass(frozen=True, eq=False)
class Raw:
    """What a recorder gave of one channel.

    Attributes
    ----------
    values : numpy.ndarray, shape (n,)
        Samples in the unit that `about` names, from the first one on; 0 where they were lost.
    lost : numpy.ndarray of bool, shape (n,)
        Which samples are missing.
    start : float
        Time of the first [s].
    rate : float
        Samples a second.
    about : mapping of str to str
        What the log says of the channel.
    """

    values: np.ndarray
    lost: np.ndarray
    start: float
    rate: float
    about: Mapping[str, str]


def raw_channels(raw: Mapping[str, Mapping[str, str]]) -> dict[str, Channel]:
    """Return the channel of each recorded channel.

    Raises
    ------
    SchemaError
        If unit, rate or type of the samples is not stated, or the log has no such type.
    """
    channels = {}
    for place, name in enumerate(sorted(raw)):
        about = {key: str(raw[name][key]) for key in sorted(raw[name])}
        lacking = [key for key in _NEEDED if not about.get(key, "").strip()]
        if lacking:
            raise SchemaError(f"raw channel {name!r} does not state its {', '.join(lacking)}")
        if about["dtype"] not in _LISTS:
            raise SchemaError(
                f"raw channel {name!r} has samples of type {about['dtype']}; allowed: {', '.join(_LISTS)}"
            )
        channels[name] = Channel(
            _FIRST + place, f"{RAW}{name}", RAW_SAMPLES, "t", f"raw {name!r}", about, ("protobuf", raw_schema())
        )
    return channels


def block_of(channel: Channel) -> int:
    """Return how many samples a message of a channel holds."""
    return min(max(1, round(_BLOCK * float(channel.metadata["rate"]))), _MOST)


@lru_cache(256)
def _layout(dtype: str, count: int) -> WireFormat:
    """Return how a message of so many samples lies in memory."""
    size = count * np.dtype(dtype).itemsize
    # Four bytes for the length, whatever it is: longer than need be is allowed.
    length = bytes([size & 0x7F | 0x80, size >> 7 & 0x7F | 0x80, size >> 14 & 0x7F | 0x80, size >> 21])
    form = Form().double(1, "t").tag(2, 1).slot("first", "<u8").tag(_LISTS[dtype][0], 2).put(length)
    return form.slot("values", (dtype, (count,))).layout()


def raw_rows(channel: Channel, first: int, values: np.ndarray, count: int, number: int = 0) -> Rows:
    """Return samples as messages of `count` each.

    Parameters
    ----------
    channel : Channel
        Of :func:`raw_channels`.
    first : int
        Number of the first sample.
    values : numpy.ndarray, shape (k * count,)
        In the type of the channel.
    count : int
        Samples of a message.
    number : int
        Sequence number of the first message.
    """
    layout = _layout(channel.metadata["dtype"], count)
    rows = np.empty(len(values) // count, np.dtype([(name, layout.dtype[name]) for name in ("t", "first", "values")]))
    rows["first"] = first + count * np.arange(len(rows))
    rows["t"] = rows["first"] / float(channel.metadata["rate"])
    rows["values"] = values.reshape(-1, count)
    return Rows(channel, layout, log_times(rows["t"]), rows, number)


def raw_of(messages: Messages, about: Mapping[str, str]) -> Raw:
    """Return the samples of a channel, those of all its messages in their places.

    Raises
    ------
    ValueError
        If the channel states no rate, or messages overlap.
    """
    rate = float(about.get("rate", "nan"))
    if not rate > 0:
        raise ValueError(f"a channel of {RAW_SAMPLES} states the rate {about.get('rate')!r}")
    dtype = about.get("dtype", "<f8") if about.get("dtype") in _LISTS else "<f8"
    parts = [part for block in messages.blocks for part in _parts(block, dtype)]
    parts.sort(key=lambda part: part[0])
    begin = parts[0][0] if parts else 0
    end = parts[-1][0] + len(parts[-1][1]) if parts else 0
    if end - begin > 100 * max(1, sum(len(part) for _, part in parts)):
        raise ValueError(f"numbers of samples run from {begin} to {end}, but there are few")
    values, lost = np.zeros(end - begin, dtype), np.ones(end - begin, bool)
    for first, part in parts:
        here = slice(first - begin, first - begin + len(part))
        if not lost[here].all():
            raise ValueError(f"two messages hold sample {first}")
        values[here] = part
        lost[here] = False
    return Raw(values, lost, begin / rate, rate, dict(about))


def _parts(block: np.ndarray, dtype: str) -> list[tuple[int, np.ndarray]]:
    """Return number of the first sample, and the samples, of messages of one length."""
    count, rest = divmod(block.shape[1] - _HEAD, np.dtype(dtype).itemsize)
    if count > 0 and not rest:
        layout = _layout(dtype, count)
        fixed = np.frombuffer(layout.blank, np.uint8)[[0, 9, 18, 19, 20, 21, 22]]
        if (block[:, 31 + np.array([0, 9, 18, 19, 20, 21, 22])] == fixed).all():
            rows = np.ndarray(len(block), layout.dtype, block, offset=31, strides=(block.shape[1],))
            return [(int(first), values) for first, values in zip(rows["first"], rows["values"], strict=True)]
    found = []
    for record in block:
        message = _message_class().FromString(record[31:].tobytes())
        found.append((message.first, np.array(getattr(message, _LISTS[dtype][1]), dtype)))  # type: ignore[attr-defined]
    return found


@cache
def _message_class() -> type[Message]:
    """Return a protobuf class of the message, for files that were not packed by vines."""
    pool = descriptor_pool.DescriptorPool()
    for file in descriptor_pb2.FileDescriptorSet.FromString(raw_schema()).file:
        pool.Add(file)
    return message_factory.GetMessageClass(pool.FindMessageTypeByName(RAW_SAMPLES))
