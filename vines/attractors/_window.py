"""A recorded window of a run: its rows, grown as needed, and the measures taken over it."""

from __future__ import annotations

import math

from vines.attractors import _verdict as v
from vines.dynamics.kernels import BATCHES, advance, begin, standard_errors, state_now, window_totals
from vines.dynamics.kernels import rows as col
from vines.dynamics.kernels import totals as entry
from vines.kernels import cold_njit, linked_njit, new_matrix, new_vector, njit

__all__ = ["measure_window", "open_window", "run_window", "with_room"]


@njit
def open_window(state, rows):
    """Begin a window at the time of the state; return the number of rows that it has."""
    begin(state, rows)
    return 1


@linked_njit
def run_window(c, state, stop, cap, rows, count):
    """Run on to `stop` with every row kept, and write the row of the end behind them.

    Parameters
    ----------
    c : Constants
    state : ndarray
        The run, changed in place.
    stop : float
        Time at which to stop.
    cap : int
        Most events in one forcing period.
    rows : ndarray, shape (m, ROW)
        Room; where it is not enough, more is taken.
    count : int
        Rows of the window so far, that of an end left out: the window can be run on.

    Returns
    -------
    (rows, count, status)
        The rows, how many there are without that of the end, and COMPLETE, EVENT_CAP or STEP_LIMIT.
    """
    count, code = advance(c, state, stop, cap, rows, count)
    while code == col.BUFFER_FULL:
        rows = with_room(rows, count, 2 * count)
        count, code = advance(c, state, stop, cap, rows, count)
    if count == rows.shape[0]:
        rows = with_room(rows, count, 2 * count)
    end = stop if code == col.COMPLETE else state[col.S_T] + state[col.S_CLEAR]
    x1, v1, x2, v2, phase, tau = state_now(c, state, end)
    last = rows[count]
    last[col.KIND], last[col.SIDE], last[col.TIME], last[col.TAU] = col.END, 0.0, end, tau
    last[col.PHASE], last[col.MODE], last[col.RUN] = phase, state[col.S_MODE], 0.0
    last[col.X1], last[col.V1], last[col.X2], last[col.V2] = x1, v1, x2, v2
    last[col.A_V1], last[col.A_V2] = v1, v2
    return rows, count, code


@cold_njit
def with_room(rows, count, room):
    """Return an array of so many rows, the first `count` of which are those given."""
    wider = new_matrix(room, rows.shape[1])
    for i in range(count):
        for j in range(rows.shape[1]):
            wider[i, j] = rows[i, j]
    return wider


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
        _add(total, window_totals(c, rows, n, stop - span, stop), True)
        return
    verdict[v.STICKING] = _sticking_share(rows, n, 0.0, stop, period)
    width = stop / BATCHES
    for j in range(entry.TOTALS):
        total[j] = 0.0
    if not width > 0.0:
        # A run that had to stop before its window began.
        verdict[v.KINETIC_RATIO_ERROR] = verdict[v.MAX_ABS_X1_ERROR] = verdict[v.RMS_X1_ERROR] = math.nan
        return
    values, errors = new_matrix(BATCHES, 3), new_vector(3)
    for k in range(BATCHES):
        part = window_totals(c, rows, n, k * width, stop if k == BATCHES - 1 else (k + 1) * width)
        values[k, 0] = c.mu * part[entry.V2_SQUARE] / part[entry.V1_SQUARE] if part[entry.V1_SQUARE] > 0.0 else math.nan
        values[k, 1] = part[entry.MAX_ABS_X1]
        values[k, 2] = math.sqrt(max(part[entry.X1_SQUARE] / part[entry.DURATION], 0.0))
        _add(total, part, k == 0)
    standard_errors(values, errors)
    verdict[v.KINETIC_RATIO_ERROR], verdict[v.MAX_ABS_X1_ERROR], verdict[v.RMS_X1_ERROR] = (
        errors[0],
        errors[1],
        errors[2],
    )


@cold_njit
def _add(total, part, first):
    """Add the totals of a part of a window to those of the parts before it."""
    larger = first or part[entry.MAX_ABS_X1] > total[entry.MAX_ABS_X1]
    for j in range(entry.TOTALS):
        if j in (entry.MAX_ABS_X1, entry.T_MAX_ABS_X1):
            total[j] = part[j] if larger else total[j]
        else:
            total[j] = part[j] if first else total[j] + part[j]


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
