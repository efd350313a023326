"""The event loop for several balls: the next contact of any of them, the release of those that ride, what merges."""

from __future__ import annotations

from vines.dynamics._advance import (
    AFRESH,
    BUFFER_FULL,
    COMPLETE,
    EVENT_CAP,
    RELEASE,
    S_CLEAR,
    S_DECIDE,
    S_MODE,
    S_PERIOD_START,
    S_PHASE,
    S_T,
    S_T_LOW,
    S_V1,
    S_X1,
    SNAP,
    START,
    STEP_LIMIT,
    STICK,
    advance,
    advance_phase,
    begin,
    move,
    too_many,
)
from vines.dynamics._contact import CONTACT, NO_CONTACT, STEP_CAP
from vines.dynamics._flight import derivatives, flight, flown
from vines.dynamics._sticking import merges, release_within
from vines.dynamics.parallel._constants import BETA, CORRECTION, MU, ParallelConstants, R, frame_with, of_ball, riding
from vines.dynamics.parallel._contacts import first_hits
from vines.dynamics.parallel._layout import (
    B_BETA,
    B_DECIDE,
    B_MODE,
    B_RELEASED,
    B_RUN,
    B_STEP,
    B_V2,
    B_WALL,
    B_X2,
    at,
)
from vines.dynamics.parallel._rows import count_riding, place_balls, write
from vines.dynamics.parallel._strike import PASSES, strike, strike_alone
from vines.kernels import entry_njit, fused_njit, linked_njit, loop_njit, rounded_once

__all__ = ["set_balls"]


@entry_njit
def set_balls(c, state, x1, v1, x2, v2, phase, t):
    """Put a run at its start; x2 and v2 are arrays with one number a ball. See `set_state`."""
    state[:] = 0.0
    state[S_X1], state[S_V1] = x1, v1
    state[S_PHASE], state[S_T], state[S_PERIOD_START] = advance_phase(phase, 0.0), t, t
    for i in range(c.balls):
        w, beta = x1 - x2[i], of_ball(c.each, i, BETA)
        side = 0
        if abs(w) >= beta - SNAP * (beta + abs(x1) + abs(x2[i])):
            side = 1 if w > 0.0 else -1
        approaching = side * (v1 - v2[i]) > 0.0
        state[at(i, B_BETA)] = beta
        state[at(i, B_X2)] = x1 - side * beta if side != 0 else x2[i]
        state[at(i, B_V2)] = v2[i]
        state[at(i, B_WALL)] = 0.0 if approaching else side
        if side != 0 and not approaching:
            state[at(i, B_DECIDE)] = state[S_DECIDE] = 1.0


@begin.register(ParallelConstants)
@linked_njit
def _begin(c, state, rows):
    write(c.balls, rows[0], state, START, state[at(0, B_WALL)], 0.0, 0, state[S_V1], state[at(0, B_V2)], 0.0, 0.0)


@fused_njit
def _merge(c, o, motion, modes, state, rows, count):
    """Let the first ball that is to ride from now on do so; return how many rows there are then."""
    for i in range(c.balls):
        if state[at(i, B_DECIDE)] == 0.0:
            continue
        state[at(i, B_DECIDE)] = 0.0
        wall, v1, v2 = state[at(i, B_WALL)], state[S_V1], state[at(i, B_V2)]
        speed = max(wall * (v2 - v1), 0.0)
        r, correction = of_ball(c.each, i, R), of_ball(c.each, i, CORRECTION)
        if not merges(c, o, r, correction, int(wall), speed, motion, state[at(i, B_X2)]):
            continue
        mass = 1.0 + riding(c, modes)
        mu = of_ball(c.each, i, MU)
        common = rounded_once(mu, v2, mass * v1) / (mass + mu)
        state[S_V1] = common
        state[at(i, B_MODE)], state[at(i, B_RELEASED)] = wall, 0.0
        for k in range(c.balls):
            if state[at(k, B_MODE)] != 0.0:
                state[at(k, B_V2)] = common
        count_riding(c.balls, state)
        state[at(i, B_X2)] = state[S_X1] - wall * state[at(i, B_BETA)]
        write(c.balls, rows[count], state, STICK, wall, 0.0, i, v1, v2, 0.0, modes)
        state[at(i, B_RUN)] = 0.0
        return count + 1
    state[S_DECIDE] = 0.0
    return count


@linked_njit
def _let_go(c, side, state, tau, rows, count):
    """Release all balls that ride; return how many rows there are then."""
    after = flight(c, c.free, state[S_X1], state[S_V1], state[S_PHASE], state[S_T])
    _, _, _, j, _ = derivatives(c.free, c.Omega, *after)
    for i in range(c.balls):
        if state[at(i, B_MODE)] != 0.0:
            state[at(i, B_MODE)], state[at(i, B_WALL)] = 0.0, side
            # Contact may be lost at once, with a push away from the wall that is not zero.
            state[at(i, B_RELEASED)] = 0.0 if side * j >= 0.0 else 1.0
    state[S_MODE] = 0.0
    for i in range(c.balls):
        if state[at(i, B_STEP)] == RIDES:
            v1, v2 = state[S_V1], state[at(i, B_V2)]
            write(c.balls, rows[count], state, RELEASE, float(side), tau, i, v1, v2, 0.0, 0.0)
            tau = 0.0
            count += 1
    return count


RIDES = 2.0
"""Mark of the balls that are about to be released."""


@advance.register(ParallelConstants)
@loop_njit
def _advance(c, state, stop, cap, rows, first):
    n = c.balls
    count = first
    # One instant may write this many rows.
    size = rows.shape[0] - (PASSES + 1) * n
    modes = state[S_MODE]
    o = frame_with(c, modes)
    while True:
        if count >= size:
            return count, BUFFER_FULL
        left = (stop - state[S_T]) - state[S_T_LOW]
        if left < 0.0:
            return count, COMPLETE
        if state[S_MODE] != modes:
            modes = state[S_MODE]
            o = frame_with(c, modes)
        motion = flight(c, o, state[S_X1], state[S_V1], state[S_PHASE], state[S_T])
        if state[S_DECIDE] != 0.0:
            merged = _merge(c, o, motion, modes, state, rows, count)
            if merged > count:
                count = merged
                if too_many(state, cap, c.period):
                    return count, EVENT_CAP
                continue

        until = min(left, AFRESH)
        clear = state[S_CLEAR]
        side, release, x, v = 0, NO_CONTACT, 0.0, 0.0
        low = until
        if modes != 0.0:
            side = 1 if modes > 0.0 else -1
            release, tau, x, v = release_within(c, o, side, motion, clear, until)
            low = tau
            if release == CONTACT:
                until = tau
        code, tau, hits, x_hit, v_hit = first_hits(c, o, motion, state, clear, until)
        if code == NO_CONTACT and release == CONTACT:
            tau = until
            for i in range(n):
                state[at(i, B_STEP)] = RIDES if state[at(i, B_MODE)] != 0.0 else 0.0
        elif code == CONTACT:
            x, v = x_hit, v_hit
        else:
            state[S_CLEAR] = min(tau, low)
            if STEP_CAP in (code, release):
                return count, STEP_LIMIT
            if left <= AFRESH:
                return count, COMPLETE
            tau = state[S_CLEAR]
            x, v, _, _, _ = derivatives(o, c.Omega, *flown(c, o, motion, tau))
        on_wall = place_balls(c, state, x, v, tau)
        move(c, state, tau)
        state[S_X1], state[S_V1] = x, v
        if code == CONTACT and not on_wall and hits & (hits - 1) == 0:
            i = 0
            while hits > 1:
                hits >>= 1
                i += 1
            state[at(i, B_X2)] = x - state[at(i, B_STEP)] * state[at(i, B_BETA)]
            count = strike_alone(c, state, i, tau, rows, count)
            if too_many(state, cap, c.period):
                return count, EVENT_CAP
        elif code == CONTACT:
            for i in range(n):
                if hits & (1 << i):
                    state[at(i, B_X2)] = x - state[at(i, B_STEP)] * state[at(i, B_BETA)]
            before = count
            count, whole = strike(c, state, hits, tau, rows, count)
            for _ in range(count - before):
                whole = whole and not too_many(state, cap, c.period)
            if not whole:
                return count, EVENT_CAP
        elif release == CONTACT:
            count = _let_go(c, side, state, tau, rows, count)
            if too_many(state, cap, c.period):
                return count, EVENT_CAP
        else:
            write(c.balls, rows[count], state, START, 0.0, tau, 0, v, state[at(0, B_V2)], 0.0, modes)
            count += 1
