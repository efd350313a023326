"""Record a window of each of many runs, decide what it shows, and say whether the run goes on."""

from __future__ import annotations

import math

from vines.attractors import _verdict as v
from vines.attractors._follow import follow
from vines.attractors._judge import clear, judge_window
from vines.attractors._window import measure_window
from vines.dynamics.kernels import constants_at, directions, open_window, run_window, width_of, with_room
from vines.dynamics.kernels import rows as col
from vines.kernels import byte_vector, cold_njit, entry_njit, new_matrix, new_vector, njit

__all__ = ["is_regular_block", "look_at_block"]

STRETCH = 1.5
"""Factor on the patience left up to which a run is taken on: far from its orbit it may be quicker than estimated."""


ROOM = 512
"""Rows of a window for which there is room at first."""


@cold_njit
def _look(c, state, waited, stages, watch, cap, tolerance, longest, rows, room, verdict):
    """Record a run from time 0 on, until it repeats or the last stage ends, and decide what it shows.

    Returns
    -------
    (rows, n, room, sides)
        The window's rows and their number, room for what is run on with, and sides of the contacts in one repetition.
    """
    period = 2.0 * math.pi / c.Omega
    sides = byte_vector(0)
    count = open_window(c, state, rows)
    for stage in range(stages.shape[0]):
        stop = stages[stage] * period if waited == col.COMPLETE else state[col.S_T]
        rows, count, code = run_window(c, state, stop, cap, rows, count)
        if waited != col.COMPLETE:
            code = waited
        if code != col.COMPLETE:
            clear(verdict)
            verdict[v.REGIME], verdict[v.REMAINING], verdict[v.REASON] = v.UNSETTLED, math.nan, v.CAPPED
            verdict[v.STATUS], verdict[v.RECORDED] = code, stages[stage]
            sides = byte_vector(0)
            break
        sides = judge_window(c, rows, count + 1, stages[stage], tolerance, longest, verdict)
        verdict[v.RECORDED] = stages[stage]
        # A window without impacts may only be too short.
        if verdict[v.REGIME] != v.OPEN and verdict[v.SCALE] > 0.0:
            break
    if verdict[v.REGIME] == v.OPEN:
        room = follow(c, state, verdict[v.RECORDED] * period, watch, cap, tolerance, longest, room, verdict)
    verdict[v.FINAL], verdict[v.FINAL + 1] = rows[count, col.X1], rows[count, col.A_V1]
    verdict[v.FINAL + 2], verdict[v.FINAL + 3] = rows[count, col.X2], rows[count, col.A_V2]
    verdict[v.FINAL + 4] = rows[count, col.PHASE]
    # What a row has of further balls is at its end, and goes to the end of the verdict.
    more = rows.shape[1] - col.ROW
    for k in range(more):
        verdict[verdict.shape[0] - more + k] = rows[count, col.ROW + k]
    return rows, count + 1, room, sides


@njit
def _what_next(verdict, spare, may_free):
    """Say what becomes of a run: it is freed from an unstable orbit, waits for its attractor, or is taken as it is."""
    if verdict[v.UNSTABLE] > 0.0 and may_free:
        return v.IS_FREED
    if verdict[v.SETTLED] == 0.0 and spare > 0.0 and verdict[v.REMAINING] <= STRETCH * spare:
        return v.WAITS
    return v.STAYS


@entry_njit
def look_at_block(table, states, waited, spare, stages, watch, cap, tolerance, longest, impacts, verdicts, totals):
    """Record runs from time 0 on, each until it repeats or the last stage ends, and decide what they show.

    Parameters
    ----------
    table : ParameterTable
        Parameters of each; its type is that of the system.
    states : ndarray, shape (n, STATE)
        The runs at time 0; on return at the ends of their windows.
    waited : ndarray of int, shape (n,)
        How each came there: COMPLETE, or it had to stop, and then the window is only the instant of its stop.
    spare : ndarray, shape (n, 2)
        Forcing periods that each may still wait, and whether it may be freed from an unstable orbit.
    stages : ndarray
        Forcing periods after which to look whether a run repeats; the last is the longest window.
    watch : float
        As for `follow`.
    cap : int
        Most events in one forcing period.
    tolerance, longest
        As for `judge_window`.
    impacts : bool
        Whether the recorded impacts are wanted.
    verdicts, totals : ndarray, shape (n, VERDICT) and (n, TOTALS)
        Filled; totals, and what else the window is measured for, only where a run stays as it is.

    Returns
    -------
    (sides, hits)
        Sides of the contacts of all repetitions, one behind the other; rows of the impacts of runs that stay, the
        number of the run last.
    """
    n = states.shape[0]
    # Taken once: fresh memory costs as much as a short run.
    width = width_of(table)
    rows, room = new_matrix(ROOM, width), new_matrix(ROOM, width)
    letters = byte_vector(4 * n)
    written = 0
    hits = new_matrix(16, width + 1)
    filled = 0
    for k in range(n):
        c = constants_at(table, k)
        verdict = verdicts[k]
        rows, count, room, sides = _look(
            c, states[k], waited[k], stages, watch, cap, tolerance, longest, rows, room, verdict
        )
        if written + sides.shape[0] > letters.shape[0]:
            letters = _longer(letters, written, 2 * (written + sides.shape[0]))
        for i in range(sides.shape[0]):
            letters[written + i] = sides[i]
        written += sides.shape[0]
        verdict[v.NEXT] = _what_next(verdict, spare[k, 0], spare[k, 1] > 0.0)
        if verdict[v.NEXT] != v.STAYS:
            continue
        measure_window(c, rows, count, verdict, totals[k])
        if not impacts:
            continue
        if filled + count > hits.shape[0]:
            hits = with_room(hits, filled, 2 * (filled + count))
        for i in range(1, count):
            if rows[i, col.KIND] == col.IMPACT and rows[i, col.TIME] > 0.0:
                for j in range(width):
                    hits[filled, j] = rows[i, j]
                hits[filled, width] = k
                filled += 1
    return letters[:written], hits[:filled]


@cold_njit
def _longer(letters, count, room):
    """Return a vector of so many letters, the first `count` of which are those given."""
    longer = byte_vector(room)
    for i in range(count):
        longer[i] = letters[i]
    return longer


@entry_njit
def is_regular_block(table, states, periods, cap, tolerance, longest, regular):
    """Say of each run, from time 0 on, whether it repeats, comes to an orbit or has no impact over so many periods.

    Parameters
    ----------
    table, states, cap, tolerance, longest
        As for `look_at_block`.
    periods : float
        Forcing periods.
    regular : ndarray of bool, shape (n,)
        Filled.
    """
    rows = new_matrix(ROOM, width_of(table))
    for k in range(states.shape[0]):
        c = constants_at(table, k)
        verdict = new_vector(v.EXPONENTS + 3 * len(directions(c)))
        rows, count, code = run_window(
            c, states[k], periods * 2.0 * math.pi / c.Omega, cap, rows, open_window(c, states[k], rows)
        )
        judge_window(c, rows, count + 1, periods, tolerance, longest, verdict)
        regime = verdict[v.REGIME]
        # A motion without impacts is watched on at once, and may never repeat.
        regular[k] = code == col.COMPLETE and regime not in (v.OPEN, v.QUASIPERIODIC, v.CHAOTIC)
