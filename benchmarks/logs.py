"""Speed and size of logs: a million states of eight doubles, against the writer of the mcap package.

Run as ``python -m benchmarks.logs``. Both write the same protobuf bytes with zstd in the same run, in turn, and both
get their messages packed in advance by numpy where the writer takes messages one by one; medians of five. The same is
done with the 16 fields of ``vines.v1.State``. Every byte that was written is read back through mcap's own reader with
CRC validation, outside the timing.
"""

from __future__ import annotations

import os
import statistics
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from google.protobuf import descriptor_pb2
from mcap.reader import make_reader
from mcap.writer import CompressionType, Writer

from vines import logs
from vines.logs._channels import CHANNELS, Channel, Rows, log_times
from vines.logs._file import LogFile
from vines.logs._pack import cut, pack
from vines.schema import WireFormat, numpy_dtype, wire_format

COUNT = 1_000_000
REPEATS = 5
EIGHT = ("t", "x1", "v1", "x2", "v2", "w", "w_dot", "phase")


def motion(dtype: np.dtype) -> np.ndarray:
    """Return states that move like a run: smooth between impacts, in full precision."""
    random = np.random.default_rng(1)
    rows = np.zeros(COUNT, dtype)
    t = np.arange(COUNT) * 0.0314
    for place, name in enumerate(dtype.names or ()):
        if dtype[name].kind == "f":
            rows[name] = np.sin((1 + 0.1 * place) * t + place) * (1 + 0.1 * random.standard_normal(COUNT))
    rows["t"] = t
    return rows


def eight() -> tuple[Channel, WireFormat]:
    """Return a channel of eight doubles and its layout."""
    file = descriptor_pb2.FileDescriptorProto(name="eight.proto", package="bench", syntax="proto3")
    message = file.message_type.add(name="Eight")
    for number, name in enumerate(EIGHT, 1):
        message.field.add(name=name, number=number, type=descriptor_pb2.FieldDescriptorProto.TYPE_DOUBLE, label=1)
    described = descriptor_pb2.FileDescriptorSet(file=[file]).SerializeToString()
    offsets = [1 + 9 * place for place in range(8)]
    dtype = np.dtype({"names": list(EIGHT), "formats": ["<f8"] * 8, "offsets": offsets, "itemsize": 72})
    blank = b"".join(bytes([number << 3 | 1]) + bytes(8) for number in range(1, 9))
    channel = Channel(1, "/state", "bench.Eight", "t", "states", schema=("protobuf", described))
    return channel, WireFormat(dtype, blank, np.arange(0, 72, 9))


def ours(path: Path, rows: Rows) -> None:
    """Write as `vines.logs` does."""
    with path.open("wb") as stream:
        log = LogFile(stream)
        log.channel(rows.channel)
        log.digests()
        log.chunks(cut([rows]))
        log.status("complete", {rows.channel.topic: str(len(rows))})
        log.finish()


def theirs(path: Path, rows: Rows, messages: list[bytes], times: list[int]) -> None:
    """Write with the mcap package, as it is set up by itself."""
    encoding, data = rows.channel.described()
    with path.open("wb") as stream:
        writer = Writer(stream, compression=CompressionType.ZSTD)
        writer.start()
        schema = writer.register_schema(rows.channel.message, encoding, data)
        channel = writer.register_channel(rows.channel.topic, "protobuf", schema)
        for place, (stamp, message) in enumerate(zip(times, messages, strict=True)):
            writer.add_message(channel, stamp, message, stamp, place)
        writer.finish()


def seconds(body: Callable[[], object]) -> float:
    start = time.perf_counter()
    body()
    return time.perf_counter() - start


def check(path: Path, messages: list[bytes], times: list[int]) -> None:
    """Read every message back through mcap's reader, its checksums compared."""
    with path.open("rb") as stream:
        count = 0
        for _, _, message in make_reader(stream, validate_crcs=True).iter_messages():
            if (message.data, message.log_time, message.sequence) != (messages[count], times[count], count):
                raise SystemExit(f"message {count} of {path} differs from what was written")
            count += 1
    if count != len(messages):
        raise SystemExit(f"{path} has {count} messages, not {len(messages)}")


def compare(folder: Path, rows: Rows) -> dict[str, float]:
    """Return medians and sizes of both writers for the same rows."""
    width, head = rows.width, 31
    packed = pack(rows).tobytes()
    messages = [packed[place + head : place + width] for place in range(0, len(packed), width)]
    times = rows.times.tolist()
    a, b = folder / "ours.mcap", folder / "theirs.mcap"
    own, peer = [], []
    for _ in range(REPEATS):
        own.append(seconds(lambda: ours(a, rows)))
        peer.append(seconds(lambda: theirs(b, rows, messages, times)))
    check(a, messages, times)
    return {
        "ours": statistics.median(own),
        "mcap": statistics.median(peer),
        "ratio": statistics.median(peer) / statistics.median(own),
        "size": a.stat().st_size / b.stat().st_size,
        "megabytes": a.stat().st_size / 1e6,
    }


def reading(folder: Path, states: np.ndarray) -> float:
    """Return the median time in which a log of that many states becomes Arrow tables, all checks included."""
    path = logs.write_run(
        folder / "run.mcap",
        states=states,
        impacts=np.empty(0, numpy_dtype("vines.v1.Impact")),
        sticks=np.empty(0, numpy_dtype("vines.v1.Stick")),
        provenance={},
        parameters={},
        name="a million states",
        bare=False,
    )
    return statistics.median(seconds(lambda: logs.read(path).states) for _ in range(REPEATS))


def results() -> dict[str, float]:
    """Return everything that is measured, by name."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        channel, layout = eight()
        values = motion(np.dtype([(field, "<f8") for field in EIGHT]))
        eights = compare(folder, Rows(channel, layout, log_times(values["t"]), values))
        states = motion(numpy_dtype("vines.v1.State"))
        full = compare(folder, Rows(CHANNELS[0], wire_format("vines.v1.State"), log_times(states["t"]), states))
        read = reading(folder, states)
    found = {f"8 doubles: {key}": value for key, value in eights.items()}
    found |= {f"State: {key}": value for key, value in full.items()}
    return found | {"State: read to Arrow, checked": read}


if __name__ == "__main__":
    print(f"{COUNT} rows, median of {REPEATS}, {os.cpu_count()} cores")
    for key, value in results().items():
        print(f"{key:36s} {value:10.3f}")
