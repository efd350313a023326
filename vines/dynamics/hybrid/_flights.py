"""Motion between events, with the ball in flight or riding: step by step, and the search for the next event."""

from __future__ import annotations

from vines.dynamics._advance import A_V1, A_V2, MODE, PHASE, S_MODE, S_PHASE, S_RELEASED, S_WALL, X1, X2
from vines.dynamics._contact import CONTACT, MAX_STEPS, NO_CONTACT, STEP_CAP
from vines.dynamics._flight import advance_phase
from vines.dynamics.hybrid._layout import R_V3, R_X3, STEP_Y, STEP_Z, begin_step
from vines.dynamics.hybrid._series import PUSH, Z, expand_both
from vines.dynamics.taylor._contacts import hit_within
from vines.dynamics.taylor._layout import CLEAR, SINCE, STEP_U, STEP_V, STEP_W, STEP_X
from vines.dynamics.taylor._release import release_in_step
from vines.dynamics.taylor._series import W, X, at, coefficients
from vines.kernels import fused_njit, loop_njit

__all__ = ["carry", "next_event", "of_row", "open_step", "place_row"]


@fused_njit
def open_step(c, state):
    """Expand the series of the step that a motion is in; return its length."""
    phase = advance_phase(state[S_PHASE], c.Omega * state[SINCE])
    load = c.mu if state[S_MODE] != 0.0 else 0.0
    x, v, w, u = state[STEP_X], state[STEP_V], state[STEP_W], state[STEP_U]
    return expand_both(c.field, load, x, v, w, u, state[STEP_Z], state[STEP_Y], phase)


@loop_njit
def next_event(c, state, stop):
    """Search a motion for its first contact or release until `stop`, in time since the last event.

    Returns
    -------
    (code, tau, side)
        With CONTACT, time since the last event and the wall; the state is left in the step in which it happens, and
        the room holds that.
    """
    f = c.field
    order = f.order
    a = coefficients(f)
    rides = int(state[S_MODE])
    for _ in range(MAX_STEPS):
        since = state[SINCE]
        h = open_step(c, state)
        if not h > 0.0:
            break
        until = min(h, stop - since)
        if rides != 0:
            side = rides
            code, s = release_in_step(f, PUSH, h, state[CLEAR], until, side, 0.0, since)
        else:
            wall = int(state[S_WALL]) if since == 0.0 else 0
            released = wall != 0 and state[S_RELEASED] != 0.0
            code, s, side = hit_within(f, h, state[CLEAR], until, wall, released, since)
        if code == CONTACT:
            return CONTACT, since + s, side
        state[CLEAR] = s
        if code == STEP_CAP:
            return STEP_CAP, since + s, 0
        if since + h >= stop:
            return NO_CONTACT, stop, 0
        x, v = at(a, X, order, h)
        w, u = at(a, W, order, h)
        z, y = at(a, Z, order, h)
        begin_step(state, since + h, x, v, w, u, z, y)
    return STEP_CAP, state[SINCE], 0


@fused_njit
def of_row(row):
    """Return x1, x1', w, w', z, z' just after the event of a row."""
    x, v = row[X1], row[A_V1]
    return x, v, x - row[X2], v - row[A_V2], x - row[R_X3], v - row[R_V3]


@fused_njit
def place_row(row, x, v, w, u, z, y, phase):
    """Let a row hold a state, with nothing before it."""
    row[X1], row[A_V1], row[X2], row[A_V2], row[PHASE] = x, v, x - w, v - u, phase
    row[R_X3], row[R_V3] = x - z, v - y


@loop_njit
def carry(c, row, tau):
    """Move the state of a row on by tau, at which the next event may be."""
    f = c.field
    a = coefficients(f)
    load = c.mu if row[MODE] != 0.0 else 0.0
    x, v, w, u, z, y = of_row(row)
    done = 0.0
    while True:
        h = expand_both(f, load, x, v, w, u, z, y, advance_phase(row[PHASE], f.Omega * done))
        left = tau - done
        h = min(h, left)
        x, v = at(a, X, f.order, h)
        w, u = at(a, W, f.order, h)
        z, y = at(a, Z, f.order, h)
        if not h < left:
            break
        done += h
    place_row(row, x, v, w, u, z, y, advance_phase(row[PHASE], f.Omega * tau))
