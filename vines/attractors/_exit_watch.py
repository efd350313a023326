"""Watch runs with scatter period by period: does a run still show the pattern of impacts of its regime?"""

from __future__ import annotations

import math

from vines.dynamics.kernels import advance, colour_at, constants_at, pass_over, state_now, width_of
from vines.dynamics.kernels import rows as col
from vines.kernels import cold_njit, entry_njit, new_matrix, njit, zero_vector

__all__ = [
    "CAPPED",
    "FELL",
    "GOES_ON",
    "LEFT_IT",
    "MARKS",
    "M_COUNT",
    "M_DONE",
    "M_GROUP",
    "M_STATUS",
    "ROSE",
    "codes_block",
    "places_block",
    "watch_block",
]

M_DONE, M_COUNT, M_GROUP, M_STATUS = range(4)
MARKS = 4
"""What is kept of a run: periods done, how many in a row differ, which other regime they show, what became of it."""

GOES_ON, LEFT_IT, CAPPED, ROSE, FELL = range(5)

ROOM = 128
"""Rows of events for which there is room at once."""

LETTERS = 64
"""Most contacts of a period that are told apart; further ones only count."""


@cold_njit
def _period(c, state, stop, cap, mirrored, rows, letters):
    """Run on to `stop`; return the code of the contacts until then, a complete chatter being one, and the status.

    The code is a number that two patterns share only by an odd chance of 1 to 2^63.
    """
    n, code, status = 0, 0, col.BUFFER_FULL
    while status == col.BUFFER_FULL:
        count, status = advance(c, state, stop, cap, rows, 0)
        for i in range(count):
            kind = rows[i, col.KIND]
            if kind == col.IMPACT:
                if n < LETTERS:
                    letters[n] = rows[i, col.SIDE]
                n += 1
            elif kind == col.STICK:
                n = max(n - int(rows[i, col.RUN]) + 1, 1)
                letters[min(n, LETTERS) - 1] = rows[i, col.SIDE]
    for k in range(min(n, LETTERS)):
        code = code * 1_000_003 + (2 if (letters[k] > 0.0) != mirrored else 1)
    return code + n, status


@njit
def _group(known, groups, code, own):
    """Return a regime that shows a pattern: its own one if it does, else another, else -1."""
    found = -1
    for k in range(known.shape[0]):
        if known[k] == code:
            if groups[k] == own:
                return own
            found = groups[k]
    return found


@njit
def _distance(c, state, t, centres, weights):
    """Return how far a run is at a time from the nearest of the centres, in standard deviations."""
    x1, v1, x2, v2, _, _ = state_now(c, state, t)
    least = math.inf
    for k in range(centres.shape[0]):
        a, b = x1 - centres[k, 0], v1 - centres[k, 1]
        d, e = x2 - centres[k, 2], v2 - centres[k, 3]
        square = 0.0
        for i in range(4):
            part = weights[i, 0] * a + weights[i, 1] * b + weights[i, 2] * d + weights[i, 3] * e
            square += part * part
        least = min(least, square)
    return math.sqrt(least)


@entry_njit
def watch_block(
    table, states, until, cap, known, groups, own, irregular, confirm, centres, weights, lower, upper, peaks, marks
):
    """Run on until the pattern has differed for `confirm` periods, a distance is passed, or the time is over.

    Parameters
    ----------
    table : table of parameters
        Its type says of which system, and whether with scatter.
    states : ndarray, shape (n, STATE)
        Runs that began at time 0; changed.
    until : int
        Forcing periods, counted from time 0, to run to.
    cap : int
        Most events in one forcing period.
    known, groups : ndarray of int, shape (m,)
        Codes of patterns, and the regime that shows each.
    own : int
        The regime that runs are in.
    irregular : bool
        Whether it has no patterns of its own: then a period differs that shows the pattern of another.
    confirm : int
        Periods in a row after which a run has left it.
    centres, weights : ndarray, shape (k, 4) and (4, 4)
        States and what makes distances of differences; no centre, no distance.
    lower, upper : float
        Distances at which a run stops.
    peaks : ndarray, shape (n,)
        Largest distances, changed.
    marks : ndarray of int, shape (n, MARKS)
        Changed.
    """
    rows, letters = new_matrix(ROOM, width_of(table)), zero_vector(LETTERS)
    for who in range(states.shape[0]):
        c = constants_at(table, who)
        period = 2.0 * math.pi / c.Omega
        mark, state = marks[who], states[who]
        while mark[M_STATUS] == GOES_ON and mark[M_DONE] < until:
            stop = (mark[M_DONE] + 1) * period
            code, status = _period(c, state, stop, cap, False, rows, letters)
            if status != col.COMPLETE:
                mark[M_STATUS] = CAPPED
                break
            mark[M_DONE] += 1
            group = _group(known, groups, code, own)
            differs = (group >= 0 and group != own) if irregular else group != own
            if differs and irregular and group != mark[M_GROUP]:
                mark[M_COUNT] = 0
            mark[M_COUNT] = mark[M_COUNT] + 1 if differs else 0
            mark[M_GROUP] = group
            if mark[M_COUNT] >= confirm:
                mark[M_STATUS] = LEFT_IT
            elif centres.shape[0] > 0:
                away = _distance(c, state, stop, centres, weights)
                peaks[who] = max(peaks[who], away)
                if away >= upper:
                    mark[M_STATUS] = ROSE
                elif away < lower and not differs:
                    mark[M_STATUS] = FELL


@entry_njit
def codes_block(table, states, periods, cap, mirrored, codes):
    """Fill `codes`, shape (n, periods), with those of each period of runs from time 0 on; -1 where one had to stop.

    `mirrored` says whether they are those of the mirror images.
    """
    rows, letters = new_matrix(ROOM, width_of(table)), zero_vector(LETTERS)
    for who in range(states.shape[0]):
        c = constants_at(table, who)
        period = 2.0 * math.pi / c.Omega
        for k in range(periods):
            code, status = _period(c, states[who], (k + 1) * period, cap, mirrored, rows, letters)
            codes[who, k] = code if status == col.COMPLETE else -1


@entry_njit
def places_block(table, states, periods, cap, out):
    """Run on to so many forcing periods from time 0, and say where runs are then.

    `out`, shape (n, 6), is filled with x1, v1, x2, v2, phase and the coloured force; with nan where a run had to stop.
    """
    rows = new_matrix(ROOM, width_of(table))
    for who in range(states.shape[0]):
        c = constants_at(table, who)
        t = periods[who] * 2.0 * math.pi / c.Omega
        status = pass_over(c, states[who], t, cap, rows)
        x1, v1, x2, v2, phase, _ = state_now(c, states[who], t)
        out[who, 0], out[who, 1], out[who, 2], out[who, 3] = x1, v1, x2, v2
        out[who, 4], out[who, 5] = phase, colour_at(c, t)
        if status != col.COMPLETE:
            out[who, 0] = math.nan
