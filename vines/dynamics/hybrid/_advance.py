"""The event loop: flights and sticking by series."""

from __future__ import annotations

from vines.dynamics import _advance as col
from vines.dynamics._advance import (
    BUFFER_FULL,
    COMPLETE,
    EVENT_CAP,
    RELEASE,
    S_CLEAR,
    S_DECIDE,
    S_MODE,
    S_T,
    S_T_LOW,
    S_V1,
    S_V2,
    S_WALL,
    S_X1,
    S_X2,
    START,
    STEP_LIMIT,
    advance,
    begin,
    count_run,
    merge,
    move,
    place,
    set_state,
    strike,
    too_many,
    write_row,
)
from vines.dynamics._contact import CONTACT, NO_CONTACT
from vines.dynamics._flight import advance_phase, drift, phase_after
from vines.dynamics._window import width_of, write_end
from vines.dynamics.hybrid._constants import HybridConstants, HybridTable
from vines.dynamics.hybrid._flights import next_event, open_step
from vines.dynamics.hybrid._layout import HYBRID_ROW, S_V3, S_X3, begin_step, fill
from vines.dynamics.hybrid._series import Z
from vines.dynamics.taylor._advance import settles
from vines.dynamics.taylor._layout import SINCE
from vines.dynamics.taylor._series import W, X, at, coefficients
from vines.kernels import entry_njit, linked_njit, loop_njit, njit

__all__ = ["set_hybrid"]

drift.register(HybridConstants)(drift.first)
phase_after.register(HybridConstants)(phase_after.first)


@width_of.register(HybridTable)
@njit
def _width_of(table):
    return HYBRID_ROW


@njit
def _depart(state):
    """Let the first step of a motion begin at the last event."""
    x, v, wall = state[S_X1], state[S_V1], state[S_WALL]
    w = wall if wall != 0.0 else x - state[S_X2]
    begin_step(state, 0.0, x, v, w, v - state[S_V2], x - state[S_X3], v - state[S_V3])


@entry_njit
def set_hybrid(c, state, x1, v1, x2, v2, x3, v3, phase, t):
    """Put a run at its start; see `set_state`."""
    set_state(state, x1, v1, x2, v2, phase, t)
    state[S_X3], state[S_V3] = x3, v3
    _depart(state)


_begin_one = begin.first


@begin.register(HybridConstants)
@linked_njit
def _begin(c, state, rows):
    _begin_one(c, state, rows)
    fill(rows[0], state[S_MODE], state[S_X3], state[S_V3])


@linked_njit
def _merges(c, state, wall):
    """Say whether the ball sticks to the wall that it is on, from the series that begins there."""
    open_step(c, state)
    return settles(c, state, wall)


@advance.register(HybridConstants)
@loop_njit
def _advance(c, state, stop, cap, rows, first):
    a = coefficients(c.field)
    order = c.field.order
    count = first
    size = rows.shape[0]
    period = c.period
    while True:
        if count >= size:
            return count, BUFFER_FULL
        left = (stop - state[S_T]) - state[S_T_LOW]
        if left < 0.0:
            return count, COMPLETE
        side = int(state[S_MODE])
        row = rows[count]
        if side == 0 and state[S_DECIDE] != 0.0:
            state[S_DECIDE] = 0.0
            wall = int(state[S_WALL])
            if _merges(c, state, wall):
                merge(c, state, wall, state[S_X1], state[S_V1], state[S_X2], state[S_V2], row)
                fill(row, 0.0, state[S_X3], state[S_V3])
                _depart(state)
                count += 1
                if too_many(state, cap, period):
                    return count, EVENT_CAP
                continue
        # A motion is started afresh once a period, so that its rows are a stroboscope where nothing is hit.
        until = min(left, period)
        code, tau, hit = next_event(c, state, until)
        if code != CONTACT:
            state[S_CLEAR] = tau
            if code != NO_CONTACT:
                return count, STEP_LIMIT
            if left <= period:
                return count, COMPLETE
        # The room still holds the step in which the search ended.
        s = tau - state[SINCE]
        x, v = at(a, X, order, s)
        w, u = at(a, W, order, s)
        z, y = at(a, Z, order, s)
        move(c, state, tau)
        state[S_X3], state[S_V3] = x - z, v - y
        if code != CONTACT:
            place(state, side, side, 0.0, x, v, x - w, v - u)
            begin_step(state, 0.0, x, v, w, u, z, y)
            write_row(row, state, START, 0, tau, x, v, state[S_X2], state[S_V2])
            fill(row, side, state[S_X3], state[S_V3])
            count += 1
            continue
        if side != 0:
            place(state, 0, side, 1.0, x, v, x - side, v)
            _depart(state)
            open_step(c, state)
            if side * a[W + 3] >= 0.0:
                # Contact was lost at once, with a push away from the wall that is not zero.
                state[col.S_RELEASED] = 0.0
            write_row(row, state, RELEASE, side, tau, x, v, x - side, v)
        else:
            count_run(state, hit)
            strike(c.law, state, hit, tau, x, v, v - u, row)
            _depart(state)
        fill(row, side, state[S_X3], state[S_V3])
        count += 1
        if too_many(state, cap, period):
            return count, EVENT_CAP


@write_end.register(HybridConstants)
@linked_njit
def _write_end(c, state, end, last):
    tau = (end - state[S_T]) - state[S_T_LOW]
    open_step(c, state)
    a, s = coefficients(c.field), tau - state[SINCE]
    x, v = at(a, X, c.field.order, s)
    w, u = at(a, W, c.field.order, s)
    z, y = at(a, Z, c.field.order, s)
    last[col.KIND], last[col.SIDE], last[col.TIME], last[col.TAU] = col.END, 0.0, end, tau
    last[col.PHASE] = advance_phase(state[col.S_PHASE], c.Omega * tau)
    last[col.MODE], last[col.RUN] = state[S_MODE], 0.0
    last[col.X1], last[col.V1], last[col.X2], last[col.V2] = x, v, x - w, v - u
    last[col.A_V1], last[col.A_V2] = v, v - u
    fill(last, state[S_MODE], x - z, v - y)
