"""Run many trajectories in lanes: load, tick, hand what is rare to the scalar kernel, record, refill.

A trajectory is first run for some forcing periods of which nothing is kept, then for those that are recorded. Lanes do
not know of each other, so a result does not depend on which trajectories run beside it.
"""

from __future__ import annotations

import math

import numpy as np

from vines.dynamics import _advance as col
from vines.dynamics import _lane_fields as f
from vines.dynamics._advance import advance, set_state, state_now
from vines.dynamics._constants import constants_kernel
from vines.dynamics._contact import first_step
from vines.dynamics._flight import advance_phase, derivatives, phasors, turn
from vines.dynamics._jit import njit
from vines.dynamics._lanes import tick
from vines.dynamics._sticking import merges
from vines.dynamics._tangent import carry_basis
from vines.dynamics._totals import (
    ENERGY_CHANGE,
    MAX_ABS_X1,
    add_segment,
    count_event,
    state_energy,
)

__all__ = ["CAP", "DONE", "FINAL", "LIMIT", "OVERFLOW", "WITH_EXPONENTS", "WITH_IMPACTS", "WITH_MEASURES", "run_block"]

LANES = f.LANES
FINAL, WITH_MEASURES, WITH_IMPACTS, WITH_EXPONENTS = 0, 1, 2, 4
"""What is recorded beside the final states; they add up."""

DONE, CAP, LIMIT, OVERFLOW = 0, 1, 2, 3
"""How a trajectory ended: at its time, at the cap of events in a period, at that of steps, with the buffer full."""

UNHURRIED = 4
"""Ticks between two looks for waiting lanes when no event is recorded."""

LANE_WINDOW = 1.4
"""Longest step of a lane, in units of the shortest time scale; half an angle stays below pi/4."""

LANE_NEAR = 1e-3
"""Longest last step to a contact; the Taylor polynomial of sixth order is exact to rounding over it."""

STAGE, WHO, PHASE0 = 0, 1, 2


@njit
def _constants_of(parameters):
    return constants_kernel(parameters[0], parameters[1], parameters[2], parameters[3], parameters[4])


@njit
def _fill(c, state, L, i, length):
    """Put a lane where the scalar state is, in flight; say whether it can run there."""
    wall = state[col.S_WALL]
    released = state[col.S_RELEASED] != 0.0
    x, v, phase = state[col.S_X1], state[col.S_V1], state[col.S_PHASE]
    zr, zi, qr, qi = phasors(c.free, c.Omega, x, v, phase)
    step = 0.0
    if wall != 0.0:
        step = first_step(c, zr, zi, qr, qi, state[col.S_V2], int(wall), released)
        if step < 1e-8:
            return False
    fastest = max(1.0, c.Omega)
    elapsed = state[col.S_T] + state[col.S_T_LOW]
    left = length - elapsed
    step = min(step, LANE_WINDOW / fastest)
    if left <= step + 1e-9:
        return False
    forced = math.sqrt(c.free.qr**2 + c.free.qi**2)
    L[f.HALF + i] = c.free.half
    L[f.GAMMA + i] = c.free.gamma
    L[f.INVERSE + i] = 1.0 / c.free.gamma
    L[f.OMEGA + i] = c.Omega
    L[f.LAM + i] = c.lam
    L[f.PASS1 + i] = c.pass1
    L[f.PASS2 + i] = c.pass2
    L[f.Q_RE + i] = c.free.qr
    L[f.Q_IM + i] = c.free.qi
    L[f.FORCED5 + i] = forced * c.Omega4 * c.Omega
    L[f.WINDOW + i] = LANE_WINDOW / fastest
    L[f.NEAR + i] = LANE_NEAR / fastest
    L[f.CORRECTION + i] = c.correction
    L[f.PERIOD + i] = 2.0 * math.pi / c.Omega
    L[f.X_FREE + i] = zr
    L[f.V_FREE + i] = v + c.Omega * qi
    L[f.COS + i] = math.cos(phase)
    L[f.SIN + i] = math.sin(phase)
    L[f.BALL + i] = state[col.S_X2]
    L[f.SPEED + i] = state[col.S_V2]
    L[f.LEFT + i] = left
    L[f.MOVE + i] = step
    L[f.FREE5 + i] = math.sqrt(zr * zr + zi * zi)
    L[f.POLISH + i] = 0.0
    L[f.TAU + i] = 0.0
    L[f.WALL + i] = wall
    L[f.RELEASED + i] = 1.0 if released else 0.0
    L[f.CHAIN + i] = 0.0 if released or state[col.S_RUN_SIDE] != wall else state[col.S_RUN]
    L[f.BUSY + i] = state[col.S_PERIOD_EVENTS]
    L[f.BEGAN + i] = left + (elapsed - state[col.S_PERIOD_START])
    L[f.WAITS + i] = 0.0
    L[f.HIT + i] = 0.0
    return True


@njit
def _clock(c, phase, phase0, roughly):
    """Return the time since `phase0` was the phase: exact to the rounding of the phase, its period from `roughly`."""
    period = 2.0 * math.pi / c.Omega
    part = advance_phase(phase - phase0, 0.0) / c.Omega
    return part + period * round((roughly - part) / period)


@njit
def _take(c, L, i, state, length, phase0):
    """Put the scalar state where the flight of a lane began."""
    tau = L[f.TAU + i]
    xh, vh = L[f.X_FREE + i], L[f.V_FREE + i]
    qr = c.free.qr * L[f.COS + i] - c.free.qi * L[f.SIN + i]
    qi = c.free.qr * L[f.SIN + i] + c.free.qi * L[f.COS + i]
    zr, zi, qr, qi = turn(c.free, c.Omega, xh, -(vh + c.free.half * xh) / c.free.gamma, qr, qi, -tau)
    x, v, _, _, _ = derivatives(c.free, c.Omega, zr, zi, qr, qi)
    wall = L[f.WALL + i]
    phase = advance_phase(math.atan2(L[f.SIN + i], L[f.COS + i]), -c.Omega * tau)
    began = _clock(c, phase, phase0, length - (L[f.LEFT + i] + tau))
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


@njit
def _may_fly(c, state):
    """Say whether the scalar state is that of an ordinary flight."""
    if state[col.S_MODE] != 0.0:
        return False
    if state[col.S_DECIDE] != 0.0:
        wall = state[col.S_WALL]
        zr, zi, qr, qi = phasors(c.free, c.Omega, state[col.S_X1], state[col.S_V1], state[col.S_PHASE])
        speed = max(wall * (state[col.S_V2] - state[col.S_V1]), 0.0)
        return not merges(c, int(wall), speed, zr, zi, qr, qi, state[col.S_X2])
    return True


@njit
def _note(c, row, last, total, what, basis, growth, events, filled, who):
    """Record an event of the part of a run that is kept; return how much of `events` is filled, -1 if it is full."""
    kind = row[col.KIND]
    # The flight in which the recording began is older than it.
    tau = row[col.TIME] - last[col.TIME] if last[col.KIND] == col.START else row[col.TAU]
    if what & WITH_MEASURES:
        if kind in (col.IMPACT, col.STICK):
            count_event(c, total, row)
        add_segment(
            c, total, last[col.MODE], last[col.TIME], last[col.X1], last[col.A_V1], last[col.A_V2], last[col.PHASE], tau
        )
    if what & WITH_EXPONENTS:
        carry_basis(c, last[col.MODE], row, tau, basis, growth)
    if what & WITH_IMPACTS and kind != col.START:
        if filled >= events.shape[0]:
            return -1
        events[filled, : col.ROW] = row
        events[filled, col.ROW] = who
        filled += 1
    last[:] = row
    return filled


@njit
def _open(c, mode, x1, v1, x2, v2, phase, last, total, basis, growth):
    """Begin the part of a run that is kept."""
    last[:] = 0.0
    last[col.KIND] = col.START
    last[col.PHASE] = phase
    last[col.X1], last[col.V1], last[col.A_V1] = x1, v1, v1
    last[col.X2], last[col.V2], last[col.A_V2] = x2, v2, v2
    last[col.MODE] = mode
    if total.shape[0]:
        total[:] = 0.0
        total[MAX_ABS_X1] = abs(x1)
        total[ENERGY_CHANGE] = -state_energy(c, x1, v1, v2, phase)
    basis[:, :] = np.eye(4)
    growth[:] = 0.0


@njit
def run_block(parameters, starts, first, lengths, cap, what, finals, totals, growths, counts, status, events):
    """Run a block of trajectories.

    Parameters
    ----------
    parameters : ndarray, shape (n, 5)
        mu, A, Omega, r, lam of each.
    starts : ndarray, shape (n, 5)
        x1, v1, x2, v2 and phase of each.
    first, lengths : ndarray, shape (n,)
        Time to run first, and time to record after it.
    cap : int
        Most events in one forcing period.
    what : int
        Sum of WITH_MEASURES, WITH_IMPACTS, WITH_EXPONENTS.
    finals : ndarray, shape (n, 6)
        Receives x1, v1, x2, v2, phase and the wall stuck to.
    totals : ndarray, shape (n or 0, TOTALS)
        Receives the totals of the time recorded, from which measures follow.
    growths : ndarray, shape (n or 0, 5)
        Receives the logarithmic growth of four orthogonal disturbances in the time recorded, and that time.
    counts, status : ndarray of int64, shape (n,)
        Receive the number of impacts in all, and DONE, CAP, LIMIT or OVERFLOW.
    events : ndarray, shape (m, ROW + 1)
        Receives the events of the time recorded, the number of the trajectory last.

    Returns
    -------
    int
        Events filled.
    """
    n = parameters.shape[0]
    L = np.zeros(f.SIZE)
    L[f.WAITS : f.WAITS + LANES] = 1.0
    state = np.zeros(col.STATE)
    row = np.zeros((1, col.ROW))
    last = np.zeros((LANES, col.ROW))
    total = np.zeros((LANES, totals.shape[1]))
    basis = np.zeros((LANES, 4, 4))
    growth = np.zeros((LANES, 5))
    run = np.full((LANES, 3), -1.0)
    # The constants of the trajectory in each lane.
    held = [_constants_of(parameters[0]) for _ in range(LANES)]
    next_one = 0
    active = 0
    filled = 0
    looks = 1 if what else UNHURRIED
    while True:
        for i in range(LANES):
            if what and L[f.HIT + i] > 0.0 and run[i, STAGE] == 1.0:
                who = int(run[i, WHO])
                c = held[i]
                _row_of(c, L, i, row[0], lengths[who], run[i, PHASE0])
                filled = _note(c, row[0], last[i], total[i], what, basis[i], growth[i], events, max(filled, 0), who)
                if filled < 0:
                    status[who] = OVERFLOW
                    return events.shape[0]
            if L[f.WAITS + i] == 0.0:
                continue
            # A waiting lane: with a new trajectory, or with one that the scalar kernel has to see to.
            while True:
                if run[i, WHO] < 0.0:
                    if next_one >= n:
                        break
                    who = next_one
                    next_one += 1
                    active += 1
                    c = _constants_of(parameters[who])
                    held[i] = c
                    s = starts[who]
                    set_state(state, s[0], s[1], s[2], s[3], s[4], 0.0)
                    run[i, WHO] = who
                    run[i, STAGE] = 0.0 if first[who] > 0.0 else 1.0
                    run[i, PHASE0] = state[col.S_PHASE]
                    counts[who] = 0
                    status[who] = DONE
                    L[f.IMPACTS + i] = 0.0
                    length = lengths[who] if run[i, STAGE] == 1.0 else first[who]
                    if run[i, STAGE] == 1.0:
                        _open(c, 0.0, s[0], s[1], s[2], s[3], s[4], last[i], total[i], basis[i], growth[i])
                    if _may_fly(c, state) and _fill(c, state, L, i, length):
                        break
                else:
                    who = int(run[i, WHO])
                    c = held[i]
                    length = lengths[who] if run[i, STAGE] == 1.0 else first[who]
                    _take(c, L, i, state, length, run[i, PHASE0])
                flies = False
                while True:
                    length = lengths[who] if run[i, STAGE] == 1.0 else first[who]
                    _, code = advance(c, state, length, cap, row, 0)
                    if code in (col.BUFFER_FULL, col.EVENT_CAP):
                        if row[0, col.KIND] == col.IMPACT:
                            L[f.IMPACTS + i] += 1.0
                        if what and run[i, STAGE] == 1.0:
                            filled = _note(
                                c, row[0], last[i], total[i], what, basis[i], growth[i], events, max(filled, 0), who
                            )
                            if filled < 0:
                                status[who] = OVERFLOW
                                return events.shape[0]
                    if code == col.BUFFER_FULL:
                        if _may_fly(c, state) and _fill(c, state, L, i, length):
                            flies = True
                            break
                        continue
                    if code == col.COMPLETE:
                        x1, v1, x2, v2, phase, _ = state_now(c, state, length)
                        if run[i, STAGE] == 0.0:
                            # On with the part that is kept: the same flight, its time counted from here.
                            state[col.S_T] -= length
                            state[col.S_PERIOD_START] -= length
                            run[i, STAGE] = 1.0
                            run[i, PHASE0] = phase
                            _open(c, state[col.S_MODE], x1, v1, x2, v2, phase, last[i], total[i], basis[i], growth[i])
                            if _may_fly(c, state) and _fill(c, state, L, i, lengths[who]):
                                flies = True
                                break
                            continue
                        if what:
                            row[0, :] = 0.0
                            row[0, col.KIND] = col.END
                            row[0, col.TIME] = length
                            row[0, col.TAU] = length - last[i, col.TIME]
                            row[0, col.PHASE] = phase
                            row[0, col.X1], row[0, col.V1], row[0, col.A_V1] = x1, v1, v1
                            row[0, col.X2], row[0, col.V2], row[0, col.A_V2] = x2, v2, v2
                            row[0, col.MODE] = state[col.S_MODE]
                            filled = _note(
                                c, row[0], last[i], total[i], what, basis[i], growth[i], events, max(filled, 0), who
                            )
                            if filled < 0:
                                status[who] = OVERFLOW
                                return events.shape[0]
                            if what & WITH_MEASURES:
                                total[i, ENERGY_CHANGE] += state_energy(c, x1, v1, v2, phase)
                                totals[who] = total[i]
                            if what & WITH_EXPONENTS:
                                growths[who] = growth[i]
                    else:
                        status[who] = CAP if code == col.EVENT_CAP else LIMIT
                        x1, v1, x2, v2, phase, _ = state_now(c, state, state[col.S_T] + state[col.S_T_LOW])
                        if what & WITH_MEASURES:
                            totals[who] = total[i]
                        if what & WITH_EXPONENTS:
                            growths[who] = growth[i]
                    finals[who, 0], finals[who, 1], finals[who, 2], finals[who, 3] = x1, v1, x2, v2
                    finals[who, 4], finals[who, 5] = phase, state[col.S_MODE]
                    counts[who] = int(L[f.IMPACTS + i])
                    run[i, WHO] = -1.0
                    active -= 1
                    break
                if flies:
                    break
        if active == 0 and next_one >= n:
            return filled
        for _ in range(looks):
            tick(L, cap)


@njit
def _row_of(c, L, i, row, length, phase0):
    """Write the row of the impact that a lane had in this tick."""
    side = L[f.WALL + i]
    qr = c.free.qr * L[f.COS + i] - c.free.qi * L[f.SIN + i]
    qi = c.free.qr * L[f.SIN + i] + c.free.qi * L[f.COS + i]
    phase = advance_phase(math.atan2(L[f.SIN + i], L[f.COS + i]), 0.0)
    row[col.KIND] = col.IMPACT
    row[col.SIDE] = side
    row[col.TIME] = _clock(c, phase, phase0, length - L[f.LEFT + i])
    row[col.TAU] = L[f.FLIGHT + i]
    row[col.PHASE] = phase
    row[col.X1] = L[f.X_FREE + i] + qr
    row[col.V1] = L[f.BEFORE1 + i]
    row[col.X2] = L[f.BALL + i]
    row[col.V2] = L[f.BEFORE2 + i]
    row[col.A_V1] = L[f.V_FREE + i] - c.Omega * qi
    row[col.A_V2] = L[f.SPEED + i]
    row[col.MODE] = 0.0
    row[col.RUN] = 0.0
