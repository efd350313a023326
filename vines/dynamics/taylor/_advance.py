"""The event loop: flights by series, sticking in closed form."""

from __future__ import annotations

import math

from vines.dynamics import _advance as col
from vines.dynamics._advance import (
    BUFFER_FULL,
    COMPLETE,
    EVENT_CAP,
    RELEASE,
    S_CLEAR,
    S_DECIDE,
    S_MODE,
    S_PHASE,
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
from vines.dynamics._sticking import UNRESOLVED, ends_chatter
from vines.dynamics._window import width_of, write_end
from vines.dynamics.taylor._constants import TaylorConstants, TaylorTable
from vines.dynamics.taylor._contacts import fly, open_step
from vines.dynamics.taylor._held import release, ride
from vines.dynamics.taylor._layout import SINCE, begin_step
from vines.dynamics.taylor._series import W, X, at, coefficients
from vines.kernels import entry_njit, linked_njit, loop_njit, njit

__all__ = ["set_mass", "settles"]

begin.register(TaylorConstants)(begin.first)
drift.register(TaylorConstants)(drift.first)
phase_after.register(TaylorConstants)(phase_after.first)
width_of.register(TaylorTable)(width_of.first)


@njit
def _depart(state):
    """Let the first step of a flight begin at the last event."""
    x, v, wall = state[S_X1], state[S_V1], state[S_WALL]
    w = wall if wall != 0.0 else x - state[S_X2]
    begin_step(state, 0.0, x, v, w, v - state[S_V2])


@entry_njit
def set_mass(c, state, x1, v1, x2, v2, phase, t):
    """Put a run at its start; without barriers any gap is one."""
    set_state(state, x1, v1, x2, v2, phase, t)
    if c.walls == 0.0:
        state[S_X2], state[S_WALL], state[S_DECIDE] = x2, 0.0, 0.0
    _depart(state)


@linked_njit
def _merges(c, state, wall):
    """Say whether the mass sticks to the wall that it is on, from the series that begins there."""
    open_step(c, state)
    return settles(c, state, wall)


@linked_njit
def settles(c, state, wall):
    """Say the same where the room holds that series."""
    a = coefficients(c.field)
    speed = max(wall * (state[S_V2] - state[S_V1]), 0.0)
    size = 1.0 + abs(state[S_X1]) + abs(state[S_X2]) + c.A * (1.0 + c.Omega)
    push, jerk, snap = 2.0 * wall * a[W + 2], 6.0 * wall * a[W + 3], 24.0 * abs(a[W + 4])
    return ends_chatter(c.r, c.correction, speed, push, jerk, snap, UNRESOLVED * size, math.inf)


@advance.register(TaylorConstants)
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
        x1, v1 = state[S_X1], state[S_V1]
        # A flight is started afresh once a period, so that its rows are a stroboscope where nothing is hit.
        until = min(left, period)
        if side != 0:
            code, tau, x, v = release(c.stuck, c, side, x1, v1, state[S_PHASE], state[S_CLEAR], until)
            if code == CONTACT:
                move(c, state, tau)
                place(state, 0, side, 1.0, x, v, x - side, v)
                _depart(state)
                open_step(c, state)
                if side * a[W + 3] >= 0.0:
                    # Contact was lost at once, with a push away from the wall that is not zero.
                    state[col.S_RELEASED] = 0.0
                write_row(rows[count], state, RELEASE, side, tau, x, v, x - side, v)
                count += 1
                if too_many(state, cap, period):
                    return count, EVENT_CAP
                continue
        else:
            wall = int(state[S_WALL])
            if state[S_DECIDE] != 0.0:
                state[S_DECIDE] = 0.0
                if _merges(c, state, wall):
                    x2, v2 = state[S_X2], state[S_V2]
                    merge(c, state, wall, x1, v1, x2, v2, rows[count])
                    count += 1
                    if too_many(state, cap, period):
                        return count, EVENT_CAP
                    continue
            code, tau, hit = fly(c, state, until)
            if code == CONTACT:
                s = tau - state[SINCE]
                x, v = at(a, X, order, s)
                _, u = at(a, W, order, s)
                move(c, state, tau)
                count_run(state, hit)
                strike(c.law, state, hit, tau, x, v, v - u, rows[count])
                _depart(state)
                count += 1
                if too_many(state, cap, period):
                    return count, EVENT_CAP
                continue
        state[S_CLEAR] = tau
        if code != NO_CONTACT:
            return count, STEP_LIMIT
        if left <= period:
            return count, COMPLETE
        if side != 0:
            x, v = ride(c.stuck, c.Omega, x1, v1, state[S_PHASE], until)
            move(c, state, until)
            place(state, side, side, 0.0, x, v, x - side, v)
        else:
            # The room still holds the step in which the search ended.
            s = until - state[SINCE]
            x, v = at(a, X, order, s)
            w, u = at(a, W, order, s)
            move(c, state, until)
            place(state, 0, 0, 0.0, x, v, x - w, v - u)
            begin_step(state, 0.0, x, v, w, u)
        write_row(rows[count], state, START, 0, until, x, v, state[S_X2], state[S_V2])
        count += 1


@write_end.register(TaylorConstants)
@linked_njit
def _write_end(c, state, end, last):
    tau = (end - state[S_T]) - state[S_T_LOW]
    side = state[S_MODE]
    if side != 0.0:
        x, v = ride(c.stuck, c.Omega, state[S_X1], state[S_V1], state[S_PHASE], tau)
        x2, v2 = x - side, v
    else:
        open_step(c, state)
        a = coefficients(c.field)
        x, v = at(a, X, c.field.order, tau - state[SINCE])
        w, u = at(a, W, c.field.order, tau - state[SINCE])
        x2, v2 = x - w, v - u
    last[col.KIND], last[col.SIDE], last[col.TIME], last[col.TAU] = col.END, 0.0, end, tau
    last[col.PHASE], last[col.MODE], last[col.RUN] = advance_phase(state[S_PHASE], c.Omega * tau), side, 0.0
    last[col.X1], last[col.V1], last[col.X2], last[col.V2] = x, v, x2, v2
    last[col.A_V1], last[col.A_V2] = v, v2
