"""Energies and largest displacements of runs in short equal parts of time, for the errors of their measures."""

from __future__ import annotations

from vines.dynamics.kernels import (
    ball_mass,
    constants_at,
    open_window,
    run_window,
    shift_time,
    totals,
    width_of,
    window_totals,
)
from vines.dynamics.kernels import rows as col
from vines.kernels import entry_njit, new_matrix

__all__ = ["BALL_SQUARE", "COLUMNS", "MAX_ABS_X1", "V1_SQUARE", "X1_SQUARE", "series_block"]

X1_SQUARE, V1_SQUARE, BALL_SQUARE, MAX_ABS_X1 = range(4)
"""Columns of a series: integrals of x1^2, v1^2 and mu v2^2 over a part, and the largest |x1| in it."""
COLUMNS = 4

ROOM = 64
"""Rows of a part for which there is room at first."""


@entry_njit
def series_block(table, states, length, cap, out):
    """Run on and take totals part by part.

    Parameters
    ----------
    table : ParameterTable
        Parameters of each run; its type is that of the system.
    states : ndarray, shape (n, STATE)
        The runs at time 0; on return at time 0 again, one series later.
    length : ndarray, shape (n,)
        Time of a part.
    cap : int
        Most events in one forcing period.
    out : ndarray, shape (n, parts, COLUMNS)
        Filled, but for what follows a part in which a run had to stop.
    """
    rows = new_matrix(ROOM, width_of(table))
    for k in range(states.shape[0]):
        c = constants_at(table, k)
        state = states[k]
        for part in range(out.shape[1]):
            count = open_window(c, state, rows)
            rows, count, code = run_window(c, state, length[k], cap, rows, count)
            if code != col.COMPLETE:
                break
            sums = window_totals(c, rows, count + 1, 0.0, length[k])
            out[k, part, X1_SQUARE] = sums[totals.X1_SQUARE]
            out[k, part, V1_SQUARE] = sums[totals.V1_SQUARE]
            out[k, part, BALL_SQUARE] = ball_mass(c) * sums[totals.V2_SQUARE]
            out[k, part, MAX_ABS_X1] = sums[totals.MAX_ABS_X1]
            shift_time(state, length[k])
