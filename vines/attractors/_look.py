"""Record a window and decide: one run, or a block of them in one call."""

from __future__ import annotations

import math

from vines.attractors import _verdict as v
from vines.attractors._follow import follow
from vines.attractors._judge import clear, judge_window
from vines.attractors._window import measure_window, open_window, run_window
from vines.dynamics import _advance as col
from vines.dynamics._advance import set_state
from vines.dynamics._constants import constants_kernel
from vines.kernels import byte_vector, cold_njit, entry_njit, new_matrix, zero_vector

__all__ = ["look", "look_at_block"]


@cold_njit
def look(c, state, waited, stages, watch, cap, tolerance, rows, verdict):
    """Record a run from time 0 on, until it repeats or the last stage ends, and decide what it shows.

    Parameters
    ----------
    c : Constants
    state : ndarray
        The run at time 0; on return at the end of the window.
    waited : int
        How the run came there: COMPLETE, or it had to stop, and then the window is only the instant of its stop.
    stages : ndarray
        Forcing periods after which to look whether it repeats; the last is the longest window.
    watch : float
        As for `follow`.
    cap : int
        Most events in one forcing period.
    tolerance : float
        As for `judge_window`.
    rows : ndarray, shape (m, ROW)
        Room for the window.
    verdict : ndarray, shape (VERDICT,)
        Overwritten.

    Returns
    -------
    (rows, n, sides, totals)
        The window's rows, their number, sides of the contacts in one repetition, and the totals of its measures.
    """
    period = 2.0 * math.pi / c.Omega
    sides = byte_vector(0)
    count = open_window(state, rows)
    for stage in range(stages.shape[0]):
        stop = stages[stage] * period if waited == col.COMPLETE else state[col.S_T]
        rows, count, code = run_window(c, state, stop, cap, rows, count)
        if waited != col.COMPLETE:
            code = waited
        sides = judge_window(c, rows, count + 1, stages[stage], tolerance, verdict)
        verdict[v.RECORDED] = stages[stage]
        if code != col.COMPLETE:
            clear(verdict)
            verdict[v.REGIME], verdict[v.REMAINING], verdict[v.REASON] = v.UNSETTLED, math.nan, v.CAPPED
            verdict[v.STATUS], verdict[v.RECORDED] = code, stages[stage]
            sides = byte_vector(0)
            break
        # A window without impacts may only be too short.
        if verdict[v.REGIME] != v.OPEN and verdict[v.SCALE] > 0.0:
            break
    if verdict[v.REGIME] == v.OPEN:
        follow(c, state, verdict[v.RECORDED] * period, verdict[v.RECORDED], watch, cap, tolerance, verdict)
    totals = measure_window(c, rows, count + 1, verdict)
    last = rows[count]
    verdict[v.FINAL], verdict[v.FINAL + 1] = last[col.X1], last[col.A_V1]
    verdict[v.FINAL + 2], verdict[v.FINAL + 3], verdict[v.FINAL + 4] = last[col.X2], last[col.A_V2], last[col.PHASE]
    return rows, count + 1, sides, totals


@entry_njit
def look_at_block(parameters, starts, waited, stages, watch, cap, tolerance, impacts, verdicts, totals):
    """Do as `look` for many runs.

    Parameters
    ----------
    parameters, starts : ndarray, shape (n, 5)
        mu, A, Omega, r, lam and x1, v1, x2, v2, phase of each.
    waited : ndarray of int, shape (n,)
        How each came there, as for `look`.
    stages, watch, cap, tolerance
        As for `look`.
    impacts : bool
        Whether the recorded impacts are wanted.
    verdicts, totals : ndarray, shape (n, VERDICT) and (n, TOTALS)
        Filled.

    Returns
    -------
    (sides, hits)
        Sides of the contacts of all repetitions, one behind the other; rows of the impacts, the number of the run last.
    """
    n = parameters.shape[0]
    rows = new_matrix(512, col.ROW)
    state = zero_vector(col.STATE)
    letters = byte_vector(4 * n)
    written = 0
    hits = new_matrix(16, col.ROW + 1)
    filled = 0
    for k in range(n):
        p, s = parameters[k], starts[k]
        c = constants_kernel(p[0], p[1], p[2], p[3], p[4])
        set_state(state, s[0], s[1], s[2], s[3], s[4], 0.0)
        rows, count, sides, total = look(c, state, waited[k], stages, watch, cap, tolerance, rows, verdicts[k])
        totals[k] = total
        if written + sides.shape[0] > letters.shape[0]:
            more = byte_vector(2 * (written + sides.shape[0]))
            more[:written] = letters[:written]
            letters = more
        letters[written : written + sides.shape[0]] = sides
        written += sides.shape[0]
        if not impacts:
            continue
        if filled + count > hits.shape[0]:
            wider = new_matrix(2 * (filled + count), col.ROW + 1)
            wider[:filled] = hits[:filled]
            hits = wider
        for i in range(1, count):
            if rows[i, col.KIND] == col.IMPACT and rows[i, col.TIME] > 0.0:
                hits[filled, : col.ROW] = rows[i]
                hits[filled, col.ROW] = k
                filled += 1
    return letters[:written], hits[:filled].copy()
