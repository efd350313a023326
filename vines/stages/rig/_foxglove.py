"""A run while it goes on for Foxglove, by the server of its SDK, on this machine only."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Iterator, Mapping
from importlib import import_module
from typing import Any

import msgspec
import numpy as np

from vines.errors import ViewerError
from vines.packages import need
from vines.rig.watch import Report
from vines.schema import numpy_dtype, schema_bytes, wire_format

__all__ = ["FoxgloveServer", "foxglove_server"]

_SAMPLE = "vines.v1.SensorSample"


class FoxgloveServer:
    """Sends what is watched to each Foxglove that connects.

    Parameters
    ----------
    sdk : module
        ``foxglove``.
    context : foxglove.Context
        Of the server.
    """

    def __init__(self, sdk: Any, context: Any):
        self._sdk, self._context = sdk, context
        self._channels: dict[str, Any] = {}
        self._status: Any = None
        self._begun = 0

    def begin(self, name: str, sensors: Mapping[str, str]) -> None:
        """Begin a run: a channel ``/sensor/<name>`` for each sensor, with what its values are, and ``/status``."""
        self.end()
        self._begun = time.time_ns()
        schema = self._sdk.Schema(name=_SAMPLE, encoding="protobuf", data=schema_bytes(_SAMPLE))
        for sensor, label in sensors.items():
            self._channels[sensor] = self._sdk.Channel(
                f"/sensor/{sensor}",
                schema=schema,
                message_encoding="protobuf",
                context=self._context,
                metadata={"run": name, "measures": label},
            )
        self._status = self._sdk.Channel("/status", message_encoding="json", context=self._context)

    def samples(self, sensor: str, t: np.ndarray, values: np.ndarray) -> None:
        """Send samples of a channel, times in seconds, shape (n,), if anybody looks at it."""
        channel = self._channels.get(sensor)
        if channel is None or not channel.has_sinks():
            return
        layout = wire_format(_SAMPLE)
        rows = np.frombuffer(bytearray(layout.blank * len(t)), layout.dtype)
        for name, column in zip(numpy_dtype(_SAMPLE).names or (), (t, values, 1), strict=True):
            rows[name] = column
        data, size = rows.tobytes(), layout.dtype.itemsize
        for place, when in enumerate((self._begun + 1e9 * t).astype(np.int64).tolist()):
            channel.log(data[place * size : (place + 1) * size], log_time=when)

    def status(self, t: float, report: Report) -> None:
        """Send a report."""
        if self._status is not None:
            self._status.log(msgspec.json.encode(report), log_time=self._begun + int(1e9 * t))

    def end(self) -> None:
        """End the channels of a run."""
        for channel in (*self._channels.values(), self._status):
            if channel is not None:
                channel.close()
        self._channels, self._status = {}, None


@contextlib.contextmanager
def foxglove_server(port: int) -> Iterator[FoxgloveServer]:
    """Serve on 127.0.0.1; it ends with the context.

    Raises
    ------
    PackageMissingError
        If foxglove-sdk is not installed.
    ViewerError
        If the port cannot be had.
    """
    need("foxglove")
    sdk = import_module("foxglove")
    context = sdk.Context()
    try:
        server = sdk.start_server(name="vines rig watch", host="127.0.0.1", port=port, context=context)
    except Exception as refused:
        # The SDK raises what its Rust side had; nothing but the port can be wrong here.
        reason = " ".join(str(refused).split())
        raise ViewerError(f"--foxglove {port}: {reason}; is the port in use? name another one") from None
    serving = FoxgloveServer(sdk, context)
    try:
        yield serving
    finally:
        serving.end()
        server.stop()
