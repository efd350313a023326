"""A log that is still being written, read as it grows."""

from __future__ import annotations

import os
import struct
from collections import defaultdict
from io import BytesIO
from pathlib import Path

import numpy as np
from mcap import records
from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.writer import MCAP0_MAGIC

from vines.errors import FileMissingError, LogError
from vines.logs._channels import BALL, KINDS, PARAMETERS, PROVENANCE, RUN, SAMPLE, SENSOR, Channel
from vines.logs._contents import Messages, gather, split
from vines.logs._decode import decode
from vines.logs._unpack import CHUNK_LIMIT, Unpacker
from vines.logs._walk import BROKEN, line_of
from vines.model import VI_NES

__all__ = ["Tail"]

_HEAD = struct.Struct("<BQ")
_MOST = 2**31
"""Bytes of a record at most: what claims more is no record."""


class Tail:
    """What is added to a log, from its beginning on.

    Parameters
    ----------
    path : path-like
        The log: as it is called while it is written (``<name>.part``), as it will be, or one that is finished.
    max_chunk : int
        As in :func:`vines.logs.read`.

    Attributes
    ----------
    path : Path
        The file that is read.
    name, kind : str
        As :class:`vines.logs.Log` has them; empty until they have been read.
    system : str
        The system of the run.
    parameters : dict of str to float
        Of the run.
    provenance : dict of str to str
        Where it comes from.
    about : dict of str to dict of str to str
        What is known of each sensor.
    ended : bool
        Whether the writer has finished the log.

    Raises
    ------
    FileMissingError
        If there is neither the log nor one of that name that is being written.
    LogError
        If it is no MCAP file.

    Examples
    --------
    >>> import tempfile
    >>> from vines.logs import LiveWriter
    >>> from vines.schema import numpy_dtype
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     with LiveWriter(f"{folder}/run.mcap", name="live", provenance={}, parameters={}) as live:
    ...         tail = Tail(f"{folder}/run.mcap")
    ...         live.add("impacts", np.zeros(2, numpy_dtype("vines.v1.Impact")))
    ...     len(tail.take()["impacts"]), tail.name, tail.ended
    (2, 'live', True)
    """

    def __init__(self, path: str | os.PathLike[str], *, max_chunk: int = CHUNK_LIMIT):
        given = Path(path)
        partial = given.with_name(f"{given.name}.part")
        self.path = next((each for each in (given, partial) if each.is_file()), given)
        if not self.path.is_file():
            raise FileMissingError(f"there is no log {given}, and none of that name is being written ({partial.name})")
        self._stream = self.path.open("rb")
        if self._stream.read(len(MCAP0_MAGIC)) != MCAP0_MAGIC:
            self.close()
            raise LogError(f"{self.path} is not an MCAP file; a log ends in .mcap, or .part while it is written")
        self._max_chunk = max_chunk
        self._schemas: dict[int, records.Schema] = {}
        self._known: dict[int, Channel] = {}
        self.name, self.kind, self.system, self.ended = "", "", VI_NES.name, False
        self.parameters: dict[str, float] = {}
        self.provenance: dict[str, str] = {}
        self.about: dict[str, dict[str, str]] = {}

    def take(self) -> dict[str, np.ndarray]:
        """Return the rows of each channel of vines that were added since the last call, in the order of time.

        Returns
        -------
        dict of str to numpy.ndarray, structured
            By ``"states"``, ``"impacts"``, ``"sticks"``, ``"base"``, the number of a ball or the name of a sensor.

        Raises
        ------
        LogError
            If what was added is damaged.
        """
        messages: defaultdict[int, Messages] = defaultdict(Messages)
        before = 0
        try:
            while not self.ended and (record := self._next()) is not None:
                opcode, body = record
                if opcode == Opcode.CHUNK:
                    chunk = records.Chunk.read(ReadDataStream(BytesIO(body)))
                    inside = Unpacker(len(body), self._max_chunk).unpack(chunk)
                    places, _ = split(inside)
                    gather(messages, inside, places, before)
                    before += len(inside)
                else:
                    self._describe(opcode, body)
            found: dict[str, np.ndarray] = {}
            for number, channel in self._known.items():
                if number in messages:
                    every = np.concatenate([decode(block, channel) for block in messages[number].blocks])
                    found[channel.key] = every[messages[number].order()]
        except BROKEN as broken:
            self.close()
            raise LogError(f"{self.path} is damaged ({line_of(broken)}); try `vines recover`") from None
        return found

    def close(self) -> None:
        """Let go of the file; nothing more is taken from it."""
        self._stream.close()
        self.ended = True

    def _next(self) -> tuple[int, bytes] | None:
        """Return the next record if it is there as a whole."""
        place = self._stream.tell()
        head = self._stream.read(_HEAD.size)
        if len(head) == _HEAD.size:
            opcode, length = _HEAD.unpack(head)
            if length > _MOST:
                raise ValueError(f"a record at byte {place} claims {length} bytes")
            body = self._stream.read(length)
            if len(body) == length:
                return opcode, body
        self._stream.seek(place)
        return None

    def _describe(self, opcode: int, body: bytes) -> None:
        stream = ReadDataStream(BytesIO(body))
        if opcode == Opcode.SCHEMA:
            schema = records.Schema.read(stream)
            self._schemas[schema.id] = schema
        elif opcode == Opcode.CHANNEL:
            self._learn(records.Channel.read(stream))
        elif opcode == Opcode.METADATA:
            entry = records.Metadata.read(stream)
            if entry.name == RUN:
                self.name, self.kind = entry.metadata.get("name", self.path.stem), entry.metadata.get("kind", "run")
                self.system = entry.metadata.get("system", VI_NES.name)
            elif entry.name == PARAMETERS:
                self.parameters = {key: float(text) for key, text in entry.metadata.items()}
            elif entry.name == PROVENANCE:
                self.provenance = entry.metadata
        elif opcode in (Opcode.DATA_END, Opcode.FOOTER):
            self.close()

    def _learn(self, topic: records.Channel) -> None:
        schema = self._schemas.get(topic.schema_id)
        if schema is None or topic.message_encoding != "protobuf":
            return
        if schema.name in (SAMPLE, BALL):
            key = topic.topic.removeprefix(SENSOR) if schema.name == SAMPLE else topic.topic.rpartition("/")[2]
            self._known[topic.id] = Channel(topic.id, topic.topic, schema.name, "t", key, topic.metadata)
            if schema.name == SAMPLE:
                self.about[key] = topic.metadata
        elif schema.name in KINDS:
            self._known[topic.id] = KINDS[schema.name]
