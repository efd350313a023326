"""The channels of a log, and how one array becomes the messages of a channel."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from vines.errors import SchemaError
from vines.schema import WireFormat, numpy_dtype, schema_bytes, wire_format

__all__ = [
    "BALL",
    "BALLS",
    "BALL_TOPIC",
    "BASE",
    "CHANNELS",
    "CONTENT",
    "DIGESTS",
    "FIRST_SENSOR",
    "KINDS",
    "NES",
    "OF_BALLS",
    "ORBIT",
    "OURS",
    "PARAMETERS",
    "PROVENANCE",
    "RECOVERED",
    "RUN",
    "SAMPLE",
    "SENSOR",
    "STATUS",
    "Channel",
    "Rows",
    "as_messages",
    "as_rows",
    "log_times",
    "message_header",
]

OURS = "vines."
"""Names of the metadata records of vines begin so."""
PROVENANCE = "vines.provenance"
"""Metadata record with where the numbers come from; the first record of a log after its header."""
RUN = "vines.run"
"""Metadata record with the name of the run."""
PARAMETERS = "vines.parameters"
"""Metadata record with the parameters of the model."""
DIGESTS = "vines.digests"
"""Metadata record with the SHA-256 of each record before it, so that damage there can be named."""
CONTENT = "vines.content"
"""Metadata record with the SHA-256 of what each channel says, which stays when another program rewrites the log."""
RECOVERED = "vines.recovered"
"""Metadata record of a salvaged log: what was saved and what was lost."""
STATUS = "vines.status"
"""Metadata record that is written last: without it a log is incomplete."""

_LATEST = 9.2e9
"""Nanoseconds are counted in 64 bits, and viewers read them with a sign: later times have no log time."""


@dataclass(frozen=True, eq=False)
class Channel:
    """One kind of message in a log.

    Attributes
    ----------
    number : int
        Number of the channel, and of its schema, in the file.
    topic : str
        Its name in the file.
    message : str
        Full name of its message.
    time : str
        The field of the message that gives its log time.
    key : str
        Its name as an argument of :func:`vines.logs.write_run` and as an attribute of a log.
    metadata : mapping of str to str
        What the file says about the channel.
    schema : tuple of (str, bytes) or None
        Encoding and content of the schema; None for a message of vines.
    encoding : str
        Encoding of the messages.
    """

    number: int
    topic: str
    message: str
    time: str
    key: str
    metadata: Mapping[str, str] = field(default_factory=dict)
    schema: tuple[str, bytes] | None = None
    encoding: str = "protobuf"

    def described(self) -> tuple[str, bytes]:
        """Return encoding and content of the schema as the file holds it."""
        return self.schema or ("protobuf", schema_bytes(self.message))


@dataclass(frozen=True, eq=False)
class Rows:
    """All messages of a channel, ready to be packed.

    Attributes
    ----------
    channel : Channel
        Where they go.
    layout : WireFormat
        How a message lies in memory; all have one length.
    times : numpy.ndarray of uint64, shape (n,)
        Log times, sorted.
    values : numpy.ndarray, shape (n,), structured
        A row a message with the fields of the layout.
    first : int
        Sequence number of the first.
    """

    channel: Channel
    layout: WireFormat
    times: np.ndarray
    values: np.ndarray
    first: int = 0

    @property
    def width(self) -> int:
        """Bytes of a message with its record header."""
        return 31 + len(self.layout.blank)

    def __len__(self) -> int:
        return len(self.times)

    def part(self, rows: slice) -> Rows:
        """Return some of the rows, with their sequence numbers."""
        return Rows(self.channel, self.layout, self.times[rows], self.values[rows], self.first + rows.start)


CHANNELS = (
    Channel(1, "/state", "vines.v1.State", "t", "states"),
    Channel(2, "/impact", "vines.v1.Impact", "t", "impacts"),
    Channel(3, "/stick", "vines.v1.Stick", "t_start", "sticks"),
)
"""The channels that the log of a run always has."""
ORBIT = Channel(4, "/orbit", "vines.v1.Orbit", "t", "orbits")
"""Channel of the log of an orbit."""
BASE = Channel(5, "/base", "vines.v1.BaseMotion", "t", "base")
"""Channel of the log of a rig."""
SAMPLE = "vines.v1.SensorSample"
"""Message of a sensor's channel."""
SENSOR = "/sensor/"
"""Topics of sensors begin so."""
FIRST_SENSOR = 100
"""Number of the first sensor's channel."""
OF_BALLS = (
    Channel(6, "/oscillator", "vines.v1.Oscillator", "t", "states"),
    Channel(7, "/impact", "vines.v1.BallImpact", "t", "impacts"),
    Channel(8, "/stick", "vines.v1.BallStick", "t_start", "sticks"),
)
"""Those that the log of a run with several balls has instead, beside one of each ball."""
BALL = "vines.v1.Ball"
"""Message of a ball's channel."""
BALL_TOPIC = "/ball/"
"""Topics of balls begin so."""
BALLS = tuple(Channel(8 + ball, f"{BALL_TOPIC}{ball}", BALL, "t", str(ball)) for ball in range(1, 9))
"""Channels of the balls of a run with several."""
NES = Channel(17, "/nes", "vines.v1.Nes", "t", "nes")
"""Channel of a mass on a spring beside the ball."""
KINDS = {channel.message: channel for channel in (*CHANNELS, ORBIT, BASE, NES, *OF_BALLS)}
"""Messages of which a log has one channel at most."""


@lru_cache(64)
def message_header(payload: int) -> np.dtype:
    """Return the dtype of an MCAP message record with a payload of so many bytes, which is left as a gap.

    Examples
    --------
    >>> message_header(141).itemsize
    172
    """
    return np.dtype(
        {
            "names": ["opcode", "length", "channel", "sequence", "log_time", "publish_time"],
            "formats": ["<u1", "<u8", "<u2", "<u4", "<u8", "<u8"],
            "offsets": [0, 1, 9, 11, 15, 23],
            "itemsize": 31 + payload,
        }
    )


def as_messages(array: np.ndarray, channel: Channel) -> np.ndarray:
    """Return an array with the fields of the channel's message in their types; no copy is made of one that has them.

    Parameters
    ----------
    array : numpy.ndarray, shape (n,), structured
        Rows with at least the fields of the message, sorted by time.
    channel : Channel
        Where they go.

    Raises
    ------
    SchemaError
        If a field is missing or its numbers do not fit its type, or if a time is not finite, negative, or
        earlier than the one before it.
    """
    dtype = numpy_dtype(channel.message)
    names = array.dtype.names or ()
    missing = [name for name in dtype.names or () if name not in names]
    if missing:
        raise SchemaError(
            f"{channel.key} lack {', '.join(missing)}; a {channel.message} needs {', '.join(dtype.names or ())}"
        )
    if array.ndim != 1:
        raise SchemaError(f"{channel.key} have shape {array.shape}; allowed is one row a message, shape (n,)")
    fitting = array
    if any(array.dtype[name] != dtype[name] for name in dtype.names or ()):
        fitting = _converted(array, dtype, channel)
    times = fitting[channel.time]
    if len(times) and not (np.isfinite(times).all() and times[0] >= 0.0 and times[-1] < _LATEST):
        raise SchemaError(
            f"times of {channel.key} run from {times[0]} to {times[-1]}; allowed are finite ones from 0 to {_LATEST:g}"
        )
    if (np.diff(times) < 0).any():
        place = int(np.argmax(np.diff(times) < 0)) + 1
        raise SchemaError(
            f"{channel.key} are not sorted by time: row {place} is at {times[place]}, "
            f"before the one above it; sort them by {channel.time!r}"
        )
    return fitting


def _converted(array: np.ndarray, dtype: np.dtype, channel: Channel) -> np.ndarray:
    """Return the fields of a message in the types of the message; refuse numbers that would become others."""
    fitting = np.empty(len(array), dtype)
    for name in dtype.names or ():
        values = array[name]
        try:
            fitting[name] = values.astype(dtype[name], casting="same_kind", copy=False)
        except TypeError:
            raise SchemaError(
                f"field {name!r} of {channel.key} has type {values.dtype}; {dtype[name]} is needed"
            ) from None
        if dtype[name].kind == "i" and not np.array_equal(fitting[name], values):
            raise SchemaError(f"field {name!r} of {channel.key} holds numbers that do not fit {dtype[name]}")
    return fitting


def as_rows(array: np.ndarray, channel: Channel, first: int = 0) -> Rows:
    """Return an array as the messages of a channel of vines, ready to be packed.

    Raises
    ------
    SchemaError
        As :func:`as_messages`.
    """
    values = as_messages(array, channel)
    return Rows(channel, wire_format(channel.message), log_times(values[channel.time]), values, first)


def log_times(times: np.ndarray) -> np.ndarray:
    """Return simulation times as whole nanoseconds of a unit of time.

    Examples
    --------
    >>> log_times(np.array([0.0, 1.5]))
    array([         0, 1500000000], dtype=uint64)
    """
    return np.rint(times * 1e9).astype(np.uint64)
