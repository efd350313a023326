"""Impacts heard while samples come: the detector of recordings on pieces that overlap."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from vines.rig.impacts import find_pulses, pulses_of, threshold
from vines.rig.recording import Sampled
from vines.rig.watch._channel import Channel

__all__ = ["Hearing"]

Floats = npt.NDArray[np.float64]

_EDGE = {0: 0.06, 2: 0.02}
"""Seconds at the ends of a piece in which nothing is sought, by the derivative of x1 that is measured: the smoothing
has not begun there, and a pulse is not told from what lies beyond."""


class Hearing:
    """Finds impacts in a channel of the oscillator.

    Parameters
    ----------
    channel : Channel
        Its accelerometer or displacement.
    rate : float
        Samples a second.
    """

    def __init__(self, channel: Channel, rate: float):
        self._channel, self._rate = channel, rate
        self._order = 2 if channel.role == "lo_acc" else 0
        self._edge = _EDGE[self._order]
        self._held: list[Floats] = []
        self._first = self._count = 0
        self._done = -np.inf

    def add(self, first: int, values: Floats) -> None:
        """Add samples; after a gap what there was before is forgotten."""
        if first != self._first + self._count:
            self._held, self._first, self._count = [], first, 0
        self._held.append(values)
        self._count += len(values)

    def take(self) -> tuple[Floats, Floats]:
        """Return times [s] and velocity jumps [m/s] of the impacts that can be told by now, each once."""
        if self._count < 4 * self._edge * self._rate:
            return np.empty(0), np.empty(0)
        values = np.concatenate(self._held)
        start = self._first / self._rate - self._channel.delay
        piece = Sampled(self._channel.name, self._channel.role, self._rate, start, values, np.ones(len(values), bool))
        sparse = pulses_of(piece, self._order).sparse()
        train = find_pulses(sparse, threshold(sparse))
        low, high = max(self._done, start + self._edge), start + len(values) / self._rate - self._edge
        new = (train.t >= low) & (train.t < high)
        self._done = high
        kept = min(len(values), round(3 * self._edge * self._rate))
        self._held, self._first, self._count = [values[-kept:]], self._first + len(values) - kept, kept
        return train.t[new], train.dv[new]
