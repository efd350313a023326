"""A stream from a socket: one line of JSON that describes it, then frames of samples (docs/rig.md, "While it runs")."""

from __future__ import annotations

import json
import re
import socket
import struct
import time
from collections.abc import Iterator
from datetime import UTC, datetime
from typing import Any

import numpy as np

from vines.errors import RigError, nearest
from vines.rig.ingest import Cells, RunForm
from vines.rig.watch._channel import channels_of
from vines.rig.watch._stream import IDLE, Block, Stream, check_rate

__all__ = ["MAGIC", "SocketSource"]

MAGIC = b"VINE"
"""A frame begins so."""
_FRAME = struct.Struct("<4sIQ")
"""Head of a frame: `MAGIC`, samples of each channel, number of the first one."""
_LONGEST = 65536
"""Bytes of the line that describes the stream, at most."""
_MOST = 2**22
"""Samples of a channel in a frame, at most."""
_PATIENCE = 5.0
"""Seconds to connect in."""
_GATHERED = 0.05
"""Seconds of samples that are handed on together where frames are shorter."""
_TYPES = {"f4": "<f4", "f8": "<f8", "i4": "<i4"}
_KEYS = ("name", "rate", "type", "channels", "run", "start_utc")


class SocketSource:
    """A program that sends samples over TCP.

    Parameters
    ----------
    host : str
        Where it listens; ignored if it is this side that does.
    port : int
        The port.
    listen : bool
        Whether to wait for it on 127.0.0.1 instead of connecting to it.

    Raises
    ------
    RigError
        If nobody listens there, or the port is taken; one line.
    """

    live = True

    def __init__(self, host: str, port: int, *, listen: bool = False):
        self.where = f"listen://{port}" if listen else f"tcp://{host}:{port}"
        self._server: socket.socket | None = None
        self._socket: socket.socket | None = None
        self._data = bytearray()
        self._over = False
        try:
            if listen:
                self._server = socket.create_server(("127.0.0.1", port))
                self._server.settimeout(IDLE)
                self.port = self._server.getsockname()[1]
            else:
                self._socket = socket.create_connection((host, port), timeout=_PATIENCE)
                self.port = port
        except OSError as refused:
            remedy = "is it in use by another program?" if listen else "start the program that sends first"
            raise RigError(f"{self.where}: {refused.strerror or refused}; {remedy}") from None

    def streams(self) -> Iterator[Stream | None]:
        """Yield the stream once it is described; None while it is not.

        Raises
        ------
        RigError
            If what arrives is no such stream.
        """
        while self._socket is None and self._server is not None:
            try:
                self._socket, _ = self._server.accept()
            except TimeoutError:
                yield None
        assert self._socket is not None
        self._socket.settimeout(IDLE)
        while b"\n" not in self._data[:_LONGEST]:
            if len(self._data) >= _LONGEST or self._over:
                what = "it ended" if self._over else f"{_LONGEST} bytes came"
                raise RigError(f"{self.where}: {what} without a first line that describes the stream")
            if not self._receive():
                yield None
        line, _, rest = bytes(self._data).partition(b"\n")
        self._data = bytearray(rest)
        yield self._described(line)

    def close(self) -> None:
        """End the connection."""
        for each in (self._socket, self._server):
            if each is not None:
                each.close()

    def _receive(self) -> bool:
        """Take what has arrived; say whether there was anything."""
        assert self._socket is not None
        try:
            got = self._socket.recv(1 << 20)
        except TimeoutError:
            return False
        except OSError:
            got = b""
        if not got:
            self._over = True
        self._data += got
        return bool(got)

    def _described(self, line: bytes) -> Stream:
        """Return the stream that a first line describes."""
        try:
            head: Any = json.loads(line)
        except ValueError:
            raise RigError(f"{self.where}: its first line is no JSON: {line[:60]!r}") from None
        if not isinstance(head, dict):
            raise RigError(f"{self.where}: its first line is no object {{...}}: {line[:60]!r}")
        for key in head:
            if key not in _KEYS:
                raise RigError(f"{self.where}: unknown entry {key!r} in its first line: {nearest(key, _KEYS)}")
        rate, kind, rows = head.get("rate"), head.get("type", "f4"), head.get("channels")
        if not isinstance(rate, (int, float)) or isinstance(rate, bool):
            raise RigError(f"{self.where}: rate is {rate!r}, allowed is a number, in samples a second")
        if kind not in _TYPES:
            raise RigError(f"{self.where}: type is {kind!r}, allowed are {', '.join(_TYPES)}")
        if not isinstance(rows, list) or not all(isinstance(row, dict) for row in rows):
            raise RigError(f"{self.where}: channels is no list of objects, one a channel")
        cells = [
            Cells(
                {key: str(value) for key, value in row.items() if value is not None}, f"{self.where} channel {number}"
            )
            for number, row in enumerate(rows, 1)
        ]
        channels = channels_of(cells)
        run = head.get("run", {})
        known = RunForm.__struct_fields__
        for key in run if isinstance(run, dict) else {}:
            if key not in known:
                raise RigError(f"{self.where}: unknown entry {key!r} in run: {nearest(key, known)}")
        started = head.get("start_utc") or datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")
        return Stream(
            name=re.sub(r"[^A-Za-z0-9_.-]+", "_", str(head.get("name") or "stream")).strip("_.-") or "stream",
            channels=channels,
            rate=check_rate(float(rate), self.where),
            blocks=self._blocks(len(channels), float(rate), _TYPES[kind]),
            dtype=_TYPES[kind],
            run={"start_utc": started, **(run if isinstance(run, dict) else {})},
        )

    def _blocks(self, channels: int, rate: float, dtype: str) -> Iterator[Block | None]:
        """Yield what arrives; frames that follow each other are handed on together."""
        size = channels * np.dtype(dtype).itemsize
        least = max(1, round(_GATHERED * rate))
        held: list[np.ndarray] = []
        first = count = frames = 0
        looked = time.monotonic()
        while True:
            while (frame := self._frame(size, dtype, channels, frames)) is not None:
                frames += 1
                number, values = frame
                if held and number != first + count:
                    yield Block(first, np.concatenate(held, axis=1))
                    held = []
                if not held:
                    first, count = number, 0
                held.append(values)
                count += values.shape[1]
                if count >= least:
                    yield Block(first, np.concatenate(held, axis=1))
                    held, looked = [], time.monotonic()
            if self._over:
                break
            if not self._receive() or time.monotonic() - looked > IDLE:
                looked = time.monotonic()
                yield None
        if held:
            yield Block(first, np.concatenate(held, axis=1))

    def _frame(self, size: int, dtype: str, channels: int, number: int) -> tuple[int, np.ndarray] | None:
        """Return the next frame that is there as a whole: number of its first sample, values channel by channel."""
        if len(self._data) < _FRAME.size:
            return None
        magic, count, first = _FRAME.unpack_from(self._data)
        if magic != MAGIC:
            raise RigError(
                f"{self.where}: frame {number} begins with {bytes(magic)!r}, not {MAGIC!r}; each is {MAGIC!r}, the "
                f"number of samples (uint32), that of the first (uint64), then {channels} values a sample ({dtype[1:]})"
            )
        if not 0 < count <= _MOST:
            raise RigError(f"{self.where}: frame {number} holds {count} samples a channel, allowed is 1 to {_MOST}")
        end = _FRAME.size + count * size
        if len(self._data) < end:
            return None
        values = np.frombuffer(bytes(self._data[_FRAME.size : end]), dtype).reshape(count, channels).T
        del self._data[:end]
        return first, values
