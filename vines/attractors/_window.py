"""The measures taken over a recorded window of a run."""

from __future__ import annotations

import math

from vines.attractors import _verdict as v
from vines.dynamics.kernels import BATCHES, ball_mass, close_batch, standard_errors, window_totals
from vines.dynamics.kernels import rows as col
from vines.dynamics.kernels import totals as entry
from vines.kernels import cold_njit, new_matrix, new_vector

__all__ = ["measure_window"]


@cold_njit
def measure_window(c, rows, n, verdict, total):
    """Take the totals of a window: over one repetition if it is periodic, else over all of it with its errors.

    The share of its forcing periods in which the ball sticks goes to STICKING.
    """
    stop = rows[n - 1, col.TIME]
    period = 2.0 * math.pi / c.Omega
    if verdict[v.REGIME] == v.PERIODIC:
        span = verdict[v.P] * period
        stop = _quiet_time(rows, n, span)
        verdict[v.STICKING] = _sticking_share(rows, n, stop - span, stop, period)
        part = window_totals(c, rows, n, stop - span, stop)
        for j in range(total.shape[0]):
            total[j] = part[j]
        return
    verdict[v.STICKING] = _sticking_share(rows, n, 0.0, stop, period)
    width = stop / BATCHES
    for j in range(total.shape[0]):
        total[j] = 0.0
    if not width > 0.0:
        # A run that had to stop before its window began.
        verdict[v.KINETIC_RATIO_ERROR] = verdict[v.MAX_ABS_X1_ERROR] = verdict[v.RMS_X1_ERROR] = math.nan
        return
    values, errors = new_matrix(BATCHES, 3), new_vector(3)
    for k in range(BATCHES):
        part = window_totals(c, rows, n, k * width, stop if k == BATCHES - 1 else (k + 1) * width)
        close_batch(ball_mass(c), part, total, values[k])
        for j in range(entry.TOTALS, total.shape[0]):
            total[j] += part[j]
    standard_errors(values, errors)
    verdict[v.KINETIC_RATIO_ERROR], verdict[v.MAX_ABS_X1_ERROR], verdict[v.RMS_X1_ERROR] = (
        errors[0],
        errors[1],
        errors[2],
    )


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
