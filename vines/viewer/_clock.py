"""The timelines of a recording: simulation time and cycles of the forcing.

Both are durations, in which the viewer shows one unit as a second: one 1/omega0, or one cycle.
"""

from __future__ import annotations

import math

import numpy as np
import rerun as rr

__all__ = ["CYCLE", "SIM_TIME", "Clock"]

SIM_TIME = "sim_time"
"""Timeline of the dimensionless time t."""
CYCLE = "cycle"
"""Timeline of the forcing cycles, fractions included: (Omega t + phi)/2π, whole where the phase is 0."""


class Clock:
    """Gives rows with a time and a forcing phase their places on all timelines.

    Parameters
    ----------
    t, phase : float
        Time and phase of any one row; they fix the phase of the forcing at t = 0.
    Omega : float or None
        Forcing frequency; without it there is no timeline of cycles.
    """

    def __init__(self, t: float, phase: float, Omega: float | None):
        self._Omega = Omega
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

    def columns(self, t: np.ndarray) -> list[rr.TimeColumn]:
        """Return the time columns of rows at these times, shape (n,)."""
        columns = [rr.TimeColumn(SIM_TIME, duration=t)]
        if self._Omega is not None:
            columns.append(rr.TimeColumn(CYCLE, duration=self.cycles(t)))
        return columns
