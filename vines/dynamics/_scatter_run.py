"""Run trajectories with scatter, one after the other, by the scalar kernel."""

from __future__ import annotations

import math

from vines.dynamics import _advance as col
from vines.dynamics import _lane_run as lanes
from vines.dynamics import _totals as entry
from vines.dynamics._advance import pass_over, set_state, state_now
from vines.dynamics._batches import BATCHES, PART, close_batch, standard_errors
from vines.dynamics._scatter_constants import scatter_constants
from vines.dynamics._scatter_energies import fill_forms
from vines.dynamics._totals import window_totals
from vines.dynamics._window import open_window, run_window
from vines.kernels import entry_njit, linked_njit, new_matrix, njit, zero_matrix, zero_vector

__all__ = ["scatter_block"]

ROOM = 256
"""Rows of a part of a run for which there is room at first."""


@linked_njit
def _keep_impacts(rows, count, who, events, filled):
    """Add the impacts among the rows of a window to the events; return how many there are, -1 if they do not fit."""
    for i in range(1, count):
        if rows[i, col.KIND] != col.IMPACT:
            continue
        if filled >= events.shape[0]:
            return -1
        for j in range(col.ROW):
            events[filled, j] = rows[i, j]
        events[filled, col.ROW] = who
        filled += 1
    return filled


@njit
def _is_like_the_last(parameters, who):
    same = who > 0
    for k in range(parameters.shape[1]):
        same = same and parameters[who, k] == parameters[who - 1, k]
    return same


@entry_njit
def scatter_block(
    parameters,
    starts,
    first,
    lengths,
    cap,
    what,
    finals,
    totals,
    errors,
    counts,
    status,
    events,
    numbers,
    base,
    address,
):
    """Run a block of trajectories with scatter, the first of which has the number `base`.

    Other arguments are as for `run_block` and `scatter_constants`.

    Returns
    -------
    int
        Impacts filled.
    """
    filled = 0
    rows, state = new_matrix(ROOM, col.ROW), zero_vector(col.STATE)
    values, spread, total = zero_matrix(BATCHES, PART), zero_vector(3), zero_vector(entry.TOTALS)
    for who in range(parameters.shape[0]):
        s, length = starts[who], lengths[who]
        c = scatter_constants(parameters[who], numbers[who], base + who, -first[who], address)
        if what & lanes.WITH_MEASURES and c.drawn and not _is_like_the_last(parameters, who):
            fill_forms(c)
        set_state(state, s[0], s[1], s[2], s[3], s[4], -first[who])
        code, end = col.COMPLETE, 0.0
        if not what or first[who] > 0.0:
            end = 0.0 if what else length
            code = pass_over(c, state, end, cap, rows)
        for k in range(entry.TOTALS):
            total[k] = 0.0
        part = 0
        while what and part < BATCHES and code == col.COMPLETE:
            begins = end
            part += 1
            end = length if part == BATCHES else part * length / BATCHES
            rows, count, code = run_window(c, state, end, cap, rows, open_window(c, state, rows))
            if what & lanes.WITH_MEASURES:
                sums = window_totals(c, rows, count + 1, begins, rows[count, col.TIME])
                close_batch(c.mu, sums, total, values[part - 1])
            if what & lanes.WITH_IMPACTS:
                filled = _keep_impacts(rows, count, who, events, filled)
                if filled < 0:
                    status[who] = lanes.OVERFLOW
                    return events.shape[0]
        status[who] = lanes.DONE
        if code != col.COMPLETE:
            status[who] = lanes.CAP if code == col.EVENT_CAP else lanes.LIMIT
            end = state[col.S_T] + state[col.S_T_LOW]
        x1, v1, x2, v2, phase, _ = state_now(c, state, end)
        finals[who, 0], finals[who, 1], finals[who, 2], finals[who, 3] = x1, v1, x2, v2
        finals[who, 4], finals[who, 5] = phase, state[col.S_MODE]
        counts[who] = int(state[col.S_IMPACTS])
        if what & lanes.WITH_MEASURES:
            for k in range(entry.TOTALS):
                totals[who, k] = total[k]
            for k in range(3):
                errors[who, k] = math.nan
            if code == col.COMPLETE:
                standard_errors(c.lam, values, total, spread)
                for k in range(3):
                    errors[who, k] = spread[k]
    return filled
