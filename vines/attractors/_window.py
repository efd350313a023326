"""The measures taken over a recorded window of a run."""

from __future__ import annotations

import math

from vines.attractors import _verdict as v
from vines.dynamics.kernels import rows as col
from vines.dynamics.kernels import window_totals
from vines.kernels import cold_njit

__all__ = ["measure_window"]


@cold_njit
def measure_window(c, rows, n, verdict, total):
    """Take the totals of a window: over one repetition if it is periodic, else over all of it.

    The share of its forcing periods in which the ball sticks goes to STICKING. Errors are nan where the motion was not
    seen to be regular.
    """
    stop = rows[n - 1, col.TIME]
    start = 0.0
    period = 2.0 * math.pi / c.Omega
    if verdict[v.REGIME] == v.PERIODIC:
        span = verdict[v.P] * period
        stop = _quiet_time(rows, n, span)
        start = stop - span
    verdict[v.STICKING] = _sticking_share(rows, n, start, stop, period)
    if verdict[v.SETTLED] == 0.0 or verdict[v.REGIME] not in (v.PERIODIC, v.NO_IMPACT):
        verdict[v.KINETIC_RATIO_ERROR] = verdict[v.MAX_ABS_X1_ERROR] = verdict[v.RMS_X1_ERROR] = math.nan
    for j in range(total.shape[0]):
        total[j] = 0.0
    if not stop > start:
        # A run that had to stop before its window began.
        return
    part = window_totals(c, rows, n, start, stop)
    for j in range(total.shape[0]):
        total[j] = part[j]


@cold_njit
def _sticking_share(rows, n, start, stop, period):
    """Return in which share of the forcing periods from `start` to `stop` the ball rides on a wall for a while."""
    whole = int((stop - start) / period + 1e-6)
    counted = 0
    seen = -1
    for i in range(n - 1):
        if rows[i, col.MODE] == 0.0 or rows[i + 1, col.TIME] <= start:
            continue
        first = int(max(rows[i, col.TIME] - start, 0.0) / period)
        last = int((min(rows[i + 1, col.TIME], stop) - start) / period)
        for k in range(max(first, seen + 1), min(last, whole - 1) + 1):
            counted += 1
            seen = k
    return counted / whole if whole > 0 else 0.0


@cold_njit
def _quiet_time(rows, n, span):
    """Return the middle of the longest pause in the last `span`, so that no event lies on the edge of a window."""
    last = rows[n - 1, col.TIME]
    longest = -1.0
    middle = last
    for i in range(n - 1, 0, -1):
        if rows[i - 1, col.TIME] < last - span:
            break
        pause = rows[i, col.TIME] - rows[i - 1, col.TIME]
        # Of equal pauses the first in time.
        if pause >= longest:
            longest = pause
            middle = rows[i - 1, col.TIME] + 0.5 * pause
    return middle
