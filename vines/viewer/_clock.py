"""The timelines of a recording: simulation time, cycles of the forcing, and impacts.

Rerun writes times as durations or as whole numbers. Forcing cycles, which the viewer opens with, are whole numbers of
thousandths, since as durations they would be shown as seconds, hours and days. The others are durations, of which the
viewer shows one unit as a second: one 1/omega0, one impact.
"""

from __future__ import annotations

import math

import numpy as np
import rerun as rr

__all__ = ["CYCLE", "IMPACT", "SIM_TIME", "Clock", "ticks"]

SIM_TIME = "sim_time"
"""Timeline of the dimensionless time t."""
CYCLE = "cycle/1000"
"""Timeline of the forcing cycles (Omega t + phi)/2π, whole where the phase is 0, in thousandths."""
IMPACT = "impact"
"""Timeline of the impacts: k at impact k, and between two the fraction of the flight that has passed."""


def ticks(cycles: np.ndarray | float) -> np.ndarray:
    """Return forcing cycles as thousandths, whole.

    Examples
    --------
    >>> int(ticks(12.3456))
    12346
    """
    return np.rint(1000.0 * np.asarray(cycles)).astype(np.int64)


class Clock:
    """Gives rows with a time and a forcing phase their places on all timelines.

    Parameters
    ----------
    t, phase : float
        Time and phase of any one row; they fix the phase of the forcing at t = 0.
    Omega : float or None
        Forcing frequency; without it there is no timeline of cycles.
    impacts : numpy.ndarray, shape (n,), optional
        Times of the impacts; without any there is no timeline of impacts.
    end : float
        Last time of the run.
    """

    def __init__(self, t: float, phase: float, Omega: float | None, impacts: np.ndarray | None = None, end: float = 0):
        self._Omega = Omega
        times = np.empty(0) if impacts is None else impacts
        self._knots = np.concatenate([[min(t, *times[:1])], times, [max(end, *times[-1:])]]) if len(times) else None
        self._phi = 0.0 if Omega is None else (phase - Omega * t) % (2 * math.pi)

    def cycles(self, t: np.ndarray) -> np.ndarray:
        """Return times as forcing cycles.

        Examples
        --------
        >>> import numpy as np
        >>> Clock(1.0, np.pi, 2.0).cycles(np.array([1.0, 1.0 + np.pi]))
        array([0.5, 1.5])
        """
        return ((self._Omega or 0.0) * t + self._phi) / (2 * math.pi)

    def impacts(self, t: np.ndarray) -> np.ndarray:
        """Return times as numbers of impacts, from -1 at the start, where there are impacts.

        Examples
        --------
        >>> Clock(0.0, 0.0, 1.0, np.array([1.0, 3.0]), 5.0).impacts(np.array([0.5, 1.0, 2.0, 3.0, 5.0]))
        array([-0.5,  0. ,  0.5,  1. ,  2. ])
        """
        if self._knots is None:
            return np.zeros_like(t)
        return np.interp(t, self._knots, np.arange(-1.0, len(self._knots) - 1.0))

    def columns(self, t: np.ndarray) -> list[rr.TimeColumn]:
        """Return the time columns of rows at these times, shape (n,)."""
        columns = [rr.TimeColumn(SIM_TIME, duration=t)]
        if self._Omega is not None:
            columns.append(rr.TimeColumn(CYCLE, sequence=ticks(self.cycles(t))))
        if self._knots is not None:
            columns.append(rr.TimeColumn(IMPACT, duration=self.impacts(t)))
        return columns
