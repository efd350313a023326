"""What watching a rig costs: processor seconds a second of four channels at 51.2 kS/s, and the ratio to real time.

``python -m benchmarks.rig_watch``: a synthetic rig is made in advance, then watched from memory as fast as it goes: all
that ``vines rig watch --no-view`` does, its log on disk included. Beside it npTDMS writes the same samples in pieces of
the same length and does nothing else.
"""

from __future__ import annotations

import argparse
import resource
import statistics
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from nptdms import ChannelObject, TdmsWriter

from vines.rig.ingest import COLUMNS, Cells
from vines.rig.synth import LiveRig, RigSettings
from vines.rig.watch import Block, Channel, Report, Stream, channels_of
from vines.stages import Watched, watch_rig

RATE = 51200.0
PIECE = 5120


class Replayed:
    """Gives samples from memory."""

    live = True

    def __init__(self, values: npt.NDArray[np.float32], channels: tuple[Channel, ...]):
        self._values, self._channels = values, channels

    def streams(self) -> Iterator[Stream]:
        """Yield the one stream."""
        run = {"start_utc": "2026-01-05T09:00:00Z", "b": {"value": 0.015, "u": 5e-5}}
        yield Stream("replayed", self._channels, RATE, self._blocks(), "<f4", run)

    def close(self) -> None:
        """Nothing is held."""

    def _blocks(self) -> Iterator[Block]:
        for first in range(0, self._values.shape[1], PIECE):
            yield Block(first, self._values[:, first : first + PIECE])


class Silent:
    """Is told, and keeps the last report."""

    last: Report | None = None

    def began(self, stream: Stream, log: Path | None) -> None:
        """Say nothing."""

    def report(self, report: Report) -> None:
        """Keep it."""
        self.last = report

    def remark(self, text: str) -> None:
        """Say nothing."""

    def ended(self, watched: Watched) -> None:
        """Say nothing."""


def clocked(work: Any) -> tuple[float, float]:
    """Return processor and wall seconds of some work."""
    begun, used = time.perf_counter(), time.process_time()
    work()
    return time.process_time() - used, time.perf_counter() - begun


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=int, default=60)
    parser.add_argument("--rounds", type=int, default=5)
    given = parser.parse_args()
    rig = LiveRig(RigSettings(settle=0.0), 3)
    values = np.concatenate([rig.take(round(RATE)) for _ in range(given.seconds)], axis=1)
    every = ({name: getattr(row, name) for name in COLUMNS} for row in rig.rows)
    cells = [Cells({k: str(v) for k, v in each.items() if v not in (None, "")}, "rig") for each in every]
    channels = channels_of(cells)
    told = Silent()

    def watched(folder: Path) -> None:
        watch_rig(Replayed(values, channels), told, out=folder, memory=3.0)

    def written(folder: Path) -> None:
        with TdmsWriter(folder / "peer.tdms") as file:
            for first in range(0, values.shape[1], PIECE):
                piece = values[:, first : first + PIECE]
                file.write_segment([ChannelObject("daq", c.name, v) for c, v in zip(channels, piece, strict=True)])

    times: dict[str, list[tuple[float, float]]] = {"vines rig watch": [], "npTDMS, written alone": []}
    size = 0
    for _ in range(given.rounds):
        for (name, taken), work in zip(times.items(), (watched, written), strict=True):
            with tempfile.TemporaryDirectory() as folder:
                taken.append(clocked(lambda work=work, folder=folder: work(Path(folder))))
                if name.startswith("vines"):
                    size = sum(each.stat().st_size for each in Path(folder).rglob("*.mcap"))
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
    print(f"{given.seconds} s of 4 channels at {RATE:g} S/s, medians of {given.rounds}; peak memory {memory:.2f} GiB")
    for name, taken in times.items():
        used, wall = (statistics.median(each[place] for each in taken) / given.seconds for place in (0, 1))
        print(f"{name:24} {used:.3f} processor seconds a second, {1 / wall:.0f} times real time")
    ratio = [statistics.median(each[0] for each in taken) for taken in times.values()]
    large = size / 2**20 / given.seconds * 60
    print(f"ratio of processor time {ratio[0] / ratio[1]:.0f}; log {large:.0f} MiB a minute")
    if told.last is not None:
        print(f"said last: {told.last.pattern}, r {told.last.r:.3f}, settled {told.last.settled}")


if __name__ == "__main__":
    main()
