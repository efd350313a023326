"""The synthetic rig as a live source."""

from __future__ import annotations

import time
from collections.abc import Iterator
from datetime import UTC, datetime

import msgspec

from vines.errors import ParameterError
from vines.rig.ingest import COLUMNS, Cells
from vines.rig.synth import LiveRig, RigSettings
from vines.rig.watch._channel import channels_of
from vines.rig.watch._stream import IDLE, Block, Stream, check_rate

__all__ = ["SynthSource"]

_BLOCK = 0.1
"""Seconds of a block."""
_OF_ITS_FILE = ("file", "field", "fs", "t0", "recorder")
"""Cells of its rows that are of a recording."""


class SynthSource:
    """A synthetic rig that runs.

    Parameters
    ----------
    settings : RigSettings
        The rig.
    seed : int
        Of everything that is drawn.
    speed : float
        Seconds of the rig in a second; infinity for as fast as it can be computed.

    Raises
    ------
    ParameterError
        If a rig cannot be so.
    """

    live = True

    def __init__(self, settings: RigSettings, seed: int = 0, *, speed: float = 1.0):
        if not speed > 0:
            raise ParameterError(f"speed is {speed:g}, allowed is more than 0")
        check_rate(settings.rate, "synth:")
        self._rig = LiveRig(settings, seed)
        self._speed = speed

    @property
    def memory(self) -> float:
        """2/lam in time units of this rig [s]."""
        return 2 * self._rig.settings.M / self._rig.settings.c if self._rig.settings.c else float("inf")

    def streams(self) -> Iterator[Stream | None]:
        """Yield the one stream."""
        s = self._rig.settings
        cells = [
            Cells({name: str(getattr(row, name)) for name in COLUMNS if getattr(row, name) not in (None, "")}, "synth:")
            for row in self._rig.rows
        ]
        told = [
            Cells({key: text for key, text in row.cells.items() if key not in _OF_ITS_FILE}, "synth:") for row in cells
        ]
        form = msgspec.to_builtins(self._rig.form)
        form["start_utc"] = datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")
        form.pop("run_id")
        yield Stream(s.run_id, channels_of(told), s.rate, self._blocks(), "<f4", form)

    def close(self) -> None:
        """Nothing is held."""

    def _blocks(self) -> Iterator[Block | None]:
        rate = self._rig.settings.rate
        count = max(1, round(_BLOCK * rate))
        first, begun = 0, time.monotonic()
        while True:
            values = self._rig.take(count)
            due = begun + (first + count) / rate / self._speed
            while (left := due - time.monotonic()) > 0:
                time.sleep(min(left, IDLE))
                if left > IDLE:
                    yield None
            yield Block(first, values)
            first += count
