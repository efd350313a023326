"""The event loop of a ball that slides: impacts, turns, stops in mid-cavity, sticking on a wall, and what ends them.

While the ball slides in one sense its gap is monotone, so that it comes to the wall ahead or to w' = 0, whichever is
first. There it stops where friction holds it, and turns where it does not.
"""

from __future__ import annotations

import math

from vines.dynamics._advance import (
    AFRESH,
    BUFFER_FULL,
    COMPLETE,
    EVENT_CAP,
    KIND,
    RELEASE,
    RUN,
    S_CLEAR,
    S_DECIDE,
    S_MODE,
    S_PHASE,
    S_RELEASED,
    S_RUN,
    S_RUN_SIDE,
    S_T,
    S_T_LOW,
    S_V1,
    S_V2,
    S_WALL,
    S_X1,
    S_X2,
    SLIDE,
    START,
    STEP_LIMIT,
    STOP,
    advance,
    begin,
    merge,
    move,
    place,
    strike,
    too_many,
    write_row,
)
from vines.dynamics._contact import CONTACT, NO_CONTACT, STEP_CAP, contact_within
from vines.dynamics._flight import derivatives, fifth, launched, modulus, turn
from vines.dynamics._steps import leaving_step
from vines.dynamics._sticking import merges, release_within
from vines.dynamics._window import width_of, write_end
from vines.dynamics.friction._constants import FrictionConstants, FrictionTable
from vines.dynamics.friction._motion import SENSE, SPEED, WAY, draws, sliding
from vines.kernels import fused_njit, linked_njit, loop_njit

__all__: list[str] = []

for _name in (begin, write_end):
    _name.register(FrictionConstants)(_name.first)
width_of.register(FrictionTable)(width_of.first)

LAST_INSIDE = math.nextafter(1.0, 0.0)
CENTRE = 1e-300
"""The gap of a ball that stops right in the middle: MODE is the gap at which it rides, and 0 says that it does not."""


@linked_njit
def _next_rest(c, motion, still, released, tau, stop):
    """Return the code and the time of the first w' = 0 after tau, as `next_release` does.

    `still` says that w' = 0 exactly at the beginning, `released` that w'' is too.
    """
    sense = int(motion[SENSE])
    if still and tau == 0.0:
        _, _, _, a, j = derivatives(c.rate.free, c.Omega, *motion)
        bound = modulus(*fifth(c.rate.free, *motion)) + modulus(motion[2], motion[3]) * c.rate.Omega4 * c.window
        pace = 0.0 if released else max(sense * a, 0.0)
        tau = leaving_step(pace, -sense * j, bound, 0.0, c.window)
        if tau > stop:
            return NO_CONTACT, 0.0
    code, at, _, _ = release_within(c.rate, c.rate.free, sense, motion, tau, stop)
    if code == CONTACT:
        # The search ends on a Taylor polynomial, which leaves 1e-11 of a velocity that is set to 0 now.
        _, _, speed, a, _ = derivatives(c.rate.free, c.Omega, *turn(c.rate.free, c.Omega, *motion, at))
        step = speed / a if sense * a < 0.0 else 0.0
        if abs(step) < 1e-9:
            at = max(at - step, tau)
    return code, at


@linked_njit
def _next_slide(c, mode, motion, tau, stop):
    """Return the code, the time and x1, v1 of the end of a ride after tau, as `next_release` does."""
    code, at, x, v = NO_CONTACT, math.inf, 0.0, 0.0
    if mode > -1.0:
        code, at, x, v = release_within(c.low, c.stuck, 1, motion, tau, stop)
    if mode < 1.0 and code != STEP_CAP:
        other, when, y, w = release_within(c.high, c.stuck, -1, motion, tau, at if code == CONTACT else stop)
        if other != NO_CONTACT or code == NO_CONTACT:
            code, at, x, v = other, min(at, when) if other == NO_CONTACT else when, y, w
    return code, at, x, v


@fused_njit
def _sticks(c, state, wall):
    """Say whether the ball that has just left a wall is to be taken as riding on it from now on."""
    x, v, v2, phase = state[S_X1], state[S_V1], state[S_V2], state[S_PHASE]
    speed = max(wall * (v2 - v), 0.0)
    held = (1.0 + c.mu) * c.friction
    if speed == 0.0 and c.friction > 0.0:
        return wall * draws(c, x, v, phase) >= -held
    # It comes back more slowly than it went: friction is against the push then.
    back = sliding(c, c.free, x, v, v2, phase, float(wall))
    return merges(c.gap, c.gap.free, c.r, c.correction, wall, speed, back, state[S_X2])


@linked_njit
def _halt(c, state, tau, sense, row, starts):
    """Let a ball that does not move against the cavity stop, or turn; say whether the row was written."""
    x, v = state[S_X1], state[S_V1]
    if abs(draws(c, x, v, state[S_PHASE])) <= (1.0 + c.mu) * c.friction:
        w = x - state[S_X2]
        w = math.copysign(min(abs(w), LAST_INSIDE), w) if w != 0.0 else CENTRE
        place(state, w, 0.0, 0.0, x, v, x - w, v)
        write_row(row, state, STOP, sense, tau, x, v, x - w, v)
        return True
    if starts:
        return False
    place(state, 0.0, 0.0, 0.0, x, v, state[S_X2], v)
    write_row(row, state, SLIDE, -sense, tau, x, v, state[S_X2], v)
    return True


@advance.register(FrictionConstants)
@loop_njit
def _advance(c, state, stop, cap, rows, first):
    count = first
    size = rows.shape[0]
    period = c.period
    while True:
        if count >= size:
            return count, BUFFER_FULL
        left = (stop - state[S_T]) - state[S_T_LOW]
        if left < 0.0:
            return count, COMPLETE
        if count > first and too_many_rows(rows[count - 1], state, cap, period):
            return count, EVENT_CAP
        mode = state[S_MODE]
        x1, v1, x2, v2 = state[S_X1], state[S_V1], state[S_X2], state[S_V2]
        o = c.stuck if mode != 0.0 else c.free
        motion = launched(c, o, x1, v1, v2, state[S_PHASE], state[S_T])
        until = min(left, AFRESH)

        if mode != 0.0:
            code, tau, x, v = _next_slide(c, mode, motion, state[S_CLEAR], until)
            if code == CONTACT:
                move(c, state, tau)
                wall = mode if abs(mode) == 1.0 else 0.0
                place(state, 0.0, wall, 1.0, x, v, x - mode, v)
                sense = 1.0 if draws(c, x, v, state[S_PHASE]) > 0.0 else -1.0
                kind, side = (RELEASE, wall) if wall != 0.0 else (SLIDE, sense)
                write_row(rows[count], state, kind, side, tau, x, v, x - mode, v)
                rows[count, RUN] = 1.0
                count += 1
                continue
        else:
            wall = int(state[S_WALL])
            if state[S_DECIDE] != 0.0:
                state[S_DECIDE] = 0.0
                if wall != 0 and _sticks(c, state, wall):
                    merge(c, state, wall, x1, v1, x2, v2, rows[count])
                    count += 1
                    continue
                if wall == 0 and v1 == v2 and _halt(c, state, 0.0, motion[SENSE], rows[count], True):
                    count += 1
                    continue
            released = state[S_RELEASED] != 0.0
            rest, halts = NO_CONTACT, math.inf
            if c.friction > 0.0:
                rest, halts = _next_rest(c, motion, v1 == v2, released, state[S_CLEAR], until)
            code, tau, hit, _, _ = contact_within(
                c.gap, motion, x2, 0.0, wall, released, state[S_CLEAR], halts if rest == CONTACT else until
            )
            if code == CONTACT:
                move(c, state, tau)
                now = turn(c.free, c.Omega, *motion, tau)
                x, v, _, _, _ = derivatives(c.free, c.Omega, *now)
                if hit != state[S_RUN_SIDE] or released or state[S_RUN] == 0.0:
                    state[S_RUN] = 1.0
                else:
                    # The row of the turn between belongs to the chatter too.
                    state[S_RUN] += 2.0 if c.friction > 0.0 else 1.0
                state[S_RUN_SIDE] = hit
                strike(c.law, state, hit, tau, x, v, now[SPEED], rows[count])
                count += 1
                continue
            if code == NO_CONTACT and rest == CONTACT:
                tau = halts
                now = turn(c.free, c.Omega, *motion, tau)
                x, v, _, _, _ = derivatives(c.free, c.Omega, *now)
                move(c, state, tau)
                place(state, 0.0, 0.0, 0.0, x, v, x2 + now[WAY], v)
                _halt(c, state, tau, motion[SENSE], rows[count], False)
                if rows[count, KIND] == STOP:
                    state[S_RUN] = 0.0
                count += 1
                continue
            if rest == NO_CONTACT and c.friction > 0.0:
                tau = min(tau, halts)
            if rest == STEP_CAP:
                code = STEP_CAP

        state[S_CLEAR] = tau
        if code != NO_CONTACT:
            return count, STEP_LIMIT
        if left <= AFRESH:
            return count, COMPLETE
        now = turn(o, c.Omega, *motion, tau)
        x, v, _, _, _ = derivatives(o, c.Omega, *now)
        move(c, state, tau)
        if mode != 0.0:
            place(state, mode, state[S_WALL], 0.0, x, v, x - mode, v)
        else:
            place(state, 0.0, 0.0, 0.0, x, v, x2 + now[WAY], now[SPEED])
        write_row(rows[count], state, START, 0, tau, x, v, state[S_X2], state[S_V2])
        count += 1


@fused_njit
def too_many_rows(row, state, cap, period):
    """Count the event of a row that was just written; say whether there were too many."""
    return row[KIND] != START and too_many(state, cap, period)
