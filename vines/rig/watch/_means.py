"""The last seconds of a channel as means over short blocks, added to as samples come."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from vines.rig.fit import Bins

__all__ = ["Means"]

Floats = npt.NDArray[np.float64]


class Means:
    """Means over blocks of equal length of the last seconds.

    Parameters
    ----------
    rate : float
        Samples a second.
    wanted : float
        Means a second, about.
    span : float
        Seconds that are kept.
    late : float
        Delay of the channel [s], which is taken off the times.
    """

    def __init__(self, rate: float, wanted: float, span: float, late: float = 0.0):
        self.size = max(1, round(rate / wanted))
        self.width = self.size / rate
        self._rate, self._late = rate, late
        self._kept = round(span / self.width)
        self._means: list[Floats] = []
        self._count = 0
        self._rest: Floats = np.empty(0)
        self._first = 0

    def add(self, first: int, values: Floats) -> None:
        """Add samples; after a gap what there was before is forgotten."""
        if first != self._first + self._count * self.size + len(self._rest):
            self._means, self._count, self._rest, self._first = [], 0, np.empty(0), first
        joined = np.concatenate([self._rest, values]) if len(self._rest) else values
        whole = len(joined) // self.size
        self._rest = joined[whole * self.size :].copy()
        if whole:
            self._means.append(joined[: whole * self.size].reshape(whole, self.size).mean(axis=1))
            self._count += whole
        while self._means and self._count - len(self._means[0]) >= self._kept:
            gone = len(self._means.pop(0))
            self._count -= gone
            self._first += gone * self.size

    def last(self, seconds: float) -> Bins:
        """Return the means of the last seconds, as many of them as there are."""
        every = np.concatenate(self._means) if self._means else np.empty(0)
        kept = min(len(every), round(seconds / self.width))
        start = self._first + (self._count - kept) * self.size
        t = (start + (self.size - 1) / 2 + self.size * np.arange(kept)) / self._rate - self._late
        return Bins(np.asarray(t, np.float64), every[len(every) - kept :], self.width)
