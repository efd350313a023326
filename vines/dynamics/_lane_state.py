"""Between a lane and the scalar kernel: put a state into a lane, take it out, write the row of its impact."""

from __future__ import annotations

import math

from vines.dynamics import _advance as col
from vines.dynamics import _lane_fields as f
from vines.dynamics._contact import first_step
from vines.dynamics._flight import advance_phase, modulus, phasors, turn
from vines.dynamics._lane_certificate import MARGIN
from vines.dynamics._lane_motion import MOST_DECAY, MOST_TURN, NEAR_DECAY, NEAR_TURN, flow
from vines.dynamics._lanes import LOOSER
from vines.dynamics._sincos import sincos
from vines.dynamics._sticking import UNRESOLVED, merges
from vines.kernels import linked_njit, njit

__all__ = ["fill_lane", "may_fly", "row_of", "take_lane"]

LANE_LARGE = 256.0
"""Steady amplitude above which the scalar kernel takes every flight: lanes keep free and forced motion apart."""


@linked_njit
def fill_lane(held, state, L, i, length):
    """Put a lane where the scalar state is, in flight; say whether it can run there.

    `held` are the constants of all lanes; a call that hands on those of one copies a hundred numbers.
    """
    c = held[i]
    wall = state[col.S_WALL]
    released = state[col.S_RELEASED] != 0.0
    x, v, phase = state[col.S_X1], state[col.S_V1], state[col.S_PHASE]
    forced = modulus(c.free.qr, c.free.qi)
    if not forced <= LANE_LARGE:
        return False
    ur, ui, gr, gi = phasors(c.free, c.Omega, x, v, phase)
    step = 0.0
    if wall != 0.0:
        # On the wall itself the gap vanishes with its derivatives after a release: so far the scalar kernel answers.
        step = first_step(c, c.free, 1.0, (ur, ui, gr, gi), state[col.S_V2], int(wall), released)
        if step < 1e-8:
            return False
    fastest = max(1.0, c.Omega)
    limit = min(MOST_TURN / fastest, MOST_DECAY / max(c.free.half, 1e-3))
    elapsed = state[col.S_T] + state[col.S_T_LOW]
    left = length - elapsed
    step = min(step, limit)
    if left <= step + 1e-9:
        return False
    L[f.HALF + i] = c.free.half
    L[f.GAMMA + i] = c.free.gamma
    L[f.INVERSE + i] = 1.0 / c.free.gamma
    L[f.OMEGA + i] = c.Omega
    L[f.LAM + i] = c.lam
    L[f.PASS1 + i] = c.law.pass1
    L[f.PASS2 + i] = c.law.pass2
    L[f.Q_RE + i] = c.free.qr
    L[f.Q_IM + i] = c.free.qi
    force = modulus(gr, gi)
    L[f.FORCED8 + i] = 1.000000001 * forced * c.Omega4 * c.Omega4
    L[f.MARGIN + i] = 1.0 - MARGIN * (1.0 + forced)
    L[f.LIMIT + i] = limit
    L[f.NEAR + i] = min(NEAR_TURN / fastest, NEAR_DECAY / max(c.free.half, 1e-3))
    L[f.CORRECTION + i] = c.correction
    # `merges` takes sizes of u, G, x2, at most 2.42 (|z| + |q|) + 1.42 |G| + 1.
    L[f.HEIGHT + i] = LOOSER * UNRESOLVED * (2.0 + 2.42 * forced + 1.42 * force)
    L[f.PERIOD + i] = c.period
    sine, cosine = sincos(phase)
    xh = x - (c.free.qr * cosine - c.free.qi * sine)
    vh = v + c.Omega * (c.free.qr * sine + c.free.qi * cosine)
    L[f.AMPLITUDE + i] = 1.000000001 * modulus(xh, (vh + c.free.half * xh) * c.free.inverse)
    L[f.X_FREE + i], L[f.V_FREE + i], L[f.COS + i], L[f.SIN + i] = flow(
        c.free.half, c.free.gamma, c.free.inverse, c.Omega, xh, vh, cosine, sine, step
    )
    L[f.BALL + i] = state[col.S_X2] + state[col.S_V2] * step
    L[f.SPEED + i] = state[col.S_V2]
    L[f.LEFT + i] = left - step
    L[f.MOVE + i] = 0.0
    L[f.TRIES + i] = 0.0
    L[f.LAST + i] = 0.5 * c.period
    L[f.ONE_BEFORE + i] = 0.5 * c.period
    L[f.USUAL + i] = 0.5 * c.period
    L[f.TAU + i] = step
    L[f.WALL + i] = wall
    L[f.RELEASED + i] = 1.0 if released else 0.0
    L[f.CHAIN + i] = 0.0 if released or state[col.S_RUN_SIDE] != wall else state[col.S_RUN]
    L[f.BUSY + i] = state[col.S_PERIOD_EVENTS]
    L[f.BEGAN + i] = left + (elapsed - state[col.S_PERIOD_START])
    L[f.UNIT + i] = 1.0
    L[f.WAITS + i] = 0.0
    L[f.HIT + i] = 0.0
    return True


@njit
def _clock(omega, period, phase, phase0, roughly):
    """Return the time since `phase0` was the phase: exact to the rounding of the phase, its period from `roughly`."""
    part = advance_phase(phase - phase0, 0.0) / omega
    return part + period * round((roughly - part) / period)


@linked_njit
def take_lane(held, L, i, state, length, phase0):
    """Put the scalar state where the flight of a lane began."""
    c = held[i]
    tau = L[f.TAU + i]
    o = c.free
    xh, vh = L[f.X_FREE + i], L[f.V_FREE + i]
    # The free part goes back by itself: long after its start it is far below the rounding of the whole.
    ur, ui, _, _ = turn(o, c.Omega, xh, -(vh + o.half * xh) * o.inverse, 0.0, 0.0, -tau)
    phase = advance_phase(math.atan2(L[f.SIN + i], L[f.COS + i]), -c.Omega * tau)
    sine, cosine = sincos(phase)
    x = ur + (o.qr * cosine - o.qi * sine)
    v = -o.half * ur - o.gamma * ui - c.Omega * (o.qr * sine + o.qi * cosine)
    wall = L[f.WALL + i]
    began = _clock(c.Omega, c.period, phase, phase0, length - (L[f.LEFT + i] + tau))
    state[:] = 0.0
    state[col.S_WALL] = wall
    state[col.S_RELEASED] = L[f.RELEASED + i]
    state[col.S_X1] = x
    state[col.S_V1] = v
    state[col.S_X2] = x - wall if wall != 0.0 else L[f.BALL + i] - L[f.SPEED + i] * tau
    state[col.S_V2] = L[f.SPEED + i]
    state[col.S_PHASE] = phase
    state[col.S_T] = began
    state[col.S_RUN] = L[f.CHAIN + i]
    state[col.S_RUN_SIDE] = wall
    state[col.S_PERIOD_START] = length - L[f.BEGAN + i]
    state[col.S_PERIOD_EVENTS] = L[f.BUSY + i]
    # Only just after an impact is there a question whether the ball leaves.
    struck = wall != 0.0 and tau == 0.0 and L[f.RELEASED + i] == 0.0
    state[col.S_DECIDE] = 1.0 if struck else 0.0


@linked_njit
def _leaves(c, state):
    """Say whether a ball that has just struck leaves the wall."""
    wall = state[col.S_WALL]
    ur, ui, gr, gi = phasors(c.free, c.Omega, state[col.S_X1], state[col.S_V1], state[col.S_PHASE])
    speed = max(wall * (state[col.S_V2] - state[col.S_V1]), 0.0)
    return not merges(c, c.free, c.r, c.correction, int(wall), speed, (ur, ui, gr, gi), state[col.S_X2])


@njit
def may_fly(c, state):
    """Say whether the scalar state is that of an ordinary flight."""
    # Where no sum is needed no call is made, which would hand on all constants.
    return state[col.S_MODE] == 0.0 and (state[col.S_DECIDE] == 0.0 or _leaves(c, state))


@linked_njit
def row_of(L, i, row, length, phase0):
    """Write the row of the impact that a lane had in this tick."""
    sine, cosine = L[f.SIN + i], L[f.COS + i]
    omega = L[f.OMEGA + i]
    phase = advance_phase(math.atan2(sine, cosine), 0.0)
    row[col.KIND] = col.IMPACT
    row[col.SIDE] = L[f.WALL + i]
    row[col.TIME] = _clock(omega, L[f.PERIOD + i], phase, phase0, length - L[f.LEFT + i])
    row[col.TAU] = L[f.FLIGHT + i]
    row[col.PHASE] = phase
    row[col.X1] = L[f.X_FREE + i] + (L[f.Q_RE + i] * cosine - L[f.Q_IM + i] * sine)
    row[col.V1] = L[f.BEFORE1 + i]
    row[col.X2] = L[f.BALL + i]
    row[col.V2] = L[f.BEFORE2 + i]
    row[col.A_V1] = L[f.V_FREE + i] - omega * (L[f.Q_RE + i] * sine + L[f.Q_IM + i] * cosine)
    row[col.A_V2] = L[f.SPEED + i]
    row[col.MODE] = 0.0
    row[col.RUN] = 0.0
