"""A recorded window of a run: its rows, grown as needed."""

from __future__ import annotations

from vines.dynamics import _advance as col
from vines.dynamics._advance import advance, begin, state_now
from vines.dynamics._constants import Constants, ParameterTable
from vines.kernels import by_type, cold_njit, linked_njit, new_matrix, njit

__all__ = ["open_window", "run_window", "width_of", "with_room", "write_end"]


@by_type(ParameterTable)
@njit
def width_of(table):
    """Return the length of the rows of events of a system."""
    return col.ROW


@njit
def open_window(c, state, rows):
    """Begin a window at the time of the state; return the number of rows that it has."""
    begin(c, state, rows)
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
        rows = with_room(rows, count, 2 * rows.shape[0])
        count, code = advance(c, state, stop, cap, rows, count)
    if count == rows.shape[0]:
        rows = with_room(rows, count, 2 * rows.shape[0])
    end = stop if code == col.COMPLETE else state[col.S_T] + state[col.S_CLEAR]
    write_end(c, state, end, rows[count])
    return rows, count, code


@by_type(Constants)
@njit
def write_end(c, state, end, last):
    """Write the row of the end of a window, with the state there."""
    x1, v1, x2, v2, phase, tau = state_now(c, state, end)
    last[col.KIND], last[col.SIDE], last[col.TIME], last[col.TAU] = col.END, 0.0, end, tau
    last[col.PHASE], last[col.MODE], last[col.RUN] = phase, state[col.S_MODE], 0.0
    last[col.X1], last[col.V1], last[col.X2], last[col.V2] = x1, v1, x2, v2
    last[col.A_V1], last[col.A_V2] = v1, v2


@cold_njit
def with_room(rows, count, room):
    """Return an array of so many rows, the first `count` of which are those given."""
    wider = new_matrix(room, rows.shape[1])
    for i in range(count):
        for j in range(rows.shape[1]):
            wider[i, j] = rows[i, j]
    return wider
